#pragma once

#include <array>
#include <vector>

#include "der/assembly/pattern.hpp"
#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"

namespace der {

/// The tensions and moments that a displacement causes to first order, and K1, the stiffness that
/// they make by turning with the structure: the initial-stress stiffness of the classical theory.
/// Material stiffness is that of the shape at the start, and so are all directions.
///
/// A tension T makes T/l across an edge of length l, and -2 T l G in the turning angles of its arc
/// (energies/arc_stretch.hpp). In space a moment M between two section frames
/// that turn by omega_a and omega_b makes the quadratic form
///   omega_b . (omega_a x M),
/// and what remains of it where an edge is turned by a force: M across the tangent t couples the
/// turning of an edge with its angle (EdgeFrame::geometric_stiffness). A clamp that lets the
/// section turn reads M in directors that spin with the edge, and the second derivatives of its
/// strains are not small: they add a part that couples spin and bending. So do springs against
/// turning, whose section follows the edges beside it as it does without stress; what the stress
/// changes of that is of second order in it, K2, and an edge's length smaller. The part that
/// couples the turning of an edge with its stretching is left out: it would make a straight beam
/// buckle under a load across it of about sqrt(EA EI), where terms of second order in the
/// displacement, left out too, cancel it. In a plane nothing remains of moments, nor where sections
/// do not count.
class InitialStress {
 public:
  /// `displacement` has all degrees of freedom, `here` the frames of the shape itself.
  InitialStress(const Model& model, const Configuration& here, const Vector& displacement);

  [[nodiscard]] double rotation() const { return rotation_; }  ///< largest of an edge [rad]
  [[nodiscard]] double strain() const { return strain_; }      ///< largest of an edge
  /// The largest tension [N]; a moment counts over the size of the model.
  [[nodiscard]] double largest() const { return largest_; }

  /// K1 in the layout of a linear solver, with the spare slot.
  [[nodiscard]] Vector stiffness(const Model& model, const MatrixLayout& layout) const;
  /// d' K1 d [J] of a displacement d (all degrees of freedom) [m], summed over the elements, each
  /// of which sees differences of it alone.
  [[nodiscard]] double variation(const Vector& direction) const;
  /// d' K2 d [J].
  [[nodiscard]] double second_variation(const Vector& direction) const;
  /// K1 d (all degrees of freedom) [N].
  [[nodiscard]] Vector product(const Vector& direction) const;
  /// The stresses of the reversed displacement.
  void reverse();

 private:
  /// A variable of an element: the difference of two degrees of freedom, or one of them.
  struct Variable {
    Index plus = 0;
    Index minus = -1;  ///< -1: none
    [[nodiscard]] double of(const Vector& direction) const {
      return direction[plus] - (minus < 0 ? 0.0 : direction[minus]);
    }
  };
  static constexpr int kMost = 8;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;
  using Values = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
  struct Term {
    int size = 0;
    std::array<Variable, kMost> variables{};
    Matrix matrix;
    [[nodiscard]] Values of(const Vector& direction) const;
  };

  template <int Dim>
  void add_edge(const std::array<Index, std::size_t{2} * Dim>& dofs,
                const Eigen::Matrix<double, Dim, 1>& edge,
                const Eigen::Matrix<double, Dim, 1>& change, double EA, double rest_length);
  /// The tension [N] that the change of an edge, or of a spring between joints, causes along it.
  template <int Dim>
  void add_tension(const std::array<Index, std::size_t{2} * Dim>& dofs,
                   const Eigen::Matrix<double, Dim, 1>& edge,
                   const Eigen::Matrix<double, Dim, 1>& change, double tension);
  template <int Dim>
  void add_axial_springs(const Model& model, const Configuration& here, const Vector& displacement);
  template <class Kernel>
  void add_arc(const std::array<Index, std::size_t{Kernel::kDofs}>& dofs,
               const typename Kernel::Constants& c, const Configuration& here,
               const Vector& displacement);
  void add_planar_edges(const Model& model, const Configuration& here, const Vector& displacement);
  void add_spatial_edges(const Model& model, const Configuration& here, const Vector& displacement);
  /// `moment` [N m] of its element, `size` of the model [m], number of variables.
  Term& add_term(double moment, double size, int variables);
  template <class Dofs>
  static void set_edge(const Dofs& dofs, std::size_t node, std::size_t angle, std::size_t first,
                       Term& term);
  template <int Edges>
  void add_springs(const Model& model, const Configuration& here, const Vector& displacement);
  template <class Curvature>
  void add_vertices(const Model& model, const Configuration& here, const Vector& displacement);

  static double variation_of(const std::vector<Term>& terms, const Vector& direction);

  std::vector<Term> terms_;      // of K1
  std::vector<Term> following_;  // of K2
  double rotation_ = 0.0;
  double strain_ = 0.0;
  double largest_ = 0.0;
};

}  // namespace der
