#pragma once

#include <string>
#include <vector>

#include "der/scenario/reader.hpp"
#include "der/scenario/scenario.hpp"

namespace der::test {

inline const char* const kPlanar = R"(
title: Planar
rods:
  - name: rod
    nodes: 9
    from: [0, 0]
    to: [1, 0]
    cross_section: {stiffness: {EA: 1e3, EI: 1e-2, mass_per_length: 0.1}}
supports: [{name: wall, rod: rod, at: start, clamp: true, prescribe: {x: 0, angle: 0}}]
loads:
  - gravity: [0, -9.81]
  - {name: push, point_force: {rod: rod, at: end, force: [0, 0]}}
time: {duration: 1, step: 0.002}
output: {every: 0.002, probes: {tip: {rod: rod, at: end, quantity: y}}}
)";

inline const char* const kSpatial = R"(
title: Spatial
rods:
  - name: rod
    nodes: 7
    from: [0, 0, 0]
    to: [1, 0, 0]
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e7, density: 1000, poissons_ratio: 0.3}
supports: [{rod: rod, at: start, clamp: true}]
loads:
  - gravity: [0, -9.81, 0]
  - point_force: {rod: rod, at: end, force: [0, 0, 0.05]}
time: {duration: 1, step: 0.002}
output: {every: 0.002}
)";

/// Scene, its model, and what is varied in it.
struct Sample {
  const char* text;
  std::vector<Override> changes;
  std::string model;
  std::string varied;
  double value;
};

inline const std::vector<Sample> kSamples{
    {kPlanar, {}, "planar", "rods.rod.cross_section.stiffness.EI", 1e-2},
    {kPlanar,
     {{"time.integrator", "bdf2"}},
     "planar",
     "rods.rod.cross_section.stiffness.mass_per_length",
     0.1},
    {kPlanar,
     {{"time", "{duration: 1, tolerance: 1e-3, integrator: tr_bdf2}"}},
     "planar",
     "rods.rod.cross_section.stiffness.EI",
     1e-2},
    {kPlanar,
     {{"time", "{duration: 1, step: 0.0002, integrator: verlet}"}},
     "planar",
     "rods.rod.cross_section.stiffness.mass_per_length",
     0.1},
    {kSpatial,
     {{"model", "spatial_bend"}, {"supports.0.clamp", "tangent"}, {"time.integrator", "newmark"}},
     "spatial_bend",
     "rods.rod.material.youngs_modulus",
     1e7},
    {kSpatial,
     {{"model", "spatial"}, {"time.integrator", "generalized_alpha"}},
     "spatial",
     "rods.rod.material.density",
     1000.0},
};

inline Scenario scene_of(const Sample& sample) {
  return Scenario::parse(sample.text, "scene", sample.changes);
}

}  // namespace der::test
