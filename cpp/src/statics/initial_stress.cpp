#include "der/statics/initial_stress.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "der/energies/arc_stretch.hpp"
#include "der/energies/axial_spring.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/registry.hpp"
#include "der/energies/section_spring.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/energies/stretched_edges.hpp"
#include "der/kinematics/planar_edge.hpp"

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

/// Rotation [rad] of an edge by a change `d` of the coordinates of its element: of the nodes from
/// number `node` on, and of the angle, number `angle` of all.
template <class Change>
Vec3 turned(const EdgeFrame& edge, const Change& d, int node, int angle) {
  const int start = 3 * node;
  Eigen::Vector4d change;
  change << d.template segment<3>(start + 3) - d.template segment<3>(start), d[angle];
  return edge.rotation() * change;
}

/// The change of the moment of a vertex as its frames turn.
Vec3 moment_change(const VertexResponse& response, const Vec3& omega_a, const Vec3& omega_b) {
  return response.stiffness * (omega_b - omega_a) - 0.5 * response.moment.cross(omega_a + omega_b);
}

/// Second derivative by vector and angle of an edge of the work of a moment that turns with it,
/// without what couples turning and stretching.
Eigen::Matrix4d own_stiffness(const EdgeFrame& edge, const Vec3& moment) {
  Eigen::Matrix4d matrix = edge.geometric_stiffness(moment);
  matrix.topLeftCorner<3, 3>().setZero();
  return matrix;
}

/// The two edges of a vertex, and the moment that a displacement causes there.
struct StressedVertex {
  EdgeFrame a;
  EdgeFrame b;
  Vec3 moment;  ///< [N m]

  template <class Curvature, class AVertex>
  static StressedVertex of(const Eigen::Matrix<double, 11, 1>& x,
                           const Eigen::Matrix<double, 11, 1>& d,
                           const typename SpatialBend<Curvature, AVertex>::Constants& c,
                           const Vector& values) {
    const auto [a, b, twist] = SpatialBend<Curvature, AVertex>::frames(c, values, x);
    VertexResponse response;
    VertexKinematics<Curvature>(a.frame, b.frame, twist)
        .template respond<true>(c.actuated_vertex(values), response);
    return {a, b, moment_change(response, turned(a, d, 0, 9), turned(b, d, 1, 10))};
  }

  /// By vector and angle of the first edge, then of the second.
  [[nodiscard]] Eigen::Matrix<double, 8, 8> stiffness() const {
    const Eigen::Matrix4d ba =
        -0.5 * b.rotation().transpose() * cross_matrix(moment) * a.rotation();
    Eigen::Matrix<double, 8, 8> matrix;
    matrix << own_stiffness(a, -moment), ba.transpose(), ba, own_stiffness(b, moment);
    return matrix;
  }
};

/// The part of S that is the moments times the second derivatives of the strains: of the moments
/// that the rotation `turn` of frame b relative to frame a causes.
template <class Curvature>
Mat3 strain_stiffness(const VertexKinematics<Curvature>& kinematics, const Vertex& vertex,
                      const Vec3& turn) {
  const auto [g1, g2, gt] = kinematics.gradients();
  const MaterialCurvature moments{vertex.bend_1 * g1.dot(turn), vertex.bend_2 * g2.dot(turn),
                                  vertex.twist * gt.dot(turn)};
  VertexResponse response;
  kinematics.template respond<true>(LoadedVertex{vertex.rest, moments}, response);
  return response.stiffness;
}

/// The same between an edge and a clamp, which does not turn.
struct StressedClamp {
  EdgeFrame edge;
  Vec3 moment;                      ///< [N m] on the edge
  Mat3 with_strain = Mat3::Zero();  ///< [N m] that the strains' second derivatives add

  template <class Curvature>
  static StressedClamp of(const Eigen::Matrix<double, 7, 1>& x,
                          const Eigen::Matrix<double, 7, 1>& d,
                          const typename SpatialClamp<Curvature>::Constants& c,
                          const Vector& values) {
    const auto frames = SpatialClamp<Curvature>::frames(c, values, x);
    const EdgeFrame& edge = frames.edge;
    const auto kinematics = SpatialClamp<Curvature>::kinematics(c, values, frames);
    const Vertex vertex = c.actuated_vertex(values);
    VertexResponse response;
    kinematics.template respond<true>(vertex, response);
    const Vec3 none = Vec3::Zero();
    const Vec3 omega = turned(edge, d, 0, 6);
    StressedClamp clamp{edge, c.side * (c.side > 0.0 ? moment_change(response, none, omega)
                                                     : moment_change(response, omega, none))};
    // In directors of half the twist the second derivatives of the strains are as small as the
    // strains, and left out, as they are between two edges. In those that spin with the edge they
    // are not.
    if (!c.holds_section) clamp.with_strain = strain_stiffness(kinematics, vertex, c.side * omega);
    return clamp;
  }

  /// By vector and angle of the edge.
  [[nodiscard]] Eigen::Matrix4d stiffness() const {
    const EdgeFrame::Rotation turn = edge.rotation();
    return own_stiffness(edge, moment) + turn.transpose() * with_strain * turn;
  }
};

/// Springs against turning on one or two edges.
template <int Edges>
struct StressedSpring {
  using Kernel = SectionSpring<Edges>;
  typename Kernel::Response at;
  HeldSection::Stress stress;

  StressedSpring(const typename Kernel::Constants& c, const Configuration& here,
                 const Eigen::Matrix<double, Kernel::kDofs, 1>& x,
                 const Eigen::Matrix<double, Kernel::kDofs, 1>& d)
      : at(c, here, x), stress(at.held.stress(rotations(at, d))) {}

  /// By vector and angle of each edge.
  using Matrix = Eigen::Matrix<double, 4 * Edges, 4 * Edges>;
  [[nodiscard]] Matrix stiffness() const {
    Matrix matrix = of_rotations(stress.stiffness);
    for (std::size_t i = 0; i < Edges; ++i) {
      matrix.template block<4, 4>(4 * Index(i), 4 * Index(i)) +=
          own_stiffness(at.edges[i], stress.moments[i]);
    }
    return matrix;
  }
  /// The same of HeldSection::Stress::by_following.
  [[nodiscard]] Matrix by_following() const { return of_rotations(stress.by_following); }

 private:
  [[nodiscard]] Matrix of_rotations(const HeldSection::Stiffness& stiffness) const {
    Matrix matrix;
    for (std::size_t i = 0; i < Edges; ++i) {
      for (std::size_t j = 0; j < Edges; ++j) {
        matrix.template block<4, 4>(4 * Index(i), 4 * Index(j)) =
            at.edges[i].rotation().transpose() * stiffness[i][j] * at.edges[j].rotation();
      }
    }
    return matrix;
  }

  /// A clamp beside the springs does not turn.
  static std::array<Vec3, HeldSection::kMost> rotations(
      const typename Kernel::Response& at, const Eigen::Matrix<double, Kernel::kDofs, 1>& d) {
    std::array<Vec3, HeldSection::kMost> result{Vec3::Zero(), Vec3::Zero()};
    for (int i = 0; i < Edges; ++i) {
      result[std::size_t(i)] = turned(at.edges[std::size_t(i)], d, i, 3 * Kernel::kNodes + i);
    }
    return result;
  }
};

/// Calls `f(dofs, constants, x)` for the elements of a kernel between pivots; x are the coordinates
/// that the kernel sees.
template <class Kernel, class F>
void for_each_pivoted(const Model& model, const Configuration& here, const F& f) {
  const auto& pivoted = elements_of<FromSpatialPivot<Kernel>>(*model.elements);
  for (std::size_t i = 0; i < pivoted.size(); ++i) {
    const auto& c = pivoted.constants[i];
    const auto x = gather(pivoted.dofs[i], here.coordinates);
    f(pivoted.dofs[i], c.element, FromSpatialPivot<Kernel>::from_pivots(c, here.controls, x));
  }
}

/// The same, and for those between nodes.
template <class Kernel, class F>
void for_each_element(const Model& model, const Configuration& here, const F& f) {
  const auto& plain = elements_of<Kernel>(*model.elements);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    f(plain.dofs[i], plain.constants[i], gather(plain.dofs[i], here.coordinates));
  }
  for_each_pivoted<Kernel>(model, here, f);
}

}  // namespace

InitialStress::InitialStress(const Model& model, const Configuration& here,
                             const Vector& displacement) {
  if (model.dimension == 2) {
    add_planar_edges(model, here, displacement);
    add_axial_springs<2>(model, here, displacement);
    return;
  }
  add_spatial_edges(model, here, displacement);
  add_axial_springs<3>(model, here, displacement);
  add_vertices<AngleCurvature>(model, here, displacement);
  add_vertices<TangentCurvature>(model, here, displacement);
  add_springs<1>(model, here, displacement);
  add_springs<2>(model, here, displacement);
}

template <int Dim>
void InitialStress::add_edge(const std::array<Index, std::size_t{2} * Dim>& dofs,
                             const Eigen::Matrix<double, Dim, 1>& edge,
                             const Eigen::Matrix<double, Dim, 1>& change, double EA,
                             double rest_length) {
  const double strain = edge.dot(change) / (edge.norm() * rest_length);
  strain_ = std::max(strain_, std::abs(strain));
  add_tension(dofs, edge, change, EA * strain);
}

template <int Dim>
void InitialStress::add_tension(const std::array<Index, std::size_t{2} * Dim>& dofs,
                                const Eigen::Matrix<double, Dim, 1>& edge,
                                const Eigen::Matrix<double, Dim, 1>& change, double tension) {
  rotation_ = std::max(rotation_, turned_by(edge, change));
  largest_ = std::max(largest_, std::abs(tension));
  Term& term = terms_.emplace_back();
  term.size = Dim;
  for (std::size_t c = 0; c < Dim; ++c) term.variables[c] = {dofs[Dim + c], dofs[c]};
  term.matrix = across(edge, tension / edge.norm());
}

/// The change of their stiffness across them. A spring of rest length 0 has the same stiffness in
/// all directions, whatever its tension.
template <int Dim>
void InitialStress::add_axial_springs(const Model& model, const Configuration& here,
                                      const Vector& displacement) {
  const auto& springs = elements_of<AxialSpring<Dim>>(*model.elements);
  for (std::size_t i = 0; i < springs.size(); ++i) {
    const auto& c = springs.constants[i];
    const auto edge = AxialSpring<Dim>::vector(gather(springs.dofs[i], here.coordinates)).eval();
    if (here.controls[c.rest_length] == 0.0) continue;
    const auto change = AxialSpring<Dim>::vector(gather(springs.dofs[i], displacement)).eval();
    add_tension<Dim>(
        springs.dofs[i], edge, change,
        c.stiffness * here.controls[c.rest_length] * edge.dot(change) / edge.squaredNorm());
  }
}

void InitialStress::add_planar_edges(const Model& model, const Configuration& here,
                                     const Vector& displacement) {
  for_each_stretched_edge(
      *model.elements, [&](const EffectiveEdge& effective, const Stretch<2>::Constants& c) {
        add_edge<2>(effective.dofs, effective.vector(here),
                    Stretch<2>::edge(gather(effective.dofs, displacement)), c.EA, c.rest_length);
      });
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (IsArcStretch<Kernel>::value) {
      for (std::size_t i = 0; i < list.size(); ++i) {
        add_arc<Kernel>(list.dofs[i], list.constants[i], here, displacement);
      }
    }
  });
}

/// The tension of an edge works on what its arc loses as the angles beside it turn. Those legs are
/// straight.
template <class Kernel>
void InitialStress::add_arc(const std::array<Index, std::size_t{Kernel::kDofs}>& dofs,
                            const typename Kernel::Constants& c, const Configuration& here,
                            const Vector& displacement) {
  constexpr int Edges = Kernel::kNodes - 1;
  constexpr int Joints = Kernel::kJoints;
  const auto x = gather(dofs, here.coordinates);
  const auto u = gather(dofs, displacement);
  const auto edge_of = [](const typename Kernel::Coordinates& values, int i) -> Vec2 {
    return values.template segment<2>(2 * i + 2) - values.template segment<2>(2 * i);
  };
  const Vec2 edge = edge_of(x, c.edge);
  const double length = edge.norm();
  const double tension = c.EA / c.rest_length * edge.dot(edge_of(u, c.edge)) / length;
  Term& term = terms_.emplace_back();
  term.size = 2 * Edges + Joints;
  Eigen::Matrix<double, 2 * Edges + Joints, Kernel::kDirections> turns;
  turns.setZero();
  for (int i = 0; i < Edges; ++i) {
    const Vec2 vector = edge_of(x, i);
    turns.template block<2, 1>(2 * i, Kernel::kFirstEdge + i) =
        direction_gradient(vector, 1.0 / vector.squaredNorm());
    for (int d = 0; d < 2; ++d) {
      term.variables[to_size(2 * i + d)] = {dofs[to_size(2 * i + 2 + d)], dofs[to_size(2 * i + d)]};
    }
  }
  for (int j = 0; j < Joints; ++j) {
    turns(2 * Edges + j, j == 0 ? 0 : Kernel::kDirections - 1) = 1.0;
    term.variables[to_size(2 * Edges + j)] = {dofs[to_size(2 * Kernel::kNodes + j)], -1};
  }
  const auto angles =
      turns.template rightCols<Kernel::kAngles>() - turns.template leftCols<Kernel::kAngles>();
  term.matrix = -2.0 * tension * length * angles * c.form * angles.transpose();
}

void InitialStress::add_spatial_edges(const Model& model, const Configuration& here,
                                      const Vector& displacement) {
  for_each_element<Stretch<3>>(
      model, here, [&](const auto& dofs, const Stretch<3>::Constants& c, const auto& x) {
        add_edge<3>(dofs, Stretch<3>::edge(x), Stretch<3>::edge(gather(dofs, displacement)), c.EA,
                    c.rest_length);
      });
}

InitialStress::Term& InitialStress::add_term(double moment, double size, int variables) {
  largest_ = std::max(largest_, moment / size);
  Term& term = terms_.emplace_back();
  term.size = variables;
  return term;
}

/// The vector and the angle of an edge between nodes `node` and `node + 1` of an element, as
/// variables from number `first` on.
template <class Dofs>
void InitialStress::set_edge(const Dofs& dofs, std::size_t node, std::size_t angle,
                             std::size_t first, Term& term) {
  for (std::size_t i = 0; i < 3; ++i) {
    term.variables[first + i] = {dofs[3 * node + 3 + i], dofs[3 * node + i]};
  }
  term.variables[first + 3] = {dofs[angle], -1};
}

template <class Curvature>
void InitialStress::add_vertices(const Model& model, const Configuration& here,
                                 const Vector& displacement) {
  const auto add_vertices_of = [&](const auto& kind) {
    using AVertex = std::decay_t<decltype(kind)>;
    for_each_element<SpatialBend<Curvature, AVertex>>(
        model, here, [&](const auto& dofs, const auto& c, const auto& x) {
          const auto vertex = StressedVertex::of<Curvature, AVertex>(x, gather(dofs, displacement),
                                                                     c, here.controls);
          Term& term = add_term(vertex.moment.norm(), model.size(), 8);
          term.matrix = vertex.stiffness();
          set_edge(dofs, 0, 9, 0, term);
          set_edge(dofs, 1, 10, 4, term);
        });
  };
  add_vertices_of(Vertex{});
  if constexpr (std::is_same_v<Curvature, AngleCurvature>) add_vertices_of(CoupledVertex{});
  for_each_pivoted<SpatialClamp<Curvature>>(
      model, here, [&](const auto& dofs, const auto& c, const auto& x) {
        const auto clamp =
            StressedClamp::of<Curvature>(x, gather(dofs, displacement), c, here.controls);
        Term& term = add_term(clamp.moment.norm(), model.size(), 4);
        term.matrix = clamp.stiffness();
        set_edge(dofs, 0, 6, 0, term);
      });
}

template <int Edges>
void InitialStress::add_springs(const Model& model, const Configuration& here,
                                const Vector& displacement) {
  const auto& springs = elements_of<SectionSpring<Edges>>(*model.elements);
  for (std::size_t number = 0; number < springs.size(); ++number) {
    const auto& dofs = springs.dofs[number];
    const StressedSpring<Edges> spring(springs.constants[number], here,
                                       gather(dofs, here.coordinates), gather(dofs, displacement));
    double moment = 0.0;
    for (std::size_t i = 0; i < Edges; ++i) {
      moment = std::max(moment, spring.stress.moments[i].norm());
    }
    Term& term = add_term(moment, model.size(), 4 * Edges);
    term.matrix = spring.stiffness();
    for (std::size_t i = 0; i < Edges; ++i) {
      set_edge(dofs, i, 3 * (Edges + 1) + i, 4 * i, term);
    }
    following_.push_back(term);
    following_.back().matrix = spring.by_following();
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

double InitialStress::variation_of(const std::vector<Term>& terms, const Vector& direction) {
  double total = 0.0;
  for (const Term& term : terms) {
    const Values d = term.of(direction);
    total += d.dot(term.matrix * d);
  }
  return total;
}

double InitialStress::variation(const Vector& direction) const {
  return variation_of(terms_, direction);
}

double InitialStress::second_variation(const Vector& direction) const {
  return variation_of(following_, direction);
}

Vector InitialStress::product(const Vector& direction) const {
  Vector product = Vector::Zero(direction.size());
  for (const Term& term : terms_) {
    const Values force = term.matrix * term.of(direction);
    for (int i = 0; i < term.size; ++i) {
      const Variable& variable = term.variables[static_cast<std::size_t>(i)];
      product[variable.plus] += force[i];
      if (variable.minus >= 0) product[variable.minus] -= force[i];
    }
  }
  return product;
}

InitialStress::Values InitialStress::Term::of(const Vector& direction) const {
  Values values(size);
  for (int i = 0; i < size; ++i) {
    values[i] = variables[static_cast<std::size_t>(i)].of(direction);
  }
  return values;
}

void InitialStress::reverse() {
  for (Term& term : terms_) term.matrix = -term.matrix;
}

}  // namespace der
