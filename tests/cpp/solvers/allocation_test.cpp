// A Newton iteration must not allocate: the C library's allocator is replaced by one that counts.
#include <doctest/doctest.h>

#include <atomic>
#include <cstddef>
#include <string>

#include "der/catalog/quantities.hpp"
#include "der/core/sanitizer.hpp"
#include "der/output/recorder.hpp"
#include "der/simulation.hpp"

// The sanitizers bring their own allocator, which cannot be replaced; they do not look for this.
#if defined(__GLIBC__) && !DER_HAS_SANITIZER

namespace {
std::atomic<long> allocations{0};
}

extern "C" {
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): glibc's own name
void* __libc_malloc(std::size_t size);
void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
}

namespace der::test {

TEST_CASE("the allocation counter counts") {
  const long before = allocations;
  const Vector vector = Vector::Zero(100);
  CHECK(vector.size() == 100);
  CHECK(allocations > before);
}

/// A clamped rod that falls from the horizontal, with `more` of the scene.
std::string falling_cantilever(const std::string& more) {
  return R"(
rods:
  - name: rod
    nodes: 21
    from: [0, 0]
    to: [1, 0]
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e7, density: 1000}
supports:
  - {rod: rod, at: start, clamp: true, prescribe: {angle: {times: [0, 1], values: [0, 1]}}}
  - {rod: rod, at: 0.43, spring: {stiffness: 0.1}}
loads:
  - gravity: [0, -9.81]
  - moment: {rod: rod, at: end, moment: {times: [0, 1], values: [0, 0.01]}}
)" + more;
}

/// Allocations of 40 calls, after a few that fill what a method remembers; explicit steps look at
/// the stable step on the way.
template <class Call>
long allocations_of_calls(const Call& call) {
  for (int i = 0; i < 3; ++i) call();
  const long before = allocations;
  for (int i = 0; i < 40; ++i) call();
  return allocations - before;
}

long allocations_of_steps(Simulation& simulation) {
  return allocations_of_calls([&] { simulation.step(); });
}

/// The same of steps whose probes are read.
long allocations_of_steps(Simulation& simulation, Recorder& recorder) {
  return allocations_of_calls([&] {
    simulation.step();
    recorder.observe(simulation);
  });
}

TEST_CASE("a step allocates nothing, with any stepper") {
  const std::string scene = falling_cantilever("time: {duration: 1, step: 0.0001}\n");
  for (const StepperInfo& info : stepper_registry()) {
    CAPTURE(info.name);
    Simulation simulation(
        Scenario::parse(scene, "scene", {{"time.integrator", std::string(info.name)}}));
    CHECK(allocations_of_steps(simulation) == 0);
    CHECK(simulation.counters().newton_iterations >= (info.implicit ? 40 : 0));
  }
}

/// A rod in space that is held at one end and falls, with `more` of the scene.
std::string falling_in_space(const std::string& model, const std::string& more) {
  return "model: " + model + R"(
rods:
  - name: rod
    nodes: 9
    from: [0, 0, 0]
    to: [1, 0, 0]
    natural_curvature: 0
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e6, poissons_ratio: 0.3, density: 1000}
supports:
  - {rod: rod, at: start, clamp: tangent}
loads:
  - gravity: [0, -9.81, 1]
)" + more;
}

/// Calls `check(scene, stepper)` for all steppers that a scene in space has.
template <class Check>
void for_each_stepper_in_space(const std::string& scene, const Check& check) {
  for (const StepperInfo& info : stepper_registry()) {
    if (std::string(info.name) == "energy_momentum") continue;  // for planar rods alone
    CAPTURE(info.name);
    Simulation simulation(
        Scenario::parse(scene, "scene", {{"time.integrator", std::string(info.name)}}));
    check(simulation);
  }
}

TEST_CASE("a step in space allocates nothing, with any stepper that it has") {
  for (const char* const model : {"spatial_bend", "spatial"}) {
    CAPTURE(model);
    for_each_stepper_in_space(
        falling_in_space(model, "time: {duration: 1, step: 2e-4}\n"),
        [](Simulation& simulation) { CHECK(allocations_of_steps(simulation) == 0); });
  }
}

TEST_CASE("an adaptive step in space allocates nothing, with any stepper, rejected ones included") {
  for (const char* const model : {"spatial_bend", "spatial"}) {
    CAPTURE(model);
    for_each_stepper_in_space(falling_in_space(model, "time: {duration: 1, tolerance: 1e-4}\n"),
                              [](Simulation& simulation) {
                                CHECK(allocations_of_steps(simulation) == 0);
                                // A blow to the end, for which the next step is too long.
                                simulation.state().velocities.segment<3>(24) << 0.0, 0.0, 10.0;
                                const long before = allocations;
                                simulation.step();
                                CHECK(allocations == before);
                                CHECK(simulation.counters().rejected_steps > 0);
                              });
  }
}

TEST_CASE("a step of a ring allocates nothing, in the plane and in space") {
  for (const char* const model : {"planar", "spatial_bend", "spatial"}) {
    CAPTURE(model);
    Simulation simulation(Scenario::parse("model: " + std::string(model) + R"(
rods:
  - name: ring
    closed: true
    points: [[1, 0, 0], [0.7, 0.7, 0], [0, 1, 0], [-0.7, 0.7, 0], [-1, 0, 0], [-0.7, -0.7, 0],
             [0, -1, 0], [0.7, -0.7, 0]]
    natural_curvature: [0, 0]
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e6, poissons_ratio: 0.3, density: 1000}
supports:
  - {rod: ring, at: start, fix: [x, y, z]}
loads:
  - gravity: [0, -9.81, 0]
time: {duration: 1, step: 1e-3, integrator: implicit_midpoint}
)"));
    CHECK(allocations_of_steps(simulation) == 0);
    CHECK(simulation.counters().newton_iterations >= 40);
  }
}

TEST_CASE("a step under loads without a potential allocates nothing") {
  Simulation simulation(Scenario::parse(R"(
rods:
  - name: rod
    nodes: 9
    from: [0, 0, 0]
    to: [1, 0, 0]
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e6, poissons_ratio: 0.3, density: 1000}
supports:
  - {rod: rod, at: start, clamp: true}
  - {rod: rod, at: 0.4, spring: {stiffness: 0.1, rotational_stiffness: [1e-4, 2e-4, 1e-4]}}
loads:
  - point_force: {rod: rod, at: end, force: [0, 1e-3, 1e-3], follower: true}
  - moment: {rod: rod, at: 0.61, moment: [1e-3, 0, 1e-3]}
time: {duration: 1, step: 2e-3, integrator: implicit_midpoint}
)"));
  CHECK(allocations_of_steps(simulation) == 0);
  CHECK(simulation.counters().newton_iterations >= 40);
}

TEST_CASE("an adaptive step allocates nothing, with any stepper, rejected ones included") {
  const std::string scene = falling_cantilever("time: {duration: 1, tolerance: 1e-4}\n");
  for (const StepperInfo& info : stepper_registry()) {
    CAPTURE(info.name);
    Simulation simulation(
        Scenario::parse(scene, "scene", {{"time.integrator", std::string(info.name)}}));
    CHECK(allocations_of_steps(simulation) == 0);
    CHECK(simulation.counters().steps == 43);
    // A blow to the end, for which the next step is too long.
    simulation.state().velocities.tail<2>() << 0.0, 10.0;
    const long before = allocations;
    simulation.step();
    CHECK(allocations == before);
    CHECK(simulation.counters().rejected_steps > 0);
  }
}

TEST_CASE("reading probes at every step allocates nothing, with every quantity there is") {
  std::string scene = falling_cantilever(R"(
time: {duration: 1, step: 0.001}
output:
  every: 1
  probes:
)");
  std::size_t probes = 0;
  for (const Quantity& quantity : quantities()) {
    if (quantity.scope > QuantityScope::Planar || quantity.read_actuation != nullptr) continue;
    if (quantity.kind == QuantityKind::Joint || quantity.read_spring != nullptr) continue;  // below
    const std::string head = "    " + quantity.name;
    if (quantity.read_reaction != nullptr) {
      scene += head + ": {quantity: " + quantity.name + ", support: 0}\n";
      ++probes;
      continue;
    }
    const std::string what = ": {quantity: " + quantity.name + ", rod: rod";
    if (quantity.kind == QuantityKind::Energy) {
      scene += head + what + "}\n";
      ++probes;
      continue;
    }
    scene += head + what + ", at: start}\n";
    scene += head + "_max" + what + ", over: rod, reduce: max}\n";
    probes += 2;
  }
  Simulation simulation(Scenario::parse(scene));
  Recorder recorder(simulation);
  CHECK(allocations_of_steps(simulation, recorder) == 0);
  CHECK(recorder.summaries().size() == probes);
}

TEST_CASE("steps of rods with joints, and what is read off them, allocate nothing") {
  for (const char* integrator : {"implicit_midpoint", "verlet", "generalized_alpha"}) {
    Simulation simulation(Scenario::parse(std::string(R"(
rods:
  - {name: a, nodes: 6, from: [0, 0], to: [1, 0], cross_section: {stiffness: {EA: 100, EI: 1, mass_per_length: 1}}}
  - {name: b, nodes: 6, from: [1, 0], to: [1, 1], cross_section: {stiffness: {EA: 100, EI: 1, mass_per_length: 1}}}
joints:
  - {name: j, of: [{rod: a, at: end}, {rod: b, at: start}]}
  - {name: wall, of: [{rod: a, at: start}]}
  - {name: tip, of: [{rod: b, at: end}]}
springs:
  - {name: tie, between: [wall, tip], stiffness: 5, damping: 0.1, rest_length: {times: [0, 1], values: [1.4, 1]}}
supports: [{rod: a, at: start, clamp: true}]
loads:
  - moment: {joint: j, moment: 0.3}
  - point_force: {rod: b, at: 0.13, force: [0, 1]}
output:
  every: 0.1
  probes:
    turn: {joint: j, quantity: rotation}
    pull: {joint: j, leg: b, quantity: force_y}
    bend: {rod: b, at: start, quantity: moment}
    slope: {rod: b, at: end, quantity: slope}
    tie: {spring: tie, quantity: spring_force}
    length: {spring: tie, quantity: spring_length}
    tension: {rod: b, over: rod, reduce: max, quantity: tension}
time: {duration: 0.1, step: 0.0005, integrator: )") +
                                          integrator + "}\n"));
    Recorder recorder(simulation);
    CAPTURE(integrator);
    CHECK(allocations_of_steps(simulation, recorder) == 0);
  }
}

TEST_CASE("reading what actuations exert allocates nothing") {
  Simulation simulation(Scenario::parse(R"(
rods:
  - name: rod
    nodes: 9
    from: [0, 0]
    to: [1, 0]
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e7, density: 1000}
supports:
  - {rod: rod, at: start, clamp: true}
actuation:
  - {name: bend, rod: rod, natural_curvature: {times: [0, 1], values: [0, 0.1]}}
  - {name: grow, rod: rod, elongation: {times: [0, 1], values: [0, 0.01]}}
time: {duration: 1, step: 0.001}
output:
  every: 1
  probes:
    moment: {quantity: actuation_moment, actuation: bend}
    force: {quantity: actuation_force, actuation: grow}
)"));
  Recorder recorder(simulation);
  CHECK(allocations_of_steps(simulation, recorder) == 0);
}

}  // namespace der::test

#endif
