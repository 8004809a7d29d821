#pragma once

#include <optional>
#include <string>
#include <variant>

namespace der::scenario {

// Each analysis has its word in the scene as `kName`.

/// A run over time: `time:`.
struct DynamicAnalysis {
  static constexpr const char* kName = "dynamic";
};
/// The static equilibrium under the loads.
struct StaticAnalysis {
  static constexpr const char* kName = "static";
  bool leave_saddles = true;  ///< whether an unstable equilibrium is left for a stable one
};
/// Free vibrations about the equilibrium.
struct ModesAnalysis {
  static constexpr const char* kName = "modes";
  int count = 6;
};
/// Linear buckling loads of the unloaded equilibrium.
struct BucklingAnalysis {
  static constexpr const char* kName = "buckling";
  int count = 3;
};
/// The quantities that a continuation scales: loads, prescribed motions of supports, or changes of
/// the rest shape.
enum class Varied { Loads, Supports, Actuations };
/// The path of equilibria as a factor of these changes.
struct ContinuationAnalysis {
  static constexpr const char* kName = "continuation";
  Varied vary = Varied::Loads;
  /// Name of the one load, support or actuation that varies; absent: all.
  std::optional<int> number;
  std::string name;    ///< of that one, until the checks find its number
  double from = 0.0;   ///< first factor
  double to = 1.0;     ///< last factor
  double step = 0.05;  ///< largest distance of two points
  int points = 500;    ///< largest number of points of a branch
  int branches = 0;    ///< how many bifurcations deep other branches are followed
};
/// The analysis that the scene asks for.
using Analysis = std::variant<DynamicAnalysis, StaticAnalysis, ModesAnalysis, BucklingAnalysis,
                              ContinuationAnalysis>;

}  // namespace der::scenario
