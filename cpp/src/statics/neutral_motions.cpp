#include "der/statics/neutral_motions.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "der/core/index.hpp"

namespace der {
namespace {

/// Shares that count as none, as motions are known to some digits only.
constexpr double kNone = 1e-6;

/// Square roots of the unit masses of the free degrees of freedom: an angle times them is a length.
Vector lengths_of(const Model& model) {
  return model.dofs.unit_masses()(model.dofs.free()).cwiseSqrt();
}

}  // namespace

NeutralMotions judge_neutral_motions(const Model& model, const Eigen::MatrixXd& neutral,
                                     const InitialStress& stress) {
  using Stresses = NeutralMotions::Stresses;
  const Vector lengths = lengths_of(model);
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
  const bool upset = Eigenvectors(motions.transpose() * forces).eigenvalues()[0] < -least;
  const Vector acted_on =
      motions * Eigenvectors(forces.transpose() * forces).eigenvectors().rightCols(1);
  Eigen::Index largest = 0;
  acted_on.cwiseAbs().maxCoeff(&largest);
  const Index node = model.dofs.node_of(model.dofs.free()[to_size(static_cast<Index>(largest))]);
  return {upset ? Stresses::UpsetThem : Stresses::ActOtherwise, place_of(model, node).rod};
}

bool does_work(const Model& model, const Vector& force, const Eigen::MatrixXd& neutral) {
  const Vector lengths = lengths_of(model);
  const Vector works = neutral.transpose() * force;
  const Vector sizes = (lengths.asDiagonal() * neutral).colwise().norm().transpose();
  return (works.cwiseAbs() - kNone * force.cwiseQuotient(lengths).norm() * sizes).maxCoeff() > 0.0;
}

}  // namespace der
