#include "output/natural_curvature.hpp"

#include <algorithm>

#include "der/core/index.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {
namespace {

Vec2 drawn_edge(const RodLayout& rod, Index edge, const Model& model) {
  const auto dofs = rod.edge_dofs(edge, model);
  return model.initial_positions.segment<2>(dofs[2]) - model.initial_positions.segment<2>(dofs[0]);
}

}  // namespace

NaturalCurvature::NaturalCurvature(const RodLayout& rod, const Model& model) {
  if (!rod.natural_curvature.empty()) {
    arc_length_ = rod.arc_length;
    values_ = rod.natural_curvature;
    return;
  }
  for (Index i = 1; i < rod.num_edges(); ++i) {
    const double before = rod.edge_length[der::to_size(i - 1)];
    const double after = rod.edge_length[der::to_size(i)];
    arc_length_.push_back(rod.arc_length[der::to_size(i)] + (after - before) / 3.0);
    values_.push_back(angle_between(drawn_edge(rod, i - 1, model), drawn_edge(rod, i, model)) /
                      (0.5 * (before + after)));
  }
}

double NaturalCurvature::at(double s) const {
  if (values_.empty()) return 0.0;
  if (values_.size() == 1) return values_.front();
  const auto above = static_cast<std::size_t>(
      std::upper_bound(arc_length_.begin(), arc_length_.end(), s) - arc_length_.begin());
  const std::size_t right = std::clamp<std::size_t>(above, 1, arc_length_.size() - 1);
  const double share = (s - arc_length_[right - 1]) / (arc_length_[right] - arc_length_[right - 1]);
  return (1.0 - share) * values_[right - 1] + share * values_[right];
}

}  // namespace der
