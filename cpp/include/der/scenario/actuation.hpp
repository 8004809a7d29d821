#pragma once

#include <limits>
#include <string>
#include <vector>

#include "der/scenario/mark.hpp"
#include "der/scenario/series.hpp"

namespace der::scenario {

/// The shape of an actuation along its stretch, from 0 to 1.
enum class Profile {
  Constant,  ///< 1
  Linear,    ///< from 0 at the start to 1 at the end
  Smooth,    ///< sin^2: 0 at both ends, with slope 0, and 1 in the middle
};

/// The part of the rest shape that an actuation changes.
enum class Actuated { Curvature, Twist, Length };

/// The bound that the sum of elongations must exceed at each place: on the edge beside a clamp,
/// whose pivot takes a fifth of it, so that some length is left.
constexpr double kLeastElongation = -1.0;
constexpr double kLeastElongationAtClamp = -0.75;

/// A change of the rest shape of a stretch of a rod, over time. Several at one place add up.
struct Actuation {
  std::string name;
  std::string rod;
  double from = 0.0;                                    ///< rest arc length [m]
  double to = std::numeric_limits<double>::infinity();  ///< the checks limit it to the rod
  Profile profile = Profile::Constant;
  Actuated what = Actuated::Curvature;
  /// [1/m], [rad/m] or [-]: one table, or two of a curvature in space, toward the two directors.
  /// Scenes of the planar model have curvatures positive counter-clockwise.
  std::vector<Series> values;
  Mark mark;
};

/// The key of an actuation's value: "natural_curvature", "natural_twist" or "elongation".
const char* key_of(Actuated what);

}  // namespace der::scenario
