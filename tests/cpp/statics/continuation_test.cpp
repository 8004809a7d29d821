// Paths of equilibria, and the loads that they scale.
#include <doctest/doctest.h>

#include <cmath>

#include "der/building/builder.hpp"
#include "der/core/constants.hpp"
#include "der/core/error.hpp"
#include "der/simulation.hpp"
#include "der/statics/load_path.hpp"
#include "statics/statics_scenes.hpp"

namespace der::test {
namespace {

const std::string kAllKinds = R"(
supports:
  - {rod: rod, at: start, clamp: true, prescribe: {angle: 0.3}}
loads:
  - gravity: [0, -2]
  - point_force: {rod: rod, at: end, force: [3, 4]}
  - moment: {rod: rod, at: end, moment: 0.5}
  - distributed_force: {rod: rod, force: [0, 1]}
analysis: static
)";

Vector controls_of(const Model& model) {
  Vector controls;
  model.controls.evaluate(0.0, controls);
  return controls;
}

std::vector<std::size_t> rows(const PathBranch& branch, PathEvent event) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < branch.points.size(); ++i) {
    if (branch.points[i].event == event) result.push_back(i);
  }
  return result;
}

}  // namespace

TEST_CASE("a load path scales every load, and nothing else") {
  const Scenario scenario = Scenario::parse(straight_rod(11, kAllKinds));
  const Model whole = build_model(scenario.scene());
  Model model = build_model(scenario.scene());
  const LoadPath loads(scenario.scene(), model, scenario::Varied::Loads, std::nullopt);
  CHECK(loads.varies());
  CHECK(loads.is_linear());
  loads.apply(0.25, model);
  CHECK((model.gravity_force - 0.25 * whole.gravity_force).norm() < 1e-14);
  CHECK((model.dead_force - 0.25 * whole.dead_force).norm() < 1e-14);
  // The clamp has the first two controls, its rotation and how far it has turned; the moment the
  // third.
  CHECK(controls_of(model)[0] == doctest::Approx(0.3));
  CHECK(controls_of(model)[2] == doctest::Approx(0.125));
}

TEST_CASE("a load path of one load, and one of the supports") {
  const Scenario scenario = Scenario::parse(straight_rod(11, kAllKinds));
  const Model whole = build_model(scenario.scene());
  Model model = build_model(scenario.scene());
  LoadPath(scenario.scene(), model, scenario::Varied::Loads, 0).apply(0.0, model);
  CHECK(model.gravity_force.norm() == 0.0);
  CHECK(model.dead_force == whole.dead_force);
  model = build_model(scenario.scene());
  const LoadPath motion(scenario.scene(), model, scenario::Varied::Supports, std::nullopt);
  CHECK_FALSE(motion.is_linear());
  motion.apply(2.0, model);
  CHECK(controls_of(model)[0] == doctest::Approx(0.6));
  CHECK(controls_of(model)[2] == doctest::Approx(0.5));
  CHECK(model.gravity_force == whole.gravity_force);
}

TEST_CASE("a guard puts the loads back when an exception passes") {
  const Scenario scenario = Scenario::parse(straight_rod(11, kAllKinds));
  const Model whole = build_model(scenario.scene());
  Model model = build_model(scenario.scene());
  const LoadPath loads(scenario.scene(), model, scenario::Varied::Loads, std::nullopt);
  try {
    const FactorGuard guard(loads, model);
    loads.apply(0.0, model);
    throw Error("test", "midway");
  } catch (const Error&) {
    CHECK((model.dead_force - whole.dead_force).norm() < 1e-14);
    CHECK((controls_of(model) - controls_of(whole)).norm() < 1e-14);
  }
  {
    FactorGuard guard(loads, model);
    guard.leave_at(0.5);
  }
  CHECK((model.dead_force - 0.5 * whole.dead_force).norm() < 1e-14);
}

TEST_CASE("a continuation that finds no start leaves the loads of the scene") {
  Simulation loose(Scenario::parse(straight_rod(11, kPush + kStatic)));
  const Vector before = loose.gradient();
  scenario::ContinuationAnalysis analysis;
  analysis.from = 0.5;
  CHECK_THROWS_AS(loose.follow(analysis), NotConvergedError);
  CHECK(loose.gradient() == before);
}

TEST_CASE("a column bifurcates at its buckling load and is followed to both sides") {
  Simulation simulation(Scenario::parse(straight_rod(21, kPinned + kPush + kStatic)));
  scenario::ContinuationAnalysis analysis;
  analysis.to = 12.0;
  analysis.branches = 1;
  const auto path = simulation.follow(analysis);
  REQUIRE(path.size() == 3);
  const auto crossings = rows(path[0], PathEvent::Bifurcation);
  REQUIRE(crossings.size() == 1);
  const double chain = 40.0 * std::sin(kPi / 40.0);  // of 20 edges, exactly; pressed to 1 - 1e-5
  CHECK(path[0].points[crossings[0]].factor == doctest::Approx(chain * chain).epsilon(3e-5));
  CHECK(path[0].points.back().factor == doctest::Approx(12.0));
  CHECK(path[0].points.back().stability.unstable_directions == 1);
  CHECK(rows(path[0], PathEvent::Fold).empty());
  const Index middle = simulation.model().dof(10, 1);
  const double up = path[1].points.back().positions[middle];
  CHECK(std::abs(up) > 0.1);
  CHECK(path[2].points.back().positions[middle] == doctest::Approx(-up).epsilon(1e-8));
  for (const std::size_t side : {1, 2}) {
    CHECK(path[side].parent == 0);
    CHECK(path[side].points.back().stability.unstable_directions == 0);
  }
  CHECK(path[1].side == -path[2].side);
}

TEST_CASE("every point of a path is in balance under its loads") {
  Simulation simulation(Scenario::parse(
      straight_rod(21, "supports:\n  - {rod: rod, at: start, clamp: true}\n" + kStatic +
                           "loads:\n  - point_force: {rod: rod, at: end, force: [0, -5]}\n")));
  const auto path = simulation.follow({});
  REQUIRE(path.size() == 1);
  double arc = -1.0;
  for (std::size_t i = 0; i < path[0].points.size(); ++i) {
    const PathPoint& point = path[0].points[i];
    simulation.show(point, static_cast<std::int64_t>(i));
    CHECK(simulation.gradient().lpNorm<Eigen::Infinity>() < 1e-5);
    CHECK(point.arc > arc);
    arc = point.arc;
  }
  CHECK(path[0].points.back().factor == doctest::Approx(1.0));
}

TEST_CASE("a path of nothing that varies is refused") {
  Simulation simulation(Scenario::parse(straight_rod(
      11, kPinned + kStatic + "loads:\n  - point_force: {rod: rod, at: end, force: [0, 0]}\n")));
  CHECK_THROWS_WITH_AS(simulation.follow({}), doctest::Contains("nothing varies"), Error);
}

}  // namespace der::test
