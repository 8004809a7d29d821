#include "statics/equilibrium/restarts.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "der/core/constants.hpp"
#include "der/model/prescribed_motion.hpp"
#include "statics/equilibrium/saddles.hpp"

namespace der::statics {
namespace {

/// Largest changes of an edge [rad] of the bent shapes.
constexpr std::array<double, 3> kBends{0.3, 1.0, 3.0};
/// Number of directions of the straight shapes.
constexpr int kDirections = 8;

/// Every open rod straight from its first node in one direction [rad], held degrees of freedom in
/// place. A ring has no straight shape: it stays as it is.
Vector straightened(const Model& model, const StaticLoads& loads, const Shape& start,
                    double direction) {
  Vector positions = start.positions;
  for (const RodLayout& rod : model.rods) {
    if (rod.closed) continue;
    const Vec2 first = start.positions.segment<2>(model.dof(rod.nodes.front(), 0));
    for (std::size_t i = 0; i < rod.nodes.size(); ++i) {
      positions.segment<2>(model.dof(rod.nodes[i], 0)) =
          first + rod.arc_length[i] * Vec2(std::cos(direction), std::sin(direction));
    }
  }
  apply_prescribed_motion(model, loads.controls, positions);
  return positions;
}

}  // namespace

std::vector<Shape> planar_restarts(const Model& model, const StaticLoads& loads,
                                   Stiffness& stiffness, const Shape& start) {
  stiffness.evaluate(loads.at(model, start));
  const Vector bend = unit_displacement(model, stiffness.softest());
  std::vector<Shape> restarts;
  const auto add = [&](Vector positions) {
    restarts.push_back({std::move(positions), start.followed});
    loads.follow(model, restarts.back());
  };
  for (const double size : kBends) {
    for (const double side : {1.0, -1.0}) add(start.positions + side * size * bend);
  }
  for (int i = 0; i < kDirections; ++i) {
    add(straightened(model, loads, start, 2.0 * kPi * i / kDirections));
  }
  return restarts;
}

}  // namespace der::statics
