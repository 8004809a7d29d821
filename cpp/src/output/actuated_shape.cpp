#include "output/actuated_shape.hpp"

#include <algorithm>

#include "der/core/index.hpp"

namespace der {
namespace {

/// Calls use(s) with the arc lengths [m] at which an actuation lets the curvature of a rod jump;
/// with `twists` also with those at which its twist jumps. Allocates nothing: fields ask for each
/// sample.
template <class Use>
void for_each_jump(const RodMesh& rod, bool twists, const Use& use) {
  for (const ActuatedStretch& stretch : rod.actuated_stretches) {
    if (!stretch.strains() || (!twists && stretch.what == scenario::Actuated::Twist)) continue;
    if (stretch.jumps(false)) use(stretch.from);
    if (stretch.jumps(true)) use(stretch.to);
  }
}

}  // namespace

ActuatedRest::ActuatedRest(const NaturalStrainOffset& shift, Index size, const Model& model) {
  if (shift.entry < 0) return;
  for (Index i = 0; i < size; ++i) {
    for (NaturalStrain::Term term : model.natural_strain.terms_of(shift.entry + i)) {
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

std::vector<double> actuated_jumps(const RodMesh& rod, bool twists) {
  std::vector<double> places;
  for_each_jump(rod, twists, [&](double s) {
    const bool within = s > rod.same_place() && s < rod.rest_length() - rod.same_place();
    if (within) places.push_back(s);
  });
  return places;
}

bool actuation_jumps_at_start(const RodMesh& rod) {
  if (!rod.closed) return false;
  bool found = false;
  for (const ActuatedStretch& stretch : rod.actuated_stretches) {
    const bool begins = stretch.from <= rod.same_place();
    const bool ends = stretch.to >= rod.rest_length() - rod.same_place();
    const bool jumps = (begins && stretch.jumps(false)) || (ends && stretch.jumps(true));
    found = found || (stretch.strains() && jumps);
  }
  return found;
}

bool actuation_jumps_in(Index edge, const RodMesh& rod, bool twists) {
  const double start = rod.arc_length_at(edge) + rod.same_place();
  const double end = rod.arc_length_at(edge + 1) - rod.same_place();
  bool found = false;
  for_each_jump(rod, twists, [&](double s) { found = found || (start < s && s < end); });
  return found;
}

}  // namespace der
