#include "output/natural_curvature.hpp"

#include <algorithm>

#include "der/core/index.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {
namespace {

Vec2 drawn_edge(const RodLayout& rod, Index edge, const Model& model) {
  return along_edge(rod.edge(edge, model), model.initial_positions);
}

}  // namespace

NaturalCurvature::NaturalCurvature(const RodLayout& rod, const Model& model) {
  if (!rod.natural_curvature.empty()) {
    arc_length_ = rod.arc_length;
    values_ = rod.natural_curvature;
    if (rod.closed) {
      arc_length_.push_back(rod.rest_length());
      values_.push_back(values_.front());
    }
    return;
  }
  for (Index i = 0; i <= rod.num_edges(); ++i) {
    if (!rod.is_inner(i)) continue;
    const double before = rod.edge_length[to_size(rod.edge_before(i))];
    const double after = rod.edge_length[to_size(rod.edge_after(i))];
    arc_length_.push_back(rod.arc_length_at(i) + (after - before) / 3.0);
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
