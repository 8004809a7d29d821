#pragma once

namespace der::app {

/// While it lives, Ctrl-C and SIGTERM ask the run to stop after the present step instead of ending
/// the process; a second one ends it at once.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  /// The signal that came; 0: none.
  [[nodiscard]] static int signal();
};

}  // namespace der::app
