#pragma once

#include <vector>

#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"

namespace der {

namespace scenario {
struct Scene;
}

/// A planar scene in space with x and y of all nodes held, so that its free degrees of freedom are
/// z of the nodes and the angles of the sections. At a planar shape the energy in space is even in
/// these: its Hessian splits into a block of the plane and this one.
///
/// Supports of the plane hold the rods out of it, too: a clamp holds the tangent and the
/// section (or the tangent alone, as the scene says), and every other support, springs included,
/// holds z of its node and the section against turning about the rod, as a fork does, at a corner
/// about the mean of its two tangents. Loads act on
/// the centre line, and forces of a constant direction in the plane, springs and foundations
/// change nothing in this block.
struct OutOfPlaneModel {
  /// The tangent of a rod at a place lies between the directions of two edges, or beyond both.
  struct Tangent {
    Index edge = 0;
    Index neighbour = 0;  ///< the edge itself: the tangent has its direction
    double share = 0.0;   ///< of the turn from the edge to its neighbour
    /// Angle [rad] by which the tangent as drawn lies beyond that, where the drawn curvature jumps.
    double lean = 0.0;

    /// Angle [rad] from the x axis; `values` begin with the blocks of all edges.
    [[nodiscard]] double direction(const Vector& values) const;
  };
  /// The axis about which a fork holds a section: the mean of the tangents on its two sides, which
  /// are the same but at corners.
  struct ForkAxis {
    Tangent before;
    Tangent after;
    Index control = 0;  ///< its angle from the x axis [rad]

    [[nodiscard]] double direction(const Vector& values) const;
  };
  /// A table of an actuation, which follows that of the planar model.
  struct Follower {
    Index planar = 0;     ///< its control
    Index control = 0;    ///< that of this model
    double factor = 1.0;  ///< of the planar value
  };
  Model model;
  std::vector<ForkAxis> forks;
  std::vector<Follower> actuations;

  /// The shape and the controls of the planar model in this one. Frames are those of the edges as
  /// they lie there.
  [[nodiscard]] Configuration at(const Model& planar, const Configuration& here) const;
};

/// `planar` is the model of `scene`, in which at least one node or section is not held by supports
/// in this sense, and the stiffness against twisting of every rod that bends is known.
OutOfPlaneModel build_out_of_plane_model(const scenario::Scene& scene, const Model& planar);

/// Whether supports hold every node, and no section can twist.
bool is_held_out_of_plane(const scenario::Scene& scene, const Model& planar);

}  // namespace der
