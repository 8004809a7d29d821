#include "output/rod_field.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "der/catalog/quantities.hpp"
#include "der/core/error.hpp"
#include "output/around_ring.hpp"

namespace der {
namespace {

std::string names_along_rods() {
  std::string names;
  for (const Quantity& quantity : quantities()) {
    if (quantity.make_field == nullptr) continue;
    names += (names.empty() ? "" : ", ") + quantity.name;
  }
  return names;
}

}  // namespace

SampleWeights linear_weights(const std::vector<double>& arc, double s) {
  if (arc.size() == 1) return {{0, 1.0}};
  const auto above =
      static_cast<std::size_t>(std::upper_bound(arc.begin(), arc.end(), s) - arc.begin());
  const std::size_t right = std::clamp<std::size_t>(above, 1, arc.size() - 1);
  const double share = (s - arc[right - 1]) / (arc[right] - arc[right - 1]);
  return {{right - 1, 1.0 - share}, {right, share}};
}

Error not_available(const Quantity& quantity, const Model& model) {
  const bool is_flat = model.dimension == 2 && model.stands_for_space && is_of_plane(quantity);
  return {"model_error", is_flat ? lacks_in_flat_scene(quantity) : lacks(model.name, quantity)};
}

void RodField::sample_all(const Model& model, const State& state, double* values) const {
  for (std::size_t i = 0; i < arc_length_.size(); ++i) values[i] = sample(i, model, state);
}

double RodField::interpolate(const SampleWeights& weights, const Model& model,
                             const State& state) const {
  double sum = 0.0;
  for (const auto& [number, weight] : weights) sum += weight * sample(number, model, state);
  return sum;
}

std::unique_ptr<RodField> make_rod_field(const std::string& quantity, const RodMesh& rod,
                                         const Model& model) {
  const Quantity* row = find_quantity(quantity);
  if (row != nullptr && row->make_field != nullptr) {
    if (!is_answered(*row, model)) {
      throw not_available(*row, model);
    }
    auto field =
        is_own(*row, model) ? row->make_field(rod, model) : row->make_field_in_smaller(rod, model);
    return rod.closed ? around_ring(std::move(field), rod) : std::move(field);
  }
  throw Error("model_error", fmt::format("'{}' is not a quantity along a rod; these are: {}",
                                         quantity, names_along_rods()));
}

}  // namespace der
