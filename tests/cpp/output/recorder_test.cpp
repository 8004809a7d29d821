// Tests of the recorded data: frames, extremes of probes, ends of runs.
#include "der/output/recorder.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "der/core/error.hpp"
#include "der/output/flush_timer.hpp"
#include "der/output/memory_sink.hpp"
#include "der/output/run.hpp"
#include "output/output_scenes.hpp"

namespace der::test {
namespace {

struct Recorded {
  explicit Recorded(const Scenario& scenario, const StepCallback& callback = {})
      : simulation(scenario), recorder(simulation) {
    recorder.add(frames);
    outcome = run(simulation, recorder, callback);
  }
  Simulation simulation;
  Recorder recorder;
  MemorySink frames;
  RunOutcome outcome;
};

}  // namespace

TEST_CASE("frames come at the start, every so many steps, and at the end") {
  const Recorded run(Scenario::parse(kSpheres));
  CHECK(run.outcome.status == "completed");
  CHECK(run.frames.steps == std::vector<std::int64_t>{0, 3, 6, 9, 12, 15, 18, 20});
  CHECK(run.frames.times.back() == 0.2);
  CHECK(run.frames.positions.size() == 8 * 6);
  CHECK(run.frames.velocities.size() == 8 * 6);
  CHECK(run.frames.probes.size() == 8 * 4);
  CHECK(run.frames.energies.size() == 8 * kEnergyTerms.size());
  CHECK(run.outcome.counters.steps == 20);
}

TEST_CASE("frames hold the state, probes and energies of their instant") {
  const Recorded run(Scenario::parse(kSpheres));
  const State& state = run.simulation.state();
  const auto n = static_cast<std::ptrdiff_t>(state.positions.size());
  CHECK(std::equal(state.positions.begin(), state.positions.end(), run.frames.positions.end() - n));
  CHECK(std::equal(state.velocities.begin(), state.velocities.end(),
                   run.frames.velocities.end() - n));
  CHECK(run.frames.probes[4 * 7 + 1] == state.positions[3]);  // y_mid
  CHECK(run.frames.energies.back() == energies(run.simulation.model(), state)[EnergyTerm::Gravity]);
}

TEST_CASE("extremes are taken over every step, saved or not") {
  double least = 0.0;
  double t_least = 0.0;
  const Recorded run(Scenario::parse(kSpheres), [&](const Simulation& now) {
    const double v = now.state().velocities[3];
    if (v < least) {
      least = v;
      t_least = now.state().time;
    }
    return true;
  });
  const ProbeSummary& v_mid = run.recorder.summaries().at(0);
  CHECK(v_mid.min == least);
  CHECK(v_mid.t_min == t_least);
  CHECK(v_mid.max == 0.0);
  CHECK(v_mid.t_max == 0.0);
  CHECK(v_mid.final == run.simulation.state().velocities[3]);
  // The scene is chosen so that saved instants alone would not do.
  const auto& times = run.frames.times;
  CHECK(std::find(times.begin(), times.end(), t_least) == times.end());
}

TEST_CASE("a callback stops the run, and the instant it stopped at is saved") {
  const Recorded run(Scenario::parse(kSpheres),
                     [](const Simulation& now) { return now.state().step < 7; });
  CHECK(run.outcome.status == "stopped");
  CHECK_FALSE(run.outcome.ok());
  CHECK_FALSE(run.outcome.failed());
  CHECK(run.outcome.time == doctest::Approx(0.07));
  CHECK(run.frames.steps == std::vector<std::int64_t>{0, 3, 6, 7});
}

TEST_CASE("a callback that says stop after the last step does not make a run incomplete") {
  const Recorded run(Scenario::parse(kSpheres),
                     [](const Simulation& now) { return !now.finished(); });
  CHECK(run.outcome.status == "completed");
}

TEST_CASE("an error of the callback is passed on") {
  struct Mine {};
  CHECK_THROWS_AS(
      Recorded(Scenario::parse(kSpheres), [](const Simulation&) -> bool { throw Mine{}; }), Mine);
}

TEST_CASE("a static analysis records its equilibrium and nothing else") {
  const Recorded run(cantilever("tip: {rod: arm, at: end, quantity: y}"));
  CHECK(run.outcome.status == "static_converged");
  REQUIRE(run.outcome.equilibrium);
  CHECK(run.outcome.equilibrium->stability.unstable_directions == 0);
  CHECK(run.frames.num_frames() == 1);
  CHECK(run.frames.times.at(0) == 0.0);
  // The elastica's tip under 1 EI/L^2; 20 edges err by 0.3 (l/L)^2 at the most.
  CHECK(std::abs(run.recorder.summaries().at(0).final + 0.301721) < 7.5e-4);
}

TEST_CASE("an adaptive step holds no more frames than a run may wait for") {
  struct Counter : FrameSink {
    void write(const Frame& /*frame*/) override { ++since_step; }
    void stepped(const Simulation& /*simulation*/, const Recorder& /*recorder*/) override {
      most = std::max(most, since_step);
      since_step = 0;
    }
    int since_step = 0;
    int most = 0;
  };
  Simulation simulation(Scenario::parse(
      kSpheres, "spheres",
      {{"time", "{duration: 1, tolerance: 0.1, integrator: tr_bdf2}"}, {"output.every", "5e-6"}}));
  Recorder recorder(simulation);
  Counter counter;
  recorder.add(counter);
  CHECK(run(simulation, recorder, {}).ok());
  CHECK(counter.most <= 10'001);
  CHECK(counter.most > 5'000);  // the scene does ask for more: without the limit 37,000
}

TEST_CASE("an equilibrium that does not exist leaves no numbers that could be taken for one") {
  // Held nowhere, the rod falls for ever.
  const Recorded run(cantilever("tip: {rod: arm, at: end, quantity: y}", {{"supports", "[]"}}));
  CHECK(run.outcome.status == "not_held");
  CHECK(run.outcome.failed());
  CHECK(run.frames.num_frames() == 0);
  CHECK_FALSE(run.recorder.has_data());
}

TEST_CASE("a run that diverges is recorded up to its last good step, with finite values") {
  const Recorded run(Scenario::parse(kSpheres, "spheres",
                                     {{"time.integrator", "explicit_euler"},
                                      {"time.step", "1e-4"},
                                      {"time.allow_unstable", "true"},
                                      {"time.duration", "10"},
                                      {"output.every", "0.05"}}));
  CHECK(run.outcome.status == "diverged");
  CHECK(run.outcome.failed());
  CHECK(run.outcome.time < 10.0);
  CHECK(run.frames.times.back() == run.simulation.state().time);
  const auto all_finite = [](const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  };
  CHECK(all_finite(run.frames.positions));
  CHECK(all_finite(run.frames.velocities));
  CHECK(all_finite(run.frames.probes));
  CHECK(all_finite(run.frames.energies));
  for (const ProbeSummary& s : run.recorder.summaries()) {
    CHECK(all_finite({s.final, s.min, s.max, s.t_min, s.t_max}));
  }
}

TEST_CASE("a value that is not finite is refused, not recorded") {
  Simulation simulation(Scenario::parse(kSpheres));
  Recorder recorder(simulation);
  MemorySink frames;
  recorder.add(frames);
  recorder.observe(simulation);
  simulation.step();
  simulation.state().velocities[3] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(recorder.observe(simulation), DivergedError);
  recorder.finish(simulation);
  CHECK(frames.num_frames() == 1);
  CHECK(recorder.summaries().at(0).final == 0.0);
  // So large that only the kinetic energy overflows.
  simulation.state().velocities[3] = 1e200;
  CHECK_THROWS_AS(recorder.observe(simulation), DivergedError);
}

TEST_CASE("an instant is recorded once, however often it is shown") {
  Simulation simulation(Scenario::parse(kSpheres));
  Recorder recorder(simulation);
  MemorySink frames;
  recorder.add(frames);
  recorder.observe(simulation);
  recorder.observe(simulation);
  recorder.finish(simulation);
  CHECK(frames.num_frames() == 1);
}

TEST_CASE("a pacer is due at once, then after its interval, at the right rate in a fast loop") {
  FlushTimer pacer{FlushTimer::Seconds(0.02)};
  CHECK(pacer.due());
  CHECK_FALSE(pacer.due());
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  int beats = 0;
  while (Clock::now() - start < std::chrono::milliseconds(300)) beats += pacer.due() ? 1 : 0;
  CHECK(beats <= 15);
  CHECK(beats >= 3);  // far fewer only if this machine stood still
}

}  // namespace der::test
