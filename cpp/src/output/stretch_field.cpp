#include "output/stretch_field.hpp"

#include <utility>

#include "der/core/index.hpp"
#include "der/supports/clamp.hpp"
#include "output/edge_excess.hpp"
#include "output/line_loads.hpp"
#include "output/section_field.hpp"
#include "output/spread_forces.hpp"
#include "output/stretch_samples.hpp"

namespace der {
namespace {

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
    const auto pass = [&](const StretchSample::Passed& load, const Vec2& force) {
      Vec2 along = Vec2::Zero();
      for (const auto& [edge, weight] : load.direction) {
        along += weight * direction(edge, model, state);
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
        excess_(rod, forces_),
        samples_(std::move(samples)) {
    for (Index edge = 0; edge < rod.num_edges(); ++edge) {
      effective_.push_back(effective_edge(rod, edge, model));
      rest_length_.push_back(effective_.back().vector(model.initial_positions, 0.0, 0.0).norm());
    }
  }

  static std::vector<double> arc_lengths(const std::vector<StretchSample>& samples) {
    std::vector<double> result;
    for (const StretchSample& sample : samples) result.push_back(sample.arc_length);
    return result;
  }

  [[nodiscard]] Vec2 direction(Index edge, const Model& model, const State& state) const {
    return effective_vector(effective_[to_size(edge)], model, state).normalized();
  }

  [[nodiscard]] double middle_strain(Index edge, const Model& model, const State& state) const {
    const Vec2 effective = effective_vector(effective_[to_size(edge)], model, state);
    const double length = effective.norm();
    const double chain = (length - rest_length_[to_size(edge)]) / rod_.edge_length[to_size(edge)];
    if (excess_.none(edge)) return chain;
    return chain + effective.dot(excess_.force(edge, forces_, model, state)) / (length * rod_.EA);
  }

  double stiffness_;
  RodLayout rod_;
  std::vector<double> rest_length_;  // of the effective edges
  std::vector<EffectiveEdge> effective_;
  SpreadForces forces_;
  EdgeExcess excess_;
  std::vector<StretchSample> samples_;
};

}  // namespace

std::unique_ptr<RodField> make_strain_field(const RodLayout& rod, const Model& model) {
  if (model.dimension == 3) return make_edge_strain_field(1.0, rod, model);
  return StretchField::make(1.0, rod, model);
}

std::unique_ptr<RodField> make_tension_field(const RodLayout& rod, const Model& model) {
  if (model.dimension == 3) return make_edge_strain_field(rod.EA, rod, model);
  return StretchField::make(rod.EA, rod, model);
}

}  // namespace der
