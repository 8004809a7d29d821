#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "der/core/magnitude.hpp"

namespace der {

/// A register of `N` numbers; `fill` sets all of them to one, and `any` asks whether a bit is set.
template <int N>
struct LaneRegister;
// A `using` cannot have this attribute, and GCC does not take it with the size of a template.
// NOLINTBEGIN(modernize-use-using)
template <>
struct LaneRegister<2> {
  typedef double type __attribute__((vector_size(16)));
  typedef std::int64_t bits __attribute__((vector_size(16)));
  static void fill(double x, type& all) { all = type{x, x}; }
  static bool any(const bits& b) { return (b[0] | b[1]) != 0; }
};
// Eigen aligns its matrices to 16 bytes.
template <>
struct LaneRegister<4> {
  typedef double type __attribute__((vector_size(32), aligned(16)));
  typedef std::int64_t bits __attribute__((vector_size(32), aligned(16)));
  static void fill(double x, type& all) { all = type{x, x, x, x}; }
  static bool any(const bits& b) {
    const bits halves = b | __builtin_shufflevector(b, b, 2, 3, 0, 1);
    return (halves[0] | halves[1]) != 0;
  }
};
template <>
struct LaneRegister<8> {
  typedef double type __attribute__((vector_size(64), aligned(16)));
  typedef std::int64_t bits __attribute__((vector_size(64), aligned(16)));
  // GCC 12 puts the eight numbers of a list in their places one by one, even where they are equal.
  static void fill(double x, type& all) {
    type first{};
    first[0] = x;
    all = __builtin_shufflevector(first, first, 0, 0, 0, 0, 0, 0, 0, 0);
  }
  static bool any(const bits& b) {
    const bits halves = b | __builtin_shufflevector(b, b, 4, 5, 6, 7, 0, 1, 2, 3);
    const bits quarters = halves | __builtin_shufflevector(halves, halves, 2, 3, 0, 1, 6, 7, 4, 5);
    return (quarters[0] | quarters[1]) != 0;
  }
};
// NOLINTEND(modernize-use-using)

/// `N` numbers that run through the same operations in one register, each as if it were alone.
/// Kernels that are templates over their number type take `double` or this; it is a scalar type
/// for Eigen's fixed-size matrices.
///
/// Functions pass and return it in memory unless they are inlined, since it has a copy constructor
/// of its own: wide registers are not the same in code for processors with and without AVX.
template <int N>
class Lanes {
  using All = std::make_integer_sequence<int, N>;

 public:
  Lanes() = default;
  ~Lanes() = default;
  Lanes(const Lanes& other) : values_(other.values_) {}  // NOLINT(modernize-use-equals-default)
  // Written out: GCC 12 copies a class with registers of 32 bytes in pieces of 16, by way of
  // memory.
  Lanes& operator=(const Lanes& other) {  // NOLINT(modernize-use-equals-default)
    values_ = other.values_;
    return *this;
  }
  // Not explicit: a constant of a formula is the same in all lanes.
  Lanes(double value) {  // NOLINT(google-explicit-constructor)
    LaneRegister<N>::fill(value, values_);
  }
  /// One number for each lane.
  template <class... Rest, class = std::enable_if_t<sizeof...(Rest) + 1 == N>>
  Lanes(double first, Rest... rest)  // NOLINT(google-explicit-constructor)
      : values_{first, rest...} {}

  /// The numbers f(0) .. f(N - 1).
  template <class F>
  static Lanes of(const F& f) {
    return Lanes(f, All{});
  }
  /// The `N` numbers from `values` on.
  static Lanes load(const double* values) {
    Lanes lanes;
    std::memcpy(&lanes.values_, values, sizeof(lanes.values_));
    return lanes;
  }

  [[nodiscard]] double lane(int number) const { return values_[number]; }
  void set_lane(int number, double value) { values_[number] = value; }

  /// In each lane `a` where `condition` is not zero, else `b`.
  static Lanes select(const Lanes& condition, const Lanes& a, const Lanes& b) {
    Lanes lanes;
    lanes.values_ = condition.values_ != 0.0 ? a.values_ : b.values_;
    return lanes;
  }
  /// In each lane the larger of |a| and |b|; NaN is above infinity, as in `magnitude_bits`.
  static Lanes larger_magnitude(const Lanes& a, const Lanes& b) {
    Bits x;
    Bits y;
    set_magnitude_bits(a, x);
    set_magnitude_bits(b, y);
    const Bits larger = x > y ? x : y;
    Lanes lanes;
    std::memcpy(&lanes.values_, &larger, sizeof larger);
    return lanes;
  }
  /// In each lane 1 where the number is above zero and finite, else 0.
  static Lanes is_positive(const Lanes& x) {
    // Less NaN where x is infinite. GCC 12 takes two conditions of eight numbers one by one.
    return if_less(0.0, x - 0.0 * x, 1.0, 0.0);
  }
  /// In each lane `x` where a < b, else `y`.
  static Lanes if_less(const Lanes& a, const Lanes& b, const Lanes& x, const Lanes& y) {
    Lanes lanes;
    lanes.values_ = a.values_ < b.values_ ? x.values_ : y.values_;
    return lanes;
  }
  /// Whether a < b in all lanes.
  static bool all_less(const Lanes& a, const Lanes& b) {
    Bits misses;
    const Register miss = a.values_ < b.values_ ? Lanes(0.0).values_ : Lanes(1.0).values_;
    std::memcpy(&misses, &miss, sizeof misses);
    return !LaneRegister<N>::any(misses);
  }
  friend Lanes abs(const Lanes& x) {
    Bits bits;
    set_magnitude_bits(x, bits);
    Lanes lanes;
    std::memcpy(&lanes.values_, &bits, sizeof bits);
    return lanes;
  }

  Lanes& operator+=(const Lanes& other) {
    values_ += other.values_;
    return *this;
  }
  Lanes& operator-=(const Lanes& other) {
    values_ -= other.values_;
    return *this;
  }
  Lanes& operator*=(const Lanes& other) {
    values_ *= other.values_;
    return *this;
  }
  Lanes& operator/=(const Lanes& other) {
    values_ /= other.values_;
    return *this;
  }
  friend Lanes operator+(Lanes a, const Lanes& b) { return a += b; }
  friend Lanes operator-(Lanes a, const Lanes& b) { return a -= b; }
  friend Lanes operator*(Lanes a, const Lanes& b) { return a *= b; }
  friend Lanes operator/(Lanes a, const Lanes& b) { return a /= b; }
  friend Lanes operator-(Lanes a) {
    a.values_ = -a.values_;
    return a;
  }

 private:
  template <class F, int... I>
  Lanes(const F& f, std::integer_sequence<int, I...> /*lanes*/) : values_{f(I)...} {}

  using Register = typename LaneRegister<N>::type;
  using Bits = typename LaneRegister<N>::bits;
  static void set_magnitude_bits(const Lanes& x, Bits& bits) {
    std::memcpy(&bits, &x.values_, sizeof bits);
    bits &= kCounts;
  }
  Register values_;
};
using TwoLanes = Lanes<2>;
using FourLanes = Lanes<4>;
using EightLanes = Lanes<8>;

/// The largest magnitude of numbers seen one by one, in each lane; NaN if one of them is NaN.
template <class T>
class LargestMagnitude;
template <>
class LargestMagnitude<double> {
 public:
  void see(double x) { largest_ = largest_ > magnitude_bits(x) ? largest_ : magnitude_bits(x); }
  [[nodiscard]] double value() const { return magnitude_of(largest_); }

 private:
  std::int64_t largest_ = 0;
};
template <int N>
class LargestMagnitude<Lanes<N>> {
 public:
  void see(const Lanes<N>& x) { largest_ = Lanes<N>::larger_magnitude(largest_, x); }
  [[nodiscard]] Lanes<N> value() const { return largest_; }

 private:
  Lanes<N> largest_ = 0.0;
};

/// Number of lanes of a number type, and access to them.
template <class T>
struct LaneTraits;
template <>
struct LaneTraits<double> {
  static constexpr int kCount = 1;
  static double lane(double value, int /*number*/) { return value; }
};
template <int N>
struct LaneTraits<Lanes<N>> {
  static constexpr int kCount = N;
  static double lane(const Lanes<N>& value, int number) { return value.lane(number); }
};

/// The number whose lane l is `f(l)`.
template <class T, class F>
T in_lanes(const F& f) {
  if constexpr (LaneTraits<T>::kCount == 1) {
    return f(0);
  } else {
    return T::of(f);
  }
}

/// Whether `holds(lane)` does for all lanes of a number type.
template <class T, class Condition>
bool in_all_lanes(const Condition& holds) {
  for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
    if (!holds(lane)) return false;
  }
  return true;
}

/// `x` where a < b, else `y`: of a `double`, or in each lane.
template <class T>
T if_less(const T& a, const T& b, const T& x, const T& y) {
  if constexpr (LaneTraits<T>::kCount == 1) {
    return a < b ? x : y;
  } else {
    return T::if_less(a, b, x, y);
  }
}

/// Whether a < b, in all lanes.
template <class T>
bool all_less(const T& a, const T& b) {
  if constexpr (LaneTraits<T>::kCount == 1) {
    return a < b;
  } else {
    return T::all_less(a, b);
  }
}

template <int N>
Lanes<N> sqrt(const Lanes<N>& x) {
  return in_lanes<Lanes<N>>([&](int lane) { return std::sqrt(x.lane(lane)); });
}

}  // namespace der

namespace Eigen {
template <int N>
struct NumTraits<der::Lanes<N>> : GenericNumTraits<double> {
  using Real = der::Lanes<N>;
  using NonInteger = der::Lanes<N>;
  using Nested = der::Lanes<N>;
  using Literal = double;
};
template <int N, class Operation>
struct ScalarBinaryOpTraits<double, der::Lanes<N>, Operation> {
  using ReturnType = der::Lanes<N>;
};
template <int N, class Operation>
struct ScalarBinaryOpTraits<der::Lanes<N>, double, Operation> {
  using ReturnType = der::Lanes<N>;
};
}  // namespace Eigen
