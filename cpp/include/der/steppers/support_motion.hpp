#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// Watches how far supports move within a step. A clamp that turns by a whole turn in a step ends
/// it where it began, without an effect on its rod; an end that is moved far off leaves its edge
/// crushed, or reversed. The motion of supports is known beforehand, so steps are cut to the length
/// in which the shape can follow.
class SupportMotion {
 public:
  explicit SupportMotion(const Model& model);

  /// The longest step [s] from `state` in which no support moves by more than a strip: an edge
  /// beside it, or a radian. Infinite if none does.
  [[nodiscard]] double longest_step(const State& state) const { return time_of(1.0, state); }
  /// Time [s] in which one of them, to and fro, has moved by that many strips.
  [[nodiscard]] double time_of(double strips, const State& state) const;

 private:
  struct Moved {
    Index control = 0;
    double strip = 0.0;  // in the unit of the control
  };
  const Model& model_;
  std::vector<Moved> moved_;
};

}  // namespace der
