#include "output/rod_field.hpp"

#include <fmt/format.h>

#include "der/catalog/quantities.hpp"
#include "der/core/error.hpp"

namespace der {
namespace {

std::string quantities_along_rods() {
  std::string names;
  for (const Quantity& quantity : quantities()) {
    if (quantity.make_field == nullptr) continue;
    names += (names.empty() ? "" : ", ") + quantity.name;
  }
  return names;
}

}  // namespace

double RodField::interpolate(const SampleWeights& weights, const Model& model,
                             const State& state) const {
  double sum = 0.0;
  for (const auto& [number, weight] : weights) sum += weight * sample(number, model, state);
  return sum;
}

std::unique_ptr<RodField> make_rod_field(const std::string& quantity, const RodLayout& rod,
                                         const Model& model) {
  const Quantity* row = find_quantity(quantity);
  if (row != nullptr && row->make_field != nullptr) return row->make_field(rod, model);
  throw Error("model_error", fmt::format("'{}' is not a quantity along a rod; these are: {}",
                                         quantity, quantities_along_rods()));
}

}  // namespace der
