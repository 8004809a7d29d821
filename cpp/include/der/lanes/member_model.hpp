#pragma once

#include <array>
#include <vector>

#include "der/assembly/member_lanes.hpp"
#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der {

/// The numbers of several members' models, besides their elements. They have one structure and suit
/// lanes (`suits_lanes`).
template <class T>
struct MemberModel {
  explicit MemberModel(const MemberModels<T>& members);

  /// Degrees of freedom of one kind (DofBlock).
  struct Block {
    Index first = 0;
    Index count = 0;
    T length = 1.0;
    std::vector<Index> free;
  };

  MemberModels<T> models;
  T size = 1.0;  ///< Model::size [m]
  std::vector<Block> blocks;
  MemberVector<T> lumped;              ///< [kg]
  MemberVector<T> coupling;            ///< mass of each coupling [kg]
  MemberVector<T> damping;             ///< [N s/m]
  MemberVector<T> gravity_force;       ///< [N]
  MemberVector<T> dead_force;          ///< [N]
  MemberVector<T> held_places;         ///< of each held degree of freedom, at first [m]
  MemberVector<T> per_squared_length;  ///< of each edge [1/m^2]

  /// The model of the first member, for all that is the same in all.
  [[nodiscard]] const Model& structure() const { return *models[0]; }
  [[nodiscard]] Index num_dofs() const { return structure().num_dofs(); }
  /// DofMap::largest_motion, ::largest_force and ::largest_free_force.
  [[nodiscard]] T largest_motion(const MemberVector<T>& displacement) const;
  [[nodiscard]] T largest_force(const MemberVector<T>& force) const;
  [[nodiscard]] T largest_free_force(const MemberVector<T>& force) const;
  /// `largest_edge_change` (model/edge_change.hpp).
  [[nodiscard]] T largest_edge_change(const MemberVector<T>& displacement) const;
};

/// Whether members with such a model can be stepped in lanes: open rods, without actuations,
/// moments, clamps that turn, and whatever else turns with the rod or counts its turns.
bool suits_lanes(const Model& model);

}  // namespace der
