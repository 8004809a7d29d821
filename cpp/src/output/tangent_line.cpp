#include "output/tangent_line.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "der/core/index.hpp"
#include "der/model/location.hpp"
#include "model/actuated_turn.hpp"
#include "model/corner.hpp"

namespace der {
namespace {

/// The amount that a jump of the curvature by 1 at `kink` adds at `s` to a line begun before it
/// [m].
double beyond(double s, double kink) { return std::max(0.0, s - kink); }

/// Number of the edge on which a place is.
Index edge_at(double s, const RodMesh& rod) {
  const auto next = std::upper_bound(rod.arc_length.begin(), rod.arc_length.end(), s);
  return std::clamp<Index>(static_cast<Index>(next - rod.arc_length.begin()) - 1, 0,
                           rod.num_edges() - 1);
}

bool changes_curvature(const ActuatedStretch& stretch) {
  return stretch.what == scenario::Actuated::Curvature;
}

bool any_bends(const RodMesh& rod) {
  return std::any_of(rod.actuated_stretches.begin(), rod.actuated_stretches.end(),
                     changes_curvature);
}

/// Arc lengths [m] at which an actuated curvature jumps.
void add_actuated_jumps(const RodMesh& rod, std::vector<double>& places) {
  for (const ActuatedStretch& stretch : rod.actuated_stretches) {
    if (!changes_curvature(stretch)) continue;
    if (stretch.jumps(false)) places.push_back(stretch.from);
    if (stretch.jumps(true)) places.push_back(stretch.to);
  }
}

}  // namespace

TangentLine::TangentLine(const RodMesh& rod, std::vector<double> kinks, const Model& model)
    : rod_(rod), is_actuated_(any_bends(rod)), kinks_(std::move(kinks)) {
  find_knots(model);
  std::vector<double> jumps = kinks_;
  add_actuated_jumps(rod, jumps);
  for (const Leg& leg : legs_) {
    if (leg.to <= 0.0 || leg.from >= rod.rest_length()) continue;  // the neighbours of a ring's
    std::vector<std::pair<double, bool>> places;                   // and whether it is smooth there
    for (Index node = 0; node <= rod.num_edges(); ++node) {
      const bool end = node == 0 || node == rod.num_edges();
      places.emplace_back(rod.arc_length_at(node), !end && rod.clamp_at(node) == nullptr);
    }
    for (const double kink : jumps) {
      for (auto& [s, smooth] : places) {
        if (std::abs(s - kink) <= rod.same_place()) smooth = false;
      }
      const bool is_node = std::any_of(places.begin(), places.end(), [&](const auto& place) {
        return std::abs(place.first - kink) <= rod.same_place();
      });
      if (!is_node) places.emplace_back(kink, false);
    }
    std::sort(places.begin(), places.end());
    for (const auto& [s, smooth] : places) {
      if (s < leg.from - rod.same_place() || s > leg.to + rod.same_place()) continue;
      const bool corner = std::min(s - leg.from, leg.to - s) <= rod.same_place();
      add_sample(s, leg, smooth && !corner);
    }
  }
}

void TangentLine::find_knots(const Model& model) {
  // A ring's first and last edge have neighbours, too.
  const RodMesh& rod = rod_;
  const Index first = rod.closed ? -1 : 0;
  const Index last = rod.num_edges() + (rod.closed ? 1 : 0);
  legs_.push_back({rod.arc_length_at(first), 0.0, 0, 0});
  for (Index place = first; place <= last; ++place) {
    const Clamp* clamp = rod.clamp_at(place);
    const auto add_clamp = [&](bool arrives) {
      if (clamp == nullptr) return;
      const auto number = static_cast<Index>(clamp - rod.clamps.data());
      knots_.push_back({rod.arc_length_at(place), -1, number, arrives});
    };
    const bool parts = place > first && place < last && is_corner(rod, place, model);
    if (parts) {
      add_clamp(true);
      legs_.back().to = rod.arc_length_at(place);
      legs_.back().last = knots_.size();
      legs_.push_back({rod.arc_length_at(place), 0.0, knots_.size(), 0});
    }
    add_clamp(place == last);
    if (place < last) knots_.push_back({tangent_place(rod, place), place, -1, false});
  }
  legs_.back().to = rod.arc_length_at(last);
  legs_.back().last = knots_.size();
}

void TangentLine::add_sample(double s, const Leg& leg, bool smooth) {
  const double length = rod_.closed ? rod_.rest_length() : 0.0;
  Sample sample{s, {}, {}, {}, smooth};
  if (leg.last - leg.first == 1) {
    sample.knots = {{leg.first, 1.0}};
    add_turns(sample);
    samples_.push_back(std::move(sample));
    return;
  }
  std::size_t right = leg.first + 1;
  while (right + 1 < leg.last && knots_[right].arc_length < s) ++right;
  const double a = knots_[right - 1].arc_length;
  const double b = knots_[right].arc_length;
  const double share = (s - a) / (b - a);
  sample.knots = {{right - 1, 1.0 - share}, {right, share}};
  for (std::size_t i = 0; i < kinks_.size(); ++i) {
    double factor = 0.0;
    for (const double turn : {-1.0, 0.0, 1.0}) {
      if (turn != 0.0 && length == 0.0) continue;
      const double kink = kinks_[i] + turn * length;
      factor += beyond(s, kink) - (1.0 - share) * beyond(a, kink) - share * beyond(b, kink);
    }
    if (std::abs(factor) > 1e-12 * (b - a)) sample.kinks.push_back({i, factor});
  }
  add_turns(sample);
  samples_.push_back(std::move(sample));
}

void TangentLine::add_turns(Sample& sample) const {
  if (!is_actuated_) return;
  const auto add = [&](Index edge, const ActuatedTurnTo& to) {
    if (!to.turn().is_zero()) sample.turns.push_back({rod_.position(edge), to.turn()});
  };
  const double s = sample.arc_length;
  for (const auto& [number, factor] : sample.knots) {
    const Knot& knot = knots_[number];
    double from = knot.arc_length;
    if (knot.clamp < 0) {
      from = std::clamp(s, rod_.arc_length_at(knot.edge), rod_.arc_length_at(knot.edge + 1));
      ActuatedTurnTo along_edge(from, rod_);
      along_edge.from_edge(knot.edge, factor, 0.0);
      add(knot.edge, along_edge);
    }
    ActuatedTurnTo beyond_edge(s, rod_);
    beyond_edge.from(from, factor, 0.0);
    add(edge_at(0.5 * (from + s), rod_), beyond_edge);
  }
}

TangentLine::Turn TangentLine::turn_between(const SampleWeights& weights) const {
  double s = 0.0;
  for (const auto& [sample, weight] : weights) s += weight * samples_[sample].arc_length;
  ActuatedTurnTo turn(s, rod_);
  for (const auto& [sample, weight] : weights) {
    turn.from(samples_[sample].arc_length, weight, 0.0);
  }
  return {edge_at(s, rod_), turn.turn()};
}

}  // namespace der
