#pragma once

#include <vector>

namespace der::scenario {

/// A point in space or a vector: 2 components (x, y) or 3 (x, y, z), as the scene's dimension says.
using Components = std::vector<double>;

/// A scalar that follows a table over time: linear between entries, constant beyond both ends. A
/// constant is a table with one entry. `times` [s] strictly increasing.
struct Series {
  std::vector<double> times{0.0};
  std::vector<double> values{0.0};
  [[nodiscard]] bool constant() const { return values.size() == 1; }
};

/// Value of a table at time `t` [s]: linear between entries, constant beyond both ends.
double value_at(const Series& series, double t);

/// As `Series`, with a vector value for each time; without any value it is not given.
struct VectorSeries {
  std::vector<double> times{0.0};
  std::vector<Components> values;
  [[nodiscard]] bool constant() const { return values.size() <= 1; }
};

/// Whether every value is zero.
bool is_zero(const Components& components);
bool is_zero(const Series& series);

/// Sets every value to zero and keeps the times.
void set_to_zero(Components& components);
void set_to_zero(Series& series);
void set_to_zero(VectorSeries& series);

}  // namespace der::scenario
