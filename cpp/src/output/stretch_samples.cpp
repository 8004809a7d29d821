#include "output/stretch_samples.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "der/core/index.hpp"
#include "model/legs.hpp"
#include "output/actuated_shape.hpp"

namespace der {
namespace {

/// Weights of two neighbouring edges for the line through the values at their middles; of one where
/// there is no other.
std::vector<Weighted> line_weights(const std::vector<double>& middles, Index first, Index last,
                                   double s) {
  if (first == last) return {{first, 1.0}};
  Index right = first + 1;
  while (right < last && middles[to_size(right)] < s) ++right;
  const double share =
      (s - middles[to_size(right - 1)]) / (middles[to_size(right)] - middles[to_size(right - 1)]);
  return {{right - 1, 1.0 - share}, {right, share}};
}

/// The parts of a rod and the samples along them.
class Layout {
 public:
  Layout(const RodMesh& rod, const SpreadForces& forces, const Model& model)
      : rod_(rod), forces_(forces), bounds_(leg_bounds(rod, model)) {
    for (Index edge = 0; edge < rod.num_edges(); ++edge) middles_.push_back(rod.edge_middle(edge));
    find_breaks();
    for (std::size_t part = 0; part + 1 < breaks_.size(); ++part) {
      if (middles_of(part).make_a_line()) lines_.push_back(middles_of(part));
    }
  }

  [[nodiscard]] std::vector<StretchSample> samples() const {
    std::vector<StretchSample> all;
    for (std::size_t part = 0; part + 1 < breaks_.size(); ++part) add_part(part, all);
    return all;
  }

 private:
  using Passed = StretchSample::Passed;

  /// The edges with their middles in a part.
  struct Middles {
    std::size_t part = 0;
    Index first = 0, last = 0;

    [[nodiscard]] bool make_a_line() const { return first < last; }
  };
  /// From where a sample continues the line of another part, at that part's end or its only middle.
  struct Way {
    double from = 0.0;  // [m]
    double to = 0.0;    // the sample [m]

    [[nodiscard]] double length() const { return to - from; }
    [[nodiscard]] double start() const { return std::min(from, to); }
    [[nodiscard]] double end() const { return std::max(from, to); }
  };

  void find_breaks() {
    breaks_ = {0.0, rod_.rest_length()};
    for (Index i = 1; i < rod_.num_edges(); ++i) {
      if (rod_.bears_force[to_size(i)] || rod_.clamp_at(i) != nullptr)
        breaks_.push_back(rod_.arc_length[to_size(i)]);
    }
    for (std::size_t f = 0; f < forces_.size(); ++f) {
      const double s = forces_[f].place.arc_length;
      if (0.0 <= s && s <= rod_.rest_length()) breaks_.push_back(s);
    }
    for (const Index bound : bounds_) breaks_.push_back(rod_.arc_length[to_size(bound)]);
    for (const double place : rod_.moment_arc_lengths()) breaks_.push_back(place);
    for (const DistributedPlace& place : rod_.distributed_places) {
      breaks_.push_back(place.from);
      breaks_.push_back(place.to);
    }
    for (const FoundationPlace& place : rod_.foundation_places) {
      breaks_.push_back(place.from);
      breaks_.push_back(place.to);
    }
    for (const double place : actuated_jumps(rod_, false)) breaks_.push_back(place);
    std::sort(breaks_.begin(), breaks_.end());
    const auto same = [&](double a, double b) { return b - a <= rod_.same_place(); };
    breaks_.erase(std::unique(breaks_.begin(), breaks_.end(), same), breaks_.end());
  }

  /// First edge whose middle is at a break or beyond it.
  [[nodiscard]] Index first_middle(std::size_t part) const {
    const auto found =
        std::lower_bound(middles_.begin(), middles_.end(), breaks_[part] - rod_.same_place());
    return static_cast<Index>(found - middles_.begin());
  }
  [[nodiscard]] bool has_middle(std::size_t part) const {
    return first_middle(part) < first_middle(part + 1);
  }
  /// The nearest part with a middle, on the way to which there is no node.
  [[nodiscard]] std::size_t part_to_go_on_from(std::size_t part) const {
    const Index edge = std::max<Index>(0, first_middle(part) - 1);
    for (std::size_t before = part + 1; before-- > 0;) {
      if (breaks_[before + 1] <= rod_.arc_length_at(edge) + rod_.same_place()) break;
      if (has_middle(before)) {
        if (breaks_[part] < rod_.arc_length_at(edge + 1) - rod_.same_place()) return before;
        break;
      }
    }
    std::size_t beyond = part;
    while (!has_middle(beyond)) ++beyond;
    return beyond;
  }
  [[nodiscard]] Middles middles_of(std::size_t part) const {
    return {part, first_middle(part), first_middle(part + 1) - 1};
  }
  /// The nearest part of the same leg with middles that make a line; none: there is no such part.
  [[nodiscard]] std::optional<Middles> nearest_line(const Middles& here) const {
    if (here.make_a_line()) return here;
    const auto distance = [&](const Middles& other) { return std::abs(other.first - here.first); };
    std::optional<Middles> nearest;
    for (const Middles& there : lines_) {
      if (leg_of(there.first) != leg_of(here.first)) continue;
      if (!nearest || distance(there) < distance(*nearest)) nearest = there;
    }
    return nearest;
  }
  /// Number of the leg that an edge belongs to.
  [[nodiscard]] std::ptrdiff_t leg_of(Index edge) const {
    return std::upper_bound(bounds_.begin(), bounds_.end(), edge) - bounds_.begin();
  }

  void add_part(std::size_t part, std::vector<StretchSample>& all) const {
    const double start = breaks_[part];
    const double end = breaks_[part + 1];
    const auto add = [&](double s, bool smooth) {
      all.push_back(sample_of(part, s));
      all.back().smooth = smooth;
    };
    add(start, false);
    for (Index edge = first_middle(part); edge < first_middle(part + 1); ++edge) {
      if (middles_[to_size(edge)] > start + rod_.same_place()) add(middles_[to_size(edge)], true);
    }
    add(end, false);
  }

  [[nodiscard]] StretchSample sample_of(std::size_t part, double s) const {
    const Middles own = middles_of(part_to_go_on_from(part));
    StretchSample sample;
    sample.arc_length = s;
    sample.line = {line_weights(middles_, own.first, own.last, s), forces_between(part, own.part)};
    if (part == own.part && own.make_a_line()) return sample;
    const std::vector<Weighted> edges = sample.line.edges;
    const std::optional<Middles> slope = nearest_line(own);
    const Way way = way_to(s, own);
    if (slope) take_slope(*slope, way, !own.make_a_line(), sample);
    for (std::size_t other = std::min(part, own.part); other <= std::max(part, own.part); ++other) {
      add_curving(std::clamp(breaks_[other], way.start(), way.end()),
                  std::clamp(breaks_[other + 1], way.start(), way.end()),
                  way.length() > 0.0 ? 1.0 : -1.0, {edges, forces_between(other, own.part)},
                  sample);
    }
    sample.distributed = loads_between(way, slope, rod_.distributed_places);
    sample.foundations = loads_between(way, slope, rod_.foundation_places);
    return sample;
  }
  /// The slope of other middles, less what curving has in it. The sample's own line has it, or does
  /// not yet have it.
  void take_slope(const Middles& other, const Way& way, bool add, StretchSample& sample) const {
    const std::vector<Weighted> pair = line_weights(middles_, other.first, other.last, way.to);
    const Index before = pair.front().place;
    const double start = middles_[to_size(before)];
    const double end = middles_[to_size(before + 1)];
    const double times = way.length() / (end - start);
    if (add) {
      sample.line.edges.push_back({before, -times});
      sample.line.edges.push_back({before + 1, times});
    }
    add_curving(start, end, -times, {{{before, 0.5}, {before + 1, 0.5}}, {}}, sample);
  }
  [[nodiscard]] Way way_to(double s, const Middles& own) const {
    if (!own.make_a_line()) return {middles_[to_size(own.first)], s};
    return {std::clamp(s, breaks_[own.part], breaks_[own.part + 1]), s};
  }
  void add_curving(double from, double to, double times, const StretchSample::Line& line,
                   StretchSample& sample) const {
    if (to - from > rod_.same_place()) {
      sample.curving.push_back({from, to, times * (to - from), line});
    }
  }

  /// The point forces between a part and the one whose line it continues.
  [[nodiscard]] std::vector<Passed> forces_between(std::size_t part, std::size_t from) const {
    std::vector<Passed> passed;
    for (std::size_t f = 0; f < forces_.size(); ++f) {
      const double there = forces_[f].place.arc_length;
      const auto is_at = [&](std::size_t number) {
        return std::abs(there - breaks_[number]) <= rod_.same_place();
      };
      for (std::size_t number = from + 1; number <= part; ++number) {
        if (is_at(number)) passed.push_back({f, -1.0, there});
      }
      for (std::size_t number = part + 1; number <= from; ++number) {
        if (is_at(number)) passed.push_back({f, 1.0, there});
      }
    }
    return passed;
  }

  /// The loads along the rod on the way to a sample, less those that the slope of the line has.
  template <class Place>
  [[nodiscard]] std::vector<Passed> loads_between(const Way& way,
                                                  const std::optional<Middles>& slope,
                                                  const std::vector<Place>& places) const {
    std::vector<Passed> passed;
    const double sign = way.length() < 0.0 ? 1.0 : -1.0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double a = std::clamp(places[i].from, way.start(), way.end());
      const double b = std::clamp(places[i].to, way.start(), way.end());
      const bool is_in_slope = slope && acts_on(slope->part, places[i]);
      const double amount = b - a - (is_in_slope ? way.end() - way.start() : 0.0);
      if (std::abs(amount) <= rod_.same_place()) continue;
      const double there = is_in_slope ? 0.5 * (way.from + way.to) : 0.5 * (a + b);
      passed.push_back({i, sign * amount, there});
    }
    return passed;
  }
  template <class Place>
  [[nodiscard]] bool acts_on(std::size_t part, const Place& place) const {
    const double middle = 0.5 * (breaks_[part] + breaks_[part + 1]);
    return place.from < middle && middle < place.to;
  }

  const RodMesh& rod_;
  const SpreadForces& forces_;
  std::vector<Index> bounds_;    // between the legs
  std::vector<double> middles_;  // of the edges [m]
  std::vector<double> breaks_;   // ascending, the ends of the rod too [m]
  std::vector<Middles> lines_;   // of the parts that have one of their own
};

}  // namespace

std::vector<StretchSample> stretch_samples(const RodMesh& rod, const SpreadForces& forces,
                                           const Model& model) {
  return Layout(rod, forces, model).samples();
}

}  // namespace der
