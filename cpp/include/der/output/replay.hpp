#pragma once

#include <optional>
#include <string>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/output/actuation_forces.hpp"
#include "der/output/reactions.hpp"
#include "der/scenario/reader.hpp"

namespace der {

/// One frame a row.
using FrameTable = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A quantity along a rod at every frame.
struct RodSeries {
  std::vector<double> arc_length;  ///< [m] of each sample, ascending; none if there is no sample
  FrameTable values;               ///< frames x samples
};

/// Reactions of the supports at every frame.
struct ReactionSeries {
  std::vector<Reaction> places;  ///< of the last frame; the tables follow them
  FrameTable points;             ///< frames x (places * 3) [m]
  FrameTable forces;             ///< frames x (places * 3) [N]
  FrameTable moments;            ///< frames x (places * 3) [N m]
};

/// Forces and moments that actuations exert at every frame.
struct ActuationForceSeries {
  std::vector<ActuationForce> actuations;  ///< of the last frame; the table follows them
  FrameTable values;                       ///< frames x (actuations * 2) [N m] or [N]
};

/// The saved frames of a run: tables with one frame a row.
struct SavedFrames {
  Eigen::Ref<const FrameTable> positions;       ///< frames x (nodes * dimension) [m]
  Eigen::Ref<const FrameTable> velocities;      ///< frames x (nodes * dimension) [m/s]
  Eigen::Ref<const FrameTable> theta;           ///< frames x edges [rad]; x 0 without sections
  Eigen::Ref<const FrameTable> section_frames;  ///< frames x (edges * FrameBlock::kSize)
  Eigen::Ref<const FrameTable> turns;           ///< frames x followed edges [rad]
};

/// Goes through the frames of a run that is over, to read off them what was not saved. Supports
/// stand as the scene has them, not as `Simulation::prescribe` may have moved them. Whole turns of
/// planar rods that the run did not follow are followed from frame to frame, the shorter way.
class Replay {
 public:
  /// `instants` tells what each frame is of: a time [s], or, `on_path`, the factor of a point on
  /// the scene's continuation. Throws SceneError or Error where no model can be built, and where
  /// the scene has no continuation to be on.
  Replay(Scenario scenario, std::vector<double> instants, bool on_path);

  [[nodiscard]] std::size_t num_frames() const { return instants_.size(); }
  [[nodiscard]] const Scenario& scenario() const { return scenario_; }
  [[nodiscard]] const Model& model() const { return model_; }
  /// Its time, or its load factor, is that of the frame shown last.
  [[nodiscard]] const State& state() const { return state_; }

  /// Puts loads and supports to a frame. Throws Error if there is no such frame.
  void show(std::size_t frame);
  /// The values of a quantity (catalog/quantities.hpp, but for the energies) where the discrete rod
  /// has it: at its nodes, at those that bend, or at the middles of its edges; curvature and moment
  /// also where they have a kink, and twice where they jump. Throws Error for an unknown rod or
  /// quantity, and for one that the model has not.
  RodSeries along(const std::string& rod, const std::string& quantity, const SavedFrames& frames);
  /// Reactions at every frame, at each place of each support: the force and moment that
  /// they exert on the rod. Forces that a program added to those of the scene are not known.
  /// `spin` [rad/s]: frames x edges, or x 0 without sections.
  ReactionSeries reactions(const SavedFrames& frames, const Eigen::Ref<const FrameTable>& spin);
  /// Forces and moments of the actuations at every frame, with the values that the scene has.
  ActuationForceSeries actuation_forces(const SavedFrames& frames);
  /// Director 1 of the section of each edge at every frame: frames x (edges * 3).
  FrameTable directors(const SavedFrames& frames);

 private:
  [[nodiscard]] double step_before(std::size_t frame) const;
  /// Puts the state to a frame.
  void go_to(std::size_t frame, const SavedFrames& frames);

  Scenario scenario_;
  const Model model_;
  State state_;
  std::vector<double> instants_;
  bool on_path_;
};

}  // namespace der
