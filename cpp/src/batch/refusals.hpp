#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <exception>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "der/core/error.hpp"

namespace der {

/// Why members cannot be simulated. All are tried, so that the one that is named is the first,
/// whatever the threads do.
class Refusals {
 public:
  /// Calls `make` for a member and keeps what it throws. Any thread may.
  template <class Make>
  void attempt(std::size_t member, const Make& make) {
    try {
      make();
    } catch (const Error&) {
      const std::lock_guard lock(mutex_);
      errors_.emplace(member, std::current_exception());
    }
  }

  /// Throws that of the first member, if there is any.
  void raise() const {
    if (errors_.empty()) return;
    try {
      std::rethrow_exception(errors_.begin()->second);
    } catch (const SceneError& scene_error) {
      std::vector<Diagnostic> diagnostics = scene_error.diagnostics();
      for (Diagnostic& diagnostic : diagnostics) diagnostic.message += " (" + who() + ")";
      throw SceneError("", std::move(diagnostics));
    } catch (const Error& error) {
      throw Error(error.status(), who() + ": " + error.what());
    }
  }

 private:
  [[nodiscard]] std::string who() const {
    const std::size_t first = errors_.begin()->first;
    return errors_.size() == 1 ? fmt::format("member {}", first)
                               : fmt::format("member {} and {} more", first, errors_.size() - 1);
  }

  std::mutex mutex_;
  std::map<std::size_t, std::exception_ptr> errors_;
};

}  // namespace der
