#include "statics/equilibrium/admissibility.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/statics/potential.hpp"
#include "der/supports/clamp.hpp"

namespace der::statics {
namespace {

/// Displacements beyond this multiple of the model's size, plus the travel of its springs, mean
/// that nothing holds the structure.
constexpr double kDrift = 100.0;
/// An edge shorter than this fraction of its rest length has collapsed.
constexpr double kCollapsed = 1e-2;
/// An edge lies along an axis if the difference across it is less than this fraction of its length.
constexpr double kAligned = 1e-9;
/// Turning angle [rad] at a node beyond which the rod is folded.
constexpr double kFolded = 3.0;

/// How far [m] springs let the structure move under `load` [N], counted from the drawn shape.
double spring_travel(const Model& model, double load) {
  double farthest = 0.0;
  for_each_list(model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (HoldsElement<Kernel>::value) {
      LocalTerm<Kernel::kDofs> drawn;
      for (std::size_t e = 0; e < list.size(); ++e) {
        Kernel::template evaluate<Derivatives::Energy>(
            list.constants[e], {}, gather(list.dofs[e], model.initial_positions), drawn);
        for (int c = 0; c < model.dimension; ++c) {
          const double stiffness = Kernel::holding_stiffness(list.constants[e], c);
          if (stiffness == 0.0) continue;
          farthest =
              std::max(farthest, load / stiffness + std::sqrt(2.0 * drawn.energy / stiffness));
        }
      }
    }
  });
  return farthest;
}

/// Smallest ratio of the length of an edge to its rest length; 1 if none is shortened.
double smallest_length_ratio(const Model& model, const Vector& positions, const Vector& controls) {
  double smallest = 1.0;
  const auto compare = [&](const Vec2& edge, double rest_length) {
    smallest = std::min(smallest, edge.norm() / rest_length);
  };
  const auto& edges = std::get<ElementList<Stretch<2>>>(model.elements);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto ends = gather(edges.dofs[e], positions);
    compare(ends.tail<2>() - ends.head<2>(), edges.constants[e].rest_length);
  }
  const auto& links = std::get<ElementList<FromPivot<Stretch<2>>>>(model.elements);
  for (std::size_t e = 0; e < links.size(); ++e) {
    const auto& c = links.constants[e];
    const Link link{links.dofs[e], c.first, c.last};
    compare(link.vector(positions, c.first.turn(controls), c.last.turn(controls)),
            c.element.rest_length);
  }
  return smallest;
}

/// Whether an edge that supports guide along an axis, so that it cannot turn, points backwards.
bool is_turned_inside_out(const Model& model, const Vector& positions) {
  const auto held = [&](Index dof) { return model.free_index[at(dof)] < 0; };
  return std::any_of(model.edges.begin(), model.edges.end(), [&](const Edge& edge) {
    const auto now = gather(edge.dofs, positions);
    const auto drawn = gather(edge.dofs, model.initial_positions);
    const Vec2 e = now.tail<2>() - now.head<2>();
    const Vec2 e0 = drawn.tail<2>() - drawn.head<2>();
    for (const int c : {0, 1}) {
      const bool guided = held(edge.dofs[at(c)]) && held(edge.dofs[at(2 + c)]);
      const bool slides = !held(edge.dofs[at(1 - c)]) || !held(edge.dofs[at(3 - c)]);
      const bool aligned = std::abs(e[c]) < kAligned * edge.rest_length;
      if (guided && slides && aligned && e[1 - c] * e0[1 - c] < 0.0) return true;
    }
    return false;
  });
}

}  // namespace

PlanarAdmissibility::PlanarAdmissibility(const Model& model, const Vector& force, Vector origin)
    : model_(model),
      origin_(std::move(origin)),
      largest_drift_(kDrift * (model.size + spring_travel(model, force.lpNorm<1>()))) {}

std::optional<FailedSearch> PlanarAdmissibility::check(const Vector& positions,
                                                       const Vector& controls) const {
  if ((positions - origin_).lpNorm<Eigen::Infinity>() > largest_drift_) {
    return FailedSearch{EquilibriumFailure::DriftsAway, {}};
  }
  if (smallest_length_ratio(model_, positions, controls) < kCollapsed ||
      is_turned_inside_out(model_, positions)) {
    return FailedSearch{EquilibriumFailure::Collapsed, {}};
  }
  return std::nullopt;
}

bool is_folded(const Model& model, const Vector& positions) {
  return largest_turning_angle(model, positions) > kFolded;
}

}  // namespace der::statics
