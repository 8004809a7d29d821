#pragma once

#include <cstdint>
#include <utility>

namespace der {

namespace scenario {
struct Scene;
}

/// The time steps of a run, worked out from what the scene says and what the model bears at first.
struct StepPlan {
  double step = 0.0;                 ///< [s]; 0: adaptive, or a static scene
  double duration = 0.0;             ///< [s] of the run; 0: a static scene
  double every = 0.0;                ///< [s] between saved frames
  std::int64_t steps_per_frame = 1;  ///< with equal steps
  std::int64_t total_steps = 0;      ///< from time 0 to the duration; 0: not known
  double largest_step = 0.0;         ///< [s] for adaptive steps: stable, with a bounded number of
                                     ///< frames; infinite: any

  /// Time [s] at the end of the equal step that begins at `time`: a multiple of `step`, so that
  /// rounding does not add up over many steps, or the duration.
  [[nodiscard]] double next_time(double time) const;
  /// Whether a regular frame is due at that instant.
  [[nodiscard]] bool is_frame(double time) const;
  /// First and last number of the frames at multiples of `every` between two times, these excluded.
  [[nodiscard]] std::pair<std::int64_t, std::int64_t> frames_between(double from, double to) const;
};

/// `stable_step` [s] is that of the initial shape, infinite for implicit steppers. Throws Error
/// ("too_many_steps") where it makes more steps of the duration than anyone can wait for.
StepPlan plan_steps(const scenario::Scene& scene, double stable_step);

}  // namespace der
