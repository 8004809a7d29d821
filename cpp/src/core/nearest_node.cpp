#include "der/core/nearest_node.hpp"

#include <algorithm>

#include "der/core/index.hpp"

namespace der {

Index nearest_node(const std::vector<double>& arc_length, double s) {
  const auto above = std::lower_bound(arc_length.begin(), arc_length.end(), s);
  const auto last = static_cast<Index>(arc_length.size()) - 1;
  const Index after = std::min(static_cast<Index>(above - arc_length.begin()), last);
  if (after == 0) return 0;
  return s - arc_length[to_size(after - 1)] < arc_length[to_size(after)] - s ? after - 1 : after;
}

}  // namespace der
