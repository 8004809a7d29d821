#include "der/energies/circulatory_load.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "der/core/index.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {
namespace {

/// An outermost edge is bent against the next one over 13/12 of its length, which brings its free
/// end onto the curve (supports/clamp.hpp). This share of that turn is the true one. It counts
/// where the weight of the edge is above 1, beyond its middle; elsewhere only if the rod is bent at
/// its end.
constexpr double kTrueTurn = 12.0 / 13.0;

bool is_beyond(double weight) { return weight > 1.0; }

/// weights_in_bending of edges with a weight.
template <class Edge>
std::array<double, 2> bending_weights(const std::vector<Edge>& edges) {
  return weights_in_bending({edges[0].weight, edges.size() > 1 ? edges[1].weight : 0.0});
}

/// A vector that turns with edges, and its derivative by their vectors and angles.
struct FollowingVector {
  Vec3 value = Vec3::Zero();
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 8> slope;
};

/// Gives a sum of turned vectors, and its derivative, the length of the one that they turn: where
/// the edges have a kink between them the sum is shorter.
template <class Value, class Slope>
void take_length(double length, Value& value, Slope&& slope) {
  const double sum = value.norm();
  if (sum == 0.0) return;
  const Value along = value / sum;
  slope = length / sum * (slope - along * (along.transpose() * slope));
  value = length * along;
}

/// sum d_i R_i v0, as long as `length`. Beyond an outermost edge, a, bending takes kTrueTurn of
/// d_a. Twisting takes the whole of d_a: with the small twist rho_t of R_a against R_b this is
/// d_a/13 rho_t (t x R_a v0) more.
template <class Edge>
FollowingVector following(const std::vector<Edge>& edges, const Configuration& here,
                          const Vec3& drawn, double length) {
  FollowingVector result;
  result.slope.setZero(3, 4 * static_cast<Index>(edges.size()));
  const auto add = [&](std::size_t i, double weight) {
    const EdgeFrame frame = edges[i].frame(here);
    const Vec3 part = weight * edges[i].turned(drawn, frame.frame);
    result.value += part;
    result.slope.template middleCols<4>(4 * static_cast<Index>(i)) -=
        cross_matrix(part) * frame.rotation();
  };
  const bool has_two = edges.size() == 2;
  const std::size_t outer = has_two && edges[1].weight > edges[0].weight ? 1 : 0;
  const double weight = edges[outer].weight;
  const auto in_bending = bending_weights(edges);
  for (std::size_t i = 0; i < edges.size(); ++i) add(i, in_bending[i]);
  if (!has_two) return result;
  if (!is_beyond(weight)) {
    take_length(length, result.value, result.slope);
    return result;
  }
  const std::size_t next = 1 - outer;

  const EdgeFrame a = edges[outer].frame(here);
  const EdgeFrame b = edges[next].frame(here);
  const Vec3& t = a.frame.tangent;
  Vec3 turn = Vec3::Zero();  // twice that of R_a against R_b, times its sine
  Mat3 by_a = Mat3::Zero();
  Mat3 by_b = Mat3::Zero();
  for (int k = 0; k < 3; ++k) {
    const Vec3 in_a = edges[outer].turned(Vec3::Unit(k), a.frame);
    const Vec3 in_b = edges[next].turned(Vec3::Unit(k), b.frame);
    turn += in_b.cross(in_a);
    by_a -= cross_matrix(in_b) * cross_matrix(in_a);
    by_b += cross_matrix(in_a) * cross_matrix(in_b);
  }
  const double twist = 0.5 * t.dot(turn);
  const Vec3 twist_by_a = 0.5 * (by_a.transpose() * t + t.cross(turn));
  const Vec3 twist_by_b = 0.5 * by_b.transpose() * t;
  const Vec3 aside = (1.0 - kTrueTurn) * weight * t.cross(edges[outer].turned(drawn, a.frame));
  result.value += twist * aside;
  result.slope.template middleCols<4>(4 * static_cast<Index>(outer)) +=
      (aside * twist_by_a.transpose() - twist * cross_matrix(aside)) * a.rotation();
  result.slope.template middleCols<4>(4 * static_cast<Index>(next)) +=
      aside * twist_by_b.transpose() * b.rotation();
  take_length(length, result.value, result.slope);
  return result;
}

/// Number of the edge along which a moment counts as a torque.
std::size_t torque_axis(const std::vector<SpatialMoment::TurnedEdge>& edges) {
  return edges.size() == 2 && edges[1].along > edges[0].along ? 1 : 0;
}

/// M0 as the edges turn it.
Vec3 reference_moment(const SpatialMoment& load, const Vec3& amount) {
  if (!load.turns_further) return amount;
  return amount + (load.compliance * amount).cross(amount);
}

/// N_i: what an edge takes of a moment with a part `torque` along `t` [N m].
Vec3 taken_by(const SpatialMoment::TurnedEdge& edge, const Vec3& moment, double torque,
              const Vec3& t) {
  return edge.across * moment + (edge.along - edge.across) * torque * t;
}

template <class Kind, class... Forces>
constexpr bool kIsOneOf = (std::is_same_v<Kind, Forces> || ...);
template <class Kind>
constexpr bool kIsForce =
    kIsOneOf<Kind, PlanarFollowerForce, JointFollowerForce, SpatialJointFollowerForce,
             FollowerForce, HeldForce<1>, HeldForce<2>>;

/// The value that `f` has for a moment on edges; a default for a force, or a moment on a joint.
template <class Result, class Kinds, class F>
Result of_moment(const Kinds& kind, const F& f) {
  return std::visit(
      [&](const auto& load) {
        using Load = std::decay_t<decltype(load)>;
        if constexpr (kIsForce<Load> || std::is_same_v<Load, JointMoment>) {
          return Result{};
        } else {
          return Result(f(load));
        }
      },
      kind);
}

}  // namespace

std::array<double, 2> weights_in_bending(const std::array<double, 2>& weights) {
  const std::size_t outer = weights[1] > weights[0] ? 1 : 0;
  return is_beyond(weights[outer]) ? turn_of_outermost_edge(weights, outer) : weights;
}

std::array<double, 2> turn_of_outermost_edge(const std::array<double, 2>& weights,
                                             std::size_t outermost) {
  std::array<double, 2> result{};
  result[outermost] = kTrueTurn * weights[outermost];
  result[1 - outermost] = 1.0 - result[outermost];
  return result;
}

void JointFollowerForce::evaluate(const Configuration& here, const Vec3& amount,
                                  CirculatoryTerm& out) const {
  out.reset(size());
  const Vec2 force = Eigen::Rotation2Dd(here.coordinates[rotation]) * amount.head<2>();
  out.force.head<2>() = force;
  out.tangent.block<2, 1>(0, 2) = -perpendicular(force);
}

void SpatialJointFollowerForce::evaluate(const Configuration& here, const Vec3& amount,
                                         CirculatoryTerm& out) const {
  out.reset(size());
  const JointTurn turn(joint, here.controls, here.coordinates.segment<3>(rotation));
  const Vec3 force = turn.rotation() * amount;
  out.force.head<3>() = force;
  out.tangent.block<3, 3>(0, 3) = cross_matrix<double>(force) * turn.spin();
}

void JointMoment::evaluate(const Configuration& here, const Vec3& amount,
                           CirculatoryTerm& out) const {
  out.reset(size());
  const JointTurn turn(joint, here.controls, here.coordinates.segment<3>(rotation));
  const Vec3 moment = follower ? Vec3(turn.rotation() * amount) : amount;
  const Mat3 spin = turn.spin();
  out.force = spin.transpose() * moment;
  out.tangent = -turn.force_gradient(moment);
  if (follower) out.tangent += spin.transpose() * cross_matrix<double>(moment) * spin;
}

void PlanarFollowerForce::evaluate(const Configuration& here, const Vec3& amount,
                                   CirculatoryTerm& out) const {
  out.reset(size());
  const Vec2 reference_force = amount.head<2>();
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const FollowedEdge& followed = edges[i];
    const Vec2 e = followed.edge.vector(here);
    const Vec2 tangent = e.normalized();
    const Vec2 force =
        followed.weight * (followed.drawn.dot(reference_force) * tangent +
                           cross(followed.drawn, reference_force) * perpendicular(tangent));
    out.force.head<2>() += force;
    out.tangent.block<2, 2>(0, 2 + 2 * static_cast<Index>(i)) =
        -perpendicular(force) * direction_gradient(e, 1.0 / e.squaredNorm()).transpose();
  }
  if (reference_force.isZero(0.0)) return;
  if (edges.size() == 2) {
    Vec2 force = out.force.head<2>();
    take_length(reference_force.norm(), force, out.tangent.block<2, 4>(0, 2));
    out.force.head<2>() = force;
  }
  if (share == 1.0) return;
  const double turned = clamp_turn < 0 ? 0.0 : held_share * here.controls[clamp_turn];
  hold_back(Eigen::Rotation2Dd(turned) * reference_force, out);
}

void PlanarFollowerForce::hold_back(const Vec2& held, CirculatoryTerm& out) const {
  const Vec2 whole = out.force.head<2>();
  const double turn = std::atan2(cross(held, whole), held.dot(whole));
  const Eigen::Rotation2Dd back((share - 1.0) * turn);
  const Vec2 force = back * whole;
  using Slopes = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, CirculatoryTerm::kMost>;
  const Slopes slopes = out.tangent.topRightCorner(2, out.tangent.cols() - 2);
  // The turn changes by perpendicular(F) . dF / F^2.
  const Vec2 by_turn = (share - 1.0) / whole.squaredNorm() * perpendicular(force);
  const Mat2 change = back.toRotationMatrix() + by_turn * perpendicular(whole).transpose();
  out.tangent.topRightCorner(2, slopes.cols()) = change * slopes;
  out.force.head<2>() = force;
}

void FollowerForce::evaluate(const Configuration& here, const Vec3& amount,
                             CirculatoryTerm& out) const {
  out.reset(size());
  const FollowingVector force = following(edges, here, amount, amount.norm());
  out.force.head<3>() = force.value;
  out.tangent.topRightCorner(3, force.slope.cols()) = -force.slope;
}

EdgeMoments SpatialMoment::moments_at(const Configuration& here, const Vec3& amount) const {
  EdgeMoments result;
  result.whole = amount;
  if (follower)
    result.whole = following(edges, here, reference_moment(*this, amount), amount.norm()).value;
  const Vec3 t = edges[torque_axis(edges)].frame(here).frame.tangent;
  const double torque = result.whole.dot(t);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    result.on_edge[i] = taken_by(edges[i], result.whole, torque, t);
  }
  return result;
}

StoredBeside SpatialMoment::stored(const Configuration& here, const Vec3& amount) const {
  const TurnedEdge& edge = edges.front();
  const Vec3 moment = follower ? amount : edge.turned_back(amount, edge.frame(here).frame);
  return {0.5 * moment.dot(compliance * moment), 0.0};
}

void SpatialMoment::evaluate(const Configuration& here, const Vec3& amount,
                             CirculatoryTerm& out) const {
  out.reset(size());
  FollowingVector whole{amount, {}};
  whole.slope.setZero(3, size());
  if (follower) whole = following(edges, here, reference_moment(*this, amount), amount.norm());
  const auto& [moment, turning] = whole;

  const std::size_t axis = torque_axis(edges);
  const EdgeFrame outer = edges[axis].frame(here);
  const Vec3& t = outer.frame.tangent;
  const double torque = moment.dot(t);
  auto leaning = turning;  // of (M . t) t
  leaning = t * (t.transpose() * turning);
  leaning.middleCols<4>(4 * static_cast<Index>(axis)) +=
      (t * t.cross(moment).transpose() - torque * cross_matrix(t)) * outer.rotation();

  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Index own = 4 * static_cast<Index>(i);
    const EdgeFrame frame = edges[i].frame(here);
    const Eigen::Matrix<double, 3, 4> rotation = frame.rotation();
    const double across = edges[i].across;
    const double excess = edges[i].along - across;
    const Vec3 taken = taken_by(edges[i], moment, torque, t);
    out.force.segment<4>(own) = rotation.transpose() * taken;
    out.tangent.middleRows<4>(own) = -rotation.transpose() * (across * turning + excess * leaning);
    out.tangent.block<4, 4>(own, own) -=
        frame.geometric_stiffness(taken) +
        0.5 * rotation.transpose() * cross_matrix(taken) * rotation;
  }
}

void CirculatoryLoad::evaluate(const Configuration& here, CirculatoryTerm& out) const {
  std::visit([&](const auto& load) { load.evaluate(here, amount.at(here.controls), out); }, kind);
}

Vec3 CirculatoryLoad::force(const Configuration& here) const {
  Vec3 total = Vec3::Zero();
  const bool is_moment =
      std::visit([](const auto& load) { return !kIsForce<std::decay_t<decltype(load)>>; }, kind);
  if (is_moment) return total;
  CirculatoryTerm term;
  evaluate(here, term);
  if (std::holds_alternative<PlanarFollowerForce>(kind) ||
      std::holds_alternative<JointFollowerForce>(kind)) {
    total.head<2>() = term.force.head<2>();
  } else {
    total = term.force.head<3>();
  }
  return total;
}

EdgeMoments CirculatoryLoad::moments(const Configuration& here) const {
  return of_moment<EdgeMoments>(
      kind, [&](const auto& moment) { return moment.moments_at(here, amount.at(here.controls)); });
}

Vec3 CirculatoryLoad::taken_by_springs(const Configuration& here) const {
  const auto taken = [&](const auto& moment) {
    return moment.taken_by_springs(here, amount.at(here.controls));
  };
  if (const auto* on_one = std::get_if<HeldMoment<1>>(&kind)) return taken(*on_one);
  if (const auto* on_two = std::get_if<HeldMoment<2>>(&kind)) return taken(*on_two);
  return Vec3::Zero();
}

std::optional<Mat3> CirculatoryLoad::axes_of_springs(const Configuration& here) const {
  const auto axes = [&](const auto& moment) {
    return moment.axes_of_springs(here, amount.at(here.controls));
  };
  if (const auto* on_one = std::get_if<HeldMoment<1>>(&kind)) return axes(*on_one);
  if (const auto* on_two = std::get_if<HeldMoment<2>>(&kind)) return axes(*on_two);
  return std::nullopt;
}

std::array<const FramedEdge*, 2> CirculatoryLoad::turned_edges() const {
  using Edges = std::array<const FramedEdge*, 2>;
  return of_moment<Edges>(kind, [](const auto& moment) {
    return Edges{&moment.edges.front(), moment.edges.size() > 1 ? &moment.edges[1] : nullptr};
  });
}

const FramedEdge& CirculatoryLoad::nearer_edge() const {
  return *of_moment<const FramedEdge*>(
      kind, [](const auto& moment) { return &moment.edges[moment.nearer()]; });
}

StoredBeside CirculatoryLoad::stored(const Configuration& here) const {
  return of_moment<StoredBeside>(
      kind, [&](const auto& moment) { return moment.stored(here, amount.at(here.controls)); });
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
