#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/scenario/series.hpp"

namespace der {

/// The time tables of a model, as entries of the controls behind those of the frames
/// (kinematics/frame_block.hpp) and of the rest shape (model/natural_strain.hpp). Forces, supports
/// and actuators name a table by its number; a stepper evaluates all of them once for each stage
/// time
/// (`evaluate_controls` in model/state.hpp, which adds what the state has in place of them).
class TimeTables {
 public:
  TimeTables() = default;
  /// `first`: number of entries before those of the tables.
  explicit TimeTables(Index first) : first_(first) {}

  /// Adds a table and returns its number.
  Index add(scenario::Series series);
  /// Number of the controls: the entries before those of the tables, and these.
  [[nodiscard]] Index size() const { return first_ + static_cast<Index>(series_.size()); }
  [[nodiscard]] const std::vector<scenario::Series>& all() const { return series_; }
  /// Writes the value of every table at time `t` into `values`, whose size it sets; the entries
  /// before those of the tables are zero where it had another.
  void evaluate(double t, Vector& values) const;
  /// The numbers of those without kinks: sines and smooth tables.
  [[nodiscard]] const std::vector<Index>& without_kinks() const { return without_kinks_; }
  [[nodiscard]] const scenario::Series& operator[](Index i) const {
    return series_[static_cast<std::size_t>(i - first_)];
  }

 private:
  Index first_ = 0;
  std::vector<scenario::Series> series_;
  std::vector<Index> without_kinks_;
};

}  // namespace der
