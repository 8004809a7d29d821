#include "der/statics/initial_stress.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/energies/stretched_edges.hpp"

namespace der {
namespace {

Eigen::Matrix2d across(const Vec2& edge, double stiffness) {
  const Vec2 normal = Vec2(-edge.y(), edge.x()) / edge.norm();
  return stiffness * normal * normal.transpose();
}
Mat3 across(const Vec3& edge, double stiffness) {
  const Vec3 tangent = edge.normalized();
  return stiffness * (Mat3::Identity() - tangent * tangent.transpose());
}

/// Angle [rad] by which the change of an edge turns it.
double turned_by(const Vec2& edge, const Vec2& change) {
  return std::abs(edge.x() * change.y() - edge.y() * change.x()) / edge.squaredNorm();
}
double turned_by(const Vec3& edge, const Vec3& change) {
  return edge.cross(change).norm() / edge.squaredNorm();
}

/// An edge beside a joint, and the change of its vector and angle.
struct TurningEdge {
  EdgeFrame frame;
  Eigen::Vector4d change;

  [[nodiscard]] Vec3 turned() const { return frame.rotation() * change; }
};

template <int N>
TurningEdge turning_edge(const Eigen::Matrix<double, N, 1>& x, const Eigen::Matrix<double, N, 1>& d,
                         int first_node, int angle, const FrameBlock& block, const Vector& values) {
  const int start = 3 * first_node;
  const Vec3 vector = x.template segment<3>(start + 3) - x.template segment<3>(start);
  const Vec3 change = d.template segment<3>(start + 3) - d.template segment<3>(start);
  return {{vector, x[angle], block.tangent(values), block.director(values)},
          {change.x(), change.y(), change.z(), d[angle]}};
}

/// The change of the moment of a joint as its frames turn.
Vec3 moment_change(const JointResponse& response, const Vec3& omega_a, const Vec3& omega_b) {
  return response.stiffness * (omega_b - omega_a) - 0.5 * response.moment.cross(omega_a + omega_b);
}

/// Second derivative by vector and angle of an edge of the work of a moment that turns with it,
/// without what couples turning and stretching.
Eigen::Matrix4d own_stiffness(const EdgeFrame& edge, const Vec3& moment) {
  Eigen::Matrix4d matrix = edge.geometric_stiffness(moment);
  matrix.topLeftCorner<3, 3>().setZero();
  return matrix;
}

template <std::size_t N>
Eigen::Matrix<double, static_cast<int>(N), 1> moved(const std::array<Index, N>& dofs,
                                                    const Configuration& here,
                                                    const SpatialPivot& first,
                                                    const SpatialPivot& last, int nodes) {
  auto x = gather(dofs, here.coordinates);
  x.template segment<3>(0) += first.offset(here.controls);
  x.template segment<3>(static_cast<Eigen::Index>(3) * (nodes - 1)) += last.offset(here.controls);
  return x;
}

/// The turning of the two edges of a joint by a displacement, and the moment that it causes.
struct StressedJoint {
  TurningEdge a;
  TurningEdge b;
  Vec3 moment;  ///< [N m]

  template <class Curvature>
  static StressedJoint of(const std::array<Index, 11>& dofs,
                          const typename SpatialBend<Curvature>::Constants& c,
                          const SpatialPivot& first, const SpatialPivot& last,
                          const Configuration& here, const Vector& displacement) {
    const Vector& values = here.controls;
    auto x = moved(dofs, here, first, last, 3);
    x[10] -= c.glued;
    const auto d = gather(dofs, displacement);
    const TurningEdge a = turning_edge(x, d, 0, 9, c.before, values);
    const TurningEdge b = turning_edge(x, d, 1, 10, c.after, values);
    const double twist =
        whole_twist(a.frame.frame, b.frame.frame, x[9], x[10], values[c.after.twist_at_start()]);
    JointResponse response;
    JointKinematics<Curvature>(a.frame.frame, b.frame.frame, twist)
        .template respond<true>(c.joint, response);
    return {a, b, moment_change(response, a.turned(), b.turned())};
  }

  /// By vector and angle of the first edge, then of the second.
  [[nodiscard]] Eigen::Matrix<double, 8, 8> stiffness() const {
    const Eigen::Matrix4d ba =
        -0.5 * b.frame.rotation().transpose() * cross_matrix(moment) * a.frame.rotation();
    Eigen::Matrix<double, 8, 8> matrix;
    matrix << own_stiffness(a.frame, -moment), ba.transpose(), ba, own_stiffness(b.frame, moment);
    return matrix;
  }
};

/// The same between an edge and a clamp, which does not turn.
struct StressedClamp {
  TurningEdge edge;
  Vec3 moment;  ///< [N m] on the edge

  template <class Curvature>
  static StressedClamp of(const std::array<Index, 7>& dofs,
                          const typename SpatialClamp<Curvature>::Constants& c,
                          const SpatialPivot& first, const SpatialPivot& last,
                          const Configuration& here, const Vector& displacement) {
    const Vector& values = here.controls;
    const auto x = moved(dofs, here, first, last, 2);
    const TurningEdge edge = turning_edge(x, gather(dofs, displacement), 0, 6, c.edge, values);
    const double turned = c.held.twist_angle(values);
    const SectionFrame held = c.held.untwisted(values).turned(turned);
    const bool leaves = c.side > 0.0;
    const SectionFrame& a = leaves ? held : edge.frame.frame;
    const SectionFrame& b = leaves ? edge.frame.frame : held;
    const double twist = leaves ? whole_twist(a, b, turned, x[6], values[c.edge.twist_at_start()])
                                : whole_twist(a, b, x[6], turned, values[c.edge.twist_at_end()]);
    JointResponse response;
    JointKinematics<Curvature>(a, b, twist).template respond<true>(c.joint, response);
    const Vec3 none = Vec3::Zero();
    return {edge, c.side * (leaves ? moment_change(response, none, edge.turned())
                                   : moment_change(response, edge.turned(), none))};
  }
};

}  // namespace

InitialStress::InitialStress(const Model& model, const Configuration& here,
                             const Vector& displacement) {
  if (model.dimension == 2) {
    add_planar_edges(model, here, displacement);
    return;
  }
  add_spatial_edges(model, here, displacement);
  add_joints<AngleCurvature>(model, here, displacement);
  add_joints<TangentCurvature>(model, here, displacement);
}

template <int Dim>
void InitialStress::add_edge(const std::array<Index, std::size_t{2} * Dim>& dofs,
                             const Eigen::Matrix<double, Dim, 1>& edge,
                             const Eigen::Matrix<double, Dim, 1>& change, double EA,
                             double rest_length) {
  const double length = edge.norm();
  const double strain = edge.dot(change) / (length * rest_length);
  const double tension = EA * strain;
  rotation_ = std::max(rotation_, turned_by(edge, change));
  strain_ = std::max(strain_, std::abs(strain));
  largest_ = std::max(largest_, std::abs(tension));
  Term& term = terms_.emplace_back();
  term.size = Dim;
  for (std::size_t c = 0; c < Dim; ++c) term.variables[c] = {dofs[Dim + c], dofs[c]};
  term.matrix = across(edge, tension / length);
}

void InitialStress::add_planar_edges(const Model& model, const Configuration& here,
                                     const Vector& displacement) {
  for_each_stretched_edge(
      *model.elements, [&](const EffectiveEdge& effective, const Stretch<2>::Constants& c) {
        add_edge<2>(effective.dofs, effective.vector(here),
                    Stretch<2>::edge(gather(effective.dofs, displacement)), c.EA, c.rest_length);
      });
}

void InitialStress::add_spatial_edges(const Model& model, const Configuration& here,
                                      const Vector& displacement) {
  const auto add = [&](const auto& dofs, const Stretch<3>::Constants& c, const SpatialPivot& first,
                       const SpatialPivot& last) {
    add_edge<3>(dofs, Stretch<3>::edge(moved(dofs, here, first, last, 2)),
                Stretch<3>::edge(gather(dofs, displacement)), c.EA, c.rest_length);
  };
  const auto& plain = elements_of<Stretch<3>>(*model.elements);
  for (std::size_t i = 0; i < plain.size(); ++i) add(plain.dofs[i], plain.constants[i], {}, {});
  const auto& clamped = elements_of<FromSpatialPivot<Stretch<3>>>(*model.elements);
  for (std::size_t i = 0; i < clamped.size(); ++i) {
    const auto& c = clamped.constants[i];
    add(clamped.dofs[i], c.element, c.first, c.last);
  }
}

template <class Curvature>
void InitialStress::add_joints(const Model& model, const Configuration& here,
                               const Vector& displacement) {
  const auto count = [&](const Vec3& moment) {
    largest_ = std::max(largest_, moment.norm() / model.size());
  };
  const auto add = [&](const auto& dofs, const auto& c, const SpatialPivot& first,
                       const SpatialPivot& last) {
    const auto joint = StressedJoint::of<Curvature>(dofs, c, first, last, here, displacement);
    count(joint.moment);
    Term& term = terms_.emplace_back();
    term.size = 8;
    term.matrix = joint.stiffness();
    for (std::size_t i = 0; i < 3; ++i) {
      term.variables[i] = {dofs[3 + i], dofs[i]};
      term.variables[4 + i] = {dofs[6 + i], dofs[3 + i]};
    }
    term.variables[3] = {dofs[9], -1};
    term.variables[7] = {dofs[10], -1};
  };
  const auto& plain = elements_of<SpatialBend<Curvature>>(*model.elements);
  for (std::size_t i = 0; i < plain.size(); ++i) add(plain.dofs[i], plain.constants[i], {}, {});
  const auto& pivoted = elements_of<FromSpatialPivot<SpatialBend<Curvature>>>(*model.elements);
  for (std::size_t i = 0; i < pivoted.size(); ++i) {
    const auto& c = pivoted.constants[i];
    add(pivoted.dofs[i], c.element, c.first, c.last);
  }
  const auto& clamps = elements_of<FromSpatialPivot<SpatialClamp<Curvature>>>(*model.elements);
  for (std::size_t i = 0; i < clamps.size(); ++i) {
    const auto& dofs = clamps.dofs[i];
    const auto& c = clamps.constants[i];
    const auto clamp =
        StressedClamp::of<Curvature>(dofs, c.element, c.first, c.last, here, displacement);
    count(clamp.moment);
    Term& term = terms_.emplace_back();
    term.size = 4;
    term.matrix = own_stiffness(clamp.edge.frame, clamp.moment);
    for (std::size_t k = 0; k < 3; ++k) term.variables[k] = {dofs[3 + k], dofs[k]};
    term.variables[3] = {dofs[6], -1};
  }
}

Vector InitialStress::stiffness(const Model& model, const MatrixLayout& layout) const {
  Vector values = Vector::Zero(layout.num_values() + 1);
  struct Entry {
    Index dof;
    double sign;
    int variable;
  };
  for (const Term& term : terms_) {
    std::array<Entry, std::size_t{2} * kMost> entries{};
    std::size_t count = 0;
    for (int i = 0; i < term.size; ++i) {
      const Variable& variable = term.variables[static_cast<std::size_t>(i)];
      entries[count++] = {variable.plus, 1.0, i};
      if (variable.minus >= 0) entries[count++] = {variable.minus, -1.0, i};
    }
    for (std::size_t p = 0; p < count; ++p) {
      for (std::size_t q = 0; q <= p; ++q) {
        const double value = entries[p].sign * entries[q].sign *
                             term.matrix(entries[p].variable, entries[q].variable);
        // Two variables that share a degree of freedom meet twice on its diagonal.
        const bool twice = p != q && entries[p].dof == entries[q].dof;
        values[layout.slot_or_spare(model.dofs.free_index(entries[p].dof),
                                    model.dofs.free_index(entries[q].dof))] +=
            twice ? 2.0 * value : value;
      }
    }
  }
  return values;
}

double InitialStress::variation(const Vector& direction) const {
  double total = 0.0;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1> d;
  for (const Term& term : terms_) {
    d.resize(term.size);
    for (int i = 0; i < term.size; ++i) {
      d[i] = term.variables[static_cast<std::size_t>(i)].of(direction);
    }
    total += d.dot(term.matrix * d);
  }
  return total;
}

void InitialStress::reverse() {
  for (Term& term : terms_) term.matrix = -term.matrix;
}

}  // namespace der
