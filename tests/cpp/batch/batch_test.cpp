// Many simulations on several threads: the bits of one, failures, resets.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batch/samples.hpp"
#include "der/assembly/structure.hpp"
#include "der/batch/batch.hpp"
#include "model/same_state.hpp"

namespace der::test {
namespace {

const auto no_beat = [] {};

Variation varied(const std::string& path, double value, std::size_t members) {
  Variation variation{path, {}};
  for (std::size_t i = 0; i < members; ++i) {
    variation.values.push_back(
        scenario::make_scalar(value * (1.0 + 0.01 * static_cast<double>(i))));
  }
  return variation;
}

bool same_bits(const double* row, const Vector& vector) {
  return std::memcmp(row, vector.data(),
                     sizeof(double) * static_cast<std::size_t>(vector.size())) == 0;
}

/// Name of the first thing in which a member is not what a simulation on its own is.
std::string difference(Batch& batch, std::size_t member, const Simulation& alone) {
  const std::string found = first_difference(batch.member(member).state(), alone.state());
  if (!found.empty()) return found;
  const auto row = static_cast<Index>(member);
  if (!same_bits(batch.positions().row(row).data(), alone.state().positions)) return "rows";
  if (!same_bits(batch.velocities().row(row).data(), alone.state().velocities)) return "rows";
  if (batch.time()[row] != alone.state().time) return "time";
  return {};
}

TEST_CASE("members have the bits of simulations on their own, on any number of threads") {
  constexpr std::size_t kMembers = 5;
  for (const Sample& sample : kSamples) {
    CAPTURE(sample.varied);
    const Scenario scene = scene_of(sample);
    const Variation variation = varied(sample.varied, sample.value, kMembers);
    std::vector<std::unique_ptr<Simulation>> alone;
    for (const scenario::Value& value : variation.values) {
      alone.push_back(std::make_unique<Simulation>(with_values(scene, {{sample.varied, value}})));
      REQUIRE(alone.back()->model().name == sample.model);
      alone.back()->state().extra_force[alone.back()->model().dof(3, 1)] = 0.01;
      for (int i = 0; i < 24; ++i) alone.back()->step();
    }
    for (const int threads : {1, 2, 3, 16}) {
      CAPTURE(threads);
      Batch batch(scene, kMembers, {variation}, threads, no_beat);
      batch.extra_force().col(batch.model().dof(3, 1)).setConstant(0.01);
      batch.step(10, no_beat);
      for (int i = 0; i < 14; ++i) batch.step(1, no_beat);
      for (std::size_t i = 0; i < kMembers; ++i) {
        CAPTURE(i);
        CHECK(difference(batch, i, *alone[i]) == "");
      }
    }
  }
}

/// A scene whose members go in lanes, and what is varied in it.
struct LaneSample {
  const char* text;
  std::vector<Override> changes;
  std::string varied;
  double value;
};
const std::vector<LaneSample> kLaneSamples{
    {kPlanar,
     {{"supports.0.prescribe", "{x: 0}"}, {"time.integrator", "implicit_midpoint"}},
     "rods.rod.cross_section.stiffness.EI",
     1e-2},
    {kPlanar,
     {{"supports.0.prescribe", "{x: 0}"}, {"time.integrator", "tr_bdf2"}},
     "rods.rod.cross_section.stiffness.EI",
     1e-2},
    {kSpatial,
     {{"model", "spatial_bend"},
      {"supports.0.clamp", "tangent"},
      {"time.integrator", "implicit_midpoint"}},
     "rods.rod.material.youngs_modulus",
     1e7},
    {kSpatial,
     {{"model", "spatial"}, {"time.integrator", "implicit_midpoint"}},
     "rods.rod.material.youngs_modulus",
     1e7},
};

TEST_CASE("members in lanes have the bits of simulations on their own, on any number of threads") {
  constexpr std::size_t kMembers = 19;
  for (const LaneSample& sample : kLaneSamples) {
    CAPTURE(sample.varied);
    const Scenario scene = Scenario::parse(sample.text, "scene", sample.changes);
    const Variation variation = varied(sample.varied, sample.value, kMembers);
    for (const int threads : {1, 2, 4}) {
      CAPTURE(threads);
      Batch batch(scene, kMembers, {variation}, threads, no_beat);
      CHECK(batch.lanes() >= 4);
      batch.step(20, no_beat);
      batch.reset(3, nullptr);
      batch.step(5, no_beat);
      for (std::size_t i = 0; i < kMembers; ++i) {
        CAPTURE(i);
        Simulation alone(with_values(scene, {{sample.varied, variation.values[i]}}));
        for (int step = 0; step < (i == 3 ? 5 : 25); ++step) alone.step();
        CHECK(difference(batch, i, alone) == "");
      }
    }
  }
}

TEST_CASE("members that fail or take a step in parts do it beside others in their lanes") {
  constexpr std::size_t kMembers = 16;
  for (const LaneSample& sample : kLaneSamples) {
    CAPTURE(sample.varied);
    const Scenario scene = Scenario::parse(sample.text, "scene", sample.changes)
                               .with({{"time.step", "0.25"},
                                      {"time.duration", "10"},
                                      {"time.allow_unstable", "true"},
                                      {"output.every", "0.25"}});
    // Steps far too long for the motion of all but the stiff ones.
    Variation variation = varied(sample.varied, sample.value, kMembers);
    for (std::size_t i = 1; i < kMembers; i += 3) {
      variation.values[i] = scenario::make_scalar(sample.value * (i % 2 == 0 ? 1e4 : 0.1));
    }
    Batch batch(scene, kMembers, {variation}, 2, no_beat);
    REQUIRE(batch.lanes() >= 4);
    batch.step(2, no_beat);
    batch.positions()(5, batch.model().dof(4, 1)) = std::numeric_limits<double>::quiet_NaN();
    batch.step(6, no_beat);
    std::int64_t retried = 0;
    for (std::size_t i = 0; i < kMembers; ++i) {
      CAPTURE(i);
      CHECK(batch.failed()[i] == (i == 5 ? 1 : 0));
      if (i == 5) continue;
      Simulation alone(with_values(scene, {{sample.varied, variation.values[i]}}));
      for (int step = 0; step < 8; ++step) alone.step();
      retried += alone.counters().retried_steps;
      CHECK(difference(batch, i, alone) == "");
    }
    CHECK(retried > 0);
  }
}

TEST_CASE("members of one scene share their model") {
  const Scenario scene = Scenario::parse(kPlanar);
  Batch batch(scene, 3, {}, 2, no_beat);
  CHECK(&batch.member(2).model() == &batch.member(0).model());
  Simulation alone(scene);
  batch.step(20, no_beat);
  for (int i = 0; i < 20; ++i) alone.step();
  for (std::size_t i = 0; i < 3; ++i) CHECK(difference(batch, i, alone) == "");
}

TEST_CASE("a member that fails is masked, and takes part again when it is reset") {
  Batch batch(Scenario::parse(kPlanar), 4, {}, 2, no_beat);
  batch.step(3, no_beat);
  const State before = batch.save(1);
  batch.positions()(1, batch.model().dof(4, 1)) = std::numeric_limits<double>::quiet_NaN();
  batch.step(5, no_beat);
  CHECK(batch.failed() == std::vector<unsigned char>{0, 1, 0, 0});
  REQUIRE(batch.failures().size() == 1);
  const MemberFailure& failure = batch.failures().at(1);
  CHECK(failure.status == "diverged");
  CHECK(failure.time == doctest::Approx(0.006));
  CHECK(failure.message.find("node 4 of rod 'rod'") != std::string::npos);
  CHECK(batch.step_count() == std::vector<std::int64_t>{8, 3, 8, 8});
  batch.reset(1, &before);
  CHECK(batch.failures().empty());
  batch.reset(0, &before);
  batch.step(5, no_beat);
  CHECK(first_difference(batch.member(1).state(), batch.member(0).state()) == "");
  // To its start: what a new simulation does.
  batch.reset(2, nullptr);
  batch.step(4, no_beat);
  Simulation alone(Scenario::parse(kPlanar));
  for (int i = 0; i < 4; ++i) alone.step();
  CHECK(difference(batch, 2, alone) == "");
}

TEST_CASE("values are set member by member, for all members or none") {
  const Scenario scene = Scenario::parse(kPlanar);
  Batch batch(scene, 3, {}, 2, no_beat);
  RowMatrix forces(3, 2);
  forces << 0.0, 0.1, 0.0, 0.2, 0.0, 0.3;
  batch.set({{"push", forces}}, std::nullopt);
  batch.prescribe(0, {{"angle", Vector::LinSpaced(3, 0.0, 0.01)}});
  batch.step(6, no_beat);
  for (std::size_t i = 0; i < 3; ++i) {
    Simulation alone(scene);
    alone.set("push", {0.0, forces(static_cast<Index>(i), 1)});
    alone.prescribe(0, "angle", Vector::LinSpaced(3, 0.0, 0.01)[static_cast<Index>(i)]);
    for (int k = 0; k < 6; ++k) alone.step();
    CHECK(difference(batch, i, alone) == "");
  }
  CHECK(batch.value("push") == forces);
  RowMatrix wrong = 2.0 * forces;
  wrong(2, 0) = std::numeric_limits<double>::infinity();
  CHECK_THROWS_WITH_AS(batch.set({{"push", wrong}}, std::nullopt),
                       "member 2: 'push': x must be finite, got inf", Error);
  CHECK(batch.value("push") == forces);
}

TEST_CASE("equilibria of all members are those of simulations on their own") {
  const Scenario scene = Scenario::parse(
      kPlanar, "scene", {{"time", ""}, {"output.every", ""}, {"analysis", "static"}});
  const Variation variation = varied("rods.rod.cross_section.stiffness.EI", 1.0, 4);
  for (const int threads : {1, 3}) {
    Batch batch(scene, 4, {variation}, threads, no_beat);
    CHECK_THROWS_AS(batch.step(1, no_beat), Error);
    const auto reports = batch.equilibrium(true, no_beat);
    const RowMatrix& probes = batch.probes(no_beat);
    for (std::size_t i = 0; i < 4; ++i) {
      Simulation alone(with_values(scene, {{variation.path, variation.values[i]}}));
      CHECK(alone.equilibrium().residual == reports[i]->residual);
      CHECK(difference(batch, i, alone) == "");
      CHECK(probes(0, static_cast<Index>(i)) == alone.state().positions[alone.model().dof(8, 1)]);
    }
  }
}

TEST_CASE("refusals name the first member, whatever the threads do") {
  const Scenario scene = Scenario::parse(kPlanar);
  const auto message = [&](const Variation& variation) -> std::string {
    try {
      Batch(scene, 4, {variation}, 3, no_beat);
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  };
  using scenario::make_scalar;
  const std::string path = "rods.rod.cross_section.stiffness.EI";
  CHECK(message({path, {make_scalar(1.0), make_scalar(-1.0), make_scalar(2.0), make_scalar(-3.0)}})
            .find("(member 1 and 1 more)") != std::string::npos);
  CHECK(message({path, {make_scalar(1.0), make_scalar(1.0), make_scalar(0.0), make_scalar(1.0)}})
            .find("member 2: only numbers of a scene may differ") != std::string::npos);
  CHECK(
      message({"rods.rod.nodes", {make_scalar(9), make_scalar(9), make_scalar(9), make_scalar(8)}})
          .find("member 3: only numbers of a scene may differ, not its structure: its rod 'rod' "
                "has 8 nodes in place of 9") != std::string::npos);
  CHECK(message({path, {make_scalar(1.0)}}).find("1 values") != std::string::npos);
}

TEST_CASE("structures differ by what a matrix shows") {
  const auto difference_by = [](const std::vector<Override>& changes) {
    const Simulation other(Scenario::parse(kPlanar));
    const Simulation here(Scenario::parse(kPlanar, "scene", changes));
    return structural_difference(here.model(), other.model());
  };
  CHECK(difference_by({{"rods.rod.cross_section.stiffness.EI", "2"}}) == "");
  CHECK(difference_by({{"supports.wall.clamp", "false"},
                       {"supports.wall.fix", "[y]"},
                       {"supports.wall.prescribe", "{x: 0}"}})
            .find("its rods stretch or bend by other elements, first at node 0 of rod 'rod'") == 0);
  CHECK(difference_by({{"loads.0", "{foundation: {rod: rod, stiffness: 1, from: 0.3}}"}}) ==
        "its foundations hold other edges, first at node 2 of rod 'rod': a foundation has to begin "
        "and end in the same edges, so vary its 'from' and 'to' along with the length of the rod");
  CHECK(difference_by({{"supports.wall.at", "middle"}}) == "its supports hold other components");
  CHECK(difference_by({{"rods.rod.closed", "false"}, {"model", "spatial_bend"}}).substr(0, 9) ==
        "its model");
}

TEST_CASE("there are no more threads than members") {
  const Scenario scene = Scenario::parse(kPlanar);
  CHECK(Batch(scene, 3, {}, 100000, no_beat).threads() == 3);
  CHECK(Batch(scene, 3, {}, 2, no_beat).threads() == 2);
  CHECK(Batch(scene, 1, {}, 0, no_beat).threads() == 1);
}

TEST_CASE("what the beat throws ends a call between two steps") {
  Batch batch(Scenario::parse(kPlanar), 4, {}, 2, no_beat);
  int beats = 0;
  const auto stop = [&] {
    if (++beats == 2) throw std::runtime_error("stop");
  };
  CHECK_THROWS_WITH_AS(batch.step(1000000, stop), "stop", std::runtime_error);
  CHECK(batch.failures().empty());
  for (std::size_t i = 0; i < 4; ++i) {
    Simulation alone(Scenario::parse(kPlanar));
    while (alone.state().step < batch.step_count()[i]) alone.step();
    CHECK(difference(batch, i, alone) == "");
  }
}

}  // namespace
}  // namespace der::test
