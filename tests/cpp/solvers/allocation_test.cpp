// A Newton iteration must not allocate: the C library's allocator is replaced by one that counts.
#include <doctest/doctest.h>

#include <atomic>
#include <cstddef>
#include <string>

#include "der/output/quantities.hpp"
#include "der/output/recorder.hpp"
#include "der/simulation.hpp"

// The sanitizers bring their own allocator, which cannot be replaced; they do not look for this.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)

namespace {
std::atomic<long> allocations{0};
}

extern "C" {
void* __libc_malloc(std::size_t size);  // NOLINT(bugprone-reserved-identifier): glibc's own name
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

TEST_CASE("a step allocates nothing, with any stepper") {
  const char* const scene = R"(
title: Falling cantilever
rods:
  - name: rod
    nodes: 21
    from: [0, 0]
    to: [1, 0]
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e7, density: 1000}
supports:
  - {rod: rod, at: start, clamp: true}
loads:
  - gravity: [0, -9.81]
  - moment: {rod: rod, at: end, moment: {times: [0, 1], values: [0, 0.01]}}
time: {duration: 1, step: 0.0001, integrator: implicit_euler}
)";
  for (const StepperInfo& info : stepper_registry()) {
    CAPTURE(info.name);
    Simulation simulation(
        Scenario::parse(scene, "scene", {{"time.integrator", std::string(info.name)}}));
    for (int i = 0; i < 3; ++i) simulation.step();  // multi-step methods fill their history
    const long before = allocations;
    for (int i = 0; i < 20; ++i) simulation.step();
    CHECK(allocations == before);
    CHECK(simulation.counters().newton_iterations >= (info.implicit ? 20 : 0));
  }
}

TEST_CASE("reading probes at every step allocates nothing, with every quantity there is") {
  std::string scene = R"(
rods:
  - name: rod
    nodes: 21
    from: [0, 0]
    to: [1, 0]
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e7, density: 1000}
supports:
  - {rod: rod, at: start, clamp: true, prescribe: {angle: {times: [0, 1], values: [0, 1]}}}
loads:
  - gravity: [0, -9.81]
time: {duration: 1, step: 0.001}
output:
  every: 1
  probes:
)";
  for (const Quantity& quantity : quantities()) {
    const std::string head = "    " + quantity.name;
    const std::string what = ": {quantity: " + quantity.name + ", rod: rod";
    if (quantity.kind == QuantityKind::Energy) {
      scene += head + what + "}\n";
      continue;
    }
    scene += head + what + ", at: start}\n";
    scene += head + "_max" + what + ", over: rod, reduce: max}\n";
  }
  Simulation simulation(Scenario::parse(scene));
  Recorder recorder(simulation);
  for (int i = 0; i < 3; ++i) {
    simulation.step();
    recorder.observe(simulation);
  }
  const long before = allocations;
  for (int i = 0; i < 20; ++i) {
    simulation.step();
    recorder.observe(simulation);
  }
  CHECK(allocations == before);
  CHECK(recorder.summaries().size() == 2 * quantities().size() - 6);
}

}  // namespace der::test

#endif
