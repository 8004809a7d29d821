#pragma once

#include <string_view>

namespace der::run_status {

// The status of a run in its summary and its files. One that failed has the status of its error in
// place of these (core/error.hpp).

inline constexpr const char* kRunning = "running";  ///< goes on, or was killed
inline constexpr const char* kCompleted = "completed";
inline constexpr const char* kStaticConverged = "static_converged";
inline constexpr const char* kStopped = "stopped";  ///< early, as the caller asked

/// Whether a run of that status has reached the end of its scene.
constexpr bool is_finished(std::string_view status) {
  return status == kCompleted || status == kStaticConverged;
}
/// Whether a run of that status has ended as it was meant to: it is finished, or the caller stopped
/// it.
constexpr bool ended_as_asked(std::string_view status) {
  return is_finished(status) || status == kStopped;
}

}  // namespace der::run_status
