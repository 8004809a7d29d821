#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "der/scenario/reader.hpp"

namespace der::test {

/// The three falling spheres of the course report, 0.2 s in 20 steps, every third one saved.
inline const std::string kSpheres = R"(
title: Three spheres
rods:
  - name: rod
    nodes: 3
    from: [0, 0]
    to: [0.1, 0]
    cross_section: {circle: {radius: 0.001}}
    material: {youngs_modulus: 1e9, density: 0}
    spheres:
      - {at: all, radius: 0.005, density: 7000}
      - {at: middle, radius: 0.025, density: 7000}
loads:
  - gravity: [0, -9.8]
  - fluid: {density: 1000, viscosity: 1000}
time: {duration: 0.2, step: 0.01, integrator: implicit_euler}
output:
  every: 0.03
  probes:
    v_mid: {rod: rod, at: middle, quantity: vy}
    y_mid: {rod: rod, at: middle, quantity: y}
    angle: {rod: rod, at: middle, quantity: turning_angle}
    kinetic: {quantity: kinetic_energy}
)";

/// A planar rod on a spring against turning.
inline const std::string kWound = R"(
rods:
  - name: rod
    nodes: 5
    from: [0, 0]
    to: [1, 0]
    cross_section: {stiffness: {EA: 1e4, EI: 1, mass_per_length: 1}}
supports:
  - {rod: rod, at: start, fix: [x, y]}
  - {rod: rod, at: 0.5, spring: {rotational_stiffness: 0.1}}
loads:
  - moment: {rod: rod, at: end, moment: 0.5}
time: {duration: 0.02, step: 0.005}
output: {every: 0.01, probes: {tip: {rod: rod, at: end, quantity: y}}}
)";

/// A flat strip with a natural bow and twist, dropped from a clamp: 5 edges, every third of 12
/// steps saved.
inline const std::string kStrip = R"(
title: A strip that falls out of its plane
model: spatial
rods:
  - name: strip
    nodes: 6
    from: [0, 0, 0]
    to: [0.3, 0.1, 0.2]
    cross_section: {rectangle: {width: 0.02, height: 0.002}, director: [0, 0, 1]}
    material: {youngs_modulus: 1e8, poissons_ratio: 0.3, density: 1000}
    natural_curvature: [1.0, 2.0]
    natural_twist: 3.0
supports:
  - {rod: strip, at: start, clamp: true}
loads:
  - gravity: [0, 0, -9.8]
time: {duration: 0.024, step: 0.002, integrator: implicit_euler}
output:
  every: 0.006
  probes:
    z: {rod: strip, at: end, quantity: z}
    twist: {rod: strip, at: 0.1, quantity: twist}
)";

/// A cantilever of unit bending stiffness under a tip load of P L^2/EI = 1.
inline const std::string kCantilever = R"(
rods:
  - name: arm
    nodes: 21
    from: [0, 0]
    to: [1, 0]
    cross_section: {stiffness: {EA: 1e4, EI: 1, mass_per_length: 1}}
supports:
  - {rod: arm, at: start, clamp: true}
loads:
  - point_force: {rod: arm, at: end, force: [0, -1]}
analysis: static
)";

/// The cantilever with probes, in YAML flow style: "tip: {rod: arm, at: end, quantity: y}".
inline Scenario cantilever(const std::string& probes, const std::vector<Override>& overrides = {}) {
  return Scenario::parse(kCantilever + "output: {probes: {" + probes + "}}\n", "cantilever",
                         overrides);
}

/// A new folder that is removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "der-test-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace der::test
