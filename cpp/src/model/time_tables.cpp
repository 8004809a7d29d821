#include "der/model/time_tables.hpp"

#include <utility>

namespace der {

Index TimeTables::add(scenario::Series series) {
  series_.push_back(std::move(series));
  return size() - 1;
}

void TimeTables::evaluate(double t, Vector& values) const {
  if (values.size() != size()) values.setZero(size());
  for (Index i = first_; i < size(); ++i) values[i] = value_at((*this)[i], t);
}

}  // namespace der
