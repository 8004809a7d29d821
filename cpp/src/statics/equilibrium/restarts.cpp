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

/// Every open rod straight from its first node in one direction of the x-y plane [rad], held
/// degrees of freedom in place. A ring has no straight shape: it stays as it is.
Vector straightened(const Model& model, const StaticLoads& loads, const Shape& start,
                    double direction) {
  const Vec3 along(std::cos(direction), std::sin(direction), 0.0);
  Vector positions = start.positions;
  for (const RodMesh& rod : model.rods) {
    if (rod.closed) continue;
    const auto position = [&](std::size_t i) {
      return positions.segment(model.dof(rod.nodes[i], 0), model.dimension);
    };
    const Vector first = position(0);
    for (std::size_t i = 0; i < rod.nodes.size(); ++i) {
      position(i) = first + rod.arc_length[i] * along.head(model.dimension);
    }
  }
  apply_prescribed_motion(model, loads.controls, positions);
  return positions;
}

}  // namespace

std::vector<Shape> restarts(const Model& model, const StaticLoads& loads, Stiffness& stiffness,
                            const Shape& start) {
  stiffness.evaluate(loads.at(model, start));
  const Vector bend = unit_displacement(model, stiffness.softest());
  std::vector<Shape> shapes;
  const auto add = [&](Vector positions) {
    shapes.push_back({std::move(positions), start.followed});
    loads.follow(model, shapes.back());
  };
  for (const double size : kBends) {
    for (const double side : {1.0, -1.0}) add(start.positions + side * size * bend);
  }
  for (int i = 0; i < kDirections; ++i) {
    add(straightened(model, loads, start, 2.0 * kPi * i / kDirections));
  }
  return shapes;
}

}  // namespace der::statics
