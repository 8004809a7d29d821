#pragma once

#include <cstddef>
#include <vector>

namespace der::scenario {

/// A point in space or a vector: 2 components (x, y) or 3 (x, y, z), as the scene's dimension says.
using Components = std::vector<double>;

/// How a value follows time. Whatever the course, the value is linear in the numbers that the
/// series lists.
struct Course {
  enum class Kind {
    Linear,  ///< straight between entries, constant beyond both ends
    /// Likewise, but with zero slope and curvature at every entry: over a piece, of which u is
    /// done, 10 u^3 - 15 u^4 + 6 u^5 of the change. Its second derivative is continuous.
    Smooth,
    Sine,  ///< values[0] + values[1] sin(2 pi frequency t + phase); it has no entries
  };
  Kind kind = Kind::Linear;
  double frequency = 0.0;  ///< [Hz] of a sine
  double phase = 0.0;      ///< [rad] of a sine
};

/// A scalar that follows time. A constant is a table with one entry. `times` [s] strictly
/// increasing; a sine has none.
struct Series {
  std::vector<double> times{0.0};
  std::vector<double> values{0.0};
  Course course{};
  [[nodiscard]] bool constant() const { return values.size() == 1; }
};

/// Share of the change that a smooth piece has done after the share `u` of its time.
double smooth_share(double u);

/// Value at time `t` [s].
double value_at(const Series& series, double t);
/// Its rate of change at time `t` [s], of a course without kinks.
double slope_at(const Series& series, double t);

/// As `Series`, with a vector value for each time; without any value it is not given.
struct VectorSeries {
  std::vector<double> times{0.0};
  std::vector<Components> values;
  Course course{};
  [[nodiscard]] bool constant() const { return values.size() <= 1; }
};

/// One component of a vector over time.
Series component_of(const VectorSeries& series, std::size_t component);

/// The longest step [s] that still sees how a sine swings: a quarter of its period; infinite for
/// tables.
double longest_resolving_step(const Course& course);

/// Whether every value is zero.
bool is_zero(const Components& components);
bool is_zero(const Series& series);

/// Sets every value to zero and keeps the times.
void set_to_zero(Components& components);
void set_to_zero(Series& series);
void set_to_zero(VectorSeries& series);

}  // namespace der::scenario
