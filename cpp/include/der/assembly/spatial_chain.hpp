#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "der/assembly/chain_run.hpp"
#include "der/assembly/lane_spans.hpp"
#include "der/assembly/pattern.hpp"
#include "der/core/types.hpp"
#include "der/energies/isotropic_bend.hpp"
#include "der/energies/local_term.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/energies/stretch.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"

namespace der {

/// PlanarChain in space: a run of plain stretch elements with the bend elements between them,
/// assembled by edges. Frame terms that the energies of an edge's two joints share are worked out
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

  /// Adds to `gradient` (all degrees of freedom).
  void add_gradient(const Model& model, const Configuration& here, Vector& gradient) const;
  /// Adds to `gradient` likewise, and the Hessian to the matrix's `values`.
  void add_gradient_and_hessian(const Model& model, const Configuration& here, Vector& gradient,
                                double* values) const;

 private:
  enum class Kind { SectionAngle, SectionTangent, IsotropicAngle, IsotropicTangent };
  /// Entries of a node's own block (lower triangle; its position, then the angle of the edge that
  /// begins there), of the block of the next node below it, and of the position of the node after
  /// that: column by column. Without angles some are not used.
  using NodeSlots = std::array<Index, 10 + 16 + 12>;
  struct Totals {
    Vector& gradient;
    double* values;
  };

  void map_nodes(const Model& model, const MatrixLayout& layout);
  template <Derivatives D>
  void add(const Model& model, const Configuration& here, Vector& gradient, double* values) const;
  template <Derivatives D, template <class, class> class Terms, class Curvature>
  void add_measured(const Model& model, const Configuration& here, const Totals& totals) const;
  template <Derivatives D, class Terms>
  void add_in(const LaneSpans<typename Terms::Number>& spans, const Model& model,
              const Configuration& here, const Totals& totals) const;

  Kind kind_ = Kind::SectionAngle;
  ChainRange edges_;
  ChainRange bends_;
  bool actuated_ = false;   ///< whether the rest shape of any of them is
  Index first_dof_ = 0;     ///< of the first node; the others follow
  Index first_theta_ = -1;  ///< of the first edge; the others follow; -1: there are no angles
  std::vector<NodeSlots> slots_;
};

}  // namespace der
