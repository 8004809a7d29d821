#include "solvers/stage_kernels.hpp"

#include <algorithm>

#include "der/core/loops.hpp"
#include "der/core/magnitude.hpp"

namespace der {
namespace {

// The loops see plain arrays that do not overlap.

double subtract(Index size, const double* __restrict force, double* __restrict residual) {
  std::int64_t largest = 0;
  for (Index i = 0; i < size; ++i) {
    largest = std::max(largest, magnitude_bits(residual[i]));
    residual[i] -= force[i];
  }
  return magnitude_of(largest);
}

double add_inertia(Index size, double factor, const double* __restrict lumped,
                   const double* __restrict displacement, const double* __restrict target,
                   double* __restrict acceleration, double* __restrict residual) {
  std::int64_t largest = 0;
  for (Index i = 0; i < size; ++i) {
    const double a = factor * (displacement[i] - target[i]);
    const double force = lumped[i] * a;
    acceleration[i] = a;
    residual[i] += force;
    largest = std::max(largest, magnitude_bits(force));
  }
  return magnitude_of(largest);
}

}  // namespace

double subtract_force(const DofMap& dofs, const Vector& force, Vector& residual) {
  return largest_over(dofs.blocks(), [&](const DofBlock& block) {
    const Index i = block.first;
    const double largest =
        run_loop([&] { return subtract(block.count, force.data() + i, residual.data() + i); });
    return largest / block.length;
  });
}

double add_lumped_inertia(const DofMap& dofs, double factor, const Vector& lumped,
                          const Vector& displacement, const Vector& target, Vector& acceleration,
                          Vector& residual) {
  return largest_over(dofs.blocks(), [&](const DofBlock& block) {
    const Index i = block.first;
    const double largest = run_loop([&] {
      return add_inertia(block.count, factor, lumped.data() + i, displacement.data() + i,
                         target.data() + i, acceleration.data() + i, residual.data() + i);
    });
    return largest / block.length;
  });
}

}  // namespace der
