#include "output/axial_spring_reader.hpp"

#include <algorithm>
#include <array>

#include "der/model/state.hpp"
#include "der/supports/axial_spring.hpp"

namespace der {
namespace {

/// The control that is its rest length.
Index control_of(const std::string& spring, const Model& model) {
  return std::find_if(model.named.begin(), model.named.end(),
                      [&](const NamedControl& named) { return named.name == spring; })
      ->components.front()
      .controls.front();
}

class AxialSpringReader : public ProbeReader {
 public:
  AxialSpringReader(SpringReading read, const scenario::AxialSpring& spring,
                    const scenario::Scene& scene, const Model& model)
      : read_(read),
        nodes_(nodes_of(spring, scene, model)),
        stiffness_(spring.stiffness),
        rest_length_(control_of(spring.name, model)),
        damping_(spring.damping) {}

  double value(const Model& model, const State& state) override {
    // It has two or three components, and needs no memory of its own.
    using Point = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1>;
    const auto difference = [&](const Vector& values) -> Point {
      return values.segment(model.dof(nodes_[1], 0), model.dimension) -
             values.segment(model.dof(nodes_[0], 0), model.dimension);
    };
    const Point between = difference(state.positions);
    const double length = between.norm();
    const double rate = between.normalized().dot(difference(state.velocities));
    return read_(length, stiffness_ * (length - control_value(model, state, rest_length_)) +
                             damping_ * rate);
  }

 private:
  SpringReading read_;
  std::array<Index, 2> nodes_;
  double stiffness_;
  Index rest_length_;  // control
  double damping_;
};

}  // namespace

std::unique_ptr<ProbeReader> make_axial_spring_reader(SpringReading read, const std::string& name,
                                                      const scenario::Scene& scene,
                                                      const Model& model) {
  const auto spring = std::find_if(scene.springs.begin(), scene.springs.end(),
                                   [&](const auto& other) { return other.name == name; });
  return std::make_unique<AxialSpringReader>(read, *spring, scene, model);
}

}  // namespace der
