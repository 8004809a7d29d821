#include "output/moment_recovery.hpp"

#include <algorithm>
#include <cmath>

#include "der/core/index.hpp"
#include "der/model/moment_place.hpp"

namespace der {
namespace {

/// The clamped place nearest to an edge on one side, if there is one.
std::optional<Index> clamp_before(const RodLayout& rod, Index edge) {
  const Index first = rod.closed ? edge - rod.num_edges() + 1 : 0;
  for (Index place = edge; place >= first; --place) {
    if (rod.clamp_at(place) != nullptr) return place;
  }
  return std::nullopt;
}
std::optional<Index> clamp_beyond(const RodLayout& rod, Index edge) {
  const Index last = rod.closed ? edge + rod.num_edges() : rod.num_edges();
  for (Index place = edge + 1; place <= last; ++place) {
    if (rod.clamp_at(place) != nullptr) return place;
  }
  return std::nullopt;
}

}  // namespace

MomentRecovery::MomentRecovery(const RodLayout& rod, const Model& model)
    : rod_(rod),
      forces_(rod, model),
      edges_(to_size(rod.num_edges())),
      kinks_(loaded_nodes(rod, model)) {
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
// on which a load is not spread across a clamp.

void MomentRecovery::add_moments(Index edge, Index turns, std::optional<Index> start,
                                 std::optional<Index> end) {
  for (std::size_t p = 0; p < rod_.moment_places.size(); ++p) {
    const MomentPlace& place = rod_.moment_places[p];
    const Index first_edge = place.first_edge + turns * rod_.num_edges();
    const double s = place.arc_length + turns * rod_.rest_length();
    const auto count = static_cast<Index>(place.weights.size());
    const bool from_before = end && first_edge + count > *end;
    const Where where = where_is(s, edge);
    MomentTerm term{p, s, where == Where::Inside};
    for (Index i = 0; i < count; ++i) {
      const Index other = first_edge + i;
      const double weight = place.weights[to_size(i)];
      if (other == edge) term.own = weight;
      if (from_before && other < start.value_or(0)) continue;
      if (!from_before && end && other >= *end) continue;
      if (from_before) {
        if (other < edge) term.first += weight;
        if (other <= edge) term.last += weight;
      } else {
        if (other >= edge) term.first -= weight;
        if (other > edge) term.last -= weight;
      }
    }
    const bool in_span =
        (!start || s >= rod_.arc_length_at(*start)) && (!end || s <= rod_.arc_length_at(*end));
    const double beyond = from_before ? 0.0 : 1.0;
    if (in_span && where != Where::Inside) {
      const double factor = where == Where::Beyond ? beyond : beyond - 1.0;
      term.first += factor;
      term.last += factor;
    }
    if (term.inside) {
      term.before = beyond;
      term.after = beyond - 1.0;
    }
    constexpr double kRounding = 1e-12;
    if (term.inside || term.own != 0.0 || std::abs(term.first) > kRounding ||
        std::abs(term.last) > kRounding) {
      edges_[to_size(edge)].moments.push_back(term);
    }
  }
}

void MomentRecovery::add_forces(Index edge, std::optional<Index> start, std::optional<Index> end) {
  for (std::size_t f = 0; f < forces_.size(); ++f) {
    const SpreadForces::Force& force = forces_[f];
    if (force.nodes.front().place > edge || force.nodes.back().place <= edge) continue;
    const bool from_before = end && force.nodes.back().place > *end;
    ForceTerm term{f, where_is(force.place.arc_length, edge), from_before ? -1.0 : 1.0, {}};
    for (const Weighted& node : force.nodes) {
      const bool before = node.place <= edge;
      const bool in_span = (!start || node.place >= *start) && (!end || node.place <= *end);
      if (before == from_before && in_span) term.nodes.push_back(node);
    }
    edges_[to_size(edge)].forces.push_back(std::move(term));
  }
}

double MomentRecovery::carried(std::size_t number, const Model& model, const State& state) const {
  const MomentPlace& place = rod_.moment_places[number];
  double applied = 0.0;
  for (const Index moment : place.moments) {
    applied += control_value(model, state, moment);
  }
  return carried_moment(place, rod_, model, state, applied);
}

Vec3 MomentRecovery::smooth(Index edge, bool last, const Vec3& point, const Model& model,
                            const State& state) const {
  const EdgeTerms& terms = edges_[to_size(edge)];
  Vec3 moment = Vec3::Zero();
  // A moment is a couple at the nodes of its edge: a pivot between them sees the nearer one's force
  // taken by the clamp.
  const Vec3 along = forces_.node_point(edge + 1, state) - forces_.node_point(edge, state);
  const double pivot =
      (point - forces_.node_point(last ? edge + 1 : edge, state)).dot(along) / along.squaredNorm();
  for (const MomentTerm& term : terms.moments) {
    const double factor = (last ? term.last : term.first) + term.own * pivot;
    if (factor != 0.0) moment.z() += factor * carried(term.place, model, state);
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

Vec3 MomentRecovery::inside(Index edge, const Place& place, const Model& model,
                            const State& state) const {
  const EdgeTerms& terms = edges_[to_size(edge)];
  const double s = place.arc_length;
  Vec3 moment = Vec3::Zero();
  for (const MomentTerm& term : terms.moments) {
    if (!term.inside) continue;
    const bool beyond = std::abs(term.arc_length - s) <= rod_.same_place()
                            ? place.loads_here_are_beyond
                            : term.arc_length > s;
    const double factor = beyond ? term.before : term.after;
    if (factor != 0.0) moment.z() += factor * carried(term.place, model, state);
  }
  for (const ForceTerm& term : terms.forces) {
    if (term.where != Where::Inside) continue;
    const double there = forces_[term.place].place.arc_length;
    const bool counts = term.sign > 0.0 ? there > s : there < s;
    if (!counts) continue;
    const Index end = term.sign > 0.0 ? edge : edge + 1;
    const double share = (there - s) / (there - rod_.arc_length_at(end));
    const Vec3 arm = share * (forces_.point(term.place, state) - forces_.node_point(end, state));
    moment += term.sign * arm.cross(forces_.value(term.place, model, state));
  }
  return moment;
}

double MomentRecovery::at_end(bool last, const Model& model, const State& state) const {
  const MomentPlace* place = rod_.moment_place_at(last ? rod_.rest_length() : 0.0);
  if (place == nullptr) return 0.0;
  const auto number = static_cast<std::size_t>(place - rod_.moment_places.data());
  return last ? carried(number, model, state) : -carried(number, model, state);
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
  // One of each place: the one with a jump, where there is one.
  std::sort(found.begin(), found.end(), [&](const Break& a, const Break& b) {
    if (std::abs(a.arc_length - b.arc_length) > rod_.same_place()) {
      return a.arc_length < b.arc_length;
    }
    return a.jumps && !b.jumps;
  });
  found.erase(std::unique(found.begin(), found.end(),
                          [&](const Break& a, const Break& b) {
                            return std::abs(a.arc_length - b.arc_length) <= rod_.same_place();
                          }),
              found.end());
  return found;
}

bool MomentRecovery::jumps_at(Index node) const {
  if (!rod_.is_inner(node)) return false;
  return rod_.clamp_at(node) != nullptr ||
         rod_.moment_place_at(rod_.arc_length[to_size(rod_.position(node))]) != nullptr;
}

}  // namespace der
