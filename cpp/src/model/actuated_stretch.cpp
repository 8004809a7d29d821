#include "der/model/actuated_stretch.hpp"

#include "der/scenario/stretch_profile.hpp"

namespace der {
namespace {

scenario::StretchProfile profile_of(const ActuatedStretch& stretch) {
  return {stretch.profile, stretch.from, stretch.to};
}

}  // namespace

double ActuatedStretch::profile_at(double s, bool before) const {
  const bool covers = before ? from < s && s <= to : from <= s && s < to;
  return covers ? profile_of(*this).at(s) : 0.0;
}

double ActuatedStretch::integral(double a, double b) const {
  return profile_of(*this).integral(a, b);
}

double ActuatedStretch::first_moment(double a, double b) const {
  return profile_of(*this).first_moment(a, b);
}

bool ActuatedStretch::jumps(bool at_end) const {
  return profile == scenario::Profile::Constant || (profile == scenario::Profile::Linear && at_end);
}

}  // namespace der
