#pragma once

#include <array>

#include "der/catalog/energy_terms.hpp"

namespace der {

/// Energies [J] by term.
class Energies {
 public:
  double& operator[](EnergyTerm term) { return values_[row_of(term)]; }
  double operator[](EnergyTerm term) const { return values_[row_of(term)]; }
  /// All terms, in the order of `kEnergyTerms`, in which they are recorded.
  [[nodiscard]] const std::array<double, kEnergyTerms.size()>& values() const { return values_; }

  [[nodiscard]] double elastic() const;
  [[nodiscard]] double total() const;
  Energies& operator+=(const Energies& other);

 private:
  std::array<double, kEnergyTerms.size()> values_{};
};

}  // namespace der
