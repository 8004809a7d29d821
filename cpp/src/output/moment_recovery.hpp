#pragma once

#include <array>
#include <optional>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/location.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "output/spread_forces.hpp"
#include "output/spread_moments.hpp"

namespace der {

/// Makes the bending moment of a rod out of that of its chain.
///
/// The chain's moment at a node is that of the loads beyond it as they are spread over nodes and
/// edges: a moment over two edges, a point force between nodes over up to six nodes
/// (docs/mechanics.md). Spread and true load have the same resultants, so that the two moments
/// differ next to the load alone: by what the true loads beyond a place give more than the spread
/// ones, in the deformed shape. That is of order 0 for moments and of order 1 for forces; without
/// it curvature and moment would be wrong next to each load.
///
/// Along an edge the moment is the sum of a straight line, given by `smooth` at both its ends, and
/// of a correction for the loads inside the edge, `inside`. Moments are vectors in space, exerted
/// by what is beyond a place on what is before it; in a plane they are along z.
class MomentRecovery {
 public:
  MomentRecovery(const RodMesh& rod, const Model& model);

  /// Where along an edge a value is: a load at that very place is before it or beyond it.
  struct Place {
    double arc_length = 0.0;  ///< [m]
    bool loads_here_are_beyond = false;
  };
  /// A place inside an edge at which the moment or the natural curvature has a kink, or jumps.
  struct Break {
    double arc_length = 0.0;  ///< [m]
    bool jumps = false;
  };

  /// Difference [N m] between the straight line and the chain's moment at a point of an edge: at
  /// its first end (`last` false) or its last one.
  [[nodiscard]] Vec3 smooth(Index edge, bool last, const Vec3& point, const Model& model,
                            const State& state) const;
  /// Correction [N m] of the straight line at a place of an edge.
  [[nodiscard]] Vec3 inside(Index edge, const Place& place, const Model& model,
                            const State& state) const;
  /// Where along an edge a point is, as a share of the edge. A clamp's pivot does not move as the
  /// edge stretches: it is then at another section of the rod than as drawn.
  [[nodiscard]] double share_of(Index edge, const Vec3& point, const State& state) const;
  /// By which share of its edge the section at arc length `s` [m] is further on than on an edge
  /// that stretches evenly. Where a force between nodes stands the strain jumps, and the chain's
  /// nodes beside it are where the spread force pulls them.
  [[nodiscard]] double displaced(Index edge, double s, const Model& model,
                                 const State& state) const;
  /// Moment [N m] at the start or the end of the rod, which are not clamped.
  [[nodiscard]] Vec3 at_end(bool last, const Model& model, const State& state) const;

  /// The moment [N m] that an edge next to an end takes beyond the whole of the moments on it.
  [[nodiscard]] Vec3 excess(Index edge, const Model& model, const State& state) const;
  /// Whether moments of loads and springs make a difference on an edge.
  [[nodiscard]] bool has_moments(Index edge) const {
    return !edges_[static_cast<std::size_t>(edge)].moments.empty();
  }

  /// Inside an edge, in the order of the arc length.
  [[nodiscard]] std::vector<Break> breaks(Index edge) const;
  /// Whether the moment, its components or the curvature jump at a node: at an inner clamp, at a
  /// moment, at a corner, and where the drawn curvature jumps.
  [[nodiscard]] bool jumps_at(Index node) const;
  /// Whether a place is a corner (model/corner.hpp).
  [[nodiscard]] bool is_corner(Index place) const {
    return corners_[static_cast<std::size_t>(rod_.position(place))];
  }
  /// Whether a leg of the rod ends at a place: at a corner, or where the drawn curvature jumps.
  [[nodiscard]] bool bounds_legs(Index place) const {
    return bounds_[static_cast<std::size_t>(rod_.position(place))];
  }
  /// Whether a force at a node, of a load or a support, may give the moment a kink there.
  [[nodiscard]] bool has_kink_at(Index node) const {
    return rod_.bears_force[static_cast<std::size_t>(rod_.position(node))];
  }

 private:
  enum class Where { Before, Inside, Beyond };  // of a load, as seen from an edge

  /// Factors of a moment, and of what its edges take of it.
  struct MomentFactors {
    double whole = 0.0;
    std::array<double, 2> on_edge{};

    [[nodiscard]] Vec3 times(const EdgeMoments& moment) const {
      return whole * moment.whole + on_edge[0] * moment.on_edge[0] + on_edge[1] * moment.on_edge[1];
    }
  };
  /// How the moment at a place enters an edge.
  struct MomentTerm {
    std::size_t number = 0;  // in `moments_`
    double arc_length = 0.0;
    bool inside = false;
    MomentFactors first, last;         // of `smooth`
    int own = -1;                      // which edge of the moment this one is; -1: none
    double before = 0.0, after = 0.0;  // of `inside`, on either side of the place
  };
  /// How a force between nodes enters an edge whose ends part its nodes.
  struct ForceTerm {
    std::size_t place = 0;  // in `forces_`
    Where where = Where::Inside;
    double sign = 1.0;            // -1: counted by what stands before the edge
    std::vector<Weighted> nodes;  // on that side
  };
  struct EdgeTerms {
    std::vector<MomentTerm> moments;
    std::vector<ForceTerm> forces;
  };

  [[nodiscard]] Where where_is(double s, Index edge) const;
  [[nodiscard]] Vec3 edge_vector(Index edge, const State& state) const;
  [[nodiscard]] double kink(const SpreadForces::Force& force, double s) const;
  void add_moments(Index edge, Index turns, std::optional<Index> start, std::optional<Index> end);
  void add_forces(Index edge, std::optional<Index> start, std::optional<Index> end);
  [[nodiscard]] bool is_same_place(double a, double b) const;

  RodMesh rod_;
  SpreadForces forces_;
  SpreadMoments moments_;
  std::vector<EdgeTerms> edges_;
  std::vector<bool> corners_;  // for each node
  std::vector<bool> bounds_;   // for each node, of legs
};

}  // namespace der
