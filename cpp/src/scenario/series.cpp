#include "der/scenario/series.hpp"

#include <algorithm>
#include <cstddef>

namespace der::scenario {

double value_at(const Series& series, double t) {
  const auto& times = series.times;
  const auto after = std::upper_bound(times.begin(), times.end(), t);
  if (after == times.begin()) return series.values.front();
  if (after == times.end()) return series.values.back();
  const auto i = static_cast<std::size_t>(after - times.begin());
  const double share = (t - times[i - 1]) / (times[i] - times[i - 1]);
  return series.values[i - 1] + share * (series.values[i] - series.values[i - 1]);
}

bool is_zero(const Components& components) {
  return std::all_of(components.begin(), components.end(), [](double c) { return c == 0.0; });
}

bool is_zero(const Series& series) { return is_zero(series.values); }

void set_to_zero(Components& components) { std::fill(components.begin(), components.end(), 0.0); }

void set_to_zero(Series& series) { set_to_zero(series.values); }

void set_to_zero(VectorSeries& series) {
  for (Components& value : series.values) set_to_zero(value);
}

}  // namespace der::scenario
