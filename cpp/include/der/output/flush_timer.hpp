#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace der {

/// Tells, inside a fast loop, when an interval has passed. It asks the clock only every n-th time,
/// n growing until that is about once in half a millisecond: in between a call is one decrement.
class FlushTimer {
 public:
  using Seconds = std::chrono::duration<double>;
  explicit FlushTimer(Seconds interval) : interval_(interval) {}

  /// True when the interval has passed since it last was true; the first call is true.
  bool due() { return --countdown_ <= 0 && check(); }
  void set_interval(Seconds interval) { interval_ = interval; }

 private:
  using Clock = std::chrono::steady_clock;
  bool check();

  Seconds interval_;
  std::int64_t countdown_ = 1;
  std::int64_t stride_ = 1;
  Clock::time_point last_check_;
  std::optional<Clock::time_point> last_due_;
};

}  // namespace der
