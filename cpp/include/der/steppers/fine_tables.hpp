#pragma once

#include <string>
#include <vector>

namespace der {

namespace scenario {
struct Scene;
}

/// Warnings, in sentences, about the tables over time that have entries closer together than equal
/// steps of `step` [s], which go over kinks without seeing them, so that no stepper keeps its
/// order; and about sines that these steps hardly see.
std::vector<std::string> fine_table_warnings(const scenario::Scene& scene, double step);

/// An entry of a table at which a support jumps to another velocity.
struct MotionKink {
  std::string path;   ///< of the table, as in `--set`
  double time = 0.0;  ///< [s]
};
/// For each table of a support's motion that has kinks before the time `until` [s] the first of
/// them. Pieces that sample a smooth motion have none: each jump is small against the velocity.
std::vector<MotionKink> motion_kinks(const scenario::Scene& scene, double until);

}  // namespace der
