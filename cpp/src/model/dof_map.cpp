#include "der/model/dof_map.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace der {

DofMap::DofMap(int dimension, Index num_nodes, std::vector<Index> edge_starts)
    : dimension_(dimension), num_nodes_(num_nodes), starts_(std::move(edge_starts)) {
  blocks_.push_back({DofKind::Position, 0, num_positions(), 1.0});
  if (!starts_.empty()) {
    blocks_.push_back({DofKind::Angle, num_positions(), static_cast<Index>(starts_.size()), 1.0});
  }
  free_index_.assign(to_size(size()), 0);
  number_free();
}

Dof DofMap::operator[](Index dof) const {
  if (dof >= num_positions()) return {DofKind::Angle, dof - num_positions(), 0};
  return {DofKind::Position, dof / dimension_, dof % dimension_};
}

Index DofMap::node_of(Index dof) const {
  const Dof what = (*this)[dof];
  return what.kind == DofKind::Position ? what.owner : starts_[to_size(what.owner)];
}

void DofMap::close(Index first_node, Index last_node) {
  rings_.push_back({first_node, last_node});
  number_free();
}

/// Its node; that of the first node of a ring is the last one.
Index DofMap::eliminated_with(Index dof) const {
  const Index node = node_of(dof);
  if (dof >= num_positions()) return node;
  for (const Ring& ring : rings_) {
    if (node == ring.first_node) return ring.last_node;
  }
  return node;
}

void DofMap::hold(const std::vector<Index>& held) {
  for (const Index dof : held) free_index_[to_size(dof)] = -1;
  number_free();
}

void DofMap::number_free() {
  counts_.setZero(size());
  // Positions of a node come before the angles of edges that begin there, as they do in storage.
  std::vector<std::tuple<Index, bool, Index>> ranked;
  ranked.reserve(to_size(size()));
  for (Index dof = 0; dof < size(); ++dof) {
    if (!is_free(dof)) continue;
    const Index node = eliminated_with(dof);
    ranked.emplace_back(node, node != node_of(dof), dof);
    counts_[dof] = kCounts;
  }
  std::sort(ranked.begin(), ranked.end());
  free_.resize(ranked.size());
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    free_[i] = std::get<2>(ranked[i]);
    free_index_[to_size(free_[i])] = static_cast<Index>(i);
  }
}

void DofMap::set_length(double length) {
  length_ = length;
  for (DofBlock& block : blocks_) {
    if (block.kind == DofKind::Angle) block.length = length;
  }
}

Vector DofMap::unit_masses() const {
  return Vector::NullaryExpr(size(), [this](Index dof) { return unit_mass(dof); });
}

double DofMap::largest_motion(const Vector& displacement) const {
  return largest_over(blocks_, [&](const DofBlock& block) {
    return block.length * largest_magnitude(block.count, displacement.data() + block.first);
  });
}

Index DofMap::most_moved(const Vector& displacement) const {
  Index most = 0;
  std::int64_t largest = -1;
  for (Index dof = 0; dof < size(); ++dof) {
    const std::int64_t here = magnitude_bits(motion_of(dof, displacement[dof]));
    if (here <= largest) continue;
    largest = here;
    most = dof;
  }
  return most;
}

double DofMap::largest_force(const Vector& force) const {
  return largest_over(blocks_, [&](const DofBlock& block) {
    return largest_magnitude(block.count, force.data() + block.first) / block.length;
  });
}

double DofMap::largest_free_force(const Vector& force) const {
  return largest_over(blocks_, [&](const DofBlock& block) {
    return largest_magnitude(block.count, force.data() + block.first,
                             counts_.data() + block.first) /
           block.length;
  });
}

}  // namespace der
