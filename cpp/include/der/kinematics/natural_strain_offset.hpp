#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/material_curvature.hpp"

namespace der {

/// Where the controls have what actuations add to the rest shape of an element
/// (model/natural_strain.hpp).
struct NaturalStrainOffset {
  Index entry = -1;  ///< -1: no actuation reaches the element

  /// The shift of an extension [m] or a turning angle [-].
  template <class Values>
  [[nodiscard]] double value(const Values& controls) const {
    return entry < 0 ? 0.0 : controls[entry];
  }
  /// The shifts of two integrated curvatures and a twist, which are three entries [-].
  template <class Values>
  [[nodiscard]] MaterialCurvature strain(const Values& controls) const {
    if (entry < 0) return {};
    return {controls[entry], controls[entry + 1], controls[entry + 2]};
  }
};

}  // namespace der
