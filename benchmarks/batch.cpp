// Batches against a loop over simulations of the same scene: one step of all, where each member's
// memory comes from afar in both, and many steps of each member after another. Compare lines of one
// run. Arguments: nodes; members; steps; whether members go in lanes. Those that do not show what a
// batch costs beyond its members. benchmarks/batch.py runs these.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "der/batch/batch.hpp"

namespace der {
namespace {

/// A clamp whose angle is set keeps members out of lanes.
Scenario swing(std::int64_t nodes, bool in_lanes) {
  return Scenario::parse(R"(
rods:
  - name: rod
    nodes: )" + std::to_string(nodes) +
                         R"(
    from: [0, 0]
    to: [1, 0]
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e7, density: 1000}
supports: [{rod: rod, at: start, clamp: true, prescribe: {)" +
                         (in_lanes ? "x: 0" : "angle: 0") + R"(}}]
loads: [{gravity: [0, -9.81]}]
time: {duration: 1, step: 0.0025, integrator: implicit_midpoint}
solver: {residual_tolerance: 1e-3, step_tolerance: 1e-3}
)");
}

void loop_over_simulations(benchmark::State& state) {
  const Scenario scene = swing(state.range(0), state.range(3) != 0);
  std::vector<std::unique_ptr<Simulation>> simulations;
  simulations.push_back(std::make_unique<Simulation>(scene));
  for (std::int64_t i = 1; i < state.range(1); ++i) {
    // They share their model, as members do.
    simulations.push_back(std::make_unique<Simulation>(scene, *simulations.front()));
  }
  const State start = simulations.front()->state();
  for (auto _ : state) {
    state.PauseTiming();
    for (const auto& simulation : simulations) simulation->restore(start);
    state.ResumeTiming();
    for (const auto& simulation : simulations) {
      for (std::int64_t step = 0; step < state.range(2); ++step) simulation->step();
    }
  }
  state.SetItemsProcessed(state.iterations() * state.range(1));
}

void batch(benchmark::State& state) {
  const auto members = static_cast<std::size_t>(state.range(1));
  Batch batch(swing(state.range(0), state.range(3) != 0), members, {}, 1, {});
  for (auto _ : state) {
    state.PauseTiming();
    for (std::size_t i = 0; i < members; ++i) batch.reset(i, nullptr);
    state.ResumeTiming();
    batch.step(state.range(2), {});
  }
  state.SetItemsProcessed(state.iterations() * state.range(1));
}

void arguments(benchmark::internal::Benchmark* each) {
  each->ArgNames({"nodes", "members", "steps", "lanes"})
      ->ArgsProduct({{3, 51}, {1000}, {1}, {0, 1}})
      ->ArgsProduct({{25}, {200}, {100}, {0, 1}})
      ->Unit(benchmark::kMicrosecond);
}

BENCHMARK(loop_over_simulations)->Apply(arguments);
BENCHMARK(batch)->Apply(arguments);

}  // namespace
}  // namespace der
