#include "der/output/strain_monitor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "der/core/index.hpp"

namespace der {
namespace {

constexpr double kLongest = 2.0;     // times the rest length
constexpr double kShortest = 0.125;  // times the rest length
constexpr double kBent = 1.0;        // strain of the surface

Vec3 along(const Edge& edge, const Model& model, const Vector& positions) {
  Vec3 vector = Vec3::Zero();
  for (int c = 0; c < model.dimension; ++c) {
    vector[c] = positions[edge.last + c] - positions[edge.first + c];
  }
  return vector;
}

/// Twice the tangent of half the angle by which the rod turns at an inner place.
double turn_at(const RodMesh& rod, Index place, const Model& model, const Vector& positions) {
  const Vec3 before = along(rod.edge(rod.edge_before(place), model), model, positions);
  const Vec3 after = along(rod.edge(rod.edge_after(place), model), model, positions);
  const double lengths = std::sqrt(before.squaredNorm() * after.squaredNorm());
  return 2.0 * before.cross(after).norm() / (lengths + before.dot(after));
}

/// Of the rod without stress or as it is drawn, whichever is larger: a bound of what bending is not
/// to be blamed for.
double natural_turn_at(const RodMesh& rod, Index place, const Model& model) {
  double turn = turn_at(rod, place, model, model.initial_positions);
  if (to_size(place) < rod.rest_turning_angle.size()) {
    turn = std::max(turn, std::abs(rod.rest_turning_angle[to_size(place)]));
  }
  if (to_size(place) < rod.natural_curvatures.size()) {
    turn =
        std::max(turn, rod.natural_curvatures[to_size(place)].norm() * rod.voronoi_length(place));
  }
  return turn;
}

bool bends(const RodMesh& rod) { return rod.EI > 0.0 || rod.EI_1 > 0.0; }

}  // namespace

void StrainMonitor::look(const Model& model, const State& state) {
  if (found_) return;
  for (const RodMesh& rod : model.rods) {
    if (rod.actuated_stretches.empty()) look_at_lengths(model, rod, state);
  }
  if (found_) return;
  for (const RodMesh& rod : model.rods) {
    if (rod.actuated_stretches.empty() && bends(rod)) look_at_bending(model, rod, state);
  }
}

void StrainMonitor::look_at_lengths(const Model& model, const RodMesh& rod, const State& state) {
  for (Index i = 0; i < rod.num_edges(); ++i) {
    const Edge edge = rod.edge(i, model);
    const double ratio = along(edge, model, state.positions).norm() / edge.rest_length;
    const double longest = found_ ? std::max(found_->ratio, kLongest) : kLongest;
    const double shortest = found_ ? std::min(found_->ratio, kShortest) : kShortest;
    const bool is_stretched = ratio > longest;
    const bool is_compressed = ratio < shortest && (!found_ || found_->ratio < 1.0);
    if (!is_stretched && !is_compressed) continue;
    found_ = {rod.name, rod.edge_middle(i), ratio, 0.0, state.time, state.load_factor};
  }
}

void StrainMonitor::look_at_bending(const Model& model, const RodMesh& rod, const State& state) {
  if (rod.draw_radius == 0.0) return;
  for (Index place = 0; place < static_cast<Index>(rod.nodes.size()); ++place) {
    if (!rod.is_inner(place)) continue;
    const double largest = found_ ? found_->bending : kBent;
    const double scale = rod.draw_radius / rod.voronoi_length(place);
    const double turn = turn_at(rod, place, model, state.positions);
    if (!(scale * turn > largest)) continue;
    const double strain = scale * (turn - natural_turn_at(rod, place, model));
    if (!(strain > largest)) continue;
    found_ = {rod.name, rod.arc_length_at(place), 1.0, strain, state.time, state.load_factor};
  }
}

std::string describe(const StrainMonitor::Strained& strained, const std::string& when) {
  const std::string what =
      strained.bending > 0.0
          ? fmt::format(
                "bent {}, at arc length {:.4g} m, so that its surface is strained by {:.3g}", when,
                strained.place, strained.bending)
          : fmt::format("{} to {:.3g} times its rest length {}, at arc length {:.4g} m",
                        strained.ratio > 1.0 ? "stretched" : "compressed", strained.ratio, when,
                        strained.place);
  return fmt::format(
      "rod '{}' is {}: no material obeys a linear law so far. Are the units of its modulus, sizes "
      "and loads Pa, m and N?",
      strained.rod, what);
}

}  // namespace der
