#include "der/statics/out_of_plane.hpp"

#include "der/statics/modes.hpp"

namespace der {

OutOfPlaneTest::OutOfPlaneTest(const scenario::Scene& scene, const Model& planar)
    : planar_(planar),
      twin_(build_out_of_plane_model(scene, planar)),
      pattern_(build_pattern(twin_.model)),
      solver_(make_linear_solver("auto", pattern_)),
      assembler_(twin_.model, solver_.solver->layout()),
      stiffness_(twin_.model, assembler_, *solver_.solver) {}

Stability OutOfPlaneTest::stability(const Configuration& planar) {
  stiffness_.evaluate(twin_.at(planar_, planar));
  return stiffness_.stability();
}

bool OutOfPlaneTest::is_clear(const Configuration& planar) {
  stiffness_.evaluate(twin_.at(planar_, planar));
  return stiffness_.is_clear();
}

Stability OutOfPlaneTest::stability_by_pivots(const Configuration& planar) {
  stiffness_.evaluate(twin_.at(planar_, planar));
  return stiffness_.stability_by_pivots();
}

double OutOfPlaneTest::growth_rate(const Configuration& planar) {
  const Model& model = twin_.model;
  if (model.mass.lumped(model.dofs.free()).minCoeff() <= 0.0) return 0.0;
  return vibration_modes(twin_.model, assembler_, *solver_.solver, twin_.at(planar_, planar), 1)
      .front()
      .growth_rate;
}

std::optional<double> OutOfPlaneTest::buckling_factor(const Configuration& unloaded,
                                                      const Vector& response) {
  const Configuration here = twin_.at(planar_, unloaded);
  stiffness_.evaluate(here);
  const Stability stability = stiffness_.stability();
  if (stability.unstable_directions + stability.neutral_directions > 0) return std::nullopt;
  if (stability.unknown_directions > 0) throw hidden_buckling();
  Vector displacement = Vector::Zero(twin_.model.num_dofs());
  for (Index node = 0; node < planar_.num_nodes; ++node) {
    for (const int c : {0, 1}) {
      displacement[twin_.model.dof(node, c)] = response[planar_.dof(node, c)];
    }
  }
  const InitialStress stress(twin_.model, here, displacement);
  const auto modes = buckling_modes(twin_.model, stiffness_, *solver_.solver, here, stress, 1);
  if (modes.empty()) return std::nullopt;
  return modes.front().load_factor;
}

}  // namespace der
