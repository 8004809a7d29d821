#include "der/output/strain_monitor.hpp"

#include <cmath>

#include "der/core/index.hpp"

namespace der {
namespace {

constexpr double kLongest = 2.0;  // times the rest length

}  // namespace

void StrainMonitor::look(const Model& model, const State& state) {
  if (found_) return;
  for (const RodMesh& rod : model.rods) {
    if (!rod.actuated_stretches.empty()) continue;
    for (Index i = 0; i < rod.num_edges(); ++i) {
      const Edge edge = rod.edge(i, model);
      double squares = 0.0;
      for (int c = 0; c < model.dimension; ++c) {
        squares += std::pow(state.positions[edge.last + c] - state.positions[edge.first + c], 2);
      }
      const double ratio = std::sqrt(squares) / edge.rest_length;
      if (ratio <= (found_ ? found_->ratio : kLongest)) continue;
      found_ = {rod.name, rod.edge_middle(i), ratio, state.time, state.load_factor};
    }
  }
}

}  // namespace der
