#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "der/core/types.hpp"

namespace der::scenario {

/// A smooth part of a drawn curve. Places on it are shares of its length, from 0 to 1.
class CurvePart {
 public:
  CurvePart() = default;
  CurvePart(const CurvePart&) = delete;
  CurvePart& operator=(const CurvePart&) = delete;
  virtual ~CurvePart() = default;

  [[nodiscard]] virtual double length() const = 0;  ///< [m]
  [[nodiscard]] virtual Vec3 point(double share) const = 0;
  /// Unit vector.
  [[nodiscard]] virtual Vec3 tangent(double share) const = 0;
  /// The vector about which the curve turns [1/m].
  [[nodiscard]] virtual Vec3 curvature(double share) const = 0;
  [[nodiscard]] virtual bool straight() const { return false; }
};

class StraightPart : public CurvePart {
 public:
  StraightPart(Vec3 from, Vec3 to) : from_(std::move(from)), to_(std::move(to)) {}

  [[nodiscard]] double length() const override {
    return std::hypot(std::hypot(to_.x() - from_.x(), to_.y() - from_.y()), to_.z() - from_.z());
  }
  [[nodiscard]] Vec3 point(double share) const override {
    return share == 1.0 ? to_ : Vec3(from_ + share * (to_ - from_));
  }
  [[nodiscard]] Vec3 tangent(double /*share*/) const override {
    return (to_ - from_).stableNormalized();
  }
  [[nodiscard]] Vec3 curvature(double /*share*/) const override { return Vec3::Zero(); }
  [[nodiscard]] bool straight() const override { return true; }

 private:
  Vec3 from_, to_;
};

/// A part of a helix, or of a circle: a turn about an axis, with a climb along it.
class TurningPart : public CurvePart {
 public:
  /// From a point, about an axis through `centre` with the unit vector `axis`, by an angle > 0.
  TurningPart(const Vec3& from, const Vec3& centre, Vec3 axis, double angle, double climb = 0.0)
      : from_(from), axis_(std::move(axis)), angle_(angle), climb_(climb) {
    outwards_ = from - centre;
    outwards_ -= outwards_.dot(axis_) * axis_;
    along_ = axis_.cross(outwards_);
    length_ = std::hypot(outwards_.norm() * angle, climb);
  }
  /// Ends exactly there.
  void end_at(const Vec3& to) { to_ = to; }

  [[nodiscard]] double length() const override { return length_; }
  [[nodiscard]] Vec3 point(double share) const override {
    if (share == 1.0 && to_) return *to_;
    const double half = std::sin(0.5 * share * angle_);  // no cancellation in flat arcs
    return from_ - 2.0 * half * half * outwards_ + std::sin(share * angle_) * along_ +
           share * climb_ * axis_;
  }
  [[nodiscard]] Vec3 tangent(double share) const override {
    return (rate_of_turn(share) + climb_ * axis_) / length_;
  }
  [[nodiscard]] Vec3 curvature(double share) const override {
    const double turn = share * angle_;
    const Vec3 inwards = -std::cos(turn) * outwards_ - std::sin(turn) * along_;
    const double rate = angle_ / length_;
    return rate * rate * tangent(share).cross(inwards);
  }

 private:
  [[nodiscard]] Vec3 rate_of_turn(double share) const {
    const double turn = share * angle_;
    return angle_ * (std::cos(turn) * along_ - std::sin(turn) * outwards_);
  }

  Vec3 from_, axis_;
  double angle_, climb_;
  Vec3 outwards_;  // from the axis to the start [m]
  Vec3 along_;     // where the turn begins to lead, as long [m]
  double length_ = 0.0;
  std::optional<Vec3> to_;
};

/// The cubic spline through points over their chord lengths, with two continuous derivatives. The
/// outermost two intervals have one polynomial; three points are on a parabola.
class SplinePart : public CurvePart {
 public:
  /// Part of a spline: from point `first` to point `last`.
  SplinePart(std::vector<Vec3> points, std::size_t first, std::size_t last)
      : points_(std::move(points)) {
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
      chords_.push_back((points_[i + 1] - points_[i]).norm());
    }
    find_slopes();
    measure(first, last);
  }

  [[nodiscard]] double length() const override { return arc_length_.back(); }
  [[nodiscard]] Vec3 point(double share) const override {
    const auto [interval, t] = place_of(share);
    // At its points exactly these, which others may share.
    return t == 0.0 ? points_[interval] : t == 1.0 ? points_[interval + 1] : value(interval, t);
  }
  [[nodiscard]] Vec3 tangent(double share) const override {
    const auto [interval, t] = place_of(share);
    return derivative(interval, t).normalized();
  }
  [[nodiscard]] Vec3 curvature(double share) const override {
    const auto [interval, t] = place_of(share);
    const Vec3 first = derivative(interval, t);
    const double speed = first.norm();
    return first.cross(second_derivative(interval, t)) / (speed * speed * speed);
  }

 private:
  static constexpr int kPieces = 8;  // of an interval, whose lengths are integrated one by one

  /// A tridiagonal system for the derivatives at the points by the chord length.
  void find_slopes() {
    const std::size_t count = points_.size();
    const auto secant = [&](std::size_t i) -> Vec3 {
      return (points_[i + 1] - points_[i]) / chords_[i];
    };
    if (count == 2) {
      slopes_.assign(2, secant(0));
      return;
    }
    std::vector<double> below(count, 0.0), middle(count, 1.0), above(count, 0.0);
    slopes_.resize(count);
    for (std::size_t i = 1; i + 1 < count; ++i) {
      below[i] = chords_[i];
      middle[i] = 2.0 * (chords_[i - 1] + chords_[i]);
      above[i] = chords_[i - 1];
      slopes_[i] = 3.0 * (chords_[i] * secant(i - 1) + chords_[i - 1] * secant(i));
    }
    // One polynomial on two intervals of lengths a, from the end, and b.
    const auto end_row = [&](double a, double b, const Vec3& at_end, const Vec3& inside) -> Vec3 {
      return ((a + 2.0 * (a + b)) * b * at_end + a * a * inside) / (a + b);
    };
    const std::size_t last = count - 1;
    if (count == 3) {
      above[0] = below[last] = 1.0;
      slopes_[0] = 2.0 * secant(0);
      slopes_[last] = 2.0 * secant(1);
    } else {
      middle[0] = chords_[1];
      above[0] = chords_[0] + chords_[1];
      slopes_[0] = end_row(chords_[0], chords_[1], secant(0), secant(1));
      middle[last] = chords_[last - 2];
      below[last] = chords_[last - 1] + chords_[last - 2];
      slopes_[last] =
          end_row(chords_[last - 1], chords_[last - 2], secant(last - 1), secant(last - 2));
    }
    for (std::size_t i = 1; i < count; ++i) {
      const double factor = below[i] / middle[i - 1];
      middle[i] -= factor * above[i - 1];
      slopes_[i] -= factor * slopes_[i - 1];
    }
    slopes_[last] /= middle[last];
    for (std::size_t i = last; i-- > 0;) {
      slopes_[i] = (slopes_[i] - above[i] * slopes_[i + 1]) / middle[i];
    }
  }

  void measure(std::size_t first, std::size_t last) {
    first_ = first;
    arc_length_.push_back(0.0);
    for (std::size_t interval = first; interval < last; ++interval) {
      for (int piece = 0; piece < kPieces; ++piece) {
        const double from = static_cast<double>(piece) / kPieces;
        arc_length_.push_back(arc_length_.back() + arc(interval, from, from + 1.0 / kPieces));
      }
    }
  }

  /// An interval, and the place in it from 0 to 1.
  [[nodiscard]] std::pair<std::size_t, double> place_of(double share) const {
    const double s = share * length();
    const auto above = std::upper_bound(arc_length_.begin() + 1, arc_length_.end() - 1, s);
    const auto piece = static_cast<std::size_t>(above - arc_length_.begin()) - 1;
    const std::size_t interval = first_ + piece / kPieces;
    const double from = static_cast<double>(piece % kPieces) / kPieces;
    if (s <= arc_length_[piece]) return {interval, from};
    if (s >= arc_length_[piece + 1]) return {interval, from + 1.0 / kPieces};
    const double beyond = s - arc_length_[piece];
    double t = from + beyond / (arc_length_[piece + 1] - arc_length_[piece]) / kPieces;
    for (int i = 0; i < 20; ++i) {
      const double step =
          (beyond - arc(interval, from, t)) / derivative(interval, t).norm() / chords_[interval];
      t = std::clamp(t + step, from, from + 1.0 / kPieces);
      if (std::abs(step) < 1e-15) break;
    }
    return {interval, t};
  }

  /// Length between two places of an interval [m].
  [[nodiscard]] double arc(std::size_t interval, double from, double to) const {
    constexpr std::array<double, 5> nodes{0.1488743389816312, 0.4333953941292472,
                                          0.6794095682990244, 0.8650633666889845,
                                          0.9739065285171717};
    constexpr std::array<double, 5> weights{0.2955242247147529, 0.2692667193099963,
                                            0.2190863625159820, 0.1494513491505806,
                                            0.0666713443086881};
    const double middle = 0.5 * (from + to);
    const double half = 0.5 * (to - from);
    double sum = 0.0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      sum += weights[i] * (derivative(interval, middle - half * nodes[i]).norm() +
                           derivative(interval, middle + half * nodes[i]).norm());
    }
    return sum * half * chords_[interval];
  }

  [[nodiscard]] Vec3 value(std::size_t i, double t) const {
    const double u = 1.0 - t;
    return u * u * (1.0 + 2.0 * t) * points_[i] + t * t * (1.0 + 2.0 * u) * points_[i + 1] +
           chords_[i] * t * u * (u * slopes_[i] - t * slopes_[i + 1]);
  }
  /// By the chord length.
  [[nodiscard]] Vec3 derivative(std::size_t i, double t) const {
    const double u = 1.0 - t;
    return 6.0 * t * u / chords_[i] * (points_[i + 1] - points_[i]) +
           u * (u - 2.0 * t) * slopes_[i] + t * (t - 2.0 * u) * slopes_[i + 1];
  }
  [[nodiscard]] Vec3 second_derivative(std::size_t i, double t) const {
    const Vec3 secant = (points_[i + 1] - points_[i]) / chords_[i];
    return (6.0 * (1.0 - 2.0 * t) * secant + (6.0 * t - 4.0) * slopes_[i] +
            (6.0 * t - 2.0) * slopes_[i + 1]) /
           chords_[i];
  }

  std::vector<Vec3> points_, slopes_;
  std::vector<double> chords_;      // [m]
  std::size_t first_ = 0;           // interval at which it begins
  std::vector<double> arc_length_;  // of the pieces' ends [m]
};

}  // namespace der::scenario
