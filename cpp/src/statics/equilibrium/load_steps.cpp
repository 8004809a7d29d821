#include "statics/equilibrium/load_steps.hpp"

#include <utility>

namespace der::statics {
namespace {

/// First load step as a fraction of the whole; a power of two, so that doubling ends at 1.
constexpr double kFirstShare = 1.0 / 256.0;

}  // namespace

bool step_loads(const Model& model, const StaticLoads& loads, double force_scale,
                PseudoTransient& continuation, Shape& shape) {
  Shape now = shape;
  for (double share = kFirstShare; share <= 1.0; share *= 2.0) {
    const double inverse_step = share * force_scale / model.size();
    if (continuation.run(scaled(model, loads, share), inverse_step, now).failed) return false;
  }
  shape = std::move(now);
  return true;
}

}  // namespace der::statics
