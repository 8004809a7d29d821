#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/scenario/series.hpp"

namespace der {

/// The time tables of a model. Forces, supports and actuators name a table by its number; a stepper
/// evaluates all of them once for each stage time (`evaluate_controls` in model/state.hpp, which
/// adds what the state has in place of them).
class TimeTables {
 public:
  /// Adds a table and returns its number.
  Index add(scenario::Series series);
  [[nodiscard]] Index size() const { return static_cast<Index>(series_.size()); }
  /// Writes the value of every table at time `t` into `values`.
  void evaluate(double t, Vector& values) const;
  [[nodiscard]] const scenario::Series& operator[](Index i) const {
    return series_[static_cast<std::size_t>(i)];
  }

 private:
  std::vector<scenario::Series> series_;
};

}  // namespace der
