#include "output/section_field.hpp"

#include <cmath>
#include <utility>

#include "der/core/index.hpp"
#include "der/output/joint_strain.hpp"
#include "der/supports/spatial_clamp.hpp"

namespace der {
namespace {

bool is_of_twist(SectionQuantity quantity) {
  return quantity == SectionQuantity::Twist || quantity == SectionQuantity::Torque;
}

std::vector<double> places(SectionQuantity quantity, const RodLayout& rod) {
  std::vector<double> result;
  for (const RodJoint& joint : rod.joints) {
    result.push_back(is_of_twist(quantity) ? joint.twist_place : joint.bend_place);
  }
  return result;
}

class SectionField : public RodField {
 public:
  SectionField(SectionQuantity quantity, const RodLayout& rod)
      : RodField(places(quantity, rod)), quantity_(quantity), rod_(rod) {}

  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    const RodJoint& joint = rod_.joints[i];
    const JointStrain strain = strain_of(joint, rod_, model, state);
    const Vec2 excess =
        Vec2(strain.kappa_1 - joint.rest.kappa_1, strain.kappa_2 - joint.rest.kappa_2) /
        joint.bend_length;
    const Vec2 curvature = joint.natural_curvature + excess;
    const Vec2 moment(rod_.EI_1 * excess[0], rod_.EI_2 * excess[1]);
    switch (quantity_) {
      case SectionQuantity::Curvature:
        return curvature.norm();
      case SectionQuantity::Curvature1:
        return curvature[0];
      case SectionQuantity::Curvature2:
        return curvature[1];
      case SectionQuantity::Moment:
        return moment.norm();
      case SectionQuantity::Moment1:
        return moment[0];
      case SectionQuantity::Moment2:
        return moment[1];
      case SectionQuantity::Twist:
        return strain.twist / joint.twist_length;
      case SectionQuantity::Torque:
        break;
    }
    return rod_.GJ * (strain.twist - joint.rest.twist) / joint.twist_length;
  }

 private:
  SectionQuantity quantity_;
  RodLayout rod_;
};

std::vector<double> middles(const RodLayout& rod) {
  std::vector<double> result;
  for (Index edge = 0; edge < rod.num_edges(); ++edge) result.push_back(rod.edge_middle(edge));
  return result;
}

class EdgeStrainField : public RodField {
 public:
  EdgeStrainField(double stiffness, const RodLayout& rod, const Model& model)
      : RodField(middles(rod)), stiffness_(stiffness) {
    for (Index i = 0; i < rod.num_edges(); ++i) {
      edges_.push_back(spatial_edge(rod, i, model));
      const SpatialEdge& edge = edges_.back();
      const double whole = rod.edge_length[to_size(i)];
      whole_lengths_.push_back(whole);
      effective_lengths_.push_back(edge.has_pivot() ? edge.drawn(model.initial_positions).norm()
                                                    : whole);
    }
  }
  /// An effective edge from a pivot is shorter than its edge and stretches for all of it.
  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    const double elongation =
        effective_vector(edges_[i], model, state).norm() - effective_lengths_[i];
    return stiffness_ * elongation / whole_lengths_[i];
  }

 private:
  double stiffness_;
  std::vector<SpatialEdge> edges_;
  std::vector<double> whole_lengths_;      // at rest [m]
  std::vector<double> effective_lengths_;  // at rest [m]
};

}  // namespace

std::unique_ptr<RodField> make_section_field(SectionQuantity quantity, const RodLayout& rod,
                                             const Model& /*model*/) {
  return std::make_unique<SectionField>(quantity, rod);
}

std::unique_ptr<RodField> make_edge_strain_field(double stiffness, const RodLayout& rod,
                                                 const Model& model) {
  return std::make_unique<EdgeStrainField>(stiffness, rod, model);
}

}  // namespace der
