#pragma once

#include <optional>
#include <string>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// Looks for rods that pass through themselves or one another, which no contact prevents. A look
/// finds how far all that may meet is apart; the next one is due when nodes have moved by half of
/// that, and waits until the steps since the last one have cost far more than it does. Rods are
/// round, of the radius that they are drawn with; without one they can only cross in a plane. Left
/// out are parts of a rod that a bend of this radius could bring together, and the surroundings of
/// two places that overlap where the rods are drawn, or where the watch begins: joints, ends that
/// meet.
class CrossingMonitor {
 public:
  /// `start` is where the watch begins; null: nothing but the drawn shape is taken as given.
  /// `step_cost` is that of a step per node, against one of an implicit stepper of one stage in the
  /// spatial model.
  CrossingMonitor(const Model& model, const State* start, double step_cost);

  /// Looks if a look is due.
  void after_step(const Model& model, const State& state);
  /// Looks, unless something has been found.
  void look(const Model& model, const State& state);

  /// Where and when something was found first.
  struct Crossing {
    std::string first_rod, second_rod;  ///< the same of a rod that passes through itself
    double first_place = 0.0;           ///< rest arc length [m]
    double second_place = 0.0;
    double time = 0.0;         ///< [s]
    double load_factor = 1.0;  ///< of a path
  };
  [[nodiscard]] const std::optional<Crossing>& found() const { return found_; }

 private:
  /// A piece of a rod: an edge, or several up to the length of its radius.
  struct Piece {
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();
    Index rod = 0;
    double start = 0.0, end = 0.0;            // present arc length [m]
    double rest_start = 0.0, rest_end = 0.0;  // [m]
  };
  /// Two pieces, the places on them where their axes are nearest, and how far they are apart there.
  struct Pair {
    Index first = 0, second = 0;
    double first_share = 0.0, second_share = 0.0;
    double apart = 0.0;  // [m] between the axes
    double radii = 0.0;  // [m] sum of the two
  };

  /// Two places on rods, as rest arc lengths [m].
  struct Places {
    Index first_rod = 0, second_rod = 0;
    double first_place = 0.0, second_place = 0.0;
    bool operator<(const Places& other) const;
  };

  /// A box around the pieces of a range; those of its two halves come later in the list.
  struct Box {
    Vec3 low, high;
    Index first = 0, count = 0;  // pieces
    Index halves[2]{-1, -1};
  };

  void cut_into_pieces(const Model& model, const Vector& positions);
  void cut_rod(const Model& model, Index number, const Vector& positions);
  /// Returns the number of the box.
  Index put_into_boxes(Index first, Index count);
  /// Calls `take` with pairs of pieces that may meet: all whose axes are nearer than `limit` [m],
  /// which `take` may lower.
  template <class Take>
  void each_pair(const Model& model, const double& limit, Take&& take);
  template <class Take>
  void pairs_between(const Model& model, Index a, Index b, const double& limit, Take&& take);
  [[nodiscard]] double neighbourhood(const Model& model, Index rod) const;
  [[nodiscard]] bool can_meet(const Model& model, const Piece& a, const Piece& b) const;
  [[nodiscard]] Pair pair_of(const Model& model, Index a, Index b) const;
  [[nodiscard]] Places places_of(const Pair& pair) const;
  [[nodiscard]] bool is_left_out(const Model& model, const Pair& pair) const;
  [[nodiscard]] bool has_overlapped(const Model& model, const Pair& pair) const;
  [[nodiscard]] bool is_near_an_overlap(const Places& places, double near) const;

  std::vector<Places> overlaps_;  // at the start, sorted
  std::optional<Crossing> found_;
  Vector seen_;                 // positions at the last look [m]
  double clearance_ = 0.0;      // [m] then, between all that may meet; 0 before the first look
  double income_ = 0.0;         // work that a step pays for
  double credit_ = 0.0;         // work that the steps since have paid for
  double work_ = 0.0;           // of the last look
  double thickest_ = 0.0;       // [m] the largest radius
  double same_ = 0.0;           // [m] axes nearer than this cross
  std::vector<double> length_;  // of each rod now [m]
  std::vector<double> longest_edge_;  // of each rod at rest [m]
  std::vector<Piece> pieces_;
  std::vector<Box> boxes_;
};

/// Describes a crossing in sentences. `when` is its place in the run.
std::string describe(const CrossingMonitor::Crossing& crossing, const std::string& when);

}  // namespace der
