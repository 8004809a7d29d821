#include "scenario/resampled_rod.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scenario/rest_line.hpp"

namespace der::scenario {
namespace {

double between(double a, double b, double share) { return (1.0 - share) * a + share * b; }
CurvaturePair between(const CurvaturePair& a, const CurvaturePair& b, double share) {
  return {between(a.first, b.first, share), between(a.second, b.second, share)};
}
Components between(const Components& a, const Components& b, double share) {
  Components result(a.size());
  for (std::size_t c = 0; c < a.size(); ++c) result[c] = between(a[c], b[c], share);
  return result;
}

template <class Item>
void resample(const std::vector<OldPlace>& nodes, std::vector<Item>& list) {
  std::vector<Item> result;
  result.reserve(nodes.size());
  for (const auto& [before, share] : nodes) {
    const auto first = static_cast<std::size_t>(before);
    result.push_back(between(list[first], list[(first + 1) % list.size()], share));
  }
  list = std::move(result);
}

/// A list of numbers that jumps at some of its entries, linear between all others.
class ListWithJumps {
 public:
  ListWithJumps(const std::vector<double>& list, const std::vector<int>& jumps)
      : list_(list), jumps_(jumps) {}

  /// The mean over the cell of the new node `number` if it is at a jump.
  [[nodiscard]] double value(const std::vector<OldPlace>& nodes, std::size_t number) const {
    constexpr double kRounding = 1e-9;
    const auto [before, share] = nodes[number];
    const int nearest = share > 0.5 ? before + 1 : before;
    const auto place = [&](std::size_t i) { return nodes[i].before + nodes[i].share; };
    if (jumps_at(nearest) && std::abs(before + share - nearest) < kRounding) {
      const double cell =
          (place(number) - place(number - 1)) / (place(number + 1) - place(number - 1));
      return between(continued(nearest, 1), continued(nearest, -1), cell);
    }
    return between(jumps_at(before) ? continued(before, 1) : at(before),
                   jumps_at(before + 1) ? continued(before + 1, -1) : at(before + 1), share);
  }

 private:
  /// Behind the last of a ring its first one follows.
  [[nodiscard]] double at(int i) const { return list_[static_cast<std::size_t>(i) % list_.size()]; }
  [[nodiscard]] double continued(int i, int side) const {
    return 2.0 * at(i + side) - at(i + 2 * side);
  }
  [[nodiscard]] bool jumps_at(int i) const {
    return std::find(jumps_.begin(), jumps_.end(), i) != jumps_.end();
  }

  const std::vector<double>& list_;
  const std::vector<int>& jumps_;
};

}  // namespace

std::vector<int> natural_jumps(const Rod& rod, double cell) {
  const auto* list = std::get_if<std::vector<double>>(&rod.natural_curvature);
  if (list == nullptr) return {};
  constexpr int kBeside = 2;
  constexpr double kClear = 2.0;
  const auto beyond_chords = [cell](double curvature) {
    return std::abs(curvature) * std::pow(curvature * cell, 2) / 24.0;
  };
  std::vector<int> jumps;
  for (int i = kBeside + 1; i + kBeside + 1 < static_cast<int>(list->size()); ++i) {
    const auto at = [&](int k) { return (*list)[static_cast<std::size_t>(i + k)]; };
    const double before = 2.0 * at(-1) - at(-2);
    const double after = 2.0 * at(1) - at(2);
    const double uncertain = std::abs(at(-1) - at(-2)) + std::abs(at(1) - at(2)) +
                             std::abs(at(0) - 0.5 * (before + after)) + beyond_chords(before) +
                             beyond_chords(after);
    const double least = 1e-6 / cell;  // rounding
    if (std::abs(after - before) > std::max(kClear * uncertain, least)) jumps.push_back(i);
  }
  return jumps;
}

void resample_lists(const std::vector<OldPlace>& nodes, const std::vector<int>& jumps, Rod& rod) {
  if (!rod.initial_velocity.empty()) resample(nodes, rod.initial_velocity);
  if (auto* list = std::get_if<std::vector<double>>(&rod.natural_curvature)) {
    const ListWithJumps old(*list, jumps);
    std::vector<double> values;
    for (std::size_t i = 0; i < nodes.size(); ++i) values.push_back(old.value(nodes, i));
    *list = std::move(values);
  }
  if (auto* list = std::get_if<std::vector<CurvaturePair>>(&rod.natural_curvature)) {
    resample(nodes, *list);
  }
  if (auto* list = std::get_if<std::vector<double>>(&rod.natural_twist)) resample(nodes, *list);
}

}  // namespace der::scenario
