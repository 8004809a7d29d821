#include "output/section_field.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "der/core/index.hpp"
#include "der/model/clamp_cell.hpp"
#include "der/model/location.hpp"
#include "der/model/spin.hpp"
#include "der/output/vertex_strain.hpp"
#include "der/supports/spatial_clamp.hpp"
#include "model/actuated_turn.hpp"
#include "model/glue.hpp"
#include "model/natural_twist.hpp"
#include "output/actuated_shape.hpp"
#include "output/dip.hpp"
#include "output/edgewise_field.hpp"
#include "output/leaning_edge.hpp"
#include "output/moment_recovery.hpp"
#include "output/spatial_leg_field.hpp"
#include "output/spin_torque.hpp"

namespace der {
namespace {

bool is_of_twist(SectionQuantity quantity) {
  return quantity == SectionQuantity::Twist || quantity == SectionQuantity::Torque ||
         quantity == SectionQuantity::NaturalTwist;
}

bool is_natural(SectionQuantity quantity) {
  return quantity == SectionQuantity::NaturalCurvature1 ||
         quantity == SectionQuantity::NaturalCurvature2 ||
         quantity == SectionQuantity::NaturalTwist;
}

const char* name_of(SectionQuantity quantity) {
  switch (quantity) {
    case SectionQuantity::Curvature1:
      return "curvature_1";
    case SectionQuantity::Curvature2:
      return "curvature_2";
    case SectionQuantity::Moment1:
      return "moment_1";
    default:
      return "moment_2";
  }
}

bool is_moment(SectionQuantity quantity) {
  switch (quantity) {
    case SectionQuantity::Moment:
    case SectionQuantity::Moment1:
    case SectionQuantity::Moment2:
    case SectionQuantity::Torque:
      return true;
    default:
      return false;
  }
}

/// The section frames of the edges of a rod that does not twist: along the rod, from the clamp that
/// holds its section.
class UntwistedFrames {
 public:
  UntwistedFrames(SectionQuantity quantity, const RodMesh& rod, const Model& model) {
    const auto clamp = std::find_if(rod.clamps.begin(), rod.clamps.end(),
                                    [](const Clamp& other) { return other.holds_section; });
    if (clamp == rod.clamps.end()) {
      throw Error("model_error", lacks_held_section(rod.name, name_of(quantity)));
    }
    clamp_ = *clamp;
    for (Index edge = 0; edge < rod.num_edges(); ++edge) {
      edges_.push_back(spatial_edge(rod, edge, model));
    }
  }

  [[nodiscard]] std::vector<SectionFrame> at(const Model& model, const State& state) const {
    std::vector<SectionFrame> frames(edges_.size());
    SectionFrame frame = held_frame(clamp_.held, model, state);
    const SectionFrame held = frame;
    const auto go_on_to = [&](Index edge) {
      const Vec3 next = effective_vector(edges_[to_size(edge)], model, state).normalized();
      frame = SectionFrame::of(next, transport(frame.first, frame.tangent, next));
      frames[to_size(edge)] = frame;
    };
    for (Index edge = clamp_.place; edge < static_cast<Index>(edges_.size()); ++edge) {
      go_on_to(edge);
    }
    frame = held;
    for (Index edge = clamp_.place; edge-- > 0;) go_on_to(edge);
    return frames;
  }

 private:
  Clamp clamp_;
  std::vector<SpatialEdge> edges_;
};

/// Bending towards the two directors and twist, of a rod with sections: curvatures and twist, or
/// the two moments and the torque. For a rod without sections it is the vector about which the rod
/// bends, in fixed axes; its components are towards the directors of a rod that does not twist.
///
/// Beside moments inside the rod, and where an actuation begins or ends within an edge, the section
/// turns at rates that differ on the two sides, and components along it have a kink; at corners,
/// and where a ring is glued turned, the section itself jumps. Along the edges there the field is
/// the vector of the moment in fixed axes, and the section at each place takes its components.
class SectionField : public EdgewiseField<Vec3> {
 public:
  static std::unique_ptr<RodField> make(SectionQuantity quantity, const RodMesh& rod,
                                        const Model& model) {
    MomentRecovery recovery(rod, model);
    std::vector<Sample> samples;
    std::vector<std::pair<Known, Known>> edges;
    Lines lines;
    if (!rod.vertices.empty()) {
      samples = samples_of(rod, recovery);
      if (jumps_at_glue(quantity, rod)) part_at_start(rod, samples);
      for (Index edge = 0; edge < rod.num_edges(); ++edge) {
        const bool by_twist = is_of_twist(quantity) && !has_kinks(edge, rod, recovery);
        edges.emplace_back(known(by_twist, rod, edge, false, recovery),
                           known(by_twist, rod, edge, true, recovery));
        lines.emplace_back(edges.back().first.arc_length, edges.back().second.arc_length);
      }
    }
    return std::unique_ptr<RodField>(new SectionField(quantity, rod, model, std::move(samples),
                                                      std::move(lines), std::move(recovery),
                                                      std::move(edges)));
  }

  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    const Vec3 all = parts(i, model, state);
    if (frames_) return toward_director(i, all, frames_->at(model, state));
    if (const auto part = component()) return all[*part];
    return bending_of(all, model).norm();
  }
  void sample_all(const Model& model, const State& state, double* values) const override {
    if (!frames_) return RodField::sample_all(model, state, values);
    const std::vector<SectionFrame> frames = frames_->at(model, state);
    for (std::size_t i = 0; i < arc_length().size(); ++i) {
      values[i] = toward_director(i, parts(i, model, state), frames);
    }
  }

  /// Actuated curvatures and twist are what their profiles have at the place, not lines between
  /// samples. A magnitude is that of the vector there.
  [[nodiscard]] double interpolate(const SampleWeights& weights, const Model& model,
                                   const State& state) const override {
    const auto part = component();
    Vec3 all = Vec3::Zero();
    if (part) {
      all[*part] = RodField::interpolate(weights, model, state);
    } else {
      for (const auto& [sample, weight] : weights) {
        const bool is_end_of_ring = sample == 0 && weights.front().sample > 0;
        all += weight * (is_end_of_ring ? end_of_ring(model, state) : parts(sample, model, state));
      }
    }
    if (!is_moment(quantity_)) all += bulge(actuated_, weights, model, state);
    return part ? all[*part] : bending_of(all, model).norm();
  }

  [[nodiscard]] double dip(const Model& model, const State& state) const override {
    double least = RodField::dip(model, state);
    if (component() || arc_length().empty()) return least;
    Vec3 before = bending_of(parts(0, model, state), model);
    double s_before = arc_length().front();
    // Where it jumps it does not pass what lies between.
    const auto go_on_to = [&](double s, const Vec3& all) {
      const Vec3 here = bending_of(all, model);
      if (s > s_before + rod_.same_place())
        least = std::min(least, min_norm_on_segment(before, here));
      before = here;
      s_before = s;
    };
    for (std::size_t i = 1; i < arc_length().size(); ++i) {
      go_on_to(arc_length()[i], parts(i, model, state));
    }
    if (rod_.closed) go_on_to(rod_.rest_length(), end_of_ring(model, state));
    return least;
  }

 private:
  /// The part of a vector in fixed axes at a sample of a rod without sections.
  [[nodiscard]] double toward_director(std::size_t i, const Vec3& all,
                                       const std::vector<SectionFrame>& frames) const {
    return components(all, frames[to_size(sample_at(i).edge)])[*component()];
  }
  /// Curvatures and twist, or moments and torque, of a sample.
  [[nodiscard]] Vec3 parts(std::size_t i, const Model& model, const State& state) const {
    const Index edge = sample_at(i).edge;
    const MomentRecovery::Place& place = sample_at(i).place;
    const auto strains = [&] {
      return actuated_.strains(place.arc_length, place.loads_here_are_beyond, model, state);
    };
    if (is_natural(quantity_)) return natural_at(edge, place.arc_length) + strains();
    const Vec3 all = value(edge, place, model, state);
    if (is_vector(edge, model)) return in_turned_section(edge, place, all, model, state);
    return is_moment(quantity_) ? all : Vec3(all + strains());
  }
  /// The first sample of a ring, in the section at the end of the ring.
  [[nodiscard]] Vec3 end_of_ring(const Model& model, const State& state) const {
    const Vec3 first = parts(0, model, state);
    return model.has_sections() ? turned(first, -rod_.vertices.back().glued) : first;
  }
  /// The part of bending.
  static Vec3 bending_of(const Vec3& all, const Model& model) {
    return model.has_sections() ? Vec3(all[0], all[1], 0.0) : all;
  }

  /// Which of the two bendings and the twist the quantity is; none: a magnitude.
  [[nodiscard]] std::optional<Index> component() const {
    switch (quantity_) {
      case SectionQuantity::Curvature1:
      case SectionQuantity::Moment1:
      case SectionQuantity::NaturalCurvature1:
        return 0;
      case SectionQuantity::Curvature2:
      case SectionQuantity::Moment2:
      case SectionQuantity::NaturalCurvature2:
        return 1;
      case SectionQuantity::Twist:
      case SectionQuantity::Torque:
      case SectionQuantity::NaturalTwist:
        return 2;
      default:
        return std::nullopt;
    }
  }

  /// Where the chain has a moment: at a vertex, or, as it must be, at an end that is free to turn.
  struct Known {
    const RodVertex* vertex = nullptr;  // of the model's rod; none at an end
    double arc_length = 0.0;            // [m]
    double twist_place = 0.0;           // where it twists [m]
    bool is_at_pivot = false;           // of a clamp
    Vec3 natural = Vec3::Zero();        // curvatures and twist
    double vertex_ahead = 0.0;          // [m] by which the vertex counts its places further on
    double glued = 0.0;                 // [rad] by which the section is turned against the vertex's
    ActuatedTurn actuated;              // of the section here against the mean beside the vertex
  };

  SectionField(SectionQuantity quantity, const RodMesh& rod, const Model& model,
               std::vector<Sample> samples, Lines lines, MomentRecovery recovery,
               std::vector<std::pair<Known, Known>> edges)
      : EdgewiseField(std::move(samples), std::move(lines)),
        quantity_(quantity),
        rod_(rod),
        stiffness_(model.has_sections() ? Vec3(rod.EI_1, rod.EI_2, rod.GJ)
                                        : Vec3::Constant(rod.EI_1)),
        actuated_(rod),
        recovery_(std::move(recovery)),
        spin_(rod, model),
        edges_(std::move(edges)) {
    if (is_towards_director(quantity) && !model.has_sections())
      frames_.emplace(quantity, rod, model);
  }

  /// Components towards the two directors of a section that is turned on by an angle [rad].
  static Vec3 turned(const Vec3& parts, double angle) {
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    return {c * parts[0] + s * parts[1], c * parts[1] - s * parts[0], parts[2]};
  }

  /// Whether a quantity jumps where the two ends of a ring are glued, their sections being turned
  /// against each other by more than rounding. Natural curvatures are turned with the sections, and
  /// so are the axes of unequal stiffnesses.
  static bool jumps_at_glue(SectionQuantity quantity, const RodMesh& rod) {
    const bool is_component =
        quantity == SectionQuantity::Curvature1 || quantity == SectionQuantity::Curvature2 ||
        quantity == SectionQuantity::Moment1 || quantity == SectionQuantity::Moment2 ||
        quantity == SectionQuantity::NaturalCurvature1 ||
        quantity == SectionQuantity::NaturalCurvature2;
    const bool whole_jumps = quantity == SectionQuantity::Curvature &&
                             (!rod.natural_curvatures.empty() || rod.EI_1 != rod.EI_2);
    return rod.closed && (is_component || whole_jumps) && meets_turned(rod.vertices.back());
  }

  /// Whether components along an edge, or on from it, have a kink or jump.
  static bool has_kinks(Index edge, const RodMesh& rod, const MomentRecovery& recovery) {
    return recovery.has_moments(edge) || recovery.is_corner(edge) || recovery.is_corner(edge + 1) ||
           is_beside_glue(edge, rod) || actuation_jumps_in(edge, rod, true);
  }
  /// Whether an edge is beside the place where a ring is glued turned and the vertex is not that of
  /// either side: it bends about the directors of both, to the natural curvatures of both.
  static bool is_beside_glue(Index edge, const RodMesh& rod) {
    if (!rod.closed || (edge != 0 && edge != rod.num_edges() - 1)) return false;
    return parts_bending(rod.vertices.back(), rod);
  }

  static Vec3 natural_of(const RodMesh& rod, const RodVertex& vertex) {
    return {vertex.natural_curvature[0], vertex.natural_curvature[1],
            natural_twist_at(rod, vertex)};
  }

  /// Those of the whole cell about a vertex, in the vertex's frame.
  [[nodiscard]] Vec3 mean_natural(const RodVertex& vertex) const {
    Vec3 mean = natural_of(rod_, vertex);
    if (meets_turned(vertex)) {
      mean.head<2>() = Vec2(vertex.rest.kappa_1, vertex.rest.kappa_2) / vertex.bend_length;
    }
    return mean;
  }

  /// Natural curvatures and twist of a vertex, and the arc lengths [m] at which it bends and
  /// twists.
  struct NaturalAt {
    double arc_length = 0.0;
    double twist_place = 0.0;
    Vec3 natural;
  };

  /// Natural shapes of the two vertices of a leg next to its last end, beyond `edge`, or to its
  /// first end; fewer where it has no more. Vertices between two legs bend on both and belong to
  /// none.
  static std::vector<NaturalAt> naturals_beside_end(const RodMesh& rod, Index edge, bool last,
                                                    const MomentRecovery& recovery) {
    std::vector<NaturalAt> found;
    const Index step = last ? -1 : 1;
    const auto is_of_leg = [&](Index place) {
      return (rod.closed || (0 <= place && place <= rod.num_edges())) &&
             !recovery.bounds_legs(place);
    };
    for (Index place = last ? edge : edge + 1; found.size() < 2 && is_of_leg(place);
         place += step) {
      const auto first_here = static_cast<std::ptrdiff_t>(found.size());
      for (const RodVertex& vertex : rod.vertices) {
        if (rod.position(vertex.place()) != rod.position(place)) continue;
        const double ahead = rod.arc_length_at(place) - rod.arc_length_at(vertex.place());
        found.push_back(
            {vertex.bend_place + ahead, vertex.twist_place + ahead, natural_of(rod, vertex)});
      }
      if (last) std::reverse(found.begin() + first_here, found.end());
    }
    return found;
  }

  /// Natural curvatures and twist at an end of a leg, beyond `edge` or before it: those of the
  /// drawn rod, extrapolated.
  static Vec3 natural_at_end_of_leg(const RodMesh& rod, Index edge, bool last,
                                    const MomentRecovery& recovery) {
    const std::vector<NaturalAt> vertices = naturals_beside_end(rod, edge, last, recovery);
    if (vertices.empty()) return Vec3::Zero();
    const NaturalAt& near = vertices[0];
    if (vertices.size() == 1) return near.natural;
    const NaturalAt& far = vertices[1];
    const double end = rod.arc_length_at(last ? edge + 1 : edge);
    const Vec3 change = near.natural - far.natural;
    const double bends = (end - near.arc_length) / (near.arc_length - far.arc_length);
    const double twists = (end - near.twist_place) / (near.twist_place - far.twist_place);
    return near.natural + Vec3(bends, bends, twists).cwiseProduct(change);
  }

  /// Natural curvatures and twist at an end of the rod: as given, or those of the drawn rod.
  static Vec3 natural_at_end(const RodMesh& rod, bool last, const MomentRecovery& recovery) {
    Vec3 result = natural_at_end_of_leg(rod, last ? rod.num_edges() - 1 : 0, last, recovery);
    if (!rod.natural_curvatures.empty()) {
      result.head<2>() = last ? rod.natural_curvatures.back() : rod.natural_curvatures.front();
    }
    if (!rod.natural_twist.empty()) result[2] = natural_twist_at_end(rod, last);
    return result;
  }

  /// As given [rad/m].
  static double natural_twist_at_end(const RodMesh& rod, bool last) {
    return last ? rod.natural_twist.back() : rod.natural_twist.front();
  }

  /// `by_twist`: where the chain twists, in place of where it bends.
  static Known known(bool by_twist, const RodMesh& rod, Index edge, bool last,
                     const MomentRecovery& recovery) {
    Known result;
    result.arc_length = result.twist_place = rod.arc_length_at(last ? edge + 1 : edge);
    const auto vertex = std::find_if(
        rod.vertices.begin(), rod.vertices.end(),
        [&](const auto& other) { return (last ? other.before : other.after) == edge; });
    if (vertex == rod.vertices.end()) {
      result.natural = natural_at_end(rod, last, recovery);
      return result;
    }
    result.natural = natural_of(rod, *vertex);
    // A clamp that holds the tangent alone lets the section turn.
    const bool lets_turn = vertex->clamp >= 0 && !rod.clamps[to_size(vertex->clamp)].holds_section;
    if (by_twist && lets_turn) {
      if (!rod.natural_twist.empty()) result.natural[2] = natural_twist_at_end(rod, last);
      return result;
    }
    if (rod.closed && !last && vertex->place() > edge) {
      // The vertex at the end of a ring is at its start, too, on the other side of the glue.
      result.vertex_ahead = rod.rest_length();
      result.glued = vertex->glued;
      result.natural = turned(result.natural, result.glued);
      // The first of the scene's pairs is that of the section after the glue, too.
      if (!rod.natural_curvatures.empty())
        result.natural.head<2>() = rod.natural_curvatures.front();
    }
    const bool ends_leg = recovery.bounds_legs(vertex->place()) && vertex->clamp < 0;
    if (ends_leg) result.natural = natural_at_end_of_leg(rod, edge, last, recovery);
    result.vertex = &*vertex;
    // Where a node parts two legs, or sections that are glued turned, the torque has a kink there.
    const bool has_kink = ends_leg || parts_bending(*vertex, rod);
    result.arc_length = vertex->bend_place - result.vertex_ahead;
    result.twist_place = has_kink ? result.arc_length : vertex->twist_place - result.vertex_ahead;
    if (by_twist) result.arc_length = result.twist_place;
    result.is_at_pivot = vertex->clamp >= 0 && !by_twist;
    result.actuated = actuated_turn_from(*vertex, result.arc_length + result.vertex_ahead, rod);
    return result;
  }

  /// Whether the field is a vector in fixed axes along an edge.
  [[nodiscard]] bool is_vector(Index edge, const Model& model) const {
    return model.has_sections() && has_kinks(edge, rod_, recovery_);
  }

  [[nodiscard]] Vec3 line(Index edge, bool last, const Model& model,
                          const State& state) const override {
    const Vec3 line = unstretched_line(edge, last, model, state);
    const Known& known = known_of(edge, last);
    if (!known.is_at_pivot) return line;
    const double drawn =
        (known.arc_length - rod_.arc_length_at(edge)) / rod_.edge_length[to_size(edge)];
    return line + (drawn - bent(edge, last, model, state).share) * slope(edge, model, state);
  }

  [[nodiscard]] Vec3 slope(Index edge, const Model& model, const State& state) const override {
    const Bent first = bent(edge, false, model, state);
    const Bent last = bent(edge, true, model, state);
    const Vec3 change = (last.moment - first.moment) / (last.share - first.share);
    return is_vector(edge, model) ? change : in_section(edge, change, model, state);
  }

  [[nodiscard]] double displaced(Index edge, double s, const Model& model,
                                 const State& state) const override {
    return recovery_.displaced(edge, s, model, state);
  }

  [[nodiscard]] const Known& known_of(Index edge, bool last) const {
    const auto& ends = edges_[to_size(edge)];
    return last ? ends.second : ends.first;
  }

  /// The moment [N m], in fixed axes, at the first or last of an edge's two places, and where along
  /// the edge.
  struct Bent {
    Vec3 moment;
    double share = 0.0;  // of the edge
  };
  [[nodiscard]] Bent bent(Index edge, bool last, const Model& model, const State& state) const {
    const Known& known = known_of(edge, last);
    const Vec3 point = point_at(edge, last, model, state);
    if (known.vertex == nullptr) {
      const MomentRecovery::Place end{known.arc_length, last};
      return {recovery_.at_end(last, model, state) - recovery_.inside(edge, end, model, state),
              recovery_.share_of(edge, point, state)};
    }
    return {cell_moment(*known.vertex, rod_, model, state) +
                recovery_.smooth(edge, last, point, model, state),
            recovery_.share_of(edge, point, state)};
  }
  /// The line, where a clamp's pivot is as if that did not move along its edge as this stretches.
  [[nodiscard]] Vec3 unstretched_line(Index edge, bool last, const Model& model,
                                      const State& state) const {
    const Known& known = known_of(edge, last);
    const Vec3 natural = is_moment(quantity_) ? Vec3::Zero() : known.natural;
    const bool vector = is_vector(edge, model);
    if (known.vertex == nullptr) {
      const Vec3 beyond = inside(edge, {known.arc_length, last}, model, state);
      return (vector ? recovery_.at_end(last, model, state) : natural) - beyond;
    }
    const Vec3 missing =
        recovery_.smooth(edge, last, point_at(edge, last, model, state), model, state) +
        taken_by_spin(edge, last, model, state) + taken_by_turning(edge, last, model, state);
    if (vector) {
      const Vec3 all = moment_of(*known.vertex, rod_, model, state) + missing;
      return is_moment(quantity_) ? all : Vec3(all - viscous_moment(known, edge, model, state));
    }
    const Vec3 excess = excess_of(*known.vertex, model, state);
    Vec3 moment = stiffness_.cwiseProduct(excess);
    if (model.has_sections()) {
      const Vec3 actuated = value_of(known.actuated, model, state);
      moment = turned(moved(moment, known, last, excess, actuated), known.glued);
    }
    return natural + (is_moment(quantity_) ? moment : Vec3(moment.cwiseQuotient(stiffness_))) +
           in_section(edge, missing, model, state);
  }

  /// The part of an edge's torque beside a clamp that its inertia takes up, between the clamp and
  /// where the clamp's cell twists [N m].
  [[nodiscard]] Vec3 taken_by_spin(Index edge, bool last, const Model& model,
                                   const State& state) const {
    const Known& known = known_of(edge, last);
    if (known.vertex->clamp < 0) return Vec3::Zero();
    const double torque = spin_.along(edge, model, state);
    if (torque == 0.0) return Vec3::Zero();
    const double from_clamp = known.arc_length - rod_.arc_length_at(last ? edge + 1 : edge);
    return from_clamp / rod_.edge_length[to_size(edge)] * torque *
           section_frame(model, rod_.first_edge + edge, state).tangent;
  }

  /// What is missing in the moment of a clamp's cell where the clamp turns and the section spins
  /// [N m]. The cell has the couple of all of the edge's spin, whose tangent turns with the node
  /// about the pivot; the rod has that of the sections beyond the pivot, turning with the clamp.
  [[nodiscard]] Vec3 taken_by_turning(Index edge, bool last, const Model& model,
                                      const State& state) const {
    if (!known_of(edge, last).is_at_pivot || !model.has_sections()) return Vec3::Zero();
    const SpatialEdge& own = model.framed_edges[to_size(rod_.first_edge + edge)];
    const double spin = model.mass.lumped[own.theta] * state.velocities[own.theta];
    const Vec3 vector = effective_vector(own, model, state);
    const Vec3 rate = state.velocities.segment<3>(own.end) - state.velocities.segment<3>(own.start);
    constexpr double kBeyond = 1.0 - kPivotShare;
    return (last ? 1.0 : -1.0) * (1.0 - kBeyond * kBeyond) *
           vector.cross(gyroscopic_force<double>(vector, rate, spin));
  }

  /// The point [m] where the first or the last moment of an edge is known.
  [[nodiscard]] Vec3 point_at(Index edge, bool last, const Model& model, const State& state) const {
    const Known& known = known_of(edge, last);
    const double place = known.arc_length;
    const SpatialEdge vector = spatial_edge(rod_, edge, model);
    if (known.is_at_pivot) return effective_end(vector, last, model, state);
    const double share =
        (place - rod_.arc_length_at(last ? edge + 1 : edge)) / rod_.edge_length[to_size(edge)];
    const Vec3 along =
        state.positions.segment<3>(vector.end) - state.positions.segment<3>(vector.start);
    return state.positions.segment<3>(last ? vector.end : vector.start) + share * along;
  }

  [[nodiscard]] Vec3 inside(Index edge, const MomentRecovery::Place& place, const Model& model,
                            const State& state) const override {
    const Vec3 moment = recovery_.inside(edge, place, model, state);
    return is_vector(edge, model) ? moment : in_section(edge, moment, model, state);
  }

  /// The part of internal damping in the moment [N m] where an edge's is known, in fixed axes.
  [[nodiscard]] Vec3 viscous_moment(const Known& known, Index edge, const Model& model,
                                    const State& state) const {
    const RodVertex& vertex = *known.vertex;
    const MaterialCurvature viscous = viscous_strain(vertex, rod_, model, state);
    const Vec3 parts = stiffness_.cwiseProduct(Vec3(viscous.kappa_1 / vertex.bend_length,
                                                    viscous.kappa_2 / vertex.bend_length,
                                                    viscous.twist / vertex.twist_length));
    const SectionFrame frame = section_frame(model, rod_.first_edge + edge, state);
    return parts[0] * frame.second - parts[1] * frame.first + parts[2] * frame.tangent;
  }

  /// Curvatures and twist of a vertex beyond the natural ones [1/m]; for a moment as if those of
  /// internal damping were some of them.
  [[nodiscard]] Vec3 excess_of(const RodVertex& vertex, const Model& model,
                               const State& state) const {
    const MaterialCurvature strain = strain_of(vertex, rod_, model, state);
    if (!model.has_sections()) {
      return strain.kappa_1 / vertex.bend_length * bend_axis(vertex, rod_, model, state);
    }
    MaterialCurvature rest = rest_strain(vertex, rod_, model, state);
    if (is_moment(quantity_)) {
      const MaterialCurvature viscous = viscous_strain(vertex, rod_, model, state);
      rest = {rest.kappa_1 - viscous.kappa_1, rest.kappa_2 - viscous.kappa_2,
              rest.twist - viscous.twist};
    }
    return {(strain.kappa_1 - rest.kappa_1) / vertex.bend_length,
            (strain.kappa_2 - rest.kappa_2) / vertex.bend_length,
            (strain.twist - rest.twist) / vertex.twist_length};
  }

  /// The moments of a vertex and its torque [N m], which it has in its own frame, in the section's
  /// frame at the known place. The vertex's tangent is the mean of those beside it, and its
  /// directors are those in the middle of the length over which it twists. At inner nodes of an
  /// even mesh all these places are one. `actuated`: the turn from there that actuations make.
  [[nodiscard]] Vec3 moved(const Vec3& moment, const Known& known, bool last, const Vec3& excess,
                           const Vec3& actuated) const {
    const RodVertex& vertex = *known.vertex;
    const double place = known.arc_length + known.vertex_ahead;
    const double from_bend = place - tangent_place(vertex, der::tangent_place);
    const double from_twist = place - vertex.twist_place;
    const Vec3 turned = natural_turn(known, last, place) + actuated +
                        Vec3(from_bend, from_bend, from_twist).cwiseProduct(excess);
    // Bending towards a director turns about the other one.
    const auto about = [](const Vec3& parts) { return Vec3(-parts[1], parts[0], parts[2]); };
    const Vec3 change = about(moment).cross(about(turned));
    return moment + Vec3(change[1], -change[0], change[2]);
  }

  /// How far the section at a place is turned, without stress, against the mean of those beside a
  /// vertex: towards the directors and about the tangent [rad]. Where the natural shape jumps,
  /// `known` has that of one side, and the cell the mean of both.
  [[nodiscard]] Vec3 natural_turn(const Known& known, bool last, double place) const {
    const RodVertex& vertex = *known.vertex;
    const Vec3 mean = mean_natural(vertex);
    if (vertex.clamp >= 0) {
      const double from_bend = place - tangent_place(vertex, natural_tangent_place);
      return Vec3(from_bend, from_bend, place - vertex.twist_place).cwiseProduct(mean);
    }
    const Vec3 own = turned(known.natural, -known.glued);
    const double node = rod_.arc_length_at(vertex.place());
    const double length_before = rod_.edge_length[to_size(vertex.before)];
    const double length_after = rod_.edge_length[to_size(vertex.after)];
    const double other_share = last ? length_before / length_after : length_after / length_before;
    const Vec3 other = mean + other_share * (mean - own);
    const Vec3& before = last ? own : other;
    const Vec3& after = last ? other : own;
    const double bends_before = node - natural_tangent_place(rod_, vertex.place() - 1);
    const double bends_after = natural_tangent_place(rod_, vertex.place()) - node;
    const Vec3 to_before(bends_before, bends_before, 0.5 * length_before);
    const Vec3 to_after(bends_after, bends_after, 0.5 * length_after);
    return 0.5 * (to_before.cwiseProduct(before) - to_after.cwiseProduct(after)) +
           (place - node) * (place < node ? before : after);
  }

  /// Arc length [m] in the middle between the places where the rod has the directions of the two
  /// sides of a vertex: a clamp, or the place of an edge's direction.
  template <class PlaceOf>
  [[nodiscard]] double tangent_place(const RodVertex& vertex, const PlaceOf& place_of) const {
    const Index place = vertex.place();
    const auto side = [&](Index own, Index edge) {
      if (own < 0) return rod_.arc_length_at(place);  // of the clamp
      return place_of(rod_, edge);
    };
    return 0.5 * (side(vertex.before, place - 1) + side(vertex.after, place));
  }

  /// The moment `moment` [N m] in fixed axes at a place of an edge as the field has it, in the
  /// section there: that of the edge, turned by the strains on the way to the place.
  [[nodiscard]] Vec3 in_turned_section(Index edge, const MomentRecovery::Place& place,
                                       const Vec3& moment, const Model& model,
                                       const State& state) const {
    const SectionFrame frame = section_frame(model, rod_.first_edge + edge, state);
    const double s = place.arc_length;
    Vec3 turn = turn_between(edge, frame, der::tangent_place(rod_, edge), s, model, state);
    const double further = der::tangent_place(rod_, edge) - natural_tangent_place(rod_, edge);
    turn += further * natural_at(edge, rod_.edge_middle(edge));
    turn[2] = turn_between(edge, frame, rod_.edge_middle(edge), s, model, state)[2];
    turn -= lean(edge, frame, model, state);
    turn += value_of(actuated_turn_from_edge(edge, s, rod_), model, state);
    const Vec3 axis = turn[0] * frame.second - turn[1] * frame.first + turn[2] * frame.tangent;
    const double angle = axis.norm();
    Vec3 seen = moment;
    if (angle > 0.0) seen = Eigen::AngleAxisd(-angle, axis / angle) * moment;
    const Vec3 parts = components(seen, frame);
    return is_moment(quantity_)
               ? parts
               : Vec3(natural_at(edge, s) +
                      actuated_.strains(s, place.loads_here_are_beyond, model, state) +
                      parts.cwiseQuotient(stiffness_));
  }

  /// How far an edge's section turns from one place to another [rad], but for actuations: the
  /// strains, in the middle of each part between moments.
  [[nodiscard]] Vec3 turn_between(Index edge, const SectionFrame& frame, double from, double to,
                                  const Model& model, const State& state) const {
    const auto [low, high] = std::minmax(from, to);
    Vec3 turn = Vec3::Zero();
    double a = low;
    const auto pass = [&](double b) {
      const MomentRecovery::Place middle{0.5 * (a + b), false};
      const Vec3 moment = components(value(edge, middle, model, state), frame);
      turn +=
          (b - a) * (natural_at(edge, middle.arc_length) + Vec3(moment.cwiseQuotient(stiffness_)));
      a = b;
    };
    for (const auto& [s, jumps] : recovery_.breaks(edge)) {
      if (jumps && low < s && s < high) pass(s);
    }
    pass(high);
    return from < to ? turn : Vec3(-turn);
  }

  /// How far an outermost edge is turned beyond the curve [rad]: its free end lies on the curve and
  /// its other node beside it (model/location.hpp).
  [[nodiscard]] Vec3 lean(Index edge, const SectionFrame& frame, const Model& model,
                          const State& state) const {
    Vec3 turn = Vec3::Zero();
    for (const bool last : {false, true}) {
      if (rod_.closed) break;
      const Index node = last ? rod_.num_edges() : 0;
      if (edge != (last ? node - 1 : node) || rod_.clamp_at(node) != nullptr) continue;
      const Vec3 excess = components(recovery_.excess(edge, model, state), frame);
      const RodVertex& vertex = last ? rod_.vertices.back() : rod_.vertices.front();
      turn = vertex.bend_length * excess.cwiseQuotient(stiffness_);
      const double twelfth = (last ? 1.0 : -1.0) * rod_.edge_length[to_size(edge)] / 12.0;
      if (!rod_.natural_curvatures.empty()) {
        turn.head<2>() += twelfth * rod_.natural_curvatures[to_size(node)];
      }
    }
    return {turn[0], turn[1], 0.0};
  }

  /// Natural curvatures and twist at a place of an edge [1/m].
  [[nodiscard]] Vec3 natural_at(Index edge, double s) const {
    const auto& [first, last] = edges_[to_size(edge)];
    const auto between = [&, &a = first.natural, &b = last.natural](double from, double to) {
      const double share = (s - from) / (to - from);
      return Vec3((1.0 - share) * a + share * b);
    };
    Vec3 natural = between(first.arc_length, last.arc_length);
    natural[2] = between(first.twist_place, last.twist_place)[2];
    return natural;
  }

  /// Bending towards a director turns about the other one.
  static Vec3 components(const Vec3& moment, const SectionFrame& frame) {
    return {moment.dot(frame.second), -moment.dot(frame.first), moment.dot(frame.tangent)};
  }

  /// A moment [N m] in fixed axes as the field has it.
  [[nodiscard]] Vec3 in_section(Index edge, const Vec3& moment, const Model& model,
                                const State& state) const {
    if (moment.isZero(0.0)) return moment;
    Vec3 parts = moment;
    if (model.has_sections()) {
      parts = components(moment, section_frame(model, rod_.first_edge + edge, state));
    }
    return is_moment(quantity_) ? parts : Vec3(parts.cwiseQuotient(stiffness_));
  }

  SectionQuantity quantity_;
  RodMesh rod_;
  Vec3 stiffness_;
  ActuatedShape actuated_;
  MomentRecovery recovery_;
  SpinTorque spin_;
  std::vector<std::pair<Known, Known>> edges_;  // first and last of each
  std::optional<UntwistedFrames> frames_;       // of a component where there are no sections
};

}  // namespace

bool is_towards_director(SectionQuantity quantity) {
  switch (quantity) {
    case SectionQuantity::Curvature1:
    case SectionQuantity::Curvature2:
    case SectionQuantity::Moment1:
    case SectionQuantity::Moment2:
      return true;
    default:
      return false;
  }
}

std::unique_ptr<RodField> make_section_field(SectionQuantity quantity, const RodMesh& rod,
                                             const Model& model) {
  if (!rod.legs.empty()) return make_spatial_leg_field(quantity, rod, model);
  return SectionField::make(quantity, rod, model);
}

}  // namespace der
