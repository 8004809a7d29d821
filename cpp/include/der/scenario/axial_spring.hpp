#pragma once

#include <optional>
#include <string>
#include <vector>

#include "der/scenario/mark.hpp"
#include "der/scenario/series.hpp"

namespace der::scenario {

/// A spring along the line between two joints, and a damper beside it.
struct AxialSpring {
  std::string name;
  std::vector<std::string> between;  ///< the names of two joints
  double stiffness = 0.0;            ///< [N/m]
  /// [m]; absent: the distance between the joints as drawn.
  std::optional<Series> rest_length;
  double damping = 0.0;  ///< force per rate of the length [N s/m]
  Mark mark;
};

}  // namespace der::scenario
