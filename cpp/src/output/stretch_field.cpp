#include "output/stretch_field.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "der/core/index.hpp"
#include "der/model/location.hpp"
#include "der/supports/clamp.hpp"
#include "output/edge_excess.hpp"
#include "output/spread_forces.hpp"

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

/// The strain, times a stiffness [N] (1: the strain itself).
///
/// The tension in an edge of the chain is that of the loads beyond it as they are spread over the
/// nodes. It is corrected to that of the true loads beyond the edge's middle. From the middles it
/// is continued linearly up to the next place where it may jump or have a kink: a part of the rod
/// between two such places uses its own middles only. A part without any lies within one edge; its
/// values follow from the part beside it by the jump that the force between them causes.
class StretchField : public RodField {
 public:
  static std::unique_ptr<RodField> make(double stiffness, const RodLayout& rod,
                                        const Model& model) {
    SpreadForces forces(rod, model);
    const Layout layout(rod, forces, model);
    return std::unique_ptr<RodField>(
        new StretchField(stiffness, rod, model, std::move(forces), layout));
  }

  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    double strain = 0.0;
    for (const auto& [edge, weight] : samples_[i].edges) {
      strain += weight * middle_strain(edge, model, state);
    }
    for (const Jump& jump : samples_[i].jumps) {
      Vec2 along = Vec2::Zero();
      for (const auto& [edge, weight] : jump.direction) {
        along += weight * direction(edge, model, state);
      }
      strain += jump.sign * along.normalized().dot(forces_.value(jump.force, model, state)) / EA_;
    }
    return stiffness_ * strain;
  }
  [[nodiscard]] bool smooth_at(std::size_t i) const override { return samples_[i].smooth; }

 private:
  /// The jump of the strain at a point force.
  struct Jump {
    std::size_t force = 0;
    double sign = 1.0;
    std::vector<Weighted> direction;  // of the rod at the force, as that of edges
  };
  struct Sample {
    double arc_length = 0.0;      // [m]
    std::vector<Weighted> edges;  // values at their middles
    std::vector<Jump> jumps;
    bool smooth = true;
  };
  /// The parts of the rod and the samples along them.
  class Layout {
   public:
    Layout(const RodLayout& rod, const SpreadForces& forces, const Model& model)
        : rod_(rod), forces_(forces) {
      for (Index edge = 0; edge < rod.num_edges(); ++edge) {
        middles.push_back(rod.edge_middle(edge));
      }
      find_breaks(model);
      for (std::size_t part = 0; part + 1 < breaks_.size(); ++part) add_part(part);
    }

    std::vector<double> middles;  // of the edges [m]
    std::vector<Sample> samples;

   private:
    void find_breaks(const Model& model) {
      breaks_ = {0.0, rod_.rest_length()};
      const std::vector<bool> loaded = loaded_nodes(rod_, model);
      for (Index i = 1; i < rod_.num_edges(); ++i) {
        if (loaded[to_size(i)] || rod_.clamp_at(i) != nullptr)
          breaks_.push_back(rod_.arc_length[to_size(i)]);
      }
      for (std::size_t f = 0; f < forces_.size(); ++f) {
        breaks_.push_back(forces_[f].place.arc_length);
      }
      for (const MomentPlace& place : rod_.moment_places) breaks_.push_back(place.arc_length);
      for (const DistributedPlace& place : rod_.distributed_places) {
        breaks_.push_back(place.from);
        breaks_.push_back(place.to);
      }
      for (const FoundationPlace& place : rod_.foundation_places) {
        breaks_.push_back(place.from);
        breaks_.push_back(place.to);
      }
      std::sort(breaks_.begin(), breaks_.end());
      const auto same = [&](double a, double b) { return b - a <= rod_.same_place(); };
      breaks_.erase(std::unique(breaks_.begin(), breaks_.end(), same), breaks_.end());
    }

    /// First edge whose middle is at a break or beyond it.
    [[nodiscard]] Index first_middle(std::size_t part) const {
      const auto found =
          std::lower_bound(middles.begin(), middles.end(), breaks_[part] - rod_.same_place());
      return static_cast<Index>(found - middles.begin());
    }
    [[nodiscard]] bool has_middle(std::size_t part) const {
      return first_middle(part) < first_middle(part + 1);
    }
    /// The nearest part with a middle, on the way to which there is no node.
    [[nodiscard]] std::size_t part_to_go_on_from(std::size_t part) const {
      const Index edge = std::max<Index>(0, first_middle(part) - 1);
      for (std::size_t before = part + 1; before-- > 0;) {
        if (breaks_[before + 1] <= rod_.arc_length[to_size(edge)] + rod_.same_place()) break;
        if (has_middle(before)) {
          if (breaks_[part] < rod_.arc_length[to_size(edge + 1)] - rod_.same_place()) return before;
          break;
        }
      }
      std::size_t beyond = part;
      while (!has_middle(beyond)) ++beyond;
      return beyond;
    }

    [[nodiscard]] Sample sample_of(std::size_t part, double s) const {
      const std::size_t from = part_to_go_on_from(part);
      Sample sample{
          s, line_weights(middles, first_middle(from), first_middle(from + 1) - 1, s), {}};
      for (std::size_t f = 0; f < forces_.size(); ++f) {
        const double there = forces_[f].place.arc_length;
        const auto is_at = [&](std::size_t number) {
          return std::abs(there - breaks_[number]) <= rod_.same_place();
        };
        for (std::size_t number = from + 1; number <= part; ++number) {
          if (is_at(number)) sample.jumps.push_back({f, -1.0, direction_at(there)});
        }
        for (std::size_t number = part + 1; number <= from; ++number) {
          if (is_at(number)) sample.jumps.push_back({f, 1.0, direction_at(there)});
        }
      }
      return sample;
    }
    [[nodiscard]] std::vector<Weighted> direction_at(double s) const {
      return line_weights(middles, 0, rod_.num_edges() - 1, s);
    }

    void add_part(std::size_t part) {
      const double start = breaks_[part];
      const double end = breaks_[part + 1];
      const auto add = [&](double s, bool smooth) {
        samples.push_back(sample_of(part, s));
        samples.back().smooth = smooth;
      };
      add(start, false);
      for (Index edge = first_middle(part); edge < first_middle(part + 1); ++edge) {
        if (middles[to_size(edge)] > start + rod_.same_place()) add(middles[to_size(edge)], true);
      }
      add(end, false);
    }

    const RodLayout& rod_;
    const SpreadForces& forces_;
    std::vector<double> breaks_;  // ascending, the ends of the rod too [m]
  };

  StretchField(double stiffness, const RodLayout& rod, const Model& model, SpreadForces forces,
               const Layout& layout)
      : RodField(arc_lengths(layout.samples)),
        stiffness_(stiffness),
        EA_(rod.EA),
        edge_length_(rod.edge_length),
        forces_(std::move(forces)),
        excess_(rod, forces_),
        samples_(layout.samples) {
    for (Index edge = 0; edge < rod.num_edges(); ++edge) {
      effective_.push_back(effective_edge(rod, edge, model));
      rest_length_.push_back(effective_.back().vector(model.initial_positions, 0.0, 0.0).norm());
    }
  }

  static std::vector<double> arc_lengths(const std::vector<Sample>& samples) {
    std::vector<double> result;
    for (const Sample& sample : samples) result.push_back(sample.arc_length);
    return result;
  }

  [[nodiscard]] Vec2 direction(Index edge, const Model& model, const State& state) const {
    return effective_vector(effective_[to_size(edge)], model, state).normalized();
  }

  [[nodiscard]] double middle_strain(Index edge, const Model& model, const State& state) const {
    const Vec2 effective = effective_vector(effective_[to_size(edge)], model, state);
    const double length = effective.norm();
    const double chain = (length - rest_length_[to_size(edge)]) / edge_length_[to_size(edge)];
    if (excess_.none(edge)) return chain;
    return chain + effective.dot(excess_.force(edge, forces_, model, state)) / (length * EA_);
  }

  double stiffness_;
  double EA_;
  std::vector<double> edge_length_;
  std::vector<double> rest_length_;  // of the effective edges
  std::vector<EffectiveEdge> effective_;
  SpreadForces forces_;
  EdgeExcess excess_;
  std::vector<Sample> samples_;
};

}  // namespace

std::unique_ptr<RodField> make_strain_field(const RodLayout& rod, const Model& model) {
  return StretchField::make(1.0, rod, model);
}

std::unique_ptr<RodField> make_tension_field(const RodLayout& rod, const Model& model) {
  return StretchField::make(rod.EA, rod, model);
}

}  // namespace der
