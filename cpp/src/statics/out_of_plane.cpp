#include "der/statics/out_of_plane.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "der/core/index.hpp"
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
    const OutOfPlaneBuckling answer = of_neutral(neutral, stress);
    if (answer.load_factor || !answer.not_tested.empty()) return answer;
    stiffness_.hold(neutral);
  }
  const auto modes = buckling_modes(twin_.model, stiffness_, *solver_.solver, here, stress, 1);
  if (modes.empty()) return {};
  return {"", modes.front().load_factor};
}

OutOfPlaneBuckling OutOfPlaneTest::of_neutral(const Eigen::MatrixXd& neutral,
                                              const InitialStress& stress) const {
  constexpr double kNone = 1e-6;  // of the largest stress over the size of the model
  const Model& model = twin_.model;
  const Vector lengths = model.dofs.unit_masses()(model.dofs.free()).cwiseSqrt();
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(lengths.asDiagonal() * neutral);
  const Eigen::MatrixXd motions =
      qr.householderQ() * Eigen::MatrixXd::Identity(neutral.rows(), neutral.cols());
  Eigen::MatrixXd forces(motions.rows(), motions.cols());
  for (Eigen::Index i = 0; i < motions.cols(); ++i) {
    const Vector motion = motions.col(i).cwiseQuotient(lengths);
    const Vector force = stress.product(over_all_dofs(model, motion))(model.dofs.free());
    forces.col(i) = force.cwiseQuotient(lengths);
  }
  const double least = kNone * stress.largest() / model.size();
  if (forces.norm() <= least) return {};
  using Eigenvectors = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;
  if (Eigenvectors(motions.transpose() * forces).eigenvalues()[0] < -least) return {"", 0.0};
  const Vector acted_on =
      motions * Eigenvectors(forces.transpose() * forces).eigenvectors().rightCols(1);
  Eigen::Index largest = 0;
  acted_on.cwiseAbs().maxCoeff(&largest);
  const Index node = model.dofs.node_of(model.dofs.free()[static_cast<std::size_t>(largest)]);
  return {fmt::format("nothing resists a motion of rod '{}' out of the plane while there are no "
                      "loads (a clamp of its tangent lets it spin), and what the loads make of it "
                      "is not decided by linear theory: hold its section ('clamp: true'), or "
                      "follow the path ('analysis: continuation')",
                      place_of(model, node).rod),
          {}};
}

}  // namespace der
