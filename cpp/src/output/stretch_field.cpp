#include "output/stretch_field.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "der/core/index.hpp"
#include "der/output/joint_strain.hpp"
#include "der/supports/clamp.hpp"
#include "der/supports/spatial_clamp.hpp"
#include "model/actuated_turn.hpp"
#include "model/corner.hpp"
#include "output/actuated_shape.hpp"
#include "output/edge_excess.hpp"
#include "output/in_space.hpp"
#include "output/leaning_edge.hpp"
#include "output/line_loads.hpp"
#include "output/natural_curvature.hpp"
#include "output/rod_field.hpp"
#include "output/spread_forces.hpp"
#include "output/stretch_samples.hpp"

namespace der {
namespace {

/// The vectors of the edges of a rod as its elements see them, from a clamp's pivot on. An
/// effective edge is shorter than its edge and stretches for all of it.
class EffectiveVectors {
 public:
  EffectiveVectors(const RodLayout& rod, const Model& model) {
    const Vector drawn = Vector::Zero(model.tables.size());
    for (Index edge = 0; edge < rod.num_edges(); ++edge) {
      if (model.dimension == 3) {
        in_space_.push_back(spatial_edge(rod, edge, model));
        rest_length_.push_back(in_space_.back().vector(model.initial_positions, drawn).norm());
      } else {
        planar_.push_back(effective_edge(rod, edge, model));
        rest_length_.push_back(planar_.back().vector(model.initial_positions, 0.0, 0.0).norm());
      }
      actuated_.emplace_back(rod.rest_entries.edge(edge), 1, model);
    }
  }

  /// [m]
  [[nodiscard]] Vec3 at(Index edge, const Model& model, const State& state) const {
    if (model.dimension == 3) return effective_vector(in_space_[to_size(edge)], model, state);
    return in_space(effective_vector(planar_[to_size(edge)], model, state));
  }
  /// [m]
  [[nodiscard]] double rest_length(Index edge, const Model& model, const State& state) const {
    return rest_length_[to_size(edge)] + actuated_[to_size(edge)].value(0, model, state);
  }

 private:
  std::vector<EffectiveEdge> planar_;
  std::vector<SpatialEdge> in_space_;  // one of the two lists is empty
  std::vector<double> rest_length_;    // without actuations
  std::vector<ActuatedRest> actuated_;
};

/// The tension that edges have in excess because they lean: an edge next to a clamp, and one at an
/// end that is bent, by a natural curvature or a moment, has the direction that the curve has not
/// in the edge's middle but a distance beyond it (supports/clamp.hpp; docs/mechanics.md). The
/// excess is this distance times k . F, with the curvature k and the force F in the rod across it.
/// The distance is another one for the curvature that a rod has as it is drawn
/// (output/leaning_edge.hpp). What actuations turn an edge against the curve in its middle is known
/// (model/actuated_turn.hpp); on an edge on which their curvature jumps that is all.
class LeaningEdges {
 public:
  LeaningEdges(const RodLayout& rod, const Model& model) : rod_(rod), actuated_(rod) {
    const bool bends = model.dimension == 2 ? rod.EI > 0.0 : !rod.joints.empty();
    if (!bends) return;
    for (const Clamp& clamp : rod.clamps) {
      for (const Index edge : {rod.edge_before(clamp.place), rod.edge_after(clamp.place)}) {
        if (edge < 0) continue;
        const double further = clamp_cell_length(rod, edge) - 0.5 * rod.edge_length[to_size(edge)];
        const double sign = edge == clamp.place ? 1.0 : -1.0;
        const Vec2 natural = drawn_curvature(edge, model);
        add({edge, sign * further, sign * (drawn_lean(rod, edge) - further) * natural, {}}, model);
      }
    }
    add_free_end(false, model);
    add_free_end(true, model);
    for (Index edge = 0; edge < rod.num_edges(); ++edge) {
      if (actuation_jumps_in(edge, rod, false)) add({edge, 0.0, Vec2::Zero(), {}}, model);
    }
    for (Lean& lean : leans_) {
      lean.actuated = actuated_turn_from_edge(lean.edge, rod.edge_middle(lean.edge), rod);
    }
  }

  /// [N], of an edge that is `stretch` times as long as without stress.
  [[nodiscard]] double excess(Index edge, double stretch, const Model& model,
                              const State& state) const {
    const Lean* lean = find(edge);
    return lean == nullptr ? 0.0 : lean_times_force(*lean, model, state) / stretch;
  }

 private:
  struct Lean {
    Index edge = 0;
    double beyond = 0.0;          // [m] for the curvature, but for an actuated one
    Vec2 natural = Vec2::Zero();  // [rad] that the natural curvature adds
    ActuatedTurn actuated;        // from the edge's direction to the curve's in its middle
  };

  [[nodiscard]] const Lean* find(Index edge) const {
    const auto found = std::find_if(leans_.begin(), leans_.end(),
                                    [&](const Lean& lean) { return lean.edge == edge; });
    return found == leans_.end() ? nullptr : &*found;
  }

  /// Curvature [1/m] of an edge of a rod that is free of stress as it is drawn; 0 of a straight
  /// one, and where the scene gives it: the cells of a clamp then have it.
  [[nodiscard]] Vec2 drawn_curvature(Index edge, const Model& model) const {
    constexpr double kStraight = 1e-12;  // [rad]
    Vec2 drawn = Vec2::Zero();
    if (!rod_.natural_curvature.empty() || !rod_.natural_curvatures.empty()) return drawn;
    if (model.dimension == 2) {
      drawn[0] = NaturalCurvature(rod_, model).at(edge, rod_.edge_middle(edge));
    } else {
      double beside = 0.0;
      for (const RodJoint& joint : rod_.joints) {
        if (joint.clamp < 0 && is_corner(rod_, joint.place(), model)) continue;
        if (joint.after != edge && joint.before != edge) continue;
        drawn += joint.natural_curvature;
        beside += 1.0;
      }
      if (beside > 0.0) drawn /= beside;
    }
    const bool straight = drawn.norm() * rod_.edge_length[to_size(edge)] < kStraight;
    return straight ? Vec2(Vec2::Zero()) : drawn;
  }

  void add_free_end(bool last, const Model& model) {
    if (rod_.closed || rod_.clamp_at(last ? rod_.num_edges() : 0) != nullptr) return;
    Vec2 natural = Vec2::Zero();
    if (!rod_.natural_curvature.empty()) {
      natural[0] = last ? rod_.natural_curvature.back() : rod_.natural_curvature.front();
    } else if (!rod_.natural_curvatures.empty()) {
      natural = last ? rod_.natural_curvatures.back() : rod_.natural_curvatures.front();
    }
    const bool is_bent = bears_moment(last ? rod_.rest_length() : 0.0);
    if (natural.isZero(0.0) && !is_bent) return;
    const Index edge = last ? rod_.num_edges() - 1 : 0;
    const double twelfth = (last ? 1.0 : -1.0) * rod_.edge_length[to_size(edge)] / 12.0;
    if (is_bent) {
      // A moment bends the end as a natural curvature does, and the curvature there has both; but
      // that of the drawn shape is no lean, since the nodes of a drawn curve lie on it.
      add({edge, twelfth, -twelfth * drawn_curvature(edge, model), {}}, model);
    } else {
      add({edge, 0.0, twelfth * natural, {}}, model);
    }
  }
  /// Whether a moment or a spring against turning acts at a place.
  [[nodiscard]] bool bears_moment(double s) const {
    const std::vector<double> places = rod_.moment_arc_lengths();
    return std::any_of(places.begin(), places.end(),
                       [&](double place) { return std::abs(place - s) <= rod_.same_place(); });
  }

  /// An edge between two clamps leans against both.
  void add(const Lean& lean, const Model& model) {
    const auto known = std::find_if(leans_.begin(), leans_.end(),
                                    [&](const Lean& other) { return other.edge == lean.edge; });
    if (known == leans_.end()) {
      leans_.push_back(lean);
    } else {
      known->beyond += lean.beyond;
      known->natural += lean.natural;
    }
    if (!bends_.empty()) return;
    const auto field = [&](const char* quantity) { return make_rod_field(quantity, rod_, model); };
    if (model.has_sections()) {
      bends_.push_back({field("curvature_1"), field("moment_1")});
      bends_.push_back({field("curvature_2"), field("moment_2")});
      twist_ = field("twist");
      torque_ = field("torque");
    } else {
      bends_.push_back({field("curvature"), field("moment")});
    }
  }

  /// On the unstretched rod: F = -M', with the components of M along directors that turn with the
  /// twist u as F1 = -M1' + u M2 - k2 T, F2 = -M2' - u M1 + k1 T. The torque's part falls out of k
  /// . F.
  [[nodiscard]] double lean_times_force(const Lean& lean, const Model& model,
                                        const State& state) const {
    const auto mean = [&](const RodField& field) {
      return mean_along(field, lean.edge, model, state);
    };
    Vec2 curvature = Vec2::Zero();
    Vec2 moment = Vec2::Zero();
    Vec2 force = Vec2::Zero();
    for (std::size_t k = 0; k < bends_.size(); ++k) {
      const auto component = static_cast<Index>(k);
      curvature[component] = mean(*bends_[k].curvature);
      moment[component] = mean(*bends_[k].moment);
      force[component] = -change(*bends_[k].moment, lean.edge, model, state) /
                         rod_.edge_length[to_size(lean.edge)];
    }
    if (twist_) force += mean(*twist_) * Vec2(moment[1], -moment[0]);
    const double product = lean.beyond * curvature.dot(force);
    const Vec3 turned = value_of(lean.actuated, model, state);
    const Vec3 actuated = actuated_.strains(rod_.edge_middle(lean.edge), false, model, state);
    const Vec2 without_load = lean.natural - turned.head<2>() - lean.beyond * actuated.head<2>();
    if (without_load.isZero(0.0)) return product;
    if (torque_) force += mean(*torque_) * Vec2(-curvature[1], curvature[0]);
    return product + without_load.dot(force);
  }

  /// The sample of a field at the first or last end of an edge, on the edge's side of a jump.
  [[nodiscard]] std::size_t sample_at_end(const RodField& field, Index edge, bool last) const {
    const double place = rod_.arc_length_at(last ? edge + 1 : edge);
    const std::vector<double>& samples = field.arc_length();
    const auto found =
        last ? std::lower_bound(samples.begin(), samples.end(), place - rod_.same_place())
             : std::upper_bound(samples.begin(), samples.end(), place + rod_.same_place()) - 1;
    return static_cast<std::size_t>(found - samples.begin());
  }
  /// Calls use(length, first, last) with the values at the ends of the parts of an edge between the
  /// jumps of a field.
  template <class Use>
  void for_each_part(const RodField& field, Index edge, const Model& model, const State& state,
                     const Use& use) const {
    const std::vector<double>& samples = field.arc_length();
    const std::size_t end = sample_at_end(field, edge, true);
    for (std::size_t i = sample_at_end(field, edge, false); i < end; ++i) {
      const double length = samples[i + 1] - samples[i];
      if (length <= rod_.same_place()) continue;
      use(length, field.sample(i, model, state), field.sample(i + 1, model, state));
    }
  }
  /// The mean of a field along an edge.
  [[nodiscard]] double mean_along(const RodField& field, Index edge, const Model& model,
                                  const State& state) const {
    double integral = 0.0;
    for_each_part(field, edge, model, state, [&](double length, double first, double last) {
      integral += 0.5 * length * (first + last);
    });
    return integral / rod_.edge_length[to_size(edge)];
  }
  /// By how much a field changes along an edge, but for its jumps.
  [[nodiscard]] double change(const RodField& field, Index edge, const Model& model,
                              const State& state) const {
    double change = 0.0;
    for_each_part(field, edge, model, state,
                  [&](double /*length*/, double first, double last) { change += last - first; });
    return change;
  }

  struct Bend {
    std::unique_ptr<RodField> curvature;
    std::unique_ptr<RodField> moment;
  };

  const RodLayout& rod_;
  ActuatedShape actuated_;
  std::vector<Lean> leans_;
  std::vector<Bend> bends_;  // towards each director, or in the plane; empty where no edge leans
  std::unique_ptr<RodField> twist_, torque_;  // of sections
};

/// The strain, times a stiffness [N] (1: the strain itself).
///
/// The tension in an edge of the chain is that of the loads beyond it as they are spread over the
/// nodes. It is corrected to that of the true loads beyond the edge's middle. From the middles it
/// is continued to the samples, by the loads on the way.
class StretchField : public RodField {
 public:
  static std::unique_ptr<RodField> make(double stiffness, const RodLayout& rod,
                                        const Model& model) {
    SpreadForces forces(rod, model);
    std::vector<StretchSample> samples = stretch_samples(rod, forces, model);
    return std::unique_ptr<RodField>(
        new StretchField(stiffness, rod, model, std::move(forces), std::move(samples)));
  }

  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    const StretchSample& sample = samples_[i];
    double strain = 0.0;
    for (const auto& [edge, weight] : sample.edges) {
      strain += weight * middle_strain(edge, model, state);
    }
    const auto pass = [&](const StretchSample::Passed& load, const Vec3& force) {
      Vec3 along = Vec3::Zero();
      for (const auto& [edge, weight] : load.direction) {
        along += weight * vectors_.at(edge, model, state).normalized();
      }
      strain += load.amount * along.normalized().dot(force) / rod_.EA;
    };
    for (const auto& load : sample.forces) pass(load, forces_.value(load.number, model, state));
    for (const auto& load : sample.distributed) {
      pass(load, force_per_length(rod_.distributed_places[load.number], model, state));
    }
    for (const auto& load : sample.foundations) {
      const FoundationPlace& place = rod_.foundation_places[load.number];
      pass(load, force_per_length(place, load.arc_length, rod_, model, state));
    }
    return stiffness_ * strain;
  }
  [[nodiscard]] bool smooth_at(std::size_t i) const override { return samples_[i].smooth; }

 private:
  StretchField(double stiffness, const RodLayout& rod, const Model& model, SpreadForces forces,
               std::vector<StretchSample> samples)
      : RodField(arc_lengths(samples)),
        stiffness_(stiffness),
        rod_(rod),
        forces_(std::move(forces)),
        vectors_(rod, model),
        leans_(rod, model),
        excess_(rod, forces_),
        samples_(std::move(samples)) {}

  static std::vector<double> arc_lengths(const std::vector<StretchSample>& samples) {
    std::vector<double> result;
    for (const StretchSample& sample : samples) result.push_back(sample.arc_length);
    return result;
  }

  [[nodiscard]] double middle_strain(Index edge, const Model& model, const State& state) const {
    const Vec3 effective = vectors_.at(edge, model, state);
    const double length = effective.norm();
    const double chain =
        (length - vectors_.rest_length(edge, model, state)) / rod_.edge_length[to_size(edge)];
    const double excess = leans_.excess(edge, 1.0 + chain, model, state);
    const double upright = chain - excess / rod_.EA;
    if (excess_.none(edge)) return upright;
    return upright + effective.dot(excess_.force(edge, forces_, model, state)) / (length * rod_.EA);
  }

  double stiffness_;
  RodLayout rod_;
  SpreadForces forces_;
  EffectiveVectors vectors_;
  LeaningEdges leans_;
  EdgeExcess excess_;
  std::vector<StretchSample> samples_;
};

}  // namespace

std::unique_ptr<RodField> make_strain_field(const RodLayout& rod, const Model& model) {
  return StretchField::make(1.0, rod, model);
}

std::unique_ptr<RodField> make_tension_field(const RodLayout& rod, const Model& model) {
  return StretchField::make(rod.EA, rod, model);
}

}  // namespace der
