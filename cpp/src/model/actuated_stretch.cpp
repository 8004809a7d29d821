#include "der/model/actuated_stretch.hpp"

#include <algorithm>
#include <cmath>

#include "der/core/constants.hpp"

namespace der {
namespace {

/// The profile at the fraction `u` of the stretch.
double value_of(scenario::Profile kind, double u) {
  switch (kind) {
    case scenario::Profile::Constant:
      return 1.0;
    case scenario::Profile::Linear:
      return u;
    case scenario::Profile::Smooth:
      break;
  }
  const double sine = std::sin(kPi * u);
  return sine * sine;
}

/// Integral of the profile from 0 to `u`.
double integrated(scenario::Profile kind, double u) {
  switch (kind) {
    case scenario::Profile::Constant:
      return u;
    case scenario::Profile::Linear:
      return 0.5 * u * u;
    case scenario::Profile::Smooth:
      break;
  }
  return 0.5 * u - std::sin(2.0 * kPi * u) / (4.0 * kPi);
}

/// Integral of u times the profile from 0 to `u`.
double integrated_moment(scenario::Profile kind, double u) {
  switch (kind) {
    case scenario::Profile::Constant:
      return 0.5 * u * u;
    case scenario::Profile::Linear:
      return u * u * u / 3.0;
    case scenario::Profile::Smooth:
      break;
  }
  const double sine = std::sin(kPi * u);
  return 0.25 * u * u - u * std::sin(2.0 * kPi * u) / (4.0 * kPi) + sine * sine / (4.0 * kPi * kPi);
}

}  // namespace

double ActuatedStretch::profile_at(double s, bool before) const {
  const bool covers = before ? from < s && s <= to : from <= s && s < to;
  return covers ? value_of(profile, (s - from) / (to - from)) : 0.0;
}

double ActuatedStretch::integral(double a, double b) const {
  const double length = to - from;
  const auto up_to = [&](double s) {
    return length * integrated(profile, (std::clamp(s, from, to) - from) / length);
  };
  return up_to(b) - up_to(a);
}

double ActuatedStretch::first_moment(double a, double b) const {
  const double length = to - from;
  const auto up_to = [&](double s) {
    return length * length * integrated_moment(profile, (std::clamp(s, from, to) - from) / length);
  };
  return up_to(b) - up_to(a) - (a - from) * integral(a, b);
}

bool ActuatedStretch::jumps(bool at_end) const {
  return profile == scenario::Profile::Constant || (profile == scenario::Profile::Linear && at_end);
}

}  // namespace der
