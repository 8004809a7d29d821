#include "der/energies/circulatory_load.hpp"

#include "der/core/index.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {
namespace {

Vec3 amount_of(const CirculatoryLoad& load, const Vector& controls) {
  Vec3 amount = Vec3::Zero();
  for (int c = 0; c < 3; ++c) {
    const Index control = load.amount[to_size(c)];
    if (control >= 0) amount[c] = controls[control];
  }
  return amount;
}

}  // namespace

void PlanarFollowerForce::evaluate(const Configuration& here, const Vec3& amount,
                                   CirculatoryTerm& out) const {
  out.reset(size());
  const Vec2 drawn_force = amount.head<2>();
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const FollowedEdge& followed = edges[i];
    const Vec2 e = followed.edge.vector(here);
    const Vec2 tangent = e.normalized();
    const Vec2 force =
        followed.weight * (followed.drawn.dot(drawn_force) * tangent +
                           cross(followed.drawn, drawn_force) * perpendicular(tangent));
    out.force.head<2>() += force;
    out.tangent.block<2, 2>(0, 2 + 2 * static_cast<Index>(i)) =
        -perpendicular(force) * direction_gradient(e, 1.0 / e.squaredNorm()).transpose();
  }
}

EdgeFrame FramedEdge::frame(const Configuration& here) const {
  return {edge.vector(here.coordinates, here.controls), here.coordinates[edge.theta],
          block.tangent(here.controls), block.director(here.controls)};
}

Vec3 FramedEdge::turned(const Vec3& vector, const SectionFrame& now) const {
  return drawn.tangent.dot(vector) * now.tangent + drawn.first.dot(vector) * now.first +
         drawn.second.dot(vector) * now.second;
}

void FollowerForce::evaluate(const Configuration& here, const Vec3& amount,
                             CirculatoryTerm& out) const {
  out.reset(size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const EdgeFrame frame = edges[i].frame(here);
    const Vec3 force = edges[i].weight * edges[i].turned(amount, frame.frame);
    out.force.head<3>() += force;
    out.tangent.block<3, 4>(0, 3 + 4 * static_cast<Index>(i)) =
        cross_matrix(force) * frame.rotation();
  }
}

void SpatialMoment::evaluate(const Configuration& here, const Vec3& amount,
                             CirculatoryTerm& out) const {
  using ByCoordinates = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 8>;
  out.reset(size());
  Vec3 moment = follower ? Vec3::Zero().eval() : amount;
  ByCoordinates turning = ByCoordinates::Zero(3, size());  // of M
  for (std::size_t i = 0; follower && i < edges.size(); ++i) {
    const EdgeFrame frame = edges[i].frame(here);
    const Vec3 part = edges[i].weight * edges[i].turned(amount, frame.frame);
    moment += part;
    turning.middleCols<4>(4 * static_cast<Index>(i)) = -cross_matrix(part) * frame.rotation();
  }

  const std::size_t axis = edges.size() == 2 && edges[1].along > edges[0].along ? 1 : 0;
  const EdgeFrame outer = edges[axis].frame(here);
  const Vec3& t = outer.frame.tangent;
  const double torque = moment.dot(t);
  ByCoordinates leaning = t * (t.transpose() * turning);  // of (M . t) t
  leaning.middleCols<4>(4 * static_cast<Index>(axis)) +=
      (t * t.cross(moment).transpose() - torque * cross_matrix(t)) * outer.rotation();

  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Index own = 4 * static_cast<Index>(i);
    const EdgeFrame frame = edges[i].frame(here);
    const Eigen::Matrix<double, 3, 4> rotation = frame.rotation();
    const double across = edges[i].across;
    const double excess = edges[i].along - across;
    const Vec3 taken = across * moment + excess * torque * t;
    out.force.segment<4>(own) = rotation.transpose() * taken;
    out.tangent.middleRows<4>(own) = -rotation.transpose() * (across * turning + excess * leaning);
    out.tangent.block<4, 4>(own, own) -=
        frame.geometric_stiffness(taken) +
        0.5 * rotation.transpose() * cross_matrix(taken) * rotation;
  }
}

void CirculatoryLoad::evaluate(const Configuration& here, CirculatoryTerm& out) const {
  std::visit([&](const auto& load) { load.evaluate(here, amount_of(*this, here.controls), out); },
             kind);
}

Vec3 CirculatoryLoad::force(const Configuration& here) const {
  Vec3 total = Vec3::Zero();
  if (std::holds_alternative<SpatialMoment>(kind)) return total;
  CirculatoryTerm term;
  evaluate(here, term);
  if (std::holds_alternative<PlanarFollowerForce>(kind)) {
    total.head<2>() = term.force.head<2>();
  } else {
    total = term.force.head<3>();
  }
  return total;
}

void add_circulatory_forces(const std::vector<CirculatoryLoad>& loads, const Configuration& here,
                            double factor, Vector& total) {
  CirculatoryTerm term;
  for (const CirculatoryLoad& load : loads) {
    load.evaluate(here, term);
    for (std::size_t k = 0; k < load.coordinates.size(); ++k) {
      const double force = factor * term.force[static_cast<Index>(k)];
      for (const auto& [dof, weight] : load.coordinates[k]) total[dof] += weight * force;
    }
  }
}

double circulatory_work(const std::vector<CirculatoryLoad>& loads, const Configuration& here,
                        const Vector& displacement) {
  double work = 0.0;
  CirculatoryTerm term;
  for (const CirculatoryLoad& load : loads) {
    load.evaluate(here, term);
    for (std::size_t k = 0; k < load.coordinates.size(); ++k) {
      for (const auto& [dof, weight] : load.coordinates[k]) {
        work += term.force[static_cast<Index>(k)] * weight * displacement[dof];
      }
    }
  }
  return work;
}

}  // namespace der
