#include "der/model/mass.hpp"

#include "der/core/sum_of.hpp"

namespace der {

Vector Mass::momentum(const Vector& velocities) const {
  Vector momentum = lumped.cwiseProduct(velocities);
  for (const auto& [a, b, mass] : coupling) {
    const double shared = mass * (velocities[a] - velocities[b]);
    momentum[a] -= shared;
    momentum[b] += shared;
  }
  return momentum;
}

double Mass::kinetic_energy(const Vector& velocities) const {
  double twice = sum_of<double>(static_cast<Index>(velocities.size()), [&](Index i) {
    return velocities[i] * (lumped[i] * velocities[i]);
  });
  for (const auto& [a, b, mass] : coupling) {
    const double difference = velocities[a] - velocities[b];
    twice -= mass * difference * difference;
  }
  return 0.5 * twice;
}

Vector Mass::lower_bound() const {
  // (v_a - v_b)^2 <= 2 v_a^2 + 2 v_b^2
  Vector bound = lumped;
  for (const auto& [a, b, mass] : coupling) {
    bound[a] -= 2.0 * mass;
    bound[b] -= 2.0 * mass;
  }
  return bound;
}

}  // namespace der
