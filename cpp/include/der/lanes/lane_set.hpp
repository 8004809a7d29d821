#pragma once

#include "der/core/lanes.hpp"

namespace der {

/// The members of a number type's lanes, as bits.
class LaneSet {
 public:
  LaneSet() = default;
  /// The lanes of a number type in which `holds` is not zero.
  template <class T>
  static LaneSet where(const T& holds) {
    LaneSet lanes;
    for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
      if (holds.lane(lane) != 0.0) lanes.add(lane);
    }
    return lanes;
  }
  [[nodiscard]] bool has(int lane) const {
    return (bits_ >> static_cast<unsigned>(lane) & 1U) != 0;
  }
  [[nodiscard]] bool empty() const { return bits_ == 0; }
  void add(int lane) { bits_ |= 1U << static_cast<unsigned>(lane); }
  void add(const LaneSet& others) { bits_ |= others.bits_; }
  void remove(int lane) { bits_ &= ~(1U << static_cast<unsigned>(lane)); }
  [[nodiscard]] LaneSet without(const LaneSet& others) const {
    return LaneSet(bits_ & ~others.bits_);
  }
  /// In the lanes of the set 1, else 0.
  template <class T>
  [[nodiscard]] T mask() const {
    return in_lanes<T>([this](int lane) { return has(lane) ? 1.0 : 0.0; });
  }

 private:
  explicit LaneSet(unsigned bits) : bits_(bits) {}
  unsigned bits_ = 0;
};

}  // namespace der
