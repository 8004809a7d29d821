#include "der/model/turning_limits.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "der/core/constants.hpp"
#include "der/core/index.hpp"
#include "der/scenario/stretch_profile.hpp"

namespace der {
namespace {

/// Relative; of equal turns the first one counts.
constexpr double kEqualTurns = 1e-12;

}  // namespace

TurningLimits::TurningLimits(const Model& model) {
  for (std::size_t rod = 0; rod < model.rods.size(); ++rod) add_rod(model, rod);
  for (Curvature& curvature : curvatures_) {
    for (const std::size_t cell : curvature.cells) {
      for (const Part& part : cells_[cell].parts) curvature.partners.push_back(part.curvature);
    }
    std::sort(curvature.partners.begin(), curvature.partners.end());
    curvature.partners.erase(std::unique(curvature.partners.begin(), curvature.partners.end()),
                             curvature.partners.end());
  }
}

void TurningLimits::add_rod(const Model& model, std::size_t number) {
  const RodMesh& rod = model.rods[number];
  if (rod.natural_strain_entries.cells < 0) return;
  for (const ActuatedStretch& stretch : rod.actuated_stretches) {
    if (stretch.what != scenario::Actuated::Curvature) continue;
    for (const Index control : stretch.controls) {
      if (control >= 0) curvatures_.push_back({stretch.name, control, 0.0, 0.0, {}, {}});
    }
  }
  const std::size_t directions = rod.natural_strain_entries.strains == 1 ? 1 : 2;
  for (std::size_t node = 0; node < rod.nodes.size(); ++node) {
    for (const bool leaves : {false, true}) {
      const Index entry = rod.natural_strain_entries.cell(static_cast<Index>(node), leaves).entry;
      Cell cell{number, static_cast<Index>(node), {}};
      for (std::size_t d = 0; d < directions; ++d) {
        for (const NaturalStrain::Term& term :
             model.natural_strain.terms_of(entry + static_cast<Index>(d))) {
          if (!bends(term.control)) continue;  // a twist: at a corner it turns the other leg
          cell.parts.push_back({find(term.control), d, term.weight});
        }
      }
      if (cell.parts.empty()) continue;
      for (const Part& part : cell.parts) {
        Curvature& curvature = curvatures_[part.curvature];
        curvature.largest_weight = std::max(curvature.largest_weight, std::abs(part.weight));
        if (curvature.cells.empty() || curvature.cells.back() != cells_.size()) {
          curvature.cells.push_back(cells_.size());
        }
      }
      cells_.push_back(std::move(cell));
    }
  }
}

std::size_t TurningLimits::find(Index control) const {
  const auto found = std::find_if(curvatures_.begin(), curvatures_.end(),
                                  [&](const Curvature& each) { return each.control == control; });
  return static_cast<std::size_t>(found - curvatures_.begin());
}

void TurningLimits::evaluate(const Model& model, const State& state, double time,
                             const Setting* set) {
  for (Curvature& each : curvatures_) {
    each.value = control_value(model, state, each.control, time);
  }
  if (set == nullptr) return;
  for (std::size_t i = 0; i < set->size; ++i) {
    curvatures_[find(set->begin[i].controls.front())].value = set->values[i];
  }
}

double TurningLimits::bound(const Curvature& curvature) const {
  double sum = 0.0;
  for (const std::size_t partner : curvature.partners) {
    sum += std::abs(curvatures_[partner].value) * curvatures_[partner].largest_weight;
  }
  return sum;
}

double TurningLimits::angle(const Cell& cell) const {
  std::array<double, 2> turn{};
  for (const Part& part : cell.parts) {
    turn[part.direction] += part.weight * curvatures_[part.curvature].value;
  }
  return std::hypot(turn[0], turn[1]);
}

void TurningLimits::look(const Curvature& curvature, const Cell*& found) const {
  if (bound(curvature) <= scenario::kCoarseTurn) return;
  double sharpest = found != nullptr ? angle(*found) : scenario::kCoarseTurn;
  for (const std::size_t number : curvature.cells) {
    const double turn = angle(cells_[number]);
    if (turn <= (1.0 + kEqualTurns) * sharpest) continue;
    sharpest = turn;
    found = &cells_[number];
  }
}

SharpTurn TurningLimits::describe(const Cell& cell, const Model& model) const {
  const RodMesh& rod = model.rods[cell.rod];
  SharpTurn turn{rod.name, cell.node, angle(cell), 0.0, {}, true};
  std::array<double, 2> curvature{};
  for (const Part& part : cell.parts) {
    const Curvature& each = curvatures_[part.curvature];
    curvature[part.direction] += std::abs(each.value);
    const bool is_known =
        std::find(turn.names.begin(), turn.names.end(), each.name) != turn.names.end();
    if (each.value != 0.0 && !is_known) turn.names.push_back(each.name);
  }
  turn.curvature = std::hypot(curvature[0], curvature[1]);
  turn.is_possible = rod.curvature != scenario::CurvatureMeasure::Angle || turn.angle < kPi;
  return turn;
}

std::optional<SharpTurn> TurningLimits::sharpest(const Model& model, const State& state,
                                                 const Setting& set) {
  std::optional<SharpTurn> found;
  const auto look_at = [&](double time) {
    evaluate(model, state, time, &set);
    const Cell* cell = nullptr;
    for (std::size_t i = 0; i < set.size; ++i) {
      look(curvatures_[find(set.begin[i].controls.front())], cell);
    }
    if (cell == nullptr || (found && angle(*cell) <= found->angle)) return;
    found = describe(*cell, model);
  };
  look_at(set.end);
  for (const Ramp& ramp : state.ramps) {
    if (ramp.end > set.end && bends(ramp.control)) look_at(ramp.end);
  }
  return found;
}

std::optional<SharpTurn> TurningLimits::sharpest(const Model& model, const State& state,
                                                 double time) {
  evaluate(model, state, time, nullptr);
  const Cell* cell = nullptr;
  for (const Curvature& curvature : curvatures_) look(curvature, cell);
  if (cell == nullptr || angle(*cell) < kPi) return std::nullopt;
  return describe(*cell, model);
}

}  // namespace der
