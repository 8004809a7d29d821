#include "der/model/dof_map.hpp"

#include <algorithm>
#include <utility>

namespace der {

DofMap::DofMap(int dimension, Index num_nodes, std::vector<Index> edge_starts,
               std::vector<Index> rotation_nodes)
    : dimension_(dimension),
      num_nodes_(num_nodes),
      starts_(std::move(edge_starts)),
      rotation_nodes_(std::move(rotation_nodes)) {
  blocks_.push_back({DofKind::Position, 0, num_positions(), 1.0});
  if (num_angles() > 0) blocks_.push_back({DofKind::Angle, angle(0), num_angles(), 1.0});
  if (num_rotations() > 0) {
    blocks_.push_back({DofKind::Rotation, rotation(0), num_rotations(), 1.0});
  }
  free_index_.assign(to_size(size()), 0);
  number_free();
}

Dof DofMap::operator[](Index dof) const {
  if (dof >= rotation(0)) {
    const Index number = dof - rotation(0);
    return {DofKind::Rotation, number, dimension_ == 3 ? number % 3 : 0};
  }
  if (dof >= num_positions()) return {DofKind::Angle, dof - num_positions(), 0};
  return {DofKind::Position, dof / dimension_, dof % dimension_};
}

Index DofMap::node_of(Index dof) const {
  const Dof what = (*this)[dof];
  if (what.kind == DofKind::Rotation) return rotation_nodes_[to_size(what.owner)];
  return what.kind == DofKind::Position ? what.owner : starts_[to_size(what.owner)];
}

void DofMap::close(const std::vector<Index>& nodes) {
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    if (nodes[i] != nodes[i - 1] + 1) return;
  }
  rings_.push_back({nodes.front(), nodes.back()});
  number_free();
}

void DofMap::hold(const std::vector<Index>& held) {
  for (const Index dof : held) free_index_[to_size(dof)] = -1;
  number_free();
}

void DofMap::number_free() {
  counts_.setZero(size());
  free_.clear();
  free_.reserve(to_size(size()));
  const auto number = [this](Index dof) {
    if (!is_free(dof)) return;
    counts_[dof] = kCounts;
    free_index_[to_size(dof)] = num_free();
    free_.push_back(dof);
  };
  const auto number_positions = [&](Index node) {
    for (int c = 0; c < dimension_; ++c) number(position(node, c));
  };
  std::vector<std::vector<Index>> rotations(to_size(num_nodes_));
  for (Index i = 0; i < num_rotations(); ++i) {
    rotations[to_size(rotation_nodes_[to_size(i)])].push_back(rotation(i));
  }
  std::vector<std::vector<Index>> angles(to_size(num_nodes_));
  for (Index i = 0; i < num_angles(); ++i) angles[to_size(starts_[to_size(i)])].push_back(angle(i));
  const auto number_node = [&](Index node) {
    number_positions(node);
    for (const Index dof : rotations[to_size(node)]) number(dof);
  };
  for (Index node = 0; node < num_nodes_; ++node) {
    const auto begins = [node](const Ring& ring) { return ring.first_node == node; };
    if (std::none_of(rings_.begin(), rings_.end(), begins)) number_node(node);
    for (const Index dof : angles[to_size(node)]) number(dof);
    for (const Ring& ring : rings_) {
      if (ring.last_node == node) number_node(ring.first_node);
    }
  }
}

void DofMap::set_length(double length) {
  length_ = length;
  for (DofBlock& block : blocks_) {
    if (block.kind != DofKind::Position) block.length = length;
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
