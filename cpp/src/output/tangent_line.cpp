#include "output/tangent_line.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "der/core/index.hpp"
#include "der/model/location.hpp"
#include "model/corner.hpp"

namespace der {
namespace {

/// What a jump of the curvature by 1 at `kink` adds at `s` to a line that begins before it [m].
double beyond(double s, double kink) { return std::max(0.0, s - kink); }

}  // namespace

TangentLine::TangentLine(const RodLayout& rod, std::vector<double> kinks, const Model& model)
    : kinks_(std::move(kinks)) {
  find_knots(rod, model);
  const double length = rod.closed ? rod.rest_length() : 0.0;
  for (const Leg& leg : legs_) {
    if (leg.to <= 0.0 || leg.from >= rod.rest_length()) continue;  // the neighbours of a ring's
    std::vector<std::pair<double, bool>> places;                   // and whether it is smooth there
    for (Index node = 0; node <= rod.num_edges(); ++node) {
      const bool end = node == 0 || node == rod.num_edges();
      places.emplace_back(rod.arc_length_at(node), !end && rod.clamp_at(node) == nullptr);
    }
    for (const double kink : kinks_) {
      for (auto& [s, smooth] : places) {
        if (std::abs(s - kink) <= rod.same_place()) smooth = false;
      }
      const bool is_node = std::any_of(places.begin(), places.end(), [&](const auto& place) {
        return std::abs(place.first - kink) <= rod.same_place();
      });
      if (!is_node) places.emplace_back(kink, false);
    }
    std::sort(places.begin(), places.end());
    for (const auto& [s, smooth] : places) {
      if (s < leg.from - rod.same_place() || s > leg.to + rod.same_place()) continue;
      const bool corner = std::min(s - leg.from, leg.to - s) <= rod.same_place();
      add_sample(s, leg, smooth && !corner, length);
    }
  }
}

void TangentLine::find_knots(const RodLayout& rod, const Model& model) {
  // A ring's first and last edge have neighbours, too.
  const Index first = rod.closed ? -1 : 0;
  const Index last = rod.num_edges() + (rod.closed ? 1 : 0);
  legs_.push_back({rod.arc_length_at(first), 0.0, 0, 0});
  for (Index place = first; place <= last; ++place) {
    if (place > first && place < last && rod.clamp_at(place) == nullptr &&
        is_corner(rod, place, model)) {
      legs_.back().to = rod.arc_length_at(place);
      legs_.back().last = knots_.size();
      legs_.push_back({rod.arc_length_at(place), 0.0, knots_.size(), 0});
    }
    if (const Clamp* clamp = rod.clamp_at(place)) {
      knots_.push_back(
          {rod.arc_length_at(place), -1, static_cast<Index>(clamp - rod.clamps.data())});
    }
    if (place < last) knots_.push_back({tangent_place(rod, place), place, -1});
  }
  legs_.back().to = rod.arc_length_at(last);
  legs_.back().last = knots_.size();
}

/// `length` [m] of a ring, 0 of an open rod.
void TangentLine::add_sample(double s, const Leg& leg, bool smooth, double length) {
  Sample sample{s, {}, {}, smooth};
  if (leg.last - leg.first == 1) {
    sample.knots = {{leg.first, 1.0}};
    samples_.push_back(std::move(sample));
    return;
  }
  std::size_t right = leg.first + 1;
  while (right + 1 < leg.last && knots_[right].arc_length < s) ++right;
  const double a = knots_[right - 1].arc_length;
  const double b = knots_[right].arc_length;
  const double share = (s - a) / (b - a);
  sample.knots = {{right - 1, 1.0 - share}, {right, share}};
  for (std::size_t i = 0; i < kinks_.size(); ++i) {
    double factor = 0.0;
    for (const double turn : {-1.0, 0.0, 1.0}) {
      if (turn != 0.0 && length == 0.0) continue;
      const double kink = kinks_[i] + turn * length;
      factor += beyond(s, kink) - (1.0 - share) * beyond(a, kink) - share * beyond(b, kink);
    }
    if (std::abs(factor) > 1e-12 * (b - a)) sample.kinks.push_back({i, factor});
  }
  samples_.push_back(std::move(sample));
}

}  // namespace der
