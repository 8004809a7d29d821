#pragma once

#include <Eigen/Core>
#include <cmath>

namespace der {

/// Two numbers that run through the same operations in one register, each as if it were alone.
/// Kernels that are templates over their number type take `double` or this; it is a scalar type
/// for Eigen's fixed-size matrices.
class TwoLanes {
 public:
  TwoLanes() = default;
  // Not explicit: a constant of a formula is the same in both lanes.
  TwoLanes(double value) : values_{value, value} {}  // NOLINT(google-explicit-constructor)
  TwoLanes(double first, double second) : values_{first, second} {}

  [[nodiscard]] double lane(int number) const { return values_[number]; }

  TwoLanes& operator+=(const TwoLanes& other) {
    values_ += other.values_;
    return *this;
  }
  TwoLanes& operator-=(const TwoLanes& other) {
    values_ -= other.values_;
    return *this;
  }
  TwoLanes& operator*=(const TwoLanes& other) {
    values_ *= other.values_;
    return *this;
  }
  TwoLanes& operator/=(const TwoLanes& other) {
    values_ /= other.values_;
    return *this;
  }
  friend TwoLanes operator+(TwoLanes a, const TwoLanes& b) { return a += b; }
  friend TwoLanes operator-(TwoLanes a, const TwoLanes& b) { return a -= b; }
  friend TwoLanes operator*(TwoLanes a, const TwoLanes& b) { return a *= b; }
  friend TwoLanes operator/(TwoLanes a, const TwoLanes& b) { return a /= b; }
  friend TwoLanes operator-(TwoLanes a) {
    a.values_ = -a.values_;
    return a;
  }

 private:
  // A `using` cannot have this attribute.
  typedef double Register __attribute__((vector_size(16)));  // NOLINT(modernize-use-using)
  Register values_;
};

/// Number of lanes of a number type, and access to them.
template <class T>
struct LaneTraits;
template <>
struct LaneTraits<double> {
  static constexpr int kCount = 1;
  static double lane(double value, int /*number*/) { return value; }
};
template <>
struct LaneTraits<TwoLanes> {
  static constexpr int kCount = 2;
  static double lane(const TwoLanes& value, int number) { return value.lane(number); }
};

/// The number whose lane l is `f(l)`.
template <class T, class F>
T in_lanes(F&& f) {
  if constexpr (LaneTraits<T>::kCount == 1) {
    return f(0);
  } else {
    return {f(0), f(1)};
  }
}

inline TwoLanes sqrt(const TwoLanes& x) { return {std::sqrt(x.lane(0)), std::sqrt(x.lane(1))}; }

}  // namespace der

namespace Eigen {
template <>
struct NumTraits<der::TwoLanes> : GenericNumTraits<double> {
  using Real = der::TwoLanes;
  using NonInteger = der::TwoLanes;
  using Nested = der::TwoLanes;
  using Literal = double;
};
template <class Operation>
struct ScalarBinaryOpTraits<double, der::TwoLanes, Operation> {
  using ReturnType = der::TwoLanes;
};
template <class Operation>
struct ScalarBinaryOpTraits<der::TwoLanes, double, Operation> {
  using ReturnType = der::TwoLanes;
};
}  // namespace Eigen
