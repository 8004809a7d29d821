#pragma once

namespace der::app {

/// While it lives, Ctrl-C and SIGTERM ask the run to stop after the present step, or at the next
/// beat of an analysis, instead of ending the process; a second one ends it at once.
class InterruptGuard {
 public:
  /// How long a run may take to stop. One that takes longer than a second, as in the middle of an
  /// eigenvalue problem of thousands of unknowns, ends with the exit code of its signal.
  enum class Patience { OneSecond, Endless };
  explicit InterruptGuard(Patience patience);
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  /// The signal that came; 0: none.
  [[nodiscard]] static int signal();
};

}  // namespace der::app
