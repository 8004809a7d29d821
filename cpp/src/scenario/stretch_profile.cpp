#include "der/scenario/stretch_profile.hpp"

#include <algorithm>
#include <cmath>

#include "der/core/constants.hpp"

namespace der::scenario {
namespace {

/// The profile at the share `u` of the stretch.
double value_of(Profile kind, double u) {
  switch (kind) {
    case Profile::Constant:
      return 1.0;
    case Profile::Linear:
      return u;
    case Profile::Smooth:
      break;
  }
  const double sine = std::sin(kPi * u);
  return sine * sine;
}

/// Integral of the profile from 0 to `u`.
double integrated(Profile kind, double u) {
  switch (kind) {
    case Profile::Constant:
      return u;
    case Profile::Linear:
      return 0.5 * u * u;
    case Profile::Smooth:
      break;
  }
  return 0.5 * u - std::sin(2.0 * kPi * u) / (4.0 * kPi);
}

/// Integral of u times the profile from 0 to `u`.
double integrated_moment(Profile kind, double u) {
  switch (kind) {
    case Profile::Constant:
      return 0.5 * u * u;
    case Profile::Linear:
      return u * u * u / 3.0;
    case Profile::Smooth:
      break;
  }
  const double sine = std::sin(kPi * u);
  return 0.25 * u * u - u * std::sin(2.0 * kPi * u) / (4.0 * kPi) + sine * sine / (4.0 * kPi * kPi);
}

}  // namespace

double fine_nodes(double curvature, double length) {
  return 1.0 + std::round(curvature * length / (0.5 * kCoarseTurn));
}

double StretchProfile::at(double s) const { return value_of(kind, (s - from) / (to - from)); }

double StretchProfile::integral(double a, double b) const {
  const double length = to - from;
  const auto up_to = [&](double s) {
    return length * integrated(kind, (std::clamp(s, from, to) - from) / length);
  };
  return up_to(b) - up_to(a);
}

double StretchProfile::first_moment(double a, double b) const {
  const double length = to - from;
  const auto up_to = [&](double s) {
    return length * length * integrated_moment(kind, (std::clamp(s, from, to) - from) / length);
  };
  return up_to(b) - up_to(a) - (a - from) * integral(a, b);
}

EdgeTurns edge_turns(const StretchProfile& profile, double start, double end, bool clamp_at_start,
                     bool clamp_at_end) {
  // The edge turns against the tangent at its start by the first of these on average, and the
  // tangent at its end against the edge by the second.
  const double last = profile.first_moment(start, end) / (end - start);
  const double first = profile.integral(start, end) - last;
  const double a = clamp_at_start ? kEdgePivot : 0.0;
  const double b = clamp_at_end ? kEdgePivot : 0.0;
  const double turn = (b * last - a * first) / (1.0 - a - b);
  return {first - turn, last + turn};
}

}  // namespace der::scenario
