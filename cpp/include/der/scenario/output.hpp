#pragma once

#include <optional>
#include <string>
#include <vector>

#include "der/scenario/location.hpp"
#include "der/scenario/mark.hpp"

namespace der::scenario {

enum class Reduce { None, Min, Max };
/// Selects one of the two values of a quantity that jumps: that on the side of smaller arc
/// lengths, or of larger ones.
enum class Side { Before, After };
struct Probe {
  std::string name;
  std::string quantity;               ///< a name of the probe registry (x, vy, turning_angle, ...)
  std::optional<std::string> rod;     ///< absent: the whole model (energies only)
  std::optional<std::string> joint;   ///< in place of the rod and the place
  std::optional<std::string> leg;     ///< the rod whose force or moment on the joint it is
  std::optional<std::string> spring;  ///< name of the one between joints
  std::optional<Location> at;
  Reduce over = Reduce::None;            ///< with `over: rod`: the extreme along the rod
  std::optional<Side> side;              ///< absent: after; quantities that jump only
  std::optional<std::string> support;    ///< of a reaction (scenario/find_support.hpp)
  std::optional<std::string> actuation;  ///< name of the one whose force or moment it is
  Mark mark;
};

struct Output {
  /// [s] between saved frames; always above 0 in a run over time.
  double every = 0.0;
  std::vector<Probe> probes;
};

}  // namespace der::scenario
