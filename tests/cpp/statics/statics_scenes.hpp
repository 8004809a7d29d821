#pragma once

#include <string>

/// Scenes of the tests of modes, buckling and continuation: a rod of length 1 and mass 1, EI = 1.
namespace der::test {

/// From (0, 0) to (1, 0), with `more` of the scene.
inline std::string straight_rod(int nodes, const std::string& more) {
  return R"(
title: Rod
rods:
  - name: rod
    nodes: )" +
         std::to_string(nodes) + R"(
    from: [0, 0]
    to: [1, 0]
    cross_section: {stiffness: {EA: 1e6, EI: 1, mass_per_length: 1}}
)" + more;
}

inline const std::string kPinned =
    "supports:\n  - {rod: rod, at: start, fix: [x, y]}\n  - {rod: rod, at: end, fix: [y]}\n";
inline const std::string kPush = "loads:\n  - point_force: {rod: rod, at: end, force: [-1, 0]}\n";
inline const std::string kStatic = "analysis: static\n";
inline const std::string kBuckling = "analysis: buckling\n";

}  // namespace der::test
