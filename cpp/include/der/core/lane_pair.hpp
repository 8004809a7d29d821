#pragma once

namespace der {

/// Two numbers that run through the same operations: as the numbers do not wait for one another,
/// two in turns take hardly longer than one. `T` has several lanes already.
template <class T>
struct LanePair {
  T first = 0.0;
  T second = 0.0;

  LanePair& operator-=(const LanePair& other) {
    first -= other.first;
    second -= other.second;
    return *this;
  }
  friend LanePair operator*(const LanePair& a, const LanePair& b) {
    return {a.first * b.first, a.second * b.second};
  }
};

}  // namespace der
