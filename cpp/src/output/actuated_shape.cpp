#include "output/actuated_shape.hpp"

#include <algorithm>

#include "der/core/index.hpp"
#include "der/model/clamp_cell.hpp"
#include "der/model/location.hpp"

namespace der {

ActuatedRest::ActuatedRest(const RestShift& shift, Index size, const Model& model) {
  if (shift.entry < 0) return;
  for (Index i = 0; i < size; ++i) {
    for (RestShape::Term term : model.rest_shape.terms_of(shift.entry + i)) {
      term.entry = i;
      terms_.push_back(term);
    }
  }
}

double ActuatedRest::value(Index i, const Model& model, const State& state) const {
  double sum = 0.0;
  for (const auto& [entry, control, weight] : terms_) {
    if (entry == i) sum += weight * control_value(model, state, control);
  }
  return sum;
}

Vec3 ActuatedRest::strains(const Model& model, const State& state) const {
  Vec3 sum = Vec3::Zero();
  for (const auto& [entry, control, weight] : terms_) {
    sum[entry] += weight * control_value(model, state, control);
  }
  return sum;
}

Vec3 ActuatedShape::strains(double s, bool before, const Model& model, const State& state) const {
  Vec3 sum = Vec3::Zero();
  for (const ActuatedStretch& stretch : stretches_) {
    if (!stretch.strains()) continue;
    const double profile = stretch.profile_at(s, before);
    if (profile == 0.0) continue;
    const Index first = stretch.what == scenario::Actuated::Twist ? 2 : 0;
    for (Index i = 0; i < 2; ++i) {
      const Index control = stretch.controls[to_size(i)];
      if (control >= 0) sum[first + i] += profile * control_value(model, state, control);
    }
  }
  return sum;
}

bool ActuatedShape::is_strained() const {
  return std::any_of(stretches_.begin(), stretches_.end(),
                     [](const ActuatedStretch& stretch) { return stretch.strains(); });
}

double actuated_lean(const RodLayout& rod, Index edge) {
  // A uniform curvature turns half of itself over half of an edge, on to its middle.
  const double a = rod.clamp_at(edge) != nullptr ? kPivotShare : 0.0;
  const double b = rod.clamp_at(edge + 1) != nullptr ? kPivotShare : 0.0;
  const double direction = 0.5 + 0.5 * (a - b) / (1.0 - a - b);
  const double length = rod.edge_length[to_size(edge)];
  return rod.arc_length_at(edge) + direction * length - tangent_place(rod, edge);
}

}  // namespace der
