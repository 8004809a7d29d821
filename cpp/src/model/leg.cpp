#include "der/model/leg.hpp"

#include "der/core/index.hpp"

namespace der {

Mat3 end_compliance(const Leg& leg, bool from_start, const std::vector<double>& edge_length) {
  const auto length = [&](Index k) {
    return edge_length[to_size(from_start ? leg.first + k : leg.last - 1 - k)];
  };
  const double first = length(0);
  Mat3 C = Mat3::Zero();
  C(0, 0) = first / 3.0;
  if (leg.num_cells() == 1) {
    C(1, 1) = C(0, 0);
    C(0, 1) = C(1, 0) = first / 6.0;
    return C;
  }
  const double second = length(1);
  if (leg.num_cells() == 2) {
    C(1, 1) = 0.5 * (first + second);
    C(2, 2) = second / 3.0;
    C(0, 1) = C(1, 0) = first / 6.0 - second / 12.0;
    C(1, 2) = C(2, 1) = second / 6.0 - first / 12.0;
  } else {
    C(1, 1) = first / 3.0 + 0.5 * second + second * second / (6.0 * first);
    C(0, 1) = C(1, 0) = first / 6.0 - second * second / (12.0 * first);
  }
  return C;
}

}  // namespace der
