#include "der/output/crossing_monitor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "der/core/constants.hpp"
#include "der/core/index.hpp"

namespace der {
namespace {

/// Axes nearer than this part of the sum of the radii pass through one another; where the watch
/// begins, rods that touch overlap, too.
constexpr double kThrough = 0.95;
constexpr double kTouching = 1.05;
/// Axes nearer than this part of the structure's size cross, with or without radii.
constexpr double kCrossing = 1e-12;
/// Ends meet if they lie beyond one another by less than this part of their pieces.
constexpr double kMeeting = 1e-3;
/// Work of a look, in pairs of boxes of 6 ns: of a piece; that a node pays for in a step, a
/// hundredth of what the step costs there; that is saved up at most, in looks.
constexpr double kWorkOfPiece = 4.0;
constexpr double kIncome = 1.6;
constexpr double kSavings = 20.0;

double radius_of(const Model& model, Index rod) { return model.rods[to_size(rod)].draw_radius; }

Vec3 point_of(const Model& model, const Vector& positions, Index node) {
  Vec3 point = Vec3::Zero();
  point.head(model.dimension) = positions.segment(model.dof(node, 0), model.dimension);
  return point;
}

/// The places, as shares from 0 to 1, at which two straight pieces are nearest.
std::array<double, 2> nearest_places(const Vec3& a, const Vec3& a_end, const Vec3& b,
                                     const Vec3& b_end) {
  const Vec3 u = a_end - a;
  const Vec3 v = b_end - b;
  const Vec3 w = a - b;
  const double uu = u.squaredNorm();
  const double vv = v.squaredNorm();
  const double uv = u.dot(v);
  const double uw = u.dot(w);
  const double vw = v.dot(w);
  const auto share = [](double part, double whole) {
    return whole > 0.0 ? std::clamp(part / whole, 0.0, 1.0) : 0.0;
  };
  double s = share(uv * vw - vv * uw, uu * vv - uv * uv);
  double t = share(uv * s + vw, vv);
  s = share(uv * t - uw, uu);
  t = share(uv * s + vw, vv);
  return {s, t};
}

}  // namespace

CrossingMonitor::CrossingMonitor(const Model& model, const State* start, double step_cost)
    : income_(kIncome * step_cost * static_cast<double>(model.num_nodes)),
      same_(kCrossing * model.size()) {
  for (const RodMesh& rod : model.rods) {
    thickest_ = std::max(thickest_, rod.draw_radius);
    longest_edge_.push_back(*std::max_element(rod.edge_length.begin(), rod.edge_length.end()));
  }
  seen_ = model.initial_positions.head(model.dofs.num_positions());
  const double touching = std::max(2.0 * kTouching * thickest_, same_);
  const auto enter_overlaps = [&](const Vector& shape) {
    if (!shape.allFinite()) return;
    cut_into_pieces(model, shape);
    each_pair(model, touching, [&](const Pair& pair) {
      if (pair.apart < std::max(kTouching * pair.radii, same_)) {
        overlaps_.push_back(places_of(pair));
      }
    });
  };
  enter_overlaps(model.initial_positions);
  if (start != nullptr) enter_overlaps(start->positions);
  if (start == nullptr) credit_ = work_;  // for a first look at once
  std::sort(overlaps_.begin(), overlaps_.end());
}

bool CrossingMonitor::Places::operator<(const Places& other) const {
  return std::tie(first_rod, second_rod, first_place, second_place) <
         std::tie(other.first_rod, other.second_rod, other.first_place, other.second_place);
}

void CrossingMonitor::after_step(const Model& model, const State& state) {
  if (found_) return;
  credit_ = std::min(credit_ + income_, std::max(kSavings * work_, income_));
  if (credit_ < work_) return;
  const double moved = (state.positions.head(seen_.size()) - seen_).lpNorm<Eigen::Infinity>();
  if (2.0 * std::sqrt(model.dimension) * moved < clearance_) return;
  look(model, state);
}

void CrossingMonitor::look(const Model& model, const State& state) {
  if (found_ || !state.positions.allFinite()) return;
  cut_into_pieces(model, state.positions);
  seen_ = state.positions.head(model.dofs.num_positions());
  clearance_ = std::numeric_limits<double>::infinity();
  double limit = clearance_;
  std::optional<Pair> nearest;
  each_pair(model, limit, [&](const Pair& pair) {
    const double clear = pair.apart - std::max(kThrough * pair.radii, same_);
    if (clear >= clearance_ || is_left_out(model, pair)) return;
    nearest = pair;
    clearance_ = clear;
    limit = clear + std::max(2.0 * kThrough * thickest_, same_);
  });
  credit_ -= work_;
  if (!nearest || clearance_ >= 0.0) return;
  const Places places = places_of(*nearest);
  found_ = Crossing{model.rods[to_size(places.first_rod)].name,
                    model.rods[to_size(places.second_rod)].name,
                    places.first_place,
                    places.second_place,
                    state.time,
                    state.load_factor};
}

void CrossingMonitor::cut_into_pieces(const Model& model, const Vector& positions) {
  pieces_.clear();
  length_.assign(model.rods.size(), 0.0);
  for (Index rod = 0; rod < static_cast<Index>(model.rods.size()); ++rod) {
    cut_rod(model, rod, positions);
  }
}

/// Short edges are joined: far below the radius a piece tells no more.
void CrossingMonitor::cut_rod(const Model& model, Index number, const Vector& positions) {
  const RodMesh& rod = model.rods[to_size(number)];
  Piece piece;
  piece.rod = number;
  piece.from = point_of(model, positions, rod.node(0));
  for (Index edge = 0; edge < rod.num_edges(); ++edge) {
    piece.to = point_of(model, positions, rod.node(edge + 1));
    piece.rest_end = rod.arc_length_at(edge) + rod.edge_length[to_size(edge)];
    const double length = (piece.to - piece.from).norm();
    piece.end = piece.start + length;
    const bool last = edge + 1 == rod.num_edges();
    if (!last && length + rod.edge_length[to_size(edge)] < rod.draw_radius) continue;
    pieces_.push_back(piece);
    piece.from = piece.to;
    piece.start = piece.end;
    piece.rest_start = piece.rest_end;
  }
  length_[to_size(number)] = piece.end;
}

Index CrossingMonitor::put_into_boxes(Index first, Index count) {
  const auto number = static_cast<Index>(boxes_.size());
  boxes_.emplace_back();
  Box box;
  box.first = first;
  box.count = count;
  if (count == 1) {
    const Piece& piece = pieces_[to_size(first)];
    box.low = piece.from.cwiseMin(piece.to);
    box.high = piece.from.cwiseMax(piece.to);
  } else {
    box.halves[0] = put_into_boxes(first, count / 2);
    box.halves[1] = put_into_boxes(first + count / 2, count - count / 2);
    const Box& a = boxes_[to_size(box.halves[0])];
    const Box& b = boxes_[to_size(box.halves[1])];
    box.low = a.low.cwiseMin(b.low);
    box.high = a.high.cwiseMax(b.high);
  }
  boxes_[to_size(number)] = box;
  return number;
}

template <class Take>
void CrossingMonitor::each_pair(const Model& model, const double& limit, Take&& take) {
  const auto count = static_cast<Index>(pieces_.size());
  work_ = kWorkOfPiece * static_cast<double>(count);
  boxes_.clear();
  boxes_.reserve(2 * pieces_.size());
  put_into_boxes(0, count);
  // Far ranges last: near neighbours lower the limit first.
  for (Index number = static_cast<Index>(boxes_.size()) - 1; number >= 0; --number) {
    const Box& box = boxes_[to_size(number)];
    if (box.count > 1) pairs_between(model, box.halves[0], box.halves[1], limit, take);
  }
}

/// Box `a` has the pieces before those of `b`.
template <class Take>
void CrossingMonitor::pairs_between(const Model& model, Index a, Index b, const double& limit,
                                    Take&& take) {
  work_ += 1.0;
  const Box& first = boxes_[to_size(a)];
  const Box& second = boxes_[to_size(b)];
  const Vec3 gap =
      (first.low - second.high).cwiseMax(second.low - first.high).cwiseMax(Vec3::Zero());
  if (gap.squaredNorm() >= limit * limit) return;
  const Piece& start = pieces_[to_size(first.first)];
  const Piece& end = pieces_[to_size(second.first + second.count - 1)];
  if (start.rod == end.rod && end.start - start.end <= neighbourhood(model, start.rod)) return;
  if (first.count == 1 && second.count == 1) {
    if (can_meet(model, start, end)) take(pair_of(model, first.first, second.first));
  } else if (first.count >= second.count) {
    pairs_between(model, first.halves[1], b, limit, take);
    pairs_between(model, first.halves[0], b, limit, take);
  } else {
    pairs_between(model, a, second.halves[0], limit, take);
    pairs_between(model, a, second.halves[1], limit, take);
  }
}

/// Bent to its own radius all around, a rod comes back to itself after this length [m].
double CrossingMonitor::neighbourhood(const Model& model, Index rod) const {
  return 2.0 * kPi * radius_of(model, rod) + same_;
}

/// The pieces come in the order of their rods and arc lengths.
bool CrossingMonitor::can_meet(const Model& model, const Piece& a, const Piece& b) const {
  const bool crosses =
      model.dimension == 2 || radius_of(model, a.rod) + radius_of(model, b.rod) > 0;
  if (a.rod != b.rod || !crosses) return crosses;
  const double around = neighbourhood(model, a.rod);
  const double other_way = length_[to_size(a.rod)] - (b.end - a.start);
  return b.start - a.end > around && (!model.rods[to_size(a.rod)].closed || other_way > around);
}

CrossingMonitor::Pair CrossingMonitor::pair_of(const Model& model, Index a, Index b) const {
  const Piece& first = pieces_[to_size(a)];
  const Piece& second = pieces_[to_size(b)];
  const auto [s, t] = nearest_places(first.from, first.to, second.from, second.to);
  const Vec3 between =
      (1.0 - s) * first.from + s * first.to - (1.0 - t) * second.from - t * second.to;
  return {a, b, s, t, between.norm(), radius_of(model, first.rod) + radius_of(model, second.rod)};
}

CrossingMonitor::Places CrossingMonitor::places_of(const Pair& pair) const {
  const auto place = [&](Index number, double share) {
    const Piece& piece = pieces_[to_size(number)];
    return (1.0 - share) * piece.rest_start + share * piece.rest_end;
  };
  return {pieces_[to_size(pair.first)].rod, pieces_[to_size(pair.second)].rod,
          place(pair.first, pair.first_share), place(pair.second, pair.second_share)};
}

/// Ends that meet, as those of a strip that rolls up to a ring do, pass through nothing.
bool CrossingMonitor::is_left_out(const Model& model, const Pair& pair) const {
  const auto from_end = [&](Index number, double share) {
    const Piece& piece = pieces_[to_size(number)];
    if (model.rods[to_size(piece.rod)].closed) return std::numeric_limits<double>::infinity();
    const double s = (1.0 - share) * piece.start + share * piece.end;
    return std::min(s, length_[to_size(piece.rod)] - s);
  };
  const auto length = [&](Index number) {
    return pieces_[to_size(number)].end - pieces_[to_size(number)].start;
  };
  const double little = kMeeting * (length(pair.first) + length(pair.second));
  const double both =
      from_end(pair.first, pair.first_share) + from_end(pair.second, pair.second_share);
  return both <= kPi * pair.radii + little || has_overlapped(model, pair);
}

/// Whether the pair is near places that overlapped at the start. Near is an edge, since an overlap
/// of parallel pieces has a place an edge, and as much as a bend could bring together.
bool CrossingMonitor::has_overlapped(const Model& model, const Pair& pair) const {
  if (overlaps_.empty()) return false;
  const Places now = places_of(pair);
  const auto first = to_size(now.first_rod);
  const auto second = to_size(now.second_rod);
  const double near = kPi * pair.radii + std::max(longest_edge_[first], longest_edge_[second]);
  // The other ways around a ring; both of its places may have passed the seam.
  const int around_first = model.rods[first].closed ? 1 : 0;
  const int around_second = model.rods[second].closed ? 1 : 0;
  for (int i = -around_first; i <= around_first; ++i) {
    for (int j = -around_second; j <= around_second; ++j) {
      Places there = now;
      there.first_place += i * model.rods[first].rest_length();
      there.second_place += j * model.rods[second].rest_length();
      if (is_near_an_overlap(there, near)) return true;
      if (first != second || around_first == 0) continue;
      std::swap(there.first_place, there.second_place);
      if (is_near_an_overlap(there, near)) return true;
    }
  }
  return false;
}

bool CrossingMonitor::is_near_an_overlap(const Places& places, double near) const {
  Places from = places;
  from.first_place -= near;
  from.second_place = -std::numeric_limits<double>::infinity();
  const auto may_be_near = [&](const Places& overlap) {
    return overlap.first_rod == places.first_rod && overlap.second_rod == places.second_rod &&
           overlap.first_place <= places.first_place + near;
  };
  for (auto overlap = std::lower_bound(overlaps_.begin(), overlaps_.end(), from);
       overlap != overlaps_.end() && may_be_near(*overlap); ++overlap) {
    if (std::abs(overlap->second_place - places.second_place) <= near) return true;
  }
  return false;
}

std::string describe(const CrossingMonitor::Crossing& crossing, const std::string& when) {
  const std::string what =
      crossing.first_rod == crossing.second_rod
          ? fmt::format(
                "rod '{}' passes through itself {}, at its arc lengths {:.4g} m and {:.4g} m",
                crossing.first_rod, when, crossing.first_place, crossing.second_place)
          : fmt::format(
                "rods '{}' and '{}' pass through one another {}, at the arc lengths {:.4g} "
                "m and {:.4g} m",
                crossing.first_rod, crossing.second_rod, when, crossing.first_place,
                crossing.second_place);
  return what + ". Rods have no contact: from then on a real structure would move otherwise";
}

}  // namespace der
