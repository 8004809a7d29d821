// The parts of the program der_run that need no terminal; tests/python/test_der_run.py drives the
// program itself.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "der/app/format.hpp"
#include "der/app/options.hpp"
#include "der/app/progress.hpp"
#include "der/app/report.hpp"
#include "output/output_scenes.hpp"
#include "statics/statics_scenes.hpp"

namespace der::test {
namespace {

using namespace der::app;  // NOLINT(google-build-using-namespace): the subject of this file

std::variant<Options, ExitCode> parse(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "der_run");
  return parse_options(static_cast<int>(arguments.size()), arguments.data());
}

}  // namespace

TEST_CASE("command line: scene, folder, overrides") {
  const auto parsed = parse({"--set", "a.b=[1, 2]", "dir/scene.yaml", "--set", "title=x=y"});
  REQUIRE(std::holds_alternative<Options>(parsed));
  const auto& options = std::get<Options>(parsed);
  CHECK(options.scene == "dir/scene.yaml");
  CHECK(options.out == "runs/scene");
  REQUIRE(options.overrides.size() == 2);
  CHECK(options.overrides[0] == Override{"a.b", "[1, 2]"});
  CHECK(options.overrides[1] == Override{"title", "x=y"});
  CHECK_FALSE(options.check);
  CHECK(std::get<Options>(parse({"scene.yaml", "--out", "here"})).out == "here");
}

TEST_CASE("counts and times of a run are readable") {
  CHECK(format_count(999) == "999");
  CHECK(format_count(1234567) == "1,234,567");
  CHECK(format_count(1, "step") == "1 step");
  CHECK(format_count(0, "step") == "0 steps");
  CHECK(format_time(2.5, 10.0) == "2.50");
  CHECK(format_time(11430.2, 12000.0) == "11430");
  CHECK(format_time(0.05, 0.2) == "0.0500");
}

TEST_CASE("times left are readable at every size") {
  CHECK(format_time_left(0.2) == "1 s");
  CHECK(format_time_left(42.0) == "42 s");
  CHECK(format_time_left(59.9) == "1:00 min");
  CHECK(format_time_left(185.0) == "3:05 min");
  CHECK(format_time_left(7384.0) == "2:03:04 h");
}

TEST_CASE("times spent are readable at every size") {
  CHECK(format_seconds(3.21e-4) == "321 us");
  CHECK(format_seconds(0.01234) == "12.3 ms");
  CHECK(format_seconds(1.234) == "1.23 s");
  CHECK(format_seconds(185.0) == "3 min 5 s");
  CHECK(format_seconds(7384.0) == "2 h 3 min");
}

TEST_CASE("the progress line says what is left and fits the terminal") {
  const RunPosition middle{250, 1000, 2.5, 10.0};
  CHECK(progress_line(middle, 50.0, 100) ==
        " 25 % [#######-----------------------]  t = 2.50 of 10 s  50 steps/s  15 s left");
  CHECK(progress_line(middle, 0.0, 100).find("left") == std::string::npos);
  CHECK(progress_line({1, 3, 0, 1}, 123456.0, 100).find("123,456 steps/s") != std::string::npos);
  for (const int width : {0, 1, 10, 30, 50, 70, 79}) {
    CAPTURE(width);
    CHECK(progress_line(middle, 50.0, width).size() <= static_cast<std::size_t>(width));
  }
  // The time left is the last to go.
  CHECK(progress_line(middle, 50.0, 30) == " 25 % [##---------]  15 s left");
  // Done only when it is done.
  CHECK(progress_line({9999, 10000, 9.999, 10.0}, 50.0, 100).find(" 99 %") == 0);
}

TEST_CASE("the report names what ran, why, and every probe") {
  Simulation simulation(Scenario::parse(kSpheres));
  Recorder recorder(simulation);
  const RunOutcome outcome = run(simulation, recorder);
  const std::string report = scene_head(simulation.scenario(), Style::plain()) +
                             run_report(simulation, recorder, outcome, RunFolder("runs/spheres"),
                                        Detail::Usual, Style::plain());
  const std::vector<std::string> parts{"Three spheres",
                                       "completed",
                                       "planar: " + simulation.model().reason,
                                       "implicit_euler",
                                       "banded: " + simulation.linear_solver_reason(),
                                       "20 steps",
                                       "runs/spheres/",
                                       "v_mid",
                                       "y_mid",
                                       "rad",
                                       "m/s"};
  for (const std::string& part : parts) {
    CAPTURE(part);
    CHECK(report.find(part) != std::string::npos);
  }
  CHECK(report.find('\x1b') == std::string::npos);
}

TEST_CASE("the report of an analysis lists what it has found") {
  const auto report_of = [](const std::string& analysis) {
    Simulation simulation(
        Scenario::parse(straight_rod(11, kPinned + kPush + "analysis: " + analysis + "\n")));
    Recorder recorder(simulation);
    const RunOutcome outcome = run(simulation, recorder);
    return run_report(simulation, recorder, outcome, RunFolder("runs/rod"), Detail::Usual,
                      Style::plain());
  };
  const auto has = [](const std::string& report, const std::string& part) {
    CAPTURE(report);
    CHECK(report.find(part) != std::string::npos);
  };
  const std::string modes = report_of("{modes: {count: 2}}");
  has(modes, "vibration modes about the equilibrium");
  has(modes, "Hz");
  const std::string buckling = report_of("{buckling: {count: 1}}");
  has(buckling, "linear buckling loads");
  has(buckling, "9.7887");  // (20 sin(pi/20))^2
  const std::string path = report_of("{continuation: {to: 12, branches: 1}}");
  has(path, "bifurcation");
  has(path, "branch");
}

}  // namespace der::test
