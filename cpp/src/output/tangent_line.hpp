#pragma once

#include <cstddef>
#include <vector>

#include "der/core/types.hpp"
#include "der/kinematics/actuated_turn.hpp"
#include "der/model/model.hpp"
#include "output/rod_field.hpp"

namespace der {

/// Where the direction of a rod is known, and how the direction at other places follows from that.
///
/// An edge has the direction of the tangent at one place (model/location.hpp), a clamp holds it at
/// its node. In between, and beyond the outermost of these knots, it is linear in the arc length
/// but for kinks, where a moment makes the curvature jump, and for the actuated turn on the way
/// from the knots. A corner as drawn parts the rod into legs, each with its own line; the direction
/// has two values there.
class TangentLine {
 public:
  struct Knot {
    double arc_length = 0.0;  ///< [m]
    Index edge = -1;          ///< number in the rod, those of a ring counted on; -1: a clamp
    Index clamp = -1;         ///< number in the rod; -1: an edge
    bool arrives = false;     ///< the clamp's leg: the one that arrives there, or leaves
  };
  /// Part of a knot or of a kink in the direction at a sample.
  struct Part {
    std::size_t number = 0;
    double factor = 0.0;
  };
  /// The turns that actuations make along an edge on the way from the knots.
  struct Turn {
    Index edge = 0;  ///< number in the rod
    ActuatedTurn actuated;
  };
  /// A place along the rod: the direction there is the sum of its parts of the knots' directions,
  /// of the kinks' jumps of curvature [m] and of actuated turns.
  struct Sample {
    double arc_length = 0.0;  ///< [m]
    std::vector<Part> knots;
    std::vector<Part> kinks;
    std::vector<Turn> turns;
    bool smooth = true;
  };

  /// `kinks`: arc lengths [m] at which the curvature jumps.
  TangentLine(const RodMesh& rod, std::vector<double> kinks, const Model& model);

  [[nodiscard]] const std::vector<Knot>& knots() const { return knots_; }
  [[nodiscard]] const std::vector<Sample>& samples() const { return samples_; }
  /// Whether actuations bend the rod.
  [[nodiscard]] bool is_actuated() const { return is_actuated_; }
  /// The actuated turn by which the direction at a place, the weighted sum of those of samples,
  /// differs from that sum.
  [[nodiscard]] Turn turn_between(const SampleWeights& weights) const;

 private:
  /// The knots of a leg stand in a row.
  struct Leg {
    double from = 0.0, to = 0.0;  // [m]
    std::size_t first = 0, last = 0;
  };
  void find_knots(const Model& model);
  void add_sample(double s, const Leg& leg, bool smooth);
  void add_turns(Sample& sample) const;

  RodMesh rod_;
  bool is_actuated_;
  std::vector<Knot> knots_;
  std::vector<Leg> legs_;
  std::vector<double> kinks_;
  std::vector<Sample> samples_;
};

}  // namespace der
