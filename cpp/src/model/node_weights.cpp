#include "der/model/node_weights.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "der/core/index.hpp"
#include "der/core/nearest_node.hpp"
#include "model/corner.hpp"

namespace der {
namespace {

constexpr Index kMost = kMostPointNodes;
constexpr Index kCubic = 4;  // nodes of a cubic

/// Arc lengths of the nodes [m], or a weight of each.
using Numbers = std::vector<double>;

/// Weights of the value at `s` of the polynomial through the nodes from `first` to before `last`.
Numbers lagrange_weights(const Numbers& nodes, std::size_t first, std::size_t last, double s) {
  Numbers weights(nodes.size(), 0.0);
  for (std::size_t i = first; i < last; ++i) {
    weights[i] = 1.0;
    for (std::size_t j = first; j < last; ++j) {
      if (j != i) weights[i] *= (s - nodes[j]) / (nodes[i] - nodes[j]);
    }
  }
  return weights;
}

/// Weights of the divided difference of an order through the nodes from `first` on, times the same
/// power of their mean distance: of polynomials of a lower degree it is 0.
Numbers difference(const Numbers& nodes, std::size_t first, std::size_t order) {
  const std::size_t last = first + order;
  const double distance = (nodes[last] - nodes[first]) / static_cast<double>(order);
  Numbers weights(nodes.size(), 0.0);
  for (std::size_t i = first; i <= last; ++i) {
    weights[i] = 1.0;
    for (std::size_t j = first; j <= last; ++j) {
      if (j != i) weights[i] *= distance / (nodes[i] - nodes[j]);
    }
  }
  return weights;
}

/// sum_ij a_i b_j |s_i - s_j| [m]
double kink(const Numbers& a, const Numbers& b, const Numbers& nodes) {
  double sum = 0.0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      sum += a[i] * b[j] * std::abs(nodes[i] - nodes[j]);
    }
  }
  return sum;
}

/// Adds differences of an order to weights so that they have no kink: the kink of w + D b is
/// k + 2 g . b - b . A b, with A positive definite, as |s| is conditionally negative definite. It
/// is largest at b = A^-1 g, and on the line from 0 through that the nearer of the two places with
/// no kink is taken. False, with the weights as they were, if there is none.
bool take_kink_out(const Numbers& nodes, std::size_t order, Numbers& weights) {
  constexpr int kMostDifferences = 3;
  using Vec = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostDifferences, 1>;
  using Mat =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostDifferences, kMostDifferences>;
  std::vector<Numbers> differences;
  for (std::size_t i = 0; i + order < nodes.size(); ++i) {
    differences.push_back(difference(nodes, i, order));
  }
  const auto count = static_cast<Index>(differences.size());
  Vec slope(count);
  Mat curving(count, count);
  for (Index i = 0; i < count; ++i) {
    slope[i] = kink(weights, differences[to_size(i)], nodes);
    for (Index j = 0; j < count; ++j) {
      curving(i, j) = -kink(differences[to_size(i)], differences[to_size(j)], nodes);
    }
  }
  const Vec top = curving.ldlt().solve(slope);
  const double rise = slope.dot(top);
  const double kink_at_top = kink(weights, weights, nodes) + rise;
  if (kink_at_top < 0.0) return false;
  // By the square roots, so that it holds without a slope, too, in whatever direction.
  const double size = std::sqrt(rise);
  const Vec direction =
      size > 0.0 ? Vec(top / size) : Vec(Vec::Unit(count, 0) / std::sqrt(curving(0, 0)));
  const Vec amounts = (size - std::sqrt(kink_at_top)) * direction;
  for (Index i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      weights[k] += amounts[i] * differences[to_size(i)][k];
    }
  }
  return true;
}

/// Weights of a cubic without its kink. Where an edge at an end is much longer than its neighbours
/// they give up the third moment for that.
void take_kink_out(const Numbers& nodes, Numbers& weights) {
  if (!take_kink_out(nodes, kCubic, weights)) take_kink_out(nodes, kCubic - 1, weights);
}

bool is_leg_end(const RodMesh& rod, Index place) {
  return std::any_of(rod.legs.begin(), rod.legs.end(),
                     [&](const Leg& leg) { return place == leg.first || place == leg.last; });
}

/// The places from the first to the last one that a point between `right - 1` and `right` may have:
/// up to the next ones on both sides where `ends` says that they end there.
template <class Ends>
std::pair<Index, Index> range_about(const RodMesh& rod, Index right, const Ends& ends) {
  Index first = right - 1;
  Index last = right;
  const auto goes_on = [&](Index place) { return rod.is_inner(place) && !ends(place); };
  while (first > right - kMost && goes_on(first)) --first;
  while (last < right + kMost - 1 && goes_on(last)) ++last;
  return {first, last};
}

}  // namespace

std::vector<Weighted> node_weights(const RodMesh& rod, double s, const Model& model) {
  const auto is_node = [&](Index place) {
    return std::abs(rod.arc_length_at(place) - s) <= rod.same_place();
  };
  const Index nearest = nearest_node(rod.arc_length, s);
  if (is_node(nearest)) return {{nearest, 1.0}};

  const auto& arc = rod.arc_length;
  const auto right = static_cast<Index>(std::upper_bound(arc.begin(), arc.end(), s) - arc.begin());
  const auto at_corner = [&](Index place) {
    return is_corner(rod, place, model) || is_leg_end(rod, place);
  };
  const auto at_force = [&](Index place) {
    return rod.divides_places[to_size(rod.position(place))] || at_corner(place);
  };
  auto [least, most] = range_about(rod, right, at_force);
  if (most - least + 1 < kCubic) std::tie(least, most) = range_about(rod, right, at_corner);

  const auto all = static_cast<Index>(arc.size());
  const Index count = std::min({kMost, all, most - least + 1});
  const auto moved_inwards = [&](Index first, Index nodes, Index from, Index to) {
    return std::clamp<Index>(first, from, to - nodes + 1);
  };
  const Index first = moved_inwards(right - kMost / 2, count, least, most);
  Numbers nodes;
  for (Index i = 0; i < count; ++i) nodes.push_back(rod.arc_length_at(first + i));
  const Index few = std::min(kCubic, count);
  const Index cubic = moved_inwards(right - kCubic / 2, few, first, first + count - 1) - first;
  Numbers weights = lagrange_weights(nodes, to_size(cubic), to_size(cubic + few), s);
  if (count > kCubic) take_kink_out(nodes, weights);

  std::vector<Weighted> result;
  for (Index i = 0; i < count; ++i) result.push_back({first + i, weights[to_size(i)]});
  return result;
}

}  // namespace der
