#include "der/model/controls.hpp"

#include <algorithm>
#include <utility>

namespace der {

double value_at(const scenario::Series& series, double t) {
  const auto& times = series.times;
  const auto after = std::upper_bound(times.begin(), times.end(), t);
  if (after == times.begin()) return series.values.front();
  if (after == times.end()) return series.values.back();
  const auto i = static_cast<std::size_t>(after - times.begin());
  const double share = (t - times[i - 1]) / (times[i] - times[i - 1]);
  return series.values[i - 1] + share * (series.values[i] - series.values[i - 1]);
}

Index Controls::add(scenario::Series series) {
  series_.push_back(std::move(series));
  return size() - 1;
}

void Controls::evaluate(double t, Vector& values) const {
  values.resize(size());
  for (Index i = 0; i < size(); ++i) values[i] = value_at((*this)[i], t);
}

void Controls::evaluate(double t, const std::vector<Ramp>& ramps, Vector& values) const {
  evaluate(t, values);
  for (const Ramp& ramp : ramps) values[ramp.control] = ramp.at(t);
}

double Controls::value(Index i, double t, const std::vector<Ramp>& ramps) const {
  const auto ramp = std::find_if(ramps.begin(), ramps.end(),
                                 [i](const Ramp& candidate) { return candidate.control == i; });
  return ramp == ramps.end() ? value_at((*this)[i], t) : ramp->at(t);
}

}  // namespace der
