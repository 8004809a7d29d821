// Threads of the caller that each drive simulations of their own, and members that fail at once: by
// their bits, and for a thread sanitizer.
#include <doctest/doctest.h>

#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "batch/samples.hpp"
#include "der/batch/batch.hpp"
#include "der/core/error.hpp"
#include "der/simulation.hpp"
#include "model/same_state.hpp"

namespace der::test {
namespace {

const auto no_beat = [] {};

constexpr std::size_t kThreads = 3;
constexpr int kSteps = 20;

/// Calls `work(0)`, `work(1)`, .. at the same time.
void at_once(const std::function<void(std::size_t)>& work) {
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < kThreads; ++i) threads.emplace_back(work, i);
  for (std::thread& thread : threads) thread.join();
}

/// The calls of a program: a force of its own, steps, a state saved and restored.
void drive(Simulation& simulation) {
  simulation.state().extra_force[simulation.model().dof(3, 1)] = 0.01;
  for (int i = 0; i < kSteps; ++i) simulation.step();
  const State saved = simulation.state();
  simulation.step();
  simulation.restore(saved);
}

TEST_CASE("threads that drive simulations of one scene have the bits of one thread") {
  for (const Sample& sample : kSamples) {
    CAPTURE(sample.model);
    CAPTURE(sample.varied);
    const Scenario scene = scene_of(sample);
    Simulation alone(scene);
    drive(alone);
    std::vector<std::unique_ptr<Simulation>> simulations(kThreads);
    at_once([&](std::size_t i) {
      simulations[i] = std::make_unique<Simulation>(scene);
      drive(*simulations[i]);
    });
    for (const auto& simulation : simulations) {
      CHECK(first_difference(simulation->state(), alone.state()) == "");
    }
  }
}

TEST_CASE("simulations that share a model are built and driven while others step") {
  for (const Sample& sample : kSamples) {
    CAPTURE(sample.model);
    CAPTURE(sample.varied);
    const Simulation first(scene_of(sample));
    Simulation alone(first.scenario());
    drive(alone);
    std::vector<std::unique_ptr<Simulation>> simulations(kThreads);
    at_once([&](std::size_t i) {
      simulations[i] = std::make_unique<Simulation>(first.scenario(), first);
      drive(*simulations[i]);
    });
    for (const auto& simulation : simulations) {
      CHECK(&simulation->model() == &first.model());
      CHECK(first_difference(simulation->state(), alone.state()) == "");
    }
  }
}

TEST_CASE("equilibria that threads find at once are those of one thread") {
  const Scenario scene = Scenario::parse(
      kPlanar, "scene", {{"time", ""}, {"output.every", ""}, {"analysis", "static"}});
  Simulation alone(scene);
  alone.equilibrium();
  std::vector<std::unique_ptr<Simulation>> simulations(kThreads);
  at_once([&](std::size_t i) {
    simulations[i] = std::make_unique<Simulation>(scene);
    simulations[i]->equilibrium();
  });
  for (const auto& simulation : simulations) {
    CHECK(first_difference(simulation->state(), alone.state()) == "");
  }
}

// The midpoint rule makes energy of the whipping end: first a mark, then a failure.
const char* const kWhip = R"(
rods:
  - name: rod
    nodes: 11
    from: [0, 0]
    to: [1, 0]
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e7, density: 1000}
supports: [{rod: rod, at: start, clamp: true}]
loads: [{gravity: [0, -9.81]}]
time: {duration: 6, step: 0.005, integrator: implicit_midpoint}
output: {every: 0.05, probes: {tip: {rod: rod, at: end, quantity: moment}}}
)";

TEST_CASE("members that fail while others do fail as on their own, and start again") {
  constexpr std::size_t kMembers = 6;
  constexpr int kLong = 700;
  const Scenario scene = Scenario::parse(kWhip);
  Simulation alone(scene);
  std::string message;
  try {
    for (int i = 0; i < kLong; ++i) alone.step();
  } catch (const DivergedError& error) {
    message = error.what();
  }
  REQUIRE(message.find("created") != std::string::npos);

  Batch batch(scene, kMembers, {}, 3, no_beat);
  batch.probes(no_beat);
  for (int attempt = 0; attempt < 2; ++attempt) {
    batch.step(kLong, no_beat);
    REQUIRE(batch.failures().size() == kMembers);
    for (const auto& entry : batch.failures()) {
      const std::size_t member = entry.first;
      CAPTURE(member);
      CHECK(entry.second.message == message);
      CHECK(batch.unreliable()[member] == 1);
      CHECK(first_difference(batch.member(member).state(), alone.state()) == "");
    }
    for (std::size_t member = 0; member < kMembers; ++member) batch.reset(member, nullptr);
    CHECK(batch.failures().empty());
  }
}

}  // namespace
}  // namespace der::test
