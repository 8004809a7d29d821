#include "der/statics/out_of_plane.hpp"

#include <fmt/format.h>

#include "der/statics/modes.hpp"
#include "der/statics/neutral_motions.hpp"

namespace der {

OutOfPlaneTest::OutOfPlaneTest(const scenario::Scene& scene, const Model& planar)
    : planar_(planar),
      twin_(build_out_of_plane_model(scene, planar)),
      pattern_(build_pattern(twin_.model)),
      solver_(make_linear_solver("auto", pattern_)),
      assembler_(twin_.model, solver_.solver->layout()),
      stiffness_(twin_.model, assembler_, *solver_.solver, [this] {
        if (beat_) beat_();
      }) {}

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
  return vibration_modes(twin_.model, assembler_, *solver_.solver, twin_.at(planar_, planar), 1,
                         beat_)
      .front()
      .growth_rate;
}

OutOfPlaneBuckling OutOfPlaneTest::buckling(const Configuration& unloaded, const Vector& response) {
  const Configuration here = twin_.at(planar_, unloaded);
  stiffness_.evaluate(here);
  const Stability stability = stiffness_.stability();
  if (stability.unstable_directions > 0) {
    return {"without its loads the structure is unstable out of its plane already", {}};
  }
  if (stability.unknown_directions > 0) {
    return {
        "rounding hides whether the structure is stable out of its plane without its loads: its "
        "shortest edges are too short, or too many of its rods are free to spin",
        {}};
  }
  Vector displacement = Vector::Zero(twin_.model.num_dofs());
  for (Index node = 0; node < planar_.num_nodes; ++node) {
    for (const int c : {0, 1}) {
      displacement[twin_.model.dof(node, c)] = response[planar_.dof(node, c)];
    }
  }
  const InitialStress stress(twin_.model, here, displacement);
  const double noise = stiffness_.rounding() * twin_.model.dofs.largest_motion(displacement);
  if (stress.largest() <= noise) return {};
  if (stability.neutral_directions > 0) {
    const Eigen::MatrixXd neutral = stiffness_.softest_directions(stability.neutral_directions);
    using Stresses = NeutralMotions::Stresses;
    const NeutralMotions motions = judge_neutral_motions(twin_.model, neutral, stress);
    if (motions.stresses == Stresses::UpsetThem) return {"", 0.0};
    if (motions.stresses == Stresses::ActOtherwise) {
      return {fmt::format("nothing resists a motion of rod '{}' out of the plane while there are "
                          "no loads (a clamp of its tangent lets it spin), and what the loads make "
                          "of it is not decided by linear theory: hold its section ('clamp: "
                          "true'), or follow the path ('analysis: continuation')",
                          motions.rod),
              {}};
    }
    stiffness_.hold(neutral);
  }
  const auto modes =
      buckling_modes(twin_.model, stiffness_, *solver_.solver, here, stress, 1, beat_);
  if (modes.empty()) return {};
  return {"", modes.front().load_factor};
}

}  // namespace der
