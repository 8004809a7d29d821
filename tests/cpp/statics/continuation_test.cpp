// Paths of equilibria, and the loads that they scale.
#include <doctest/doctest.h>

#include <cmath>
#include <future>
#include <string>
#include <utility>
#include <vector>

#include "der/building/builder.hpp"
#include "der/core/constants.hpp"
#include "der/core/error.hpp"
#include "der/loads/external_force.hpp"
#include "der/scenario/scenario.hpp"
#include "der/simulation.hpp"
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
)";

/// The end of a scene that follows a path, by `keys` in YAML flow style.
std::string continuation(const std::string& keys) {
  return "analysis: {continuation: {" + keys + "}}\n";
}

Model model_of(const std::string& more) {
  return build_model(Scenario::parse(straight_rod(11, more)).scene());
}

Vector controls_of(const Model& model, const State& state) {
  Vector controls;
  evaluate_controls(model, state, 0.0, controls);
  return controls;
}

/// All that acts, without what the elements do [N].
Vector force_on(const Model& model, const State& state) {
  Vector force;
  external_force(model, configuration_of(model, state), state.extra_force, force);
  return force;
}

std::vector<std::size_t> rows(const PathBranch& branch, PathEvent event) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < branch.points.size(); ++i) {
    if (branch.points[i].event == event) result.push_back(i);
  }
  return result;
}

}  // namespace

TEST_CASE("a load factor scales every load, and nothing else") {
  const Model whole = model_of(kAllKinds + kStatic);
  const Model model = model_of(kAllKinds + continuation(""));
  CHECK_FALSE(whole.load_variation);
  REQUIRE(model.load_variation);
  CHECK(model.load_variation->varies());
  CHECK(model.load_variation->is_linear);
  State state = initial_state(model);
  CHECK((force_on(model, state) - force_on(whole, state)).norm() < 1e-14);
  const double weight = energies(whole, state)[EnergyTerm::Gravity];
  state.load_factor = 0.25;
  CHECK((force_on(model, state) - 0.25 * force_on(whole, state)).norm() < 1e-14);
  CHECK(energies(model, state)[EnergyTerm::Gravity] ==
        doctest::Approx(0.25 * weight).epsilon(1e-14));
  // The clamp has the first two controls, its rotation and how far it has turned; the moment the
  // third.
  CHECK(controls_of(model, state)[0] == doctest::Approx(0.3));
  CHECK(controls_of(model, state)[2] == doctest::Approx(0.125));
  CHECK(control_value(model, state, 2) == controls_of(model, state)[2]);
}

TEST_CASE("a load factor of one load, and one of the supports") {
  const Model whole = model_of(kAllKinds + kStatic);
  const Model one = model_of(kAllKinds + continuation("vary: loads.0"));
  State state = initial_state(whole);
  state.load_factor = 0.0;
  CHECK(energies(one, state)[EnergyTerm::Gravity] == 0.0);
  CHECK((force_on(one, state) - (force_on(whole, state) - whole.gravity_force)).norm() < 1e-14);
  const Model motion = model_of(kAllKinds + continuation("vary: supports"));
  CHECK_FALSE(motion.load_variation->is_linear);
  state.load_factor = 2.0;
  CHECK(controls_of(motion, state)[0] == doctest::Approx(0.6));
  CHECK(controls_of(motion, state)[2] == doctest::Approx(0.5));
  CHECK(force_on(motion, state) == force_on(whole, state));
}

TEST_CASE("a state of a load factor fits no scene without one") {
  Simulation path(Scenario::parse(straight_rod(11, kAllKinds + continuation(""))));
  Simulation plain(Scenario::parse(straight_rod(11, kAllKinds + kStatic)));
  State state = plain.state();
  path.restore(state);
  state.load_factor = 0.5;
  path.restore(state);
  CHECK(path.state().load_factor == 0.5);
  CHECK_THROWS_WITH_AS(plain.restore(state), doctest::Contains("varies no loads"), Error);
}

TEST_CASE("paths in two threads on one model are the same bits as alone") {
  // By type no path can write to the model; by this no path writes to what hangs on it either.
  const Scenario scenario = Scenario::parse(straight_rod(21, kPinned + kPush + continuation("")));
  const Model model = build_model(scenario.scene());
  const Pattern pattern = build_pattern(model);
  const auto follow = [&](double to) {
    const LinearSolverChoice solver = make_linear_solver(scenario.scene().solver.linear, pattern);
    const Assembler assembler(model, solver.solver->layout());
    ContinuationOptions options;
    options.to = to;
    options.branching = 1;
    State start = initial_state(model);
    start.load_factor = 0.0;
    std::vector<PathPoint> points;
    for (const PathBranch& branch :
         follow_path(model, assembler, *solver.solver, options, nullptr, start).branches) {
      points.insert(points.end(), branch.points.begin(), branch.points.end());
    }
    return points;
  };
  const auto alone = std::pair(follow(12.0), follow(-8.0));
  auto first = std::async(std::launch::async, follow, 12.0);
  auto second = std::async(std::launch::async, follow, -8.0);
  const auto together = std::pair(first.get(), second.get());
  const auto same = [](const std::vector<PathPoint>& a, const std::vector<PathPoint>& b) {
    REQUIRE(a.size() == b.size());
    CHECK(a.size() > 10);
    for (std::size_t i = 0; i < a.size(); ++i) {
      CHECK(a[i].factor == b[i].factor);
      CHECK(a[i].positions == b[i].positions);
    }
  };
  same(alone.first, together.first);
  same(alone.second, together.second);
}

TEST_CASE("a path counts the iterations of all its points") {
  Simulation simulation(
      Scenario::parse(straight_rod(21, kPinned + kPush + continuation("to: 12, branches: 1"))));
  const auto path = simulation.follow();
  std::size_t points = 0;
  for (const PathBranch& branch : path) points += branch.points.size();
  CHECK(simulation.counters().newton_iterations > static_cast<std::int64_t>(points));
}

TEST_CASE("a continuation that finds no start leaves the loads of the scene") {
  Simulation loose(Scenario::parse(straight_rod(11, kPush + continuation("from: 0.5"))));
  const Vector before = loose.gradient();
  CHECK_THROWS_AS(loose.follow(), NotConvergedError);
  CHECK(loose.gradient() == before);
}

TEST_CASE("a column bifurcates at its buckling load and is followed to both sides") {
  Simulation simulation(
      Scenario::parse(straight_rod(21, kPinned + kPush + continuation("to: 12, branches: 1"))));
  const auto path = simulation.follow();
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
      straight_rod(21, "supports:\n  - {rod: rod, at: start, clamp: true}\n" + continuation("") +
                           "loads:\n  - point_force: {rod: rod, at: end, force: [0, -5]}\n")));
  const auto path = simulation.follow();
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
  Simulation simulation(Scenario::parse(
      straight_rod(11, kPinned + continuation("") +
                           "loads:\n  - point_force: {rod: rod, at: end, force: [0, 0]}\n")));
  CHECK_THROWS_WITH_AS(simulation.follow(), doctest::Contains("nothing varies"), Error);
}

TEST_CASE("what the scene does not ask for is refused") {
  Simulation plain(Scenario::parse(straight_rod(11, kPinned + kPush + kStatic)));
  CHECK_THROWS_WITH_AS(plain.follow(), doctest::Contains("continuation"), Error);
  CHECK_THROWS_WITH_AS(plain.buckling(1), doctest::Contains("buckling"), Error);
}

}  // namespace der::test
