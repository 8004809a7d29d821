#include "der/model/natural_strain.hpp"

#include <algorithm>

namespace der {
namespace {

struct ByEntry {
  bool operator()(const NaturalStrain::Term& a, const NaturalStrain::Term& b) const {
    return a.entry < b.entry;
  }
};

}  // namespace

void NaturalStrain::add(const std::vector<Term>& terms) {
  terms_.insert(terms_.end(), terms.begin(), terms.end());
  std::stable_sort(terms_.begin(), terms_.end(), ByEntry{});
}

std::vector<NaturalStrain::Term> NaturalStrain::terms_of(Index entry) const {
  const auto [first, last] =
      std::equal_range(terms_.begin(), terms_.end(), Term{entry, 0, 0.0}, ByEntry{});
  return {first, last};
}

void NaturalStrain::enter(Vector& controls) const {
  controls.segment(first_, size_).setZero();
  for (const auto& [entry, control, weight] : terms_) controls[entry] += weight * controls[control];
}

}  // namespace der
