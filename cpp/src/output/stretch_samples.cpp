#include "output/stretch_samples.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

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
  Layout(const RodLayout& rod, const SpreadForces& forces, const Model& model)
      : rod_(rod), forces_(forces), bounds_(leg_bounds(rod, model)) {
    for (Index edge = 0; edge < rod.num_edges(); ++edge) middles_.push_back(rod.edge_middle(edge));
    find_breaks();
  }

  [[nodiscard]] std::vector<StretchSample> samples() const {
    std::vector<StretchSample> all;
    for (std::size_t part = 0; part + 1 < breaks_.size(); ++part) add_part(part, all);
    return all;
  }

 private:
  using Passed = StretchSample::Passed;

  /// The line that a sample continues: that of the edges with their middles in a part.
  struct Line {
    std::size_t part = 0;
    Index first = 0, last = 0;  // edges

    [[nodiscard]] bool has_slope() const { return first < last; }
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
  [[nodiscard]] Line line_of(std::size_t part) const {
    const std::size_t from = part_to_go_on_from(part);
    return {from, first_middle(from), first_middle(from + 1) - 1};
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
    const Line line = line_of(part);
    StretchSample sample;
    sample.arc_length = s;
    sample.edges = line_weights(middles_, line.first, line.last, s);
    sample.forces = forces_between(part, line.part);
    sample.distributed = loads_between(s, part, line, rod_.distributed_places);
    sample.foundations = loads_between(s, part, line, rod_.foundation_places);
    return sample;
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
        if (is_at(number)) passed.push_back({f, -1.0, there, direction_at(there)});
      }
      for (std::size_t number = part + 1; number <= from; ++number) {
        if (is_at(number)) passed.push_back({f, 1.0, there, direction_at(there)});
      }
    }
    return passed;
  }

  /// The loads along the rod between arc length `s` of a part and the middle from which it
  /// continues a line, less those that the slope of the line contains.
  template <class Place>
  [[nodiscard]] std::vector<Passed> loads_between(double s, std::size_t part, const Line& line,
                                                  const std::vector<Place>& places) const {
    std::vector<Passed> passed;
    if (part == line.part && line.has_slope()) return passed;
    const double middle = middles_[to_size(part < line.part ? line.first : line.last)];
    const double under_line = 0.5 * (breaks_[line.part] + breaks_[line.part + 1]);
    const bool before = s < middle;
    for (std::size_t i = 0; i < places.size(); ++i) {
      double a = std::clamp(places[i].from, std::min(s, middle), std::max(s, middle));
      double b = std::clamp(places[i].to, std::min(s, middle), std::max(s, middle));
      double sign = before ? 1.0 : -1.0;
      if (line.has_slope() && places[i].from < under_line && under_line < places[i].to) {
        // The slope contains it on the whole way: too much where it does not act.
        std::tie(a, b) = before ? std::pair(s, a) : std::pair(b, s);
        sign = -sign;
      }
      if (b - a <= rod_.same_place()) continue;
      const double there = 0.5 * (a + b);
      passed.push_back({i, sign * (b - a), there, direction_at(there)});
    }
    return passed;
  }

  /// The direction at a place within a leg: a line through those of the leg's edges.
  [[nodiscard]] std::vector<Weighted> direction_at(double s) const {
    Index first = 0;
    Index last = rod_.num_edges() - 1;
    for (const Index bound : bounds_) {
      if (rod_.arc_length_at(bound) > s) {
        last = bound - 1;
        break;
      }
      first = bound;
    }
    return line_weights(middles_, first, last, s);
  }

  const RodLayout& rod_;
  const SpreadForces& forces_;
  std::vector<Index> bounds_;    // between the legs
  std::vector<double> middles_;  // of the edges [m]
  std::vector<double> breaks_;   // ascending, the ends of the rod too [m]
};

}  // namespace

std::vector<StretchSample> stretch_samples(const RodLayout& rod, const SpreadForces& forces,
                                           const Model& model) {
  return Layout(rod, forces, model).samples();
}

}  // namespace der
