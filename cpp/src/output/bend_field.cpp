#include "output/bend_field.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "der/core/index.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/model/internal_damping.hpp"
#include "der/output/vertex_strain.hpp"
#include "der/supports/clamp.hpp"
#include "output/actuated_shape.hpp"
#include "output/edgewise_field.hpp"
#include "output/in_space.hpp"
#include "output/leg_field.hpp"
#include "output/moment_recovery.hpp"
#include "output/natural_curvature.hpp"
#include "output/section_field.hpp"
#include "supports/leg_clamp.hpp"

namespace der {
namespace {

/// The turn from one direction to the next.
struct BendCell {
  EffectiveEdge before;
  EffectiveEdge after;
  std::optional<Clamp> start;  // its tangent stands in place of the edge before
  std::optional<Clamp> end;    // its tangent stands in place of the edge after
};

Vec2 tangent(const Clamp& clamp, const Model& model, const State& state) {
  const double angle = tangent_angle(clamp, model, state);
  return {std::cos(angle), std::sin(angle)};
}

double turning_angle(const BendCell& cell, const Model& model, const State& state) {
  const Vec2 before =
      cell.start ? tangent(*cell.start, model, state) : effective_vector(cell.before, model, state);
  const Vec2 after =
      cell.end ? tangent(*cell.end, model, state) : effective_vector(cell.after, model, state);
  return angle_between(before, after);
}

/// The rate [rad/s] of that angle.
double turning_rate(const BendCell& cell, const Model& model, const State& state) {
  const auto of_clamp = [&](const Clamp& clamp) {
    return clamp.rotation < 0 ? 0.0 : turn_rate(model, state, clamp.rotation);
  };
  const auto of_edge = [&](const EffectiveEdge& edge) {
    const Vec2 vector = effective_vector(edge, model, state);
    return cross(vector, effective_rate(edge, model, state)) / vector.squaredNorm();
  };
  return (cell.end ? of_clamp(*cell.end) : of_edge(cell.after)) -
         (cell.start ? of_clamp(*cell.start) : of_edge(cell.before));
}

/// From edge to edge at an inner node, from or to the held tangent at a clamped end.
BendCell cell_at(const RodMesh& rod, Index node, const Model& model) {
  BendCell cell;
  if (const Index edge = rod.edge_before(node); edge >= 0) {
    cell.before = effective_edge(rod, edge, model);
  } else {
    cell.start = *rod.clamp_at(node);
  }
  if (const Index edge = rod.edge_after(node); edge >= 0) {
    cell.after = effective_edge(rod, edge, model);
  } else {
    cell.end = *rod.clamp_at(node);
  }
  return cell;
}

/// Turning angles, times a factor: 1, or what makes a curvature or a moment of them.
class TurnField : public RodField {
 public:
  /// `nodes`: positions in the rod of the nodes that bend, with the factor of each.
  TurnField(const RodMesh& rod, const std::vector<Weighted>& nodes, bool continuous,
            const Model& model)
      : RodField(arc_lengths(rod, nodes)), continuous_(continuous) {
    for (const auto& [node, factor] : nodes) {
      cells_.emplace_back(cell_at(rod, node, model), factor);
    }
  }
  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    return cells_[i].second * turning_angle(cells_[i].first, model, state);
  }
  [[nodiscard]] bool continuous() const override { return continuous_; }

 private:
  static std::vector<double> arc_lengths(const RodMesh& rod, const std::vector<Weighted>& nodes) {
    std::vector<double> result;
    for (const auto& [node, factor] : nodes) result.push_back(rod.arc_length[to_size(node)]);
    return result;
  }

  std::vector<std::pair<BendCell, double>> cells_;
  bool continuous_;
};

/// The quantities that are read from the bending of a rod.
enum class Bending { Curvature, Moment, NaturalCurvature };

/// A rod without bending stiffness: moment and natural curvature are zero.
std::unique_ptr<RodField> limp_field(Bending what, const RodMesh& rod, const Model& model) {
  std::vector<Weighted> nodes;
  for (Index i = 0; i < static_cast<Index>(rod.nodes.size()); ++i) {
    if (!rod.is_inner(i)) continue;
    nodes.push_back({i, what == Bending::Curvature ? 1.0 / rod.voronoi_length(i) : 0.0});
  }
  return std::make_unique<TurnField>(rod, nodes, true, model);
}

/// A rod with bending stiffness: along each edge that of its two ends, linear but for the loads
/// inside the edge.
template <class Measure>
class BendField : public EdgewiseField<double> {
 public:
  static std::unique_ptr<RodField> make(Bending what, const RodMesh& rod, const Model& model) {
    std::vector<std::pair<Known, Known>> edges;
    Lines lines;
    const NaturalCurvature natural(rod, model);
    for (Index edge = 0; edge < rod.num_edges(); ++edge) {
      edges.emplace_back(known(rod, edge, false, natural, model),
                         known(rod, edge, true, natural, model));
      lines.emplace_back(edges.back().first.arc_length, edges.back().second.arc_length);
    }
    MomentRecovery recovery(rod, model);
    std::vector<Sample> samples = samples_of(rod, recovery);
    return std::unique_ptr<RodField>(new BendField(what, rod, std::move(samples), std::move(lines),
                                                   std::move(recovery), std::move(edges)));
  }

  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    const auto& [edge, place, smooth] = sample_at(i);
    const double own = value(edge, place, model, state);
    if (is_moment()) return own;
    return own + actuated_.strains(place.arc_length, place.loads_here_are_beyond, model, state)[0];
  }

  /// The actuated curvature is what its profile has at the place, not a line between samples.
  [[nodiscard]] double interpolate(const SampleWeights& weights, const Model& model,
                                   const State& state) const override {
    const double own = RodField::interpolate(weights, model, state);
    return is_moment() ? own : own + bulge(actuated_, weights, model, state)[0];
  }

 private:
  /// Where the chain has a moment: at a node, at the pivot of a clamp, and, as it must be, at an
  /// end that is not clamped.
  struct Known {
    double arc_length = 0.0;         // [m]
    double share = 0.0;              // of the edge before it
    double natural_curvature = 0.0;  // [1/m]
    bool is_at_clamp = false;
    std::optional<BendCell> cell;  // none at an end
    double length = 0.0;           // over which the cell turns [m]
    double rest_angle = 0.0;       // of the cell, without actuations [rad]
    ActuatedRest actuated;         // [rad]
    EffectiveEdge effective;       // of the edge
  };

  BendField(Bending what, const RodMesh& rod, std::vector<Sample> samples, Lines lines,
            MomentRecovery recovery, std::vector<std::pair<Known, Known>> edges)
      : EdgewiseField(std::move(samples), std::move(lines)),
        what_(what),
        EI_(rod.EI),
        per_moment_(what == Bending::Moment ? 1.0 : rod.EI),
        damping_(rod.damping.bending),
        actuated_(rod),
        recovery_(std::move(recovery)),
        edges_(std::move(edges)) {}

  static Known known(const RodMesh& rod, Index edge, bool last, const NaturalCurvature& natural,
                     const Model& model) {
    const Index node = last ? edge + 1 : edge;
    Known result;
    result.effective = effective_edge(rod, edge, model);
    result.arc_length = rod.arc_length_at(node);
    if (const Clamp* clamp = rod.clamp_at(node)) {
      const double pivot = clamp_pivot_share() * rod.edge_length[to_size(edge)];
      result.arc_length += last ? -pivot : pivot;
      result.is_at_clamp = true;
      result.cell.emplace();
      if (last) {
        result.cell->before = result.effective;
        result.cell->end = clamp_of_leg(*clamp, true, rod, model);
      } else {
        result.cell->start = *clamp;
        result.cell->after = result.effective;
      }
      result.length = clamp_cell_length(rod, edge);
      result.rest_angle = clamp_rest_angle(rod, *clamp, edge, model);
      result.actuated =
          ActuatedRest(rod.natural_strain_entries.cell(clamp->place, !last), 1, model);
    } else if (rod.is_inner(node)) {
      result.cell = cell_at(rod, node, model);
      result.length = bend_length(rod, node);
      result.rest_angle = rod.rest_turning_angle[to_size(rod.position(node))];
      result.actuated =
          ActuatedRest(rod.natural_strain_entries.cell(rod.position(node), false), 1, model);
    }
    result.share = (result.arc_length - rod.arc_length_at(edge)) / rod.edge_length[to_size(edge)];
    result.natural_curvature = natural.at(edge, result.arc_length);
    return result;
  }

  [[nodiscard]] double line(Index edge, bool last, const Model& model,
                            const State& state) const override {
    const Known& known = known_of(edge, last);
    if (what_ == Bending::NaturalCurvature) return known.natural_curvature;
    const Bent here = bent(edge, last, model, state);
    const double natural = is_moment() ? 0.0 : known.natural_curvature;
    if (!known.is_at_clamp) return natural + here.value;
    return natural + here.value + (known.share - here.share) * slope(edge, model, state);
  }

  [[nodiscard]] double slope(Index edge, const Model& model, const State& state) const override {
    const Bent first = bent(edge, false, model, state);
    const Bent last = bent(edge, true, model, state);
    return (last.value - first.value) / (last.share - first.share);
  }

  [[nodiscard]] double displaced(Index edge, double s, const Model& model,
                                 const State& state) const override {
    if (what_ == Bending::NaturalCurvature) return 0.0;
    return recovery_.displaced(edge, s, model, state);
  }

  /// The bending of the rod by stress, and its place along the edge.
  struct Bent {
    double value = 0.0;  // moment [N m] or curvature beyond the natural one [1/m]
    double share = 0.0;  // of the edge
  };

  /// At the first or the last of an edge's two places.
  [[nodiscard]] Bent bent(Index edge, bool last, const Model& model, const State& state) const {
    const Known& known = known_of(edge, last);
    if (!known.cell) {
      const MomentRecovery::Place end{known.arc_length, last};
      const double moment =
          recovery_.at_end(last, model, state).z() - recovery_.inside(edge, end, model, state).z();
      return {moment / per_moment_, known.share};
    }
    const double angle = turning_angle(*known.cell, model, state);
    double actuated = known.actuated.value(0, model, state);
    if (is_moment()) actuated -= viscous(known, angle, model, state);
    const Vec3 point = in_space(effective_end(known.effective, last, model, state));
    return {chain(known, angle, actuated) +
                recovery_.smooth(edge, last, point, model, state).z() / per_moment_,
            recovery_.share_of(edge, point, state)};
  }

  /// The bending that internal damping bears in place of the rod's own at a cell: a time by the
  /// rate of its curvature.
  [[nodiscard]] double viscous(const Known& known, double angle, const Model& model,
                               const State& state) const {
    if (damping_ == 0.0) return 0.0;
    return damping_ * Measure::of(angle).first * turning_rate(*known.cell, model, state);
  }

  [[nodiscard]] const Known& known_of(Index edge, bool last) const {
    const auto& ends = edges_[to_size(edge)];
    return last ? ends.second : ends.first;
  }

  [[nodiscard]] double inside(Index edge, const MomentRecovery::Place& place, const Model& model,
                              const State& state) const override {
    if (what_ == Bending::NaturalCurvature) return 0.0;
    return recovery_.inside(edge, place, model, state).z() / per_moment_;
  }

  /// Moment of the chain at this turning angle, or its curvature beyond the natural one: the moment
  /// over EI, since at a corner the measure of curvature is no angle over a length. Actuations add
  /// `actuated` to the rest angle.
  [[nodiscard]] double chain(const Known& known, double angle, double actuated) const {
    const double stiffness = (is_moment() ? EI_ : 1.0) / known.length;
    const double rest_kappa = Measure::of(known.rest_angle).kappa + actuated;
    return bend_response<Measure>(stiffness, rest_kappa, angle).moment;
  }

  [[nodiscard]] bool is_moment() const { return what_ == Bending::Moment; }

  Bending what_;
  double EI_;
  double per_moment_;  // 1, or EI to make curvatures of moments
  double damping_;     // [s]
  ActuatedShape actuated_;
  MomentRecovery recovery_;
  std::vector<std::pair<Known, Known>> edges_;  // first and last of each
};

std::unique_ptr<RodField> make_bend_field(Bending what, const RodMesh& rod, const Model& model) {
  if (rod.EI == 0.0) return limp_field(what, rod, model);
  if (rod.curvature == scenario::CurvatureMeasure::Angle) {
    return BendField<AngleCurvature>::make(what, rod, model);
  }
  return BendField<TangentCurvature>::make(what, rod, model);
}

}  // namespace

std::unique_ptr<RodField> make_turning_angle_field(const RodMesh& rod, const Model& model) {
  std::vector<Weighted> nodes;
  for (Index i = 0; i < static_cast<Index>(rod.nodes.size()); ++i) {
    if (rod.is_inner(i) || rod.clamp_at(i) != nullptr) nodes.push_back({i, 1.0});
  }
  return std::make_unique<TurnField>(rod, nodes, false, model);
}

std::unique_ptr<RodField> make_curvature_field(const RodMesh& rod, const Model& model) {
  if (model.dimension == 3) return make_section_field(SectionQuantity::Curvature, rod, model);
  if (!rod.legs.empty()) return make_leg_field(LegQuantity::Curvature, rod, model);
  return make_bend_field(Bending::Curvature, rod, model);
}

std::unique_ptr<RodField> make_moment_field(const RodMesh& rod, const Model& model) {
  if (model.dimension == 3) return make_section_field(SectionQuantity::Moment, rod, model);
  if (!rod.legs.empty()) return make_leg_field(LegQuantity::Moment, rod, model);
  return make_bend_field(Bending::Moment, rod, model);
}

std::unique_ptr<RodField> make_natural_curvature_field(const RodMesh& rod, const Model& model) {
  if (!rod.legs.empty()) return make_leg_field(LegQuantity::NaturalCurvature, rod, model);
  return make_bend_field(Bending::NaturalCurvature, rod, model);
}

}  // namespace der
