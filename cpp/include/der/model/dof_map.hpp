#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "der/core/index.hpp"
#include "der/core/magnitude.hpp"
#include "der/core/types.hpp"

namespace der {

enum class DofKind {
  Position,  ///< a component of a node's position [m]
  Angle,     ///< the angle of an edge's material frame [rad]
  /// The rotation of a joint from the initial shape [rad]; in space one of its three coordinates
  /// (kinematics/joint_turn.hpp).
  Rotation,
};

/// Identifies a degree of freedom: a component of a node's position, the angle of an edge, or the
/// rotation of a joint.
struct Dof {
  DofKind kind = DofKind::Position;
  Index owner = 0;    ///< the node, the edge, or the number of the rotation
  int component = 0;  ///< of a position, or of a rotation in space: 0 x, 1 y, 2 z
};

/// Degrees of freedom of one kind, which are contiguous in storage.
struct DofBlock {
  DofKind kind = DofKind::Position;
  Index first = 0;
  Index count = 0;
  double length = 1.0;  ///< [m] that a unit of it counts as where degrees of freedom are compared
};

/// The largest of `value(block)`; NaN if one of them is NaN.
template <class Value>
double largest_over(const std::vector<DofBlock>& blocks, const Value& value) {
  std::int64_t largest = 0;
  for (const DofBlock& block : blocks) largest = std::max(largest, magnitude_bits(value(block)));
  return magnitude_of(largest);
}

/// The only place that knows how degrees of freedom are numbered: what each one is, where it is
/// stored, in which order the solver eliminates it, and what it counts for in a norm.
///
/// The positions of all nodes are stored first, then the angles of all edges, then the rotations of
/// all joints, so that each of the three is one contiguous view. Those that the solver finds, the
/// free ones, are eliminated node by node, an angle after the node at which its edge begins and a
/// rotation after the node of its joint: that makes the matrix a band.
/// The first node of a ring is eliminated after all of its others, next to the last one: what
/// couples the ring's end with its start is then in the rows of a few last degrees of freedom.
class DofMap {
 public:
  DofMap() = default;
  /// `edge_starts`: the first node of each edge that has an angle. `rotation_nodes`: the node of
  /// each rotation of a joint, in space three times. All are free at first.
  DofMap(int dimension, Index num_nodes, std::vector<Index> edge_starts = {},
         std::vector<Index> rotation_nodes = {});

  [[nodiscard]] Index size() const { return num_positions() + num_angles() + num_rotations(); }
  [[nodiscard]] Index num_positions() const { return dimension_ * num_nodes_; }
  [[nodiscard]] Index num_angles() const { return static_cast<Index>(starts_.size()); }
  [[nodiscard]] Index num_rotations() const { return static_cast<Index>(rotation_nodes_.size()); }
  [[nodiscard]] Index position(Index node, int component) const {
    return dimension_ * node + component;
  }
  [[nodiscard]] Index angle(Index edge) const { return num_positions() + edge; }
  [[nodiscard]] Index rotation(Index number) const {
    return num_positions() + num_angles() + number;
  }
  /// The kind, owner and component of a degree of freedom.
  [[nodiscard]] Dof operator[](Index dof) const;
  /// Its node, that of its joint, or the one at which its edge begins.
  [[nodiscard]] Index node_of(Index dof) const;

  /// Says that these are the nodes of a ring. Where it shares some with rods before it, they do not
  /// follow one another, and their order stays.
  void close(const std::vector<Index>& nodes);
  /// Marks the `held` ones as prescribed by supports and renumbers the free ones.
  void hold(const std::vector<Index>& held);
  /// All free ones, in the order of elimination.
  [[nodiscard]] const std::vector<Index>& free() const { return free_; }
  [[nodiscard]] Index num_free() const { return static_cast<Index>(free_.size()); }
  /// Place in the order of elimination; -1: held.
  [[nodiscard]] Index free_index(Index dof) const { return free_index_[to_size(dof)]; }
  [[nodiscard]] bool is_free(Index dof) const { return free_index(dof) >= 0; }

  /// Sets the characteristic length [m] of the model, which a radian counts as.
  void set_length(double length);
  [[nodiscard]] double length() const { return length_; }
  /// Magnitude [m] that a motion of one degree of freedom counts as.
  [[nodiscard]] double motion_of(Index dof, double motion) const {
    return std::abs(motion) * (dof < num_positions() ? 1.0 : length_);
  }
  /// Magnitude [N] that a force or moment on one degree of freedom counts as.
  [[nodiscard]] double force_of(Index dof, double force) const {
    return std::abs(force) / (dof < num_positions() ? 1.0 : length_);
  }
  /// Mass [kg] or moment of inertia [kg m^2] with which motions of the same magnitude weigh the
  /// same in every degree of freedom: 1 for positions.
  [[nodiscard]] double unit_mass(Index dof) const {
    return dof < num_positions() ? 1.0 : length_ * length_;
  }
  /// That of all degrees of freedom.
  [[nodiscard]] Vector unit_masses() const;
  [[nodiscard]] const std::vector<DofBlock>& blocks() const { return blocks_; }

  /// Largest motion [m] among displacements of all degrees of freedom: angles count times the
  /// length. NaN if one of them is NaN.
  [[nodiscard]] double largest_motion(const Vector& displacement) const;
  /// The degree of freedom with the largest motion; the first that is not a number.
  [[nodiscard]] Index most_moved(const Vector& displacement) const;
  /// Largest force [N] among those on all degrees of freedom: moments count over the length.
  [[nodiscard]] double largest_force(const Vector& force) const;
  /// Largest force [N] among those on free degrees of freedom alone.
  [[nodiscard]] double largest_free_force(const Vector& force) const;

 private:
  struct Ring {
    Index first_node = 0;
    Index last_node = 0;
  };

  void number_free();

  int dimension_ = 2;
  double length_ = 1.0;
  Index num_nodes_ = 0;
  std::vector<Index> starts_;  // of the edges that have an angle
  std::vector<Index> rotation_nodes_;
  std::vector<Ring> rings_;
  std::vector<DofBlock> blocks_;
  std::vector<Index> free_;
  std::vector<Index> free_index_;
  CountMask counts_;  // the free ones
};

}  // namespace der
