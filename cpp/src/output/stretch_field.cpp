#include "output/stretch_field.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "der/core/index.hpp"
#include "der/output/vertex_strain.hpp"
#include "der/supports/clamp.hpp"
#include "der/supports/spatial_clamp.hpp"
#include "output/edge_excess.hpp"
#include "output/force_across.hpp"
#include "output/in_space.hpp"
#include "output/lean_excess.hpp"
#include "output/leg_field.hpp"
#include "output/line_loads.hpp"
#include "output/rod_field.hpp"
#include "output/spatial_leg_field.hpp"
#include "output/spread_forces.hpp"
#include "output/stretch_samples.hpp"

namespace der {
namespace {

/// The vectors of the edges of a rod as its elements see them, from a clamp's pivot on. An
/// effective edge is shorter than its edge and stretches for all of it.
class EffectiveVectors {
 public:
  EffectiveVectors(const RodMesh& rod, const Model& model) {
    const Vector drawn = Vector::Zero(model.tables.size());
    for (Index edge = 0; edge < rod.num_edges(); ++edge) {
      if (model.dimension == 3) {
        in_space_.push_back(spatial_edge(rod, edge, model));
        rest_length_.push_back(in_space_.back().vector(model.reference_positions, drawn).norm());
      } else {
        planar_.push_back(effective_edge(rod, edge, model));
        rest_length_.push_back(planar_.back().drawn(model.reference_positions).norm());
      }
      actuated_.emplace_back(rod.natural_strain_entries.edge(edge), 1, model);
    }
  }

  /// [m]
  [[nodiscard]] Vec3 at(Index edge, const Model& model, const State& state) const {
    if (model.dimension == 3) return effective_vector(in_space_[to_size(edge)], model, state);
    return in_space(effective_vector(planar_[to_size(edge)], model, state));
  }
  /// By how much an edge is longer than without actuations and stress [m].
  [[nodiscard]] double longer(Index edge, const Model& model, const State& state) const {
    return at(edge, model, state).norm() - rest_length_[to_size(edge)];
  }
  /// The rate of its length [m/s].
  [[nodiscard]] double lengthening(Index edge, const Model& model, const State& state) const {
    const Vec3 rate = model.dimension == 3
                          ? effective_rate(in_space_[to_size(edge)], model, state)
                          : in_space(effective_rate(planar_[to_size(edge)], model, state));
    return at(edge, model, state).normalized().dot(rate);
  }
  /// The part of it that actuations ask for [m].
  [[nodiscard]] double actuated(Index edge, const Model& model, const State& state) const {
    return actuated_[to_size(edge)].value(0, model, state);
  }

 private:
  std::vector<EffectiveEdge> planar_;
  std::vector<SpatialEdge> in_space_;  // one of the two lists is empty
  std::vector<double> rest_length_;    // without actuations
  std::vector<ActuatedRest> actuated_;
};

/// The strain, or the tension: EA times the strain and what internal damping adds to it.
///
/// The tension in an edge of the chain is that of the loads beyond it as they are spread over the
/// nodes. It is corrected to that of the true loads beyond the edge's middle. From the middles it
/// is continued to the samples, by the loads on the way, and by the forces across the rod as it
/// curves.
class StretchField : public RodField {
 public:
  static std::unique_ptr<RodField> make(bool is_tension, const RodMesh& rod, const Model& model) {
    SpreadForces forces(rod, model);
    std::vector<StretchSample> samples = stretch_samples(rod, forces, model);
    return std::unique_ptr<RodField>(
        new StretchField(is_tension, rod, model, std::move(forces), std::move(samples)));
  }

  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    const StretchSample& sample = samples_[i];
    double strain = line_strain(sample.line, model, state);
    for (const StretchSample::Curving& part : sample.curving) {
      strain += curving_strain(part, model, state);
    }
    for (const auto& load : sample.distributed) {
      const DistributedPlace& place = rod_.distributed_places[load.number];
      strain += passed_strain(load, force_per_length(place, model, state), model, state);
    }
    for (const auto& load : sample.foundations) {
      const FoundationPlace& place = rod_.foundation_places[load.number];
      strain += passed_strain(load, force_per_length(place, load.arc_length, rod_, model, state),
                              model, state);
    }
    return is_tension_ ? rod_.EA * strain : strain;
  }
  [[nodiscard]] bool smooth_at(std::size_t i) const override { return samples_[i].smooth; }

 private:
  StretchField(bool is_tension, const RodMesh& rod, const Model& model, SpreadForces forces,
               std::vector<StretchSample> samples)
      : RodField(arc_lengths(samples)),
        is_tension_(is_tension),
        rod_(rod),
        forces_(std::move(forces)),
        vectors_(rod, model),
        leans_(rod, forces_, model),
        excess_(rod, forces_),
        samples_(std::move(samples)) {
    const auto any = [&](const auto& has) {
      return std::any_of(samples_.begin(), samples_.end(), has);
    };
    const bool curves = any([](const auto& sample) { return !sample.curving.empty(); });
    if ((curves || !leans_.none()) && bears_forces_across(rod, model)) across_.emplace(rod, model);
    if (!any([](const StretchSample& sample) { return sample.passes_loads(); })) return;
    for (const char* component : {"tx", "ty", "tz"}) {
      if (to_size(model.dimension) == tangents_.size()) break;
      tangents_.push_back(make_rod_field(component, rod, model));
    }
  }

  static std::vector<double> arc_lengths(const std::vector<StretchSample>& samples) {
    std::vector<double> result;
    for (const StretchSample& sample : samples) result.push_back(sample.arc_length);
    return result;
  }

  [[nodiscard]] double middle_strain(Index edge, const Model& model, const State& state) const {
    const double actuated = actuated_strain(edge, model, state);
    double strain =
        vectors_.longer(edge, model, state) / rod_.edge_length[to_size(edge)] - actuated;
    if (!excess_.none(edge)) {
      const Vec3 along = vectors_.at(edge, model, state).normalized();
      strain += along.dot(excess_.force(edge, forces_, model, state)) / rod_.EA;
    }
    if (across_ && !leans_.none(edge)) {
      const double stretch = 1.0 + strain + actuated;
      strain -= leans_.tension(edge, stretch, *across_, model, state) / rod_.EA;
    }
    if (is_tension_ && rod_.damping.stretching > 0.0) {
      strain += rod_.damping.stretching * vectors_.lengthening(edge, model, state) /
                rod_.edge_length[to_size(edge)];
    }
    return strain;
  }

  /// Strain that actuations ask for, in the mean of an edge.
  [[nodiscard]] double actuated_strain(Index edge, const Model& model, const State& state) const {
    return vectors_.actuated(edge, model, state) / rod_.edge_length[to_size(edge)];
  }

  /// The strain that a load adds; `force` is its force [N], or its force per length [N/m].
  [[nodiscard]] double passed_strain(const StretchSample::Passed& load, const Vec3& force,
                                     const Model& model, const State& state) const {
    return load.amount * tangent(load.arc_length, model, state).dot(force) / rod_.EA;
  }
  [[nodiscard]] Vec3 tangent(double s, const Model& model, const State& state) const {
    Vec3 tangent = Vec3::Zero();
    for (Index c = 0; c < model.dimension; ++c) {
      const RodField& field = *tangents_[to_size(c)];
      tangent[c] = field.interpolate(linear_weights(field.arc_length(), s), model, state);
    }
    return tangent.normalized();
  }
  [[nodiscard]] double line_strain(const StretchSample::Line& line, const Model& model,
                                   const State& state) const {
    double strain = 0.0;
    for (const auto& [edge, weight] : line.edges) {
      strain += weight * middle_strain(edge, model, state);
    }
    for (const StretchSample::Passed& load : line.forces) {
      strain += passed_strain(load, forces_.value(load.number, model, state), model, state);
    }
    return strain;
  }
  [[nodiscard]] double curving_strain(const StretchSample::Curving& part, const Model& model,
                                      const State& state) const {
    if (!across_) return 0.0;
    double stretch = 1.0 + line_strain(part.line, model, state);
    for (const auto& [edge, weight] : part.line.edges) {
      stretch += weight * actuated_strain(edge, model, state);
    }
    const ForceAcross::Mean mean = across_->mean(part.from, part.to, model, state);
    return part.amount * mean.curvature.dot(mean.force) / (stretch * rod_.EA);
  }

  bool is_tension_;
  RodMesh rod_;
  SpreadForces forces_;
  EffectiveVectors vectors_;
  LeanExcess leans_;
  EdgeExcess excess_;
  std::vector<StretchSample> samples_;
  std::optional<ForceAcross> across_;
  std::vector<std::unique_ptr<RodField>> tangents_;  // components; none where no load is passed
};

}  // namespace

std::unique_ptr<RodField> make_strain_field(const RodMesh& rod, const Model& model) {
  if (!rod.legs.empty()) {
    return model.dimension == 3 ? make_spatial_leg_field(SpatialLegQuantity::Strain, rod, model)
                                : make_leg_field(LegQuantity::Strain, rod, model);
  }
  return StretchField::make(false, rod, model);
}

std::unique_ptr<RodField> make_tension_field(const RodMesh& rod, const Model& model) {
  if (!rod.legs.empty()) {
    return model.dimension == 3 ? make_spatial_leg_field(SpatialLegQuantity::Tension, rod, model)
                                : make_leg_field(LegQuantity::Tension, rod, model);
  }
  return StretchField::make(true, rod, model);
}

}  // namespace der
