#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

namespace der {

template <int N>
struct LaneRegister;
// A `using` cannot have this attribute, and GCC does not take it with the size of a template.
template <>
struct LaneRegister<2> {
  typedef double type __attribute__((vector_size(16)));  // NOLINT(modernize-use-using)
};
template <>
struct LaneRegister<4> {
  // Eigen aligns its matrices to 16 bytes.
  typedef double type __attribute__((vector_size(32), aligned(16)));  // NOLINT(modernize-use-using)
};

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
  Lanes& operator=(const Lanes& other) = default;
  // Not explicit: a constant of a formula is the same in all lanes.
  Lanes(double value)  // NOLINT(google-explicit-constructor)
      : Lanes([&](int /*lane*/) { return value; }, All{}) {}
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
  Register values_;
};
using TwoLanes = Lanes<2>;
using FourLanes = Lanes<4>;

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
