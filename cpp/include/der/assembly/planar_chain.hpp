#pragma once

#include <array>
#include <type_traits>
#include <vector>

#include "der/assembly/chain_run.hpp"
#include "der/assembly/lane_spans.hpp"
#include "der/assembly/member_lanes.hpp"
#include "der/assembly/pattern.hpp"
#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/energies/stretch.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"

namespace der {

/// The constants of a PlanarChain in the models of several members.
template <class T>
struct PlanarChainConstants {
  MemberVector<T> along;           ///< of each edge, stiffness along it [N/m]
  MemberVector<T> rest_length;     ///< of each edge [m]
  MemberVector<T> bend_stiffness;  ///< of each vertex, over its length [N m]
  MemberVector<T> rest_kappa;      ///< of each vertex [-]
};

/// A run of plain planar stretch elements, each beginning where the one before ends, with the bend
/// elements between them: nearly all of a rod. Taken together they cost less than one by one, since
/// an edge's length, direction and their derivatives are worked out once and not for each element
/// that it belongs to, and each entry of the matrix is written once. The sums equal those of the
/// kernels Stretch<2> and PlanarBend to rounding.
class PlanarChain {
 public:
  /// All runs of a model that are at least two edges long.
  static std::vector<PlanarChain> find(const Model& model, const MatrixLayout& layout);

  /// The elements of one kernel that the chain assembles.
  template <class Kernel>
  [[nodiscard]] ChainRange range_of() const {
    if constexpr (std::is_same_v<Kernel, Stretch<2>>) return edges_;
    if constexpr (std::is_same_v<Kernel, PlanarBend<AngleCurvature>>)
      return tangent_ ? ChainRange{} : bends_;
    if constexpr (std::is_same_v<Kernel, PlanarBend<TangentCurvature>>)
      return tangent_ ? bends_ : ChainRange{};
    return {};
  }

  /// The constants of the chain in the lanes of several models of one structure, whose rest shapes
  /// are not actuated.
  template <class T>
  [[nodiscard]] PlanarChainConstants<T> constants_of(const MemberModels<T>& models) const;

  [[nodiscard]] ChainRange edges() const { return edges_; }
  [[nodiscard]] ChainRange bends() const { return bends_; }
  [[nodiscard]] bool is_actuated() const { return actuated_; }
  /// The first coordinate of the first node; the others follow, x before y.
  [[nodiscard]] Index first_dof() const { return first_dof_; }
  /// Where the entries of a node's own 2 x 2 block (lower triangle) and of the blocks below it, of
  /// the next node and of the one after, lie; column by column.
  using NodeSlots = std::array<Index, 3 + 4 + 4>;
  [[nodiscard]] const NodeSlots& slots(std::ptrdiff_t node) const {
    return slots_[static_cast<std::size_t>(node)];
  }

  /// Adds to `gradient` (all degrees of freedom).
  void add_gradient(const Model& model, const Configuration& here, Vector& gradient) const;
  /// Adds to `gradient` likewise, and the Hessian to the matrix's `values`.
  void add_gradient_and_hessian(const Model& model, const Configuration& here, Vector& gradient,
                                double* values) const;

  /// Adds likewise what the chains of several members give, each in its lane; `values` are not
  /// used where D is Gradient.
  template <Derivatives D, class T>
  void add_members(const PlanarChainConstants<T>& constants, const T* coordinates, T* gradient,
                   T* values) const;

 private:
  void map_nodes(const Model& model, const MatrixLayout& layout);
  template <Derivatives D>
  void add(const Model& model, const Configuration& here, Vector& gradient, double* values) const;

  ChainRange edges_;
  ChainRange bends_;
  bool actuated_ = false;  ///< whether the rest shape of any of them is
  bool tangent_ = false;   ///< bends_ are of TangentCurvature, not of AngleCurvature
  Index first_dof_ = 0;
  std::vector<NodeSlots> slots_;
};

}  // namespace der
