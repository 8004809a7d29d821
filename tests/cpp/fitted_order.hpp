#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace der::test {

/// Slope of log(error) against log(step) by least squares.
inline double fitted_order(const std::vector<double>& steps, const std::vector<double>& errors) {
  double sx = 0.0;
  double sy = 0.0;
  double sxx = 0.0;
  double sxy = 0.0;
  const auto n = static_cast<double>(steps.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double x = std::log(steps[i]);
    const double y = std::log(errors[i]);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace der::test
