#include "output/section_field.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "der/core/index.hpp"
#include "der/energies/registry.hpp"
#include "der/output/joint_strain.hpp"
#include "der/supports/clamp.hpp"
#include "der/supports/spatial_clamp.hpp"
#include "output/edgewise_field.hpp"
#include "output/moment_recovery.hpp"

namespace der {
namespace {

bool is_of_twist(SectionQuantity quantity) {
  return quantity == SectionQuantity::Twist || quantity == SectionQuantity::Torque;
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

/// Bending towards the two directors and twist, of a rod with sections: curvatures and twist, or
/// the two moments and the torque. Of a rod without sections the vector about which it bends, in
/// fixed axes.
class SectionField : public EdgewiseField<Vec3> {
 public:
  static std::unique_ptr<RodField> make(SectionQuantity quantity, const RodLayout& rod,
                                        const Model& model) {
    MomentRecovery recovery(rod, model);
    std::vector<Sample> samples;
    std::vector<std::pair<Known, Known>> edges;
    Lines lines;
    if (!rod.joints.empty()) {
      samples = samples_of(rod, recovery);
      if (jumps_at_glue(quantity, rod)) {
        samples.front().smooth = false;
        samples.push_back({rod.num_edges() - 1, {rod.rest_length(), true}, false});
      }
      for (Index edge = 0; edge < rod.num_edges(); ++edge) {
        edges.emplace_back(known(quantity, rod, edge, false, model),
                           known(quantity, rod, edge, true, model));
        lines.emplace_back(edges.back().first.arc_length, edges.back().second.arc_length);
      }
    }
    return std::unique_ptr<RodField>(new SectionField(quantity, rod, model, std::move(samples),
                                                      std::move(lines), std::move(recovery),
                                                      std::move(edges)));
  }

  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    const Vec3 all = value(i, model, state);
    switch (quantity_) {
      case SectionQuantity::Curvature1:
      case SectionQuantity::Moment1:
        return all[0];
      case SectionQuantity::Curvature2:
      case SectionQuantity::Moment2:
        return all[1];
      case SectionQuantity::Twist:
      case SectionQuantity::Torque:
        return all[2];
      default:
        return model.has_sections() ? all.head<2>().norm() : all.norm();
    }
  }

 private:
  /// Where the chain has a moment: at a joint, or, as it must be, at an end that is free to turn.
  struct Known {
    const RodJoint* joint = nullptr;  // of the model's rod; none at an end
    double arc_length = 0.0;          // [m]
    Vec3 natural = Vec3::Zero();      // curvatures and twist
    double joint_ahead = 0.0;         // [m] by which the joint counts its places further on
    double glued = 0.0;               // [rad] by which the section is turned against the joint's
  };

  SectionField(SectionQuantity quantity, const RodLayout& rod, const Model& model,
               std::vector<Sample> samples, Lines lines, MomentRecovery recovery,
               std::vector<std::pair<Known, Known>> edges)
      : EdgewiseField(std::move(samples), std::move(lines)),
        quantity_(quantity),
        rod_(rod),
        stiffness_(model.has_sections() ? Vec3(rod.EI_1, rod.EI_2, rod.GJ)
                                        : Vec3::Constant(rod.EI_1)),
        recovery_(std::move(recovery)),
        edges_(std::move(edges)),
        turned_ends_(turned_ends(rod, model)) {}

  /// Components towards the two directors of a section that is turned on by an angle [rad].
  static Vec3 turned(const Vec3& parts, double angle) {
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    return {c * parts[0] + s * parts[1], c * parts[1] - s * parts[0], parts[2]};
  }

  /// Whether components jump where the two ends of a ring are glued, their sections being turned
  /// against each other by more than rounding.
  static bool jumps_at_glue(SectionQuantity quantity, const RodLayout& rod) {
    const bool is_component =
        quantity == SectionQuantity::Curvature1 || quantity == SectionQuantity::Curvature2 ||
        quantity == SectionQuantity::Moment1 || quantity == SectionQuantity::Moment2;
    constexpr double rounding = 1e-9;  // [rad]
    const RodJoint& last = rod.joints.back();
    return rod.closed && is_component && last.clamp < 0 && std::abs(last.glued) > rounding;
  }

  static Vec3 natural_of(const RodJoint& joint) {
    return {joint.natural_curvature[0], joint.natural_curvature[1],
            joint.rest.twist / joint.twist_length};
  }

  /// The two joints next to an end of a rod that has two, and how much further beyond the nearer
  /// one the end is, over their distance.
  struct EndJoints {
    const RodJoint* near;
    const RodJoint* far;
    double ratio;

    EndJoints(const RodLayout& rod, bool last)
        : near(last ? &rod.joints.back() : &rod.joints.front()),
          far(last ? near - 1 : near + 1),
          ratio(((last ? rod.rest_length() : 0.0) - near->bend_place) /
                (near->bend_place - far->bend_place)) {}
  };

  /// An end at which a moment or a spring turns the section. The joint next to it bends by l/12 of
  /// the end's curvature more (model/moment_place.hpp), which follows from that of the next joint.
  struct TurnedEnd : EndJoints {
    double share;  ///< l/12 over the length in which the joint bends

    TurnedEnd(const RodLayout& rod, bool last)
        : EndJoints(rod, last),
          share(rod.edge_length[to_size(last ? near->after : near->before)] /
                (12.0 * near->bend_length)) {}
  };

  static std::vector<TurnedEnd> turned_ends(const RodLayout& rod, const Model& model) {
    std::vector<TurnedEnd> ends;
    for (const bool last : {false, true}) {
      if (rod.joints.size() > 1 && is_turned_at_end(rod, last, model)) ends.emplace_back(rod, last);
    }
    return ends;
  }

  /// Natural curvatures and twist at an end of the rod: as given, or those of the drawn rod,
  /// extrapolated.
  static Vec3 natural_at_end(const RodLayout& rod, bool last) {
    Vec3 result = natural_of(last ? rod.joints.back() : rod.joints.front());
    if (rod.joints.size() > 1) {
      const EndJoints joints(rod, last);
      result += joints.ratio * (result - natural_of(*joints.far));
    }
    if (!rod.natural_curvatures.empty()) {
      result.head<2>() = last ? rod.natural_curvatures.back() : rod.natural_curvatures.front();
    }
    if (!rod.natural_twist.empty()) {
      result[2] = last ? rod.natural_twist.back() : rod.natural_twist.front();
    }
    return result;
  }

  /// Whether a moment or a spring turns the section at an end: beyond the middle of the outermost
  /// edge.
  static bool is_turned_at_end(const RodLayout& rod, bool last, const Model& model) {
    if (!model.has_sections() || rod.closed) return false;
    const Index edge = last ? rod.num_edges() - 1 : 0;
    const Index theta = model.framed_edges[to_size(rod.first_edge + edge)].theta;
    const auto acts_here = [&](const SpatialMoment::TurnedEdge& turned) {
      return turned.edge.theta == theta && turned.across > 1.0;
    };
    const auto& loads = model.elements->circulatory;
    const bool by_load = std::any_of(loads.begin(), loads.end(), [&](const CirculatoryLoad& load) {
      const auto* moment = std::get_if<SpatialMoment>(&load.kind);
      return moment != nullptr &&
             std::any_of(moment->edges.begin(), moment->edges.end(), acts_here);
    });
    const double middle = rod.edge_middle(edge);
    const auto& springs = rod.section_springs;
    return by_load || std::any_of(springs.begin(), springs.end(), [&](const auto& spring) {
             return last ? spring.arc_length > middle : spring.arc_length < middle;
           });
  }

  /// Where something turns an end, the two joints next to it are known, and the line through them
  /// goes on to the end.
  static Known known(SectionQuantity quantity, const RodLayout& rod, Index edge, bool last,
                     const Model& model) {
    Known result;
    result.arc_length = rod.arc_length_at(last ? edge + 1 : edge);
    auto joint = std::find_if(rod.joints.begin(), rod.joints.end(), [&](const RodJoint& other) {
      return (last ? other.before : other.after) == edge;
    });
    if (joint == rod.joints.end() && is_turned_at_end(rod, last, model)) {
      if (rod.joints.size() == 1) {
        result.joint = &rod.joints.front();
        result.natural = natural_of(*result.joint);
        return result;
      }
      joint = last ? rod.joints.end() - 2 : rod.joints.begin() + 1;
    }
    if (joint == rod.joints.end()) {
      result.natural = natural_at_end(rod, last);
      return result;
    }
    result.natural = natural_of(*joint);
    // A clamp that holds the tangent alone lets the section turn.
    const bool lets_turn = joint->clamp >= 0 && !rod.clamps[to_size(joint->clamp)].holds_section;
    if (is_of_twist(quantity) && lets_turn) return result;
    result.joint = &*joint;
    if (rod.closed && !last && joint->place() > edge) {
      // The joint at the end of a ring is at its start, too, on the other side of the glue.
      result.joint_ahead = rod.rest_length();
      result.glued = joint->glued;
      result.natural = turned(result.natural, result.glued);
    }
    const double place = is_of_twist(quantity) ? joint->twist_place : joint->bend_place;
    result.arc_length = place - result.joint_ahead;
    return result;
  }

  [[nodiscard]] Vec3 line(Index edge, bool last, const Model& model,
                          const State& state) const override {
    const auto& ends = edges_[to_size(edge)];
    const Known& known = last ? ends.second : ends.first;
    const Vec3 natural = is_moment(quantity_) ? Vec3::Zero() : known.natural;
    if (known.joint == nullptr) {
      return natural - inside(edge, {known.arc_length, last}, model, state);
    }
    const Vec3 excess = excess_of(*known.joint, model, state);
    const SpatialEdge vector = spatial_edge(rod_, edge, model);
    const Index node = last ? edge + 1 : edge;
    const double share =
        (known.arc_length - rod_.arc_length_at(node)) / rod_.edge_length[to_size(edge)];
    const Vec3 along =
        state.positions.segment<3>(vector.end) - state.positions.segment<3>(vector.start);
    const Vec3 point = state.positions.segment<3>(last ? vector.end : vector.start) + share * along;
    const Vec3 recovered =
        in_section(edge, recovery_.smooth(edge, last, point, model, state), model, state);
    Vec3 moment = stiffness_.cwiseProduct(excess);
    if (model.has_sections()) {
      moment = turned(moved(moment, known, natural_of(*known.joint) + excess), known.glued);
    }
    return natural + (is_moment(quantity_) ? moment : Vec3(moment.cwiseQuotient(stiffness_))) +
           recovered;
  }

  [[nodiscard]] Vec3 inside(Index edge, const MomentRecovery::Place& place, const Model& model,
                            const State& state) const override {
    return in_section(edge, recovery_.inside(edge, place, model, state), model, state);
  }

  /// Curvatures and twist of a joint beyond the natural ones [1/m].
  [[nodiscard]] Vec3 excess_of(const RodJoint& joint, const Model& model,
                               const State& state) const {
    Vec3 excess = measured_excess(joint, model, state);
    for (const TurnedEnd& end : turned_ends_) {
      if (joint.before != end.near->before || joint.clamp >= 0) continue;
      const Vec3 next = measured_excess(*end.far, model, state);
      excess.head<2>() =
          (excess + end.share * end.ratio * next).head<2>() / (1.0 + end.share * (1.0 + end.ratio));
    }
    return excess;
  }

  [[nodiscard]] Vec3 measured_excess(const RodJoint& joint, const Model& model,
                                     const State& state) const {
    const JointStrain strain = strain_of(joint, rod_, model, state);
    if (!model.has_sections()) {
      return strain.kappa_1 / joint.bend_length * bend_axis(joint, rod_, model, state);
    }
    return {(strain.kappa_1 - joint.rest.kappa_1) / joint.bend_length,
            (strain.kappa_2 - joint.rest.kappa_2) / joint.bend_length,
            (strain.twist - joint.rest.twist) / joint.twist_length};
  }

  /// The moments of a joint and its torque [N m], which it has in its own frame, in the section's
  /// frame at the known place. The joint's tangent is the mean of those beside it, and its
  /// directors are those in the middle of the length over which it twists. At inner nodes of an
  /// even mesh all these places are one.
  [[nodiscard]] Vec3 moved(const Vec3& moment, const Known& known, const Vec3& strains) const {
    const double place = known.arc_length + known.joint_ahead;
    const double tilted = place - tangent_place(*known.joint);
    const double turned = place - known.joint->twist_place;
    // Bending towards a director turns about the other one.
    const auto about = [](const Vec3& parts) { return Vec3(-parts[1], parts[0], parts[2]); };
    const Vec3 turn = about({tilted * strains[0], tilted * strains[1], turned * strains[2]});
    const Vec3 change = about(moment).cross(turn);
    return moment + Vec3(change[1], -change[0], change[2]);
  }

  /// Arc length [m] in the middle between the places where the rod has the directions of the two
  /// sides of a joint: a clamp, or an edge's middle, which beside a clamp is a little further away
  /// (supports/clamp.hpp).
  [[nodiscard]] double tangent_place(const RodJoint& joint) const {
    const Index place = joint.place();
    const auto side = [&](Index own, Index edge) {
      if (own < 0) return rod_.arc_length_at(place);  // of the clamp
      const double further = clamp_cell_length(rod_, own) - 0.5 * rod_.edge_length[to_size(own)];
      return rod_.edge_middle(edge) + (rod_.clamp_at(edge) != nullptr ? further : 0.0) -
             (rod_.clamp_at(edge + 1) != nullptr ? further : 0.0);
    };
    return 0.5 * (side(joint.before, place - 1) + side(joint.after, place));
  }

  /// A moment [N m] in fixed axes as the field has it: bending towards a director turns about the
  /// other one.
  [[nodiscard]] Vec3 in_section(Index edge, const Vec3& moment, const Model& model,
                                const State& state) const {
    if (moment.isZero(0.0)) return moment;
    Vec3 parts = moment;
    if (model.has_sections()) {
      const SectionFrame frame = section_frame(model, rod_.first_edge + edge, state);
      parts = {moment.dot(frame.second), -moment.dot(frame.first), moment.dot(frame.tangent)};
    }
    return is_moment(quantity_) ? parts : Vec3(parts.cwiseQuotient(stiffness_));
  }

  SectionQuantity quantity_;
  RodLayout rod_;
  Vec3 stiffness_;
  MomentRecovery recovery_;
  std::vector<std::pair<Known, Known>> edges_;  // first and last of each
  std::vector<TurnedEnd> turned_ends_;          // joints are of the model's rod, as those of edges_
};

}  // namespace

std::unique_ptr<RodField> make_section_field(SectionQuantity quantity, const RodLayout& rod,
                                             const Model& model) {
  return SectionField::make(quantity, rod, model);
}

}  // namespace der
