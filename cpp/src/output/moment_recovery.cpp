#include "output/moment_recovery.hpp"

#include <algorithm>
#include <cmath>

#include "der/core/index.hpp"
#include "der/model/moment_place.hpp"
#include "model/corner.hpp"
#include "model/legs.hpp"

namespace der {
namespace {

/// The clamped place nearest to an edge on one side, if there is one.
std::optional<Index> clamp_before(const RodMesh& rod, Index edge) {
  std::optional<Index> nearest;
  for (const Clamp& clamp : rod.clamps) {
    Index place = clamp.place;
    if (rod.closed && place > edge) place -= rod.num_edges();
    if (place <= edge && (!nearest || place > *nearest)) nearest = place;
  }
  return nearest;
}
std::optional<Index> clamp_beyond(const RodMesh& rod, Index edge) {
  std::optional<Index> nearest;
  for (const Clamp& clamp : rod.clamps) {
    Index place = clamp.place;
    if (rod.closed && place <= edge) place += rod.num_edges();
    if (place > edge && (!nearest || place < *nearest)) nearest = place;
  }
  return nearest;
}

}  // namespace

MomentRecovery::MomentRecovery(const RodMesh& rod, const Model& model)
    : rod_(rod),
      forces_(rod, model),
      moments_(rod, model),
      edges_(to_size(rod.num_edges())),
      corners_(rod.nodes.size()),
      bounds_(rod.nodes.size()) {
  for (const Index corner : corners_of(rod, model)) corners_[to_size(corner)] = true;
  for (const Index bound : leg_bounds(rod, model)) bounds_[to_size(bound)] = true;
  for (Index edge = 0; edge < rod.num_edges(); ++edge) {
    const std::optional<Index> start = clamp_before(rod, edge);
    const std::optional<Index> end = clamp_beyond(rod, edge);
    for (const Index turns : turns_of(rod)) add_moments(edge, turns, start, end);
    add_forces(edge, start, end);
  }
}

MomentRecovery::Where MomentRecovery::where_is(double s, Index edge) const {
  if (s <= rod_.arc_length_at(edge) + rod_.same_place()) return Where::Before;
  if (s >= rod_.arc_length_at(edge + 1) - rod_.same_place()) return Where::Beyond;
  return Where::Inside;
}

// The moment at a place is that of all that stands beyond it, or the opposite of all that stands
// before it. A clamp at `start` or `end` takes what acts on its other side: the sums go to the side
// on which a load is not spread across a clamp, and of forces next to a clamp to its other side.

void MomentRecovery::add_moments(Index edge, Index turns, std::optional<Index> start,
                                 std::optional<Index> end) {
  for (std::size_t m = 0; m < moments_.size(); ++m) {
    const SpreadMoments::Moment& moment = moments_[m];
    const Index ahead = turns * rod_.num_edges();
    const Index first_edge = moment.first_edge + ahead;
    const double s = moment.arc_length + turns * rod_.rest_length();
    const auto count = static_cast<Index>(moment.weights.size());
    const auto beside = place_beside_clamp(rod_, moment.arc_length);
    const bool is_taken_at_end = beside && end && beside->edge + ahead + 1 == *end;
    const bool from_before = end && (first_edge + count > *end || is_taken_at_end);
    const Where where = where_is(s, edge);
    MomentTerm term{m, s, where == Where::Inside, {}, {}};
    for (Index i = 0; i < count; ++i) {
      const Index other = first_edge + i;
      if (other == edge) term.own = static_cast<int>(i);
      if (from_before && other < start.value_or(0)) continue;
      if (!from_before && end && other >= *end) continue;
      double& first = term.first.on_edge[to_size(i)];
      double& last = term.last.on_edge[to_size(i)];
      if (from_before) {
        if (other < edge) first = 1.0;
        if (other <= edge) last = 1.0;
      } else {
        if (other >= edge) first = -1.0;
        if (other > edge) last = -1.0;
      }
    }
    const bool in_span =
        (!start || s >= rod_.arc_length_at(*start)) && (!end || s <= rod_.arc_length_at(*end));
    const double beyond = from_before ? 0.0 : 1.0;
    if (in_span && where != Where::Inside) {
      term.first.whole = term.last.whole = where == Where::Beyond ? beyond : beyond - 1.0;
    }
    if (term.inside) {
      term.before = beyond;
      term.after = beyond - 1.0;
    }
    const auto vanishes = [&](const MomentFactors& factors) {
      constexpr double kRounding = 1e-12;
      double sum = factors.whole;
      for (std::size_t i = 0; i < moment.weights.size(); ++i) {
        sum += factors.on_edge[i] * moment.weights[i];
      }
      return std::abs(sum) <= kRounding;
    };
    if (term.inside || term.own >= 0 || !vanishes(term.first) || !vanishes(term.last)) {
      edges_[to_size(edge)].moments.push_back(term);
    }
  }
}

void MomentRecovery::add_forces(Index edge, std::optional<Index> start, std::optional<Index> end) {
  for (std::size_t f = 0; f < forces_.size(); ++f) {
    const SpreadForces::Force& force = forces_[f];
    if (force.nodes.front().place > edge || force.nodes.back().place <= edge) continue;
    const bool next_to_end = end && edge + 1 == *end && (!start || edge > *start) &&
                             force.nodes.front().place >= start.value_or(0);
    const bool from_before = end && (force.nodes.back().place > *end || next_to_end);
    ForceTerm term{f, where_is(force.place.arc_length, edge), from_before ? -1.0 : 1.0, {}};
    for (const Weighted& node : force.nodes) {
      const bool before = node.place <= edge;
      const bool in_span = (!start || node.place >= *start) && (!end || node.place <= *end);
      if (before == from_before && in_span) term.nodes.push_back(node);
    }
    edges_[to_size(edge)].forces.push_back(std::move(term));
  }
}

bool MomentRecovery::is_same_place(double a, double b) const {
  return std::abs(a - b) <= rod_.same_place();
}

Vec3 MomentRecovery::smooth(Index edge, bool last, const Vec3& point, const Model& model,
                            const State& state) const {
  const EdgeTerms& terms = edges_[to_size(edge)];
  Vec3 moment = Vec3::Zero();
  for (const MomentTerm& term : terms.moments) {
    moment += (last ? term.last : term.first).times(moments_.value(term.number, model, state));
  }
  for (const ForceTerm& term : terms.forces) {
    const Vec3 stands = forces_.point(term.place, state);
    Vec3 arm = Vec3::Zero();  // of the true force, less those of the spread one
    if (term.where == (term.sign > 0.0 ? Where::Beyond : Where::Before)) arm = stands - point;
    for (const auto& [node, weight] : term.nodes)
      arm -= weight * (forces_.node_point(node, state) - point);
    moment += term.sign * arm.cross(forces_.value(term.place, model, state));
  }
  return moment;
}

double MomentRecovery::share_of(Index edge, const Vec3& point, const State& state) const {
  const Vec3 along = edge_vector(edge, state);
  return (point - forces_.node_point(edge, state)).dot(along) / along.squaredNorm();
}

Vec3 MomentRecovery::edge_vector(Index edge, const State& state) const {
  return forces_.node_point(edge + 1, state) - forces_.node_point(edge, state);
}

/// Twice what a unit of strain moves the section at arc length `s` further along the rod than the
/// chain [m], as the strain jumps by it at a force, and at the force's nodes by their weights.
double MomentRecovery::kink(const SpreadForces::Force& force, double s) const {
  double kink = -std::abs(s - force.place.arc_length);
  for (const auto& [node, weight] : force.nodes) {
    kink += weight * std::abs(s - rod_.arc_length_at(node));
  }
  return kink;
}

double MomentRecovery::displaced(Index edge, double s, const Model& model,
                                 const State& state) const {
  const std::vector<ForceTerm>& terms = edges_[to_size(edge)].forces;
  if (terms.empty()) return 0.0;
  const Vec3 along = edge_vector(edge, state);
  double sum = 0.0;
  for (const ForceTerm& term : terms) {
    const double force = forces_.value(term.place, model, state).dot(along);
    sum += 0.5 * kink(forces_[term.place], s) * force / rod_.EA;
  }
  return sum / along.squaredNorm();
}

Vec3 MomentRecovery::inside(Index edge, const Place& place, const Model& model,
                            const State& state) const {
  const EdgeTerms& terms = edges_[to_size(edge)];
  const double s = place.arc_length;
  Vec3 moment = Vec3::Zero();
  for (const MomentTerm& term : terms.moments) {
    if (!term.inside) continue;
    const bool beyond =
        is_same_place(term.arc_length, s) ? place.loads_here_are_beyond : term.arc_length > s;
    const double factor = beyond ? term.before : term.after;
    if (factor != 0.0) moment += factor * moments_.value(term.number, model, state).whole;
  }
  for (const ForceTerm& term : terms.forces) {
    if (term.where != Where::Inside) continue;
    const double there = forces_[term.place].place.arc_length;
    const bool counts = term.sign > 0.0 ? there > s : there < s;
    if (!counts) continue;
    const Index end = term.sign > 0.0 ? edge : edge + 1;
    const double s_end = rod_.arc_length_at(end);
    const double share = (there - s) / (there - s_end);
    const Vec3 section = forces_.node_point(end, state) +
                         displaced(edge, s_end, model, state) * edge_vector(edge, state);
    const Vec3 arm = share * (forces_.point(term.place, state) - section);
    moment += term.sign * arm.cross(forces_.value(term.place, model, state));
  }
  return moment;
}

Vec3 MomentRecovery::at_end(bool last, const Model& model, const State& state) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t m = 0; m < moments_.size(); ++m) {
    if (is_same_place(moments_[m].arc_length, last ? rod_.rest_length() : 0.0)) {
      sum += (last ? 1.0 : -1.0) * moments_.value(m, model, state).whole;
    }
  }
  return sum;
}

Vec3 MomentRecovery::excess(Index edge, const Model& model, const State& state) const {
  Vec3 sum = Vec3::Zero();
  for (const MomentTerm& term : edges_[to_size(edge)].moments) {
    if (term.own < 0 || moments_[term.number].weights[to_size(term.own)] <= 1.0) continue;
    const EdgeMoments value = moments_.value(term.number, model, state);
    sum += value.on_edge[to_size(term.own)] - value.whole;
  }
  return sum;
}

std::vector<MomentRecovery::Break> MomentRecovery::breaks(Index edge) const {
  std::vector<Break> found;
  for (const MomentTerm& term : edges_[to_size(edge)].moments) {
    if (term.inside) found.push_back({term.arc_length, true});
  }
  for (const ForceTerm& term : edges_[to_size(edge)].forces) {
    if (term.where == Where::Inside) {
      found.push_back({forces_[term.place].place.arc_length, false});
    }
  }
  for (const ActuatedStretch& stretch : rod_.actuated_stretches) {
    if (!stretch.strains()) continue;
    for (const bool end : {false, true}) {
      const double s = end ? stretch.to : stretch.from;
      if (where_is(s, edge) == Where::Inside) found.push_back({s, stretch.jumps(end)});
    }
  }
  // One of each place: the one with a jump, where there is one.
  std::sort(found.begin(), found.end(), [&](const Break& a, const Break& b) {
    if (!is_same_place(a.arc_length, b.arc_length)) return a.arc_length < b.arc_length;
    return a.jumps && !b.jumps;
  });
  found.erase(std::unique(found.begin(), found.end(),
                          [&](const Break& a, const Break& b) {
                            return is_same_place(a.arc_length, b.arc_length);
                          }),
              found.end());
  return found;
}

bool MomentRecovery::jumps_at(Index node) const {
  if (!rod_.is_inner(node)) return false;
  const auto stands_here = [&](double s) {
    return is_same_place(s, rod_.arc_length[to_size(rod_.position(node))]);
  };
  const std::vector<double> places = rod_.moment_arc_lengths();
  const auto& stretches = rod_.actuated_stretches;
  return rod_.clamp_at(node) != nullptr || bounds_legs(node) ||
         std::any_of(places.begin(), places.end(), stands_here) ||
         std::any_of(stretches.begin(), stretches.end(), [&](const ActuatedStretch& stretch) {
           return stretch.strains() && ((stretch.jumps(false) && stands_here(stretch.from)) ||
                                        (stretch.jumps(true) && stands_here(stretch.to)));
         });
}

}  // namespace der
