#pragma once

namespace der {

/// Internal damping of a rod by the Kelvin-Voigt law: a strain e that changes by e' a second bears
/// the stress of the strain e + t e', t being one of these times [s]. 0: none.
struct DampingTimes {
  double bending = 0.0;
  double twisting = 0.0;
  double stretching = 0.0;

  [[nodiscard]] bool any() const { return bending > 0.0 || twisting > 0.0 || stretching > 0.0; }
};

}  // namespace der
