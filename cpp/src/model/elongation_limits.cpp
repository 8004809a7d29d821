#include "der/model/elongation_limits.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "der/core/index.hpp"

namespace der {

double ShortenedEdge::least_of(Index control) const {
  double others = 0.0;
  double weight = 1.0;
  for (const Part& part : parts) {
    if (part.control == control) {
      weight = part.weight;
    } else {
      others += part.weight * part.value;
    }
  }
  return (least - others) / weight;
}

std::string ShortenedEdge::of_others(Index control) const {
  std::vector<std::string> others;
  for (const Part& part : parts) {
    if (part.control == control || part.value == 0.0) continue;
    others.push_back(fmt::format("'{}' is {:.4g}", part.name, part.value));
  }
  return fmt::format("{}", fmt::join(others, " and "));
}

ElongationLimits::ElongationLimits(const Model& model) {
  for (std::size_t number = 0; number < model.rods.size(); ++number) {
    const RodMesh& rod = model.rods[number];
    if (rod.natural_strain_entries.edges < 0) continue;
    const std::size_t first = elongations_.size();
    for (const ActuatedStretch& stretch : rod.actuated_stretches) {
      if (stretch.strains()) continue;
      elongations_.push_back({stretch.name, stretch.controls[0], 0.0});
    }
    for (Index i = 0; i < rod.num_edges(); ++i) {
      const bool at_clamp = rod.clamp_at(i) != nullptr || rod.clamp_at(i + 1) != nullptr;
      Edge edge{
          number, i, at_clamp ? scenario::kLeastElongationAtClamp : scenario::kLeastElongation, {}};
      for (const NaturalStrain::Term& term :
           model.natural_strain.terms_of(rod.natural_strain_entries.edge(i).entry)) {
        std::size_t which = first;
        while (elongations_[which].control != term.control) ++which;
        edge.parts.push_back({which, term.weight / rod.edge_length[to_size(i)]});
      }
      const bool needs_a_look = edge.parts.size() > 1 || (at_clamp && !edge.parts.empty());
      if (needs_a_look && !is_known(edge)) edges_.push_back(std::move(edge));
    }
  }
}

bool ElongationLimits::is_known(const Edge& edge) const {
  constexpr double kRounding = 1e-12;
  return std::any_of(edges_.begin(), edges_.end(), [&](const Edge& other) {
    return other.least == edge.least &&
           std::equal(edge.parts.begin(), edge.parts.end(), other.parts.begin(), other.parts.end(),
                      [](const Part& a, const Part& b) {
                        return a.elongation == b.elongation &&
                               std::abs(a.weight - b.weight) <= kRounding;
                      });
  });
}

bool ElongationLimits::sums(Index control) const {
  return std::any_of(elongations_.begin(), elongations_.end(),
                     [&](const Elongation& each) { return each.control == control; });
}

bool ElongationLimits::has(const Edge& edge, Index control) const {
  return std::any_of(edge.parts.begin(), edge.parts.end(), [&](const Part& part) {
    return elongations_[part.elongation].control == control;
  });
}

double ElongationLimits::sum(const Edge& edge) const {
  double sum = 0.0;
  for (const auto& [elongation, weight] : edge.parts)
    sum += weight * elongations_[elongation].value;
  return sum;
}

std::optional<ShortenedEdge> ElongationLimits::shortest(const Model& model, const State& state,
                                                        double time, const Ramp* set) {
  double lowest = 0.0;  // of the sum on any edge, as no weight is greater than 1
  for (Elongation& each : elongations_) {
    each.value = set != nullptr && set->control == each.control
                     ? set->at(time)
                     : control_value(model, state, each.control, time);
    lowest += std::min(each.value, 0.0);
  }
  if (lowest > scenario::kLeastElongationAtClamp) return std::nullopt;
  const Edge* worst = nullptr;
  double beyond = 0.0;
  for (const Edge& edge : edges_) {
    if (set != nullptr && !has(edge, set->control)) continue;
    const double room = sum(edge) - edge.least;
    if (room > beyond) continue;
    beyond = room;
    worst = &edge;
  }
  if (worst == nullptr) return std::nullopt;
  return describe(*worst, model);
}

ShortenedEdge ElongationLimits::describe(const Edge& edge, const Model& model) const {
  const RodMesh& rod = model.rods[edge.rod];
  ShortenedEdge found{rod.name,
                      rod.arc_length_at(edge.number),
                      rod.arc_length_at(edge.number + 1),
                      -sum(edge),
                      edge.least,
                      edge.least == scenario::kLeastElongationAtClamp,
                      {}};
  for (const auto& [elongation, weight] : edge.parts) {
    const Elongation& each = elongations_[elongation];
    found.parts.push_back({each.name, each.control, weight, each.value});
  }
  return found;
}

}  // namespace der
