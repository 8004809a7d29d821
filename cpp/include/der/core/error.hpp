#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace der {

/// Base of every error that the library reports on purpose. `status()` is the short
/// machine-readable name that ends up in `summary.json`; `what()` says what went wrong, where, and
/// what to try.
class Error : public std::runtime_error {
 public:
  Error(std::string status, const std::string& message)
      : std::runtime_error(message), status_(std::move(status)) {}
  [[nodiscard]] const std::string& status() const noexcept { return status_; }

 private:
  std::string status_;
};

/// One diagnostic about a scene: 1-based line and column in the text (0 when the scene did not come
/// from a text), the key path (`rods.beam.nodes`) and a sentence.
struct Diagnostic {
  int line = 0;
  int column = 0;
  std::string path;
  std::string message;
};

/// A scene that cannot be run as written. Holds every diagnostic found, in the order of the text,
/// as `printable` texts.
class SceneError : public Error {
 public:
  /// `source` is the file name, or empty for a dictionary.
  SceneError(const std::string& source, std::vector<Diagnostic> diagnostics);
  [[nodiscard]] const std::vector<Diagnostic>& diagnostics() const noexcept { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

/// A scene file that cannot be read at all.
class UnreadableSceneError : public SceneError {
 public:
  UnreadableSceneError(const std::string& file, const std::string& reason)
      : SceneError(file, {{0, 0, "", reason}}) {}
};

/// An environment variable with a value that means nothing here.
class EnvironmentError : public Error {
 public:
  explicit EnvironmentError(const std::string& message) : Error("environment_error", message) {}
};

/// Newton's method found no solution, even with the smallest allowed time step; or there is no
/// equilibrium, for a reason that `status` names (EquilibriumReport).
class NotConvergedError : public Error {
 public:
  explicit NotConvergedError(const std::string& message,
                             const std::string& status = "not_converged")
      : Error(status, message) {}
};

/// The motion grew without bound or a value stopped being a number ("diverged"), or the time
/// stepping created energy ("unstable_motion").
class DivergedError : public Error {
 public:
  explicit DivergedError(const std::string& message, const std::string& status = "diverged")
      : Error(status, message) {}
};

}  // namespace der
