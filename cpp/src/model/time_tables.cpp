#include "der/model/time_tables.hpp"

#include <utility>

namespace der {

Index TimeTables::add(scenario::Series series) {
  const bool has_kinks = series.course.kind == scenario::Course::Kind::Linear;
  series_.push_back(std::move(series));
  const Index number = size() - 1;
  if (!has_kinks) without_kinks_.push_back(number);
  return number;
}

void TimeTables::evaluate(double t, Vector& values) const {
  if (values.size() != size()) values.setZero(size());
  for (Index i = first_; i < size(); ++i) values[i] = value_at((*this)[i], t);
}

}  // namespace der
