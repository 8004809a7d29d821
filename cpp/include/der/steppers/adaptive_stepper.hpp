#pragma once

#include <cstdint>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/steppers/dense_output.hpp"
#include "der/steppers/stepper.hpp"
#include "der/steppers/support_motion.hpp"

namespace der {

struct AdaptiveOptions {
  double tolerance = 1e-3;  ///< error of positions over the model's size, gathered over `duration`
  double duration = 1.0;    ///< [s]
  double minimum_step = 0.0;  ///< [s]
  double largest_step = 0.0;  ///< [s] that is tried; infinite: any
};

/// The cost of all attempts at one adaptive step.
struct AdaptiveReport {
  StepReport last;            ///< of the last attempt; done if the step was accepted
  double tried = 0.0;         ///< [s] length of the last attempt
  int newton_iterations = 0;  ///< of all attempts
  int rejected = 0;           ///< attempts whose error was too large, or that did not converge
  double error = 0.0;         ///< of the last attempt, over what it was allowed; 0: not known
  bool is_of_edge = false;    ///< whether that is the error of an edge, and not of a position
  bool at_rounding = false;   ///< whether that error is no more than the rounding of positions
};

/// Adaptive steps to a requested tolerance of the error in time.
///
/// Each step is done once as a whole and once in two halves, which are kept. The difference over
/// 2^p - 1, p the stepper's order, is the error of the halves (Hairer, Norsett and Wanner, Solving
/// Ordinary Differential Equations I, section II.4); `StepperInfo::error_factor` takes about three
/// times as much, since errors grow further in the motion. A step may add `tolerance * size` times
/// its share of the duration, so that the sum of all estimates stays below `tolerance * size` and
/// the error follows the tolerance in proportion. The angle of a section counts as its radius of
/// gyration times that. The same holds for the change of each edge and half its length, whatever
/// the tolerance: an edge shorter than it could turn over. The next length comes from a
/// proportional-integral controller (Gustafsson, ACM Trans. Math. Softw. 17, 1991). Entries of
/// tables over time and ends of ramps, where forces have kinks, are hit exactly, and no step is
/// longer than a quarter of the period of a sine.
class AdaptiveStepper {
 public:
  AdaptiveStepper(const Model& model, const Assembler& assembler, Stepper& stepper,
                  const StepperInfo& info, const AdaptiveOptions& options);

  /// Advances `state` by one step that ends at `horizon` [s] or before it. The state is untouched
  /// if the report says that it was not done.
  AdaptiveReport advance(State& state, double horizon);

  /// The time [s] at which the next step will end if its error is no larger than expected.
  [[nodiscard]] double end_of_next_step(const State& state, double horizon) const;

  /// Positions, velocities and works at `time` within the last step, by `DenseOutput` over its
  /// halves; everything else as in `state`, which is the state at the end of that step.
  void interpolate(double time, const State& state, State& result);

  /// The longest step that has been done [s].
  [[nodiscard]] double longest_step() const { return longest_step_; }

 private:
  [[nodiscard]] double first_step(const State& state) const;
  [[nodiscard]] double wanted_step(const State& state) const;
  [[nodiscard]] double next_stop(const State& state, double horizon) const;
  StepReport attempt(State& state, double length);
  void measure(const State& state, AdaptiveReport& report);

  const Model& model_;
  Stepper& stepper_;
  double order_;
  double error_factor_;
  AdaptiveOptions options_;
  std::vector<double> breakpoints_;  // [s] ascending
  double shortest_edge_;             // [m]
  double longest_step_ = 0.0;        // [s]
  SupportMotion support_motion_;
  State start_;  // of the last step
  State middle_;
  State whole_;        // at the end of the step done as a whole
  Vector difference_;  // of positions after the two halves [m]
  DenseOutput dense_;
};

}  // namespace der
