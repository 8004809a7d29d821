#include "der/model/controls.hpp"

#include <algorithm>
#include <utility>

namespace der {

Index Controls::add(scenario::Series series) {
  series_.push_back(std::move(series));
  return size() - 1;
}

void Controls::evaluate(double t, Vector& values) const {
  values.resize(size());
  for (Index i = 0; i < size(); ++i) values[i] = value_at((*this)[i], t);
}

double Controls::value(Index i, double t, const std::vector<Ramp>& ramps) const {
  const auto ramp = std::find_if(ramps.begin(), ramps.end(),
                                 [i](const Ramp& candidate) { return candidate.control == i; });
  return ramp == ramps.end() ? value_at((*this)[i], t) : ramp->at(t);
}

}  // namespace der
