#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "der/catalog/quantities.hpp"
#include "der/core/error.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// Part of a sample in a value between samples.
struct SampleWeight {
  std::size_t sample = 0;
  double weight = 0.0;
};
using SampleWeights = std::vector<SampleWeight>;

/// Linear between the two of these samples, by their arc lengths [m], that are nearest to `s`, and
/// beyond the outermost ones.
SampleWeights linear_weights(const std::vector<double>& arc, double s);

/// A quantity along a rod, sampled where the discrete rod has it: at nodes, at the middles of
/// edges, or, of bending, where it has a kink as well.
class RodField {
 public:
  explicit RodField(std::vector<double> arc_length) : arc_length_(std::move(arc_length)) {}
  RodField(const RodField&) = delete;
  RodField& operator=(const RodField&) = delete;
  virtual ~RodField() = default;

  /// Rest arc length of each sample [m], ascending; none if the rod has the quantity nowhere. Where
  /// the quantity jumps the place stands twice, with the value before it and the one after it.
  [[nodiscard]] const std::vector<double>& arc_length() const { return arc_length_; }
  /// The value of sample number `i`.
  [[nodiscard]] virtual double sample(std::size_t i, const Model& model,
                                      const State& state) const = 0;
  /// Sets `values` to all samples, in one pass where they depend on one another.
  virtual void sample_all(const Model& model, const State& state, double* values) const;
  /// The value at a place between samples, or beyond them: their weighted sum.
  [[nodiscard]] virtual double interpolate(const SampleWeights& weights, const Model& model,
                                           const State& state) const;
  /// The least value between samples where that is far below theirs, as of the length of a vector
  /// that passes by zero; infinity if there is none.
  [[nodiscard]] virtual double dip(const Model& /*model*/, const State& /*state*/) const {
    return std::numeric_limits<double>::infinity();
  }
  /// False if values between the samples have no meaning.
  [[nodiscard]] virtual bool continuous() const { return true; }
  /// False if the quantity may have a kink or jump at sample number `i`.
  [[nodiscard]] virtual bool smooth_at(std::size_t /*i*/) const { return true; }

 private:
  std::vector<double> arc_length_;
};

/// The error of a model that does not have a quantity.
Error not_available(const Quantity& quantity, const Model& model);

/// The field of a quantity (catalog/quantities.hpp, but for the energies). Throws Error for a name
/// that is no such quantity. Along a ring it goes all the way around.
std::unique_ptr<RodField> make_rod_field(const std::string& quantity, const RodMesh& rod,
                                         const Model& model);

}  // namespace der
