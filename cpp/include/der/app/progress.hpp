#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "der/output/flush_timer.hpp"

namespace der::app {

/// One line of at most `width` columns: percentage, bar, details, time left. Details that do not
/// fit are left out, the last one first.
///
/// `share`         of the work that is done, from 0 to 1
/// `seconds_left`  nothing: not known yet
std::string progress_line(double share, const std::vector<std::string>& details,
                          std::optional<double> seconds_left, int width);

/// Where a run is.
struct RunPosition {
  std::int64_t step = 0;
  std::int64_t total_steps = 0;
  double time = 0.0;      ///< [s]
  double duration = 0.0;  ///< [s]
};

/// The same with the time and the speed of a run. `steps_per_second` 0: not known yet.
std::string progress_line(const RunPosition& position, double steps_per_second, int width);

/// A line on stderr that shows how far a run is: only on a terminal, at most ten times a second,
/// and not at all for runs that end at once. Costs a decrement a step in between.
class Progress {
 public:
  /// `enabled` false: never shows anything.
  explicit Progress(bool enabled);
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// To be called after every step; `where()` gives the RunPosition.
  template <class Where>
  void update(const Where& where) {
    if (enabled_ && pacer_.due()) show(where());
  }
  /// Wipes the line out.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  void show(const RunPosition& position);
  void measure_speed(std::int64_t step, Clock::time_point now);

  bool enabled_;
  FlushTimer pacer_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_time_ = start_;
  std::int64_t last_step_ = -1;  // -1: not measured yet
  double speed_ = 0.0;           // [steps/s]
  bool shown_ = false;
};

}  // namespace der::app
