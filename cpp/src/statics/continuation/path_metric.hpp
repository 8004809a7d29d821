#pragma once

#include <algorithm>
#include <cmath>

#include "der/core/types.hpp"
#include "der/model/dof_map.hpp"

namespace der::statics {

/// A point in the space in which a path lies, or a difference of two: the free degrees of freedom
/// [m] and the load factor.
struct PathPosition {
  Vector x;
  double factor = 0.0;
};

/// a + step * b.
inline PathPosition combine(const PathPosition& a, double step, const PathPosition& b) {
  return {a.x + step * b.x, a.factor + step * b.factor};
}

inline PathPosition difference(const PathPosition& to, const PathPosition& from) {
  return combine(to, -1.0, from);
}

inline void reverse(PathPosition& direction) {
  direction.x = -direction.x;
  direction.factor = -direction.factor;
}

/// The metric of arc length: <a, b> = weight a.x b.x + a.factor b.factor / range^2, angles in x
/// counting as the lengths that the map of degrees of freedom gives them.
class PathMetric {
 public:
  /// `weight` [1/m^2] makes the displacements dimensionless, `range` the factor.
  PathMetric(const DofMap& dofs, double weight, double range)
      : squared_lengths_(dofs.num_free()), weight_(weight), range_(range) {
    for (Index i = 0; i < dofs.num_free(); ++i) {
      const double length = dofs.motion_of(dofs.free()[to_size(i)], 1.0);
      squared_lengths_[i] = length * length;
    }
  }

  [[nodiscard]] double dot(const PathPosition& a, const PathPosition& b) const {
    return dot(a.x, b.x) + a.factor * b.factor / (range_ * range_);
  }
  /// The part of two displacements of the free degrees of freedom.
  [[nodiscard]] double dot(const Vector& a, const Vector& b) const {
    return weight_ * a.dot(squared_lengths_.cwiseProduct(b));
  }
  [[nodiscard]] double norm(const PathPosition& a) const { return std::sqrt(dot(a, a)); }
  [[nodiscard]] double distance(const PathPosition& a, const PathPosition& b) const {
    return norm(difference(a, b));
  }
  [[nodiscard]] PathPosition unit(PathPosition a) const {
    const double length = norm(a);
    a.x /= length;
    a.factor /= length;
    return a;
  }
  [[nodiscard]] double range() const { return range_; }

  /// Makes displacements count as much as the factor does along a unit tangent, within bounds.
  void balance(const PathPosition& tangent) {
    constexpr double kMostWeight = 20.0;
    const double share = std::abs(tangent.factor / range_);
    const double motion = std::sqrt(std::max(0.0, 1.0 - share * share));
    const double scale = std::clamp(motion > 0.0 ? share / motion : kMostWeight, 1.0, kMostWeight);
    weight_ *= scale * scale;
  }

 private:
  Vector squared_lengths_;  // [m^2] of the free degrees of freedom, for a unit of each
  double weight_;
  double range_;
};

}  // namespace der::statics
