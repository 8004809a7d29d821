#pragma once

#include <array>
#include <string>
#include <vector>

#include "der/assembly/assembler.hpp"
#include "der/assembly/pattern.hpp"
#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/model/model.hpp"

namespace der {

/// The share of the stable step that `step: auto` takes and that messages suggest: a rod that is
/// compressed or bent gets stiffer between two evaluations.
constexpr double kStepMargin = 0.9;

/// The largest step of the explicit steppers, and what sets it.
struct StableStep {
  double step = 0.0;  ///< [s]; infinite where nothing limits it
  /// "stretch", "bend", "spring", "drag", "internal damping" or "nothing"
  std::string limited_by;
  Index worst_dof = -1;  ///< full degree of freedom with the fastest motion of that kind
};

/// Bound from the stiffness at some shape. A mode of frequency w and damping rate g stays bounded
/// under explicit Euler's scheme while dt^2 w^2 + 2 dt g <= 4 (both roots of its characteristic
/// polynomial inside the unit circle), under Verlet's, which takes drag implicitly, while
/// dt w <= 2; with internal damping of the rate g, of which it takes a predictor and a corrector,
/// under the first condition. w^2, and g likewise, is bounded by the theorem of Gershgorin for the
/// blocks of D^-1/2 K D^-1/2 (Feingold and Varga, Pacific J. Math. 12, 1962), D a diagonal below
/// the mass: the largest sum of the spectral norms of a node's blocks. So the step is safe,
/// invariant under rotation, and on a uniform chain close to the true limit.
class StableStepBound {
 public:
  StableStepBound(const Model& model, bool drag_limits_step);

  /// [s], infinite where nothing limits it, 0 where an edge has no length. Allocates nothing.
  double evaluate(const Configuration& here);
  /// As `evaluate`, with what sets it.
  StableStep explain(const Configuration& here);

 private:
  /// Degrees of freedom of a node: its position, and the angle of the edge that begins there.
  static constexpr Index kLargest = 4;
  /// The entries that couple two nodes, or a node with itself.
  struct Block {
    Index row = 0;  // nodes
    Index column = 0;
    std::array<Index, kLargest * kLargest> slots{};   // in the values, row by row
    std::array<double, kLargest * kLargest> scale{};  // of D^-1/2 on both sides
  };

  void find_blocks();
  double largest_sum();
  /// Place of a degree of freedom among those of its node.
  [[nodiscard]] Index place_in_block(Index dof) const;
  [[nodiscard]] double term_bound(EnergyTerm term, Index node, const Configuration& here) const;

  const Model& model_;
  Pattern pattern_;
  MatrixLayout layout_;
  Assembler assembler_;
  Vector inverse_root_mass_;  // D^-1/2
  Index block_size_ = 2;
  std::vector<Block> blocks_;
  double damping_rate_ = 0.0;  // the greatest [1/s]
  Index most_damped_ = -1;
  double viscous_rate_ = 0.0;  // of internal damping, at the last shape [1/s]
  Index most_viscous_ = 0;     // its node
  Vector gradient_;
  Vector values_;
  Vector sums_;  // over each node's blocks [1/s^2], [1/s]
};

/// At the start of a run, with the tables at time 0.
StableStep stable_step(const Model& model, const Vector& positions, bool drag_limits_step);

/// "the stable step of verlet, 1e-5 s, which bend at node 3 of rod 'arm' (y) sets"
std::string describe_stable_step(const StableStep& stable, const std::string& integrator,
                                 const Model& model);

}  // namespace der
