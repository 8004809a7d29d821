#include "der/model/rest_shape.hpp"

#include <algorithm>

namespace der {
namespace {

struct ByEntry {
  bool operator()(const RestShape::Term& a, const RestShape::Term& b) const {
    return a.entry < b.entry;
  }
};

}  // namespace

void RestShape::add(const std::vector<Term>& terms) {
  terms_.insert(terms_.end(), terms.begin(), terms.end());
  std::stable_sort(terms_.begin(), terms_.end(), ByEntry{});
}

std::vector<RestShape::Term> RestShape::terms_of(Index entry) const {
  const auto [first, last] =
      std::equal_range(terms_.begin(), terms_.end(), Term{entry, 0, 0.0}, ByEntry{});
  return {first, last};
}

void RestShape::enter(Vector& controls) const {
  controls.segment(first_, size_).setZero();
  for (const auto& [entry, control, weight] : terms_) controls[entry] += weight * controls[control];
}

}  // namespace der
