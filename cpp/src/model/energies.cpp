#include "der/model/energies.hpp"

#include <cstddef>

namespace der {

double Energies::elastic() const {
  double sum = 0.0;
  for (const EnergyTermInfo& row : kEnergyTerms) {
    if (row.elastic) sum += (*this)[row.term];
  }
  return sum;
}

double Energies::total() const {
  const Energies& self = *this;
  return self[EnergyTerm::Kinetic] + elastic() + self[EnergyTerm::Gravity];
}

Energies& Energies::operator+=(const Energies& other) {
  for (std::size_t row = 0; row < values_.size(); ++row) values_[row] += other.values_[row];
  return *this;
}

}  // namespace der
