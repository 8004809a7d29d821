// Long analyses call a beat, and what it throws ends them and leaves the state as it was.
#include <doctest/doctest.h>

#include <functional>
#include <memory>
#include <string>

#include "batch/samples.hpp"
#include "der/batch/batch.hpp"
#include "der/core/cancel_callback.hpp"
#include "der/simulation.hpp"
#include "model/same_state.hpp"
#include "statics/statics_scenes.hpp"

namespace der::test {
namespace {

struct Stop {};

/// Throws at the call of that number, counted from 1, be it of one copy or another.
CancelCallback stop_at(int number) {
  return [left = std::make_shared<int>(number)] {
    if (--*left == 0) throw Stop{};
  };
}

/// Stops some work at several of its beats; done in full afterwards, it has the bits of work that
/// nobody stopped. Work beats at least once an iteration, and at least so often.
void check_stops(int at_least, const std::string& text,
                 const std::function<void(Simulation&, CancelCallback)>& work) {
  const Scenario scene = Scenario::parse(text);
  int beats = 0;
  Simulation alone(scene);
  work(alone, [&] { ++beats; });
  REQUIRE(beats >= alone.counters().newton_iterations);
  CAPTURE(beats);
  REQUIRE(beats >= at_least);
  Simulation simulation(scene);
  const State before = simulation.state();
  for (const int stop : {1, 2, 5, beats / 2, beats}) {
    CAPTURE(stop);
    CHECK_THROWS_AS(work(simulation, stop_at(stop)), Stop);
    CHECK(first_difference(simulation.state(), before) == "");
  }
  work(simulation, {});
  CHECK(first_difference(simulation.state(), alone.state()) == "");
}

TEST_CASE("a search for an equilibrium can be stopped at each iteration") {
  const std::string load = "loads:\n  - point_force: {rod: rod, at: end, force: [-1e3, 0]}\n";
  check_stops(100, straight_rod(21, kPinned + load + kStatic),
              [](Simulation& rod, const CancelCallback& beat) { rod.equilibrium(true, beat); });
}

TEST_CASE("the verdict out of the plane can be stopped, and leaves the state as it was") {
  std::string text = straight_rod(21, kPinned + kStatic);
  text.replace(text.find("EI: 1,"), 6, "EI: 1, GJ: 1,");
  const Scenario scene = Scenario::parse(text);
  int search = 0;
  Simulation(scene).settle(true, [&] { ++search; });
  check_stops(search + 3, text,
              [](Simulation& rod, const CancelCallback& beat) { rod.equilibrium(true, beat); });
}

TEST_CASE("the modes, the buckling loads and the path of a rod can be stopped") {
  check_stops(15, straight_rod(41, kPinned + kStatic),
              [](Simulation& rod, const CancelCallback& beat) { (void)rod.modes(3, beat); });
  check_stops(100, straight_rod(21, kPinned + kPush + kBuckling),
              [](Simulation& rod, const CancelCallback& beat) { (void)rod.buckling(2, beat); });
  check_stops(500, straight_rod(21, kPinned + kPush + "analysis: {continuation: {to: 12}}\n"),
              [](Simulation& rod, const CancelCallback& beat) { (void)rod.follow(beat); });
}

TEST_CASE("a stop of the equilibria of a batch leaves each member found or as it was") {
  const Scenario scene = Scenario::parse(
      kPlanar, "scene", {{"time", ""}, {"output.every", ""}, {"analysis", "static"}});
  Simulation drawn(scene);
  Simulation found(scene);
  found.equilibrium();
  for (const int threads : {1, 3}) {
    Batch batch(scene, 40, {}, threads, {});
    bool stopped = false;
    try {
      batch.equilibrium(true, stop_at(1));
    } catch (const Stop&) {
      stopped = true;
    }
    int as_before = 0;
    for (std::size_t member = 0; member < batch.size(); ++member) {
      const State& state = batch.member(member).state();
      if (first_difference(state, drawn.state()).empty()) {
        ++as_before;
      } else {
        CHECK(first_difference(state, found.state()) == "");
      }
    }
    // Other threads may be done with all members before the caller's begins.
    if (threads == 1) CHECK(stopped);
    if (threads == 1) CHECK(as_before == 40);
    if (!stopped) CHECK(as_before == 0);
    CHECK(batch.failures().empty());
    for (std::size_t member = 0; member < batch.size(); ++member) batch.reset(member, nullptr);
    batch.equilibrium(true, {});
    CHECK(first_difference(batch.member(39).state(), found.state()) == "");
  }
}

}  // namespace
}  // namespace der::test
