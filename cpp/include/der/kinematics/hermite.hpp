#pragma once

namespace der {

/// The cubic with values x0, x1 and slopes v0, v1 at the ends of an interval of length h, and its
/// slope, at the fraction u of it.
struct Hermite {
  Hermite(double u, double h)
      : x0((1.0 + 2.0 * u) * (1.0 - u) * (1.0 - u)),
        x1(u * u * (3.0 - 2.0 * u)),
        v0(h * u * (1.0 - u) * (1.0 - u)),
        v1(-h * u * u * (1.0 - u)),
        slope_x((6.0 * u - 6.0 * u * u) / h),
        slope_v0((1.0 - u) * (1.0 - 3.0 * u)),
        slope_v1(u * (3.0 * u - 2.0)) {}
  double x0, x1, v0, v1;
  double slope_x, slope_v0, slope_v1;

  /// Takes numbers or vectors.
  template <class T>
  auto value(const T& first, const T& last, const T& first_rate, const T& last_rate) const {
    return x0 * first + x1 * last + v0 * first_rate + v1 * last_rate;
  }
  template <class T>
  auto rate(const T& first, const T& last, const T& first_rate, const T& last_rate) const {
    return slope_x * (last - first) + slope_v0 * first_rate + slope_v1 * last_rate;
  }
};

}  // namespace der
