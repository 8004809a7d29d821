#include "output/spread_moments.hpp"

#include <utility>

#include "der/core/index.hpp"
#include "der/energies/circulatory_load.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/section_spring.hpp"
#include "der/model/moment_place.hpp"
#include "der/model/section_place.hpp"
#include "der/output/vertex_strain.hpp"

namespace der {
namespace {

/// The moments that a spring exerts on its edges, and their sum, of which a clamp beside it has a
/// part.
template <int Edges>
EdgeMoments moments_of_spring(std::size_t number, const Model& model, const State& state) {
  using Kernel = SectionSpring<Edges>;
  const auto& springs = elements_of<Kernel>(*model.elements);
  const Configuration here = configuration_of(model, state);
  return Kernel::moments(springs.constants[number], here,
                         gather(springs.dofs[number], here.coordinates));
}

}  // namespace

SpreadMoments::SpreadMoments(const RodMesh& rod, const Model& model) : rod_(rod) {
  for (std::size_t i = 0; i < rod.moment_places.size(); ++i) {
    const MomentPlace& place = rod.moment_places[i];
    moments_.push_back({place.arc_length, place.first_edge, place.weights});
    sources_.emplace_back(PlanarPlace{i});
  }
  if (!model.has_sections()) return;
  const auto add = [&](double s) -> const Moment& {
    const SectionPlace place = section_place(s, rod);
    moments_.push_back({s, place.first_edge, place.across});
    return moments_.back();
  };
  for (const SpatialMomentPlace& place : rod.spatial_moments) {
    add(place.arc_length);
    sources_.emplace_back(SpatialLoad{to_size(place.load)});
  }
  for (const SectionSpringPlace& spring : rod.section_springs) {
    if (add(spring.arc_length).weights.size() == 1) {
      sources_.emplace_back(SpatialSpring<1>{to_size(spring.element)});
    } else {
      sources_.emplace_back(SpatialSpring<2>{to_size(spring.element)});
    }
  }
}

EdgeMoments SpreadMoments::value(std::size_t i, const Model& model, const State& state) const {
  return std::visit([&](const auto& source) { return value_of(source, model, state); },
                    sources_[i]);
}

EdgeMoments SpreadMoments::value_of(PlanarPlace place, const Model& model,
                                    const State& state) const {
  const MomentPlace& moments = rod_.moment_places[place.number];
  double applied = 0.0;
  for (const Index moment : moments.moments) applied += control_value(model, state, moment);
  const double carried = carried_moment(moments, rod_, model, state, applied);
  EdgeMoments result;
  result.whole.z() = carried;
  const std::vector<double>& weights = moments_[place.number].weights;  // planar ones come first
  for (std::size_t k = 0; k < weights.size(); ++k) result.on_edge[k].z() = weights[k] * carried;
  return result;
}

EdgeMoments SpreadMoments::value_of(SpatialLoad load, const Model& model, const State& state) {
  return circulatory_loads(*model.elements)[load.number].moments(configuration_of(model, state));
}

EdgeMoments SpreadMoments::value_of(SpatialSpring<1> spring, const Model& model,
                                    const State& state) {
  return moments_of_spring<1>(spring.number, model, state);
}

EdgeMoments SpreadMoments::value_of(SpatialSpring<2> spring, const Model& model,
                                    const State& state) {
  return moments_of_spring<2>(spring.number, model, state);
}

}  // namespace der
