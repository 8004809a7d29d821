#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "der/assembly/chain_run.hpp"
#include "der/assembly/member_lanes.hpp"
#include "der/assembly/pattern.hpp"
#include "der/core/types.hpp"
#include "der/energies/isotropic_bend.hpp"
#include "der/energies/local_term.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/energies/stretch.hpp"
#include "der/energies/vertex_response.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"

namespace der {

/// The constants of a SpatialChain in the models of several members.
template <class T>
struct SpatialChainConstants {
  MemberVector<T> EA;                 ///< of each edge [N]
  MemberVector<T> rest_length;        ///< of each edge [m]
  std::vector<VertexOf<T>> vertices;  ///< where sections count
  std::vector<T> bend_stiffness;      ///< of each vertex, over its length [N m], where they do not
};

/// PlanarChain in space: a run of plain stretch elements with the bend elements between them,
/// assembled by edges. Frame terms that the energies of an edge's two vertices share are worked out
/// once, and blocks of edges are differenced into those of nodes. The sums equal those of the
/// kernels Stretch<3> and SpatialBend or IsotropicBend to rounding.
class SpatialChain {
 public:
  /// All runs of a model that are at least two edges long.
  static std::vector<SpatialChain> find(const Model& model, const MatrixLayout& layout);

  /// The elements of one kernel that the chain assembles.
  template <class Kernel>
  [[nodiscard]] ChainRange range_of() const {
    if constexpr (std::is_same_v<Kernel, Stretch<3>>) return edges_;
    const bool is_bend =
        (std::is_same_v<Kernel, SpatialBend<AngleCurvature>> && kind_ == Kind::SectionAngle) ||
        (std::is_same_v<Kernel, SpatialBend<TangentCurvature>> && kind_ == Kind::SectionTangent) ||
        (std::is_same_v<Kernel, IsotropicBend<AngleCurvature>> && kind_ == Kind::IsotropicAngle) ||
        (std::is_same_v<Kernel, IsotropicBend<TangentCurvature>> &&
         kind_ == Kind::IsotropicTangent);
    return is_bend ? bends_ : ChainRange{};
  }

  /// The constants of the chain in the lanes of several models of one structure, whose rest shapes
  /// are not actuated.
  template <class T>
  [[nodiscard]] SpatialChainConstants<T> constants_of(const MemberModels<T>& models) const;

  [[nodiscard]] ChainRange edges() const { return edges_; }
  [[nodiscard]] ChainRange bends() const { return bends_; }
  [[nodiscard]] bool is_actuated() const { return actuated_; }
  /// The first coordinate of the first node; the others follow.
  [[nodiscard]] Index first_dof() const { return first_dof_; }
  /// The angle of the first edge; the others follow. -1: there are no angles.
  [[nodiscard]] Index first_theta() const { return first_theta_; }
  /// Entry of the controls where the FrameBlock of the first edge begins; the others follow.
  [[nodiscard]] Index first_frame() const { return first_frame_; }
  /// Where the entries of a node's own block (lower triangle; its position, then the angle of the
  /// edge that begins there), of the block of the next node below it, and of the position of the
  /// node after that lie: column by column. Without angles some are not used.
  using NodeSlots = std::array<Index, 10 + 16 + 12>;
  [[nodiscard]] const NodeSlots& slots(std::ptrdiff_t node) const {
    return slots_[static_cast<std::size_t>(node)];
  }
  /// Calls use(slot, row, column) for the lower triangle of the position of the last node.
  template <class Use>
  void for_each_end_slot(const Use& use) const {
    const int size = first_theta_ < 0 ? 3 : 4;
    const Index* slot = slots_.back().data();
    for (int column = 0; column < 3; ++column) {
      for (int row = column; row < 3; ++row) use(slot[row - column], row, column);
      slot += (size - column) + size + 3;
    }
  }

  /// Adds to `gradient` (all degrees of freedom).
  void add_gradient(const Model& model, const Configuration& here, Vector& gradient) const;
  /// Adds to `gradient` likewise, and the Hessian to the matrix's `values`.
  void add_gradient_and_hessian(const Model& model, const Configuration& here, Vector& gradient,
                                double* values) const;

  /// Adds likewise what the chains of several members give, each in its lane; `frames` are the
  /// blocks of all edges (FrameBlock), and `values` are not used where D is Gradient.
  template <Derivatives D, class T>
  void add_members(const SpatialChainConstants<T>& constants, const T* coordinates, const T* frames,
                   T* gradient, T* values) const;

 private:
  enum class Kind { SectionAngle, SectionTangent, IsotropicAngle, IsotropicTangent };

  void map_nodes(const Model& model, const MatrixLayout& layout);
  template <class T, class Work>
  void with_terms(const Work& work) const;
  template <Derivatives D>
  void add(const Model& model, const Configuration& here, Vector& gradient, double* values) const;

  Kind kind_ = Kind::SectionAngle;
  ChainRange edges_;
  ChainRange bends_;
  bool actuated_ = false;  ///< whether the rest shape of any of them is
  Index first_dof_ = 0;
  Index first_theta_ = -1;
  Index first_frame_ = -1;
  std::vector<NodeSlots> slots_;
};

}  // namespace der
