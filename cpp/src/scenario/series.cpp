#include "der/scenario/series.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <vector>

#include "der/core/constants.hpp"

namespace der::scenario {

namespace {

constexpr double kStepsPerPeriod = 4.0;

/// A piece of a table between two entries.
struct Piece {
  std::size_t end;  // number of the entry at its end
  double length;    // [s]
  double done;      // share of its time that is over
};

/// The piece at time `t` [s]; none before the first entry, and from the last one on.
std::optional<Piece> piece_at(double t, const std::vector<double>& times) {
  const auto after = std::upper_bound(times.begin(), times.end(), t);
  if (after == times.begin() || after == times.end()) return std::nullopt;
  const double start = *std::prev(after);
  const double length = *after - start;
  return Piece{static_cast<std::size_t>(after - times.begin()), length, (t - start) / length};
}

}  // namespace

double smooth_share(double u) { return u * u * u * (10.0 + u * (6.0 * u - 15.0)); }

double value_at(const Series& series, double t) {
  const auto& [times, values, course] = series;
  if (course.kind == Course::Kind::Sine) {
    return values[0] + values[1] * std::sin(2.0 * kPi * course.frequency * t + course.phase);
  }
  const auto piece = piece_at(t, times);
  if (!piece) return t < times.front() ? values.front() : values.back();
  const auto& [i, length, done] = *piece;
  const double share = course.kind == Course::Kind::Linear ? done : smooth_share(done);
  return values[i - 1] + share * (values[i] - values[i - 1]);
}

double slope_at(const Series& series, double t) {
  const auto& [times, values, course] = series;
  if (course.kind == Course::Kind::Sine) {
    const double rate = 2.0 * kPi * course.frequency;
    return values[1] * rate * std::cos(rate * t + course.phase);
  }
  const auto piece = piece_at(t, times);
  if (!piece) return 0.0;
  const auto& [i, length, u] = *piece;
  const double by_share = 30.0 * u * u * (1.0 - u) * (1.0 - u);  // the slope of smooth_share
  return by_share * (values[i] - values[i - 1]) / length;
}

Series component_of(const VectorSeries& series, std::size_t component) {
  Series result{series.times, {}, series.course};
  result.values.reserve(series.values.size());
  for (const Components& value : series.values) result.values.push_back(value[component]);
  return result;
}

double longest_resolving_step(const Course& course) {
  if (course.kind != Course::Kind::Sine) return std::numeric_limits<double>::infinity();
  return 1.0 / (kStepsPerPeriod * course.frequency);
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
