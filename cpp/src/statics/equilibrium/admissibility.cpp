#include "statics/equilibrium/admissibility.hpp"

#include <algorithm>
#include <cmath>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/registry.hpp"
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

/// How far [m] springs let the structure move under `load` [N], counted from the initial shape.
double spring_travel(const Model& model, double load) {
  double farthest = 0.0;
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (HoldsElement<Kernel>::value) {
      LocalTerm<Kernel::kDofs> drawn;
      for (std::size_t e = 0; e < list.size(); ++e) {
        evaluate_element<Kernel, Derivatives::Energy>(
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

/// Smallest ratio of the length of an edge, as its stretching sees it, to its rest length; 1 if
/// none is shortened.
template <int Dim, class PivotKind>
double smallest_length_ratio(const Model& model, const Configuration& here) {
  using Plain = Stretch<Dim>;
  using Clamped = FromPivot<Plain, PivotKind>;
  double smallest = 1.0;
  const auto take = [&](const auto& ends, const typename Plain::Constants& c) {
    smallest = std::min(smallest, Plain::edge(ends).norm() / c.rest_length);
  };
  const auto& plain = elements_of<Plain>(*model.elements);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    take(gather(plain.dofs[i], here.coordinates), plain.constants[i]);
  }
  const auto& clamped = elements_of<Clamped>(*model.elements);
  for (std::size_t i = 0; i < clamped.size(); ++i) {
    const auto& c = clamped.constants[i];
    const auto ends = gather(clamped.dofs[i], here.coordinates);
    take(Clamped::from_pivots(c, here.controls, ends), c.element);
  }
  return smallest;
}

bool has_collapsed(const Model& model, const Configuration& here) {
  return (model.dimension == 2 ? smallest_length_ratio<2, Pivot>(model, here)
                               : smallest_length_ratio<3, SpatialPivot>(model, here)) < kCollapsed;
}

/// Whether an edge that supports guide along an axis, so that it cannot turn, points backwards.
bool planar_is_turned_inside_out(const Model& model, const Vector& positions) {
  if (model.dimension != 2) return false;
  const auto held = [&](Index dof) { return !model.dofs.is_free(dof); };
  return std::any_of(model.edges.begin(), model.edges.end(), [&](const Edge& edge) {
    const Vec2 now = along_edge(edge, positions);
    const Vec2 drawn = along_edge(edge, model.initial_positions);
    for (const int c : {0, 1}) {
      const bool guided = held(edge.first + c) && held(edge.last + c);
      const bool slides = !held(edge.first + 1 - c) || !held(edge.last + 1 - c);
      const bool aligned = std::abs(now[c]) < kAligned * edge.rest_length;
      if (guided && slides && aligned && now[1 - c] * drawn[1 - c] < 0.0) return true;
    }
    return false;
  });
}

}  // namespace

Admissibility::Admissibility(const Model& model, const Vector& force, Vector origin)
    : model_(model),
      origin_(std::move(origin)),
      largest_drift_(kDrift * (model.size() + spring_travel(model, force.lpNorm<1>()))) {}

std::optional<FailedSearch> Admissibility::check(const Configuration& here) const {
  // Sections follow the clamps of a rod without limit.
  const double turned = model_.dofs.length() * largest_turn_of_clamps(model_, here.controls);
  if (model_.dofs.largest_motion(here.coordinates - origin_) > largest_drift_ + 2.0 * turned) {
    return FailedSearch{EquilibriumFailure::DriftsAway, {}};
  }
  if (has_collapsed(model_, here) || planar_is_turned_inside_out(model_, here.coordinates)) {
    return FailedSearch{EquilibriumFailure::Collapsed, {}};
  }
  return std::nullopt;
}

bool is_folded(const Model& model, const Vector& positions) {
  return largest_turning_angle(model, positions) > kFolded;
}

}  // namespace der::statics
