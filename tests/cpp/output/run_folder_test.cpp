// Run folders: what is replaced and what is not, the summary, and which runs can be resumed.
#include "der/output/run_folder.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "der/output/io_error.hpp"
#include "der/output/result_size.hpp"
#include "der/scenario/scenario.hpp"
#include "output/output_scenes.hpp"

namespace der::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<std::string> files_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

Json summary_of(const RunFolder& folder) { return Json::parse(std::ifstream(folder.summary())); }

RunOutcome run_scene(const RunFolder& folder, const Scenario& scenario, bool resume = false,
                     const StepCallback& callback = {}) {
  Simulation simulation(scenario);
  Recorder recorder(simulation);
  return resume ? resume_in_folder(folder, simulation, recorder, callback)
                : run_in_folder(folder, simulation, recorder, callback);
}

bool stop_at_once(const Simulation& /*simulation*/) { return false; }

}  // namespace

TEST_CASE("a run leaves a summary, a result file and its scene with the overrides") {
  const TemporaryFolder temporary;
  const RunFolder folder(temporary.path() / "runs" / "spheres");
  const Scenario scenario = Scenario::parse(kSpheres, "spheres", {{"time.step", "0.005"}});
  run_scene(folder, scenario);
  CHECK(fs::exists(folder.results()));
  CHECK(Scenario::load(folder.scene()).scene().time.step == 0.005);
  const Json summary = summary_of(folder);
  CHECK(summary["status"] == "completed");
  CHECK(summary["title"] == "Three spheres");
  CHECK(summary["model"] == "planar");
  CHECK(summary["model_reason"].get<std::string>().size() > 10);
  CHECK(summary["integrator"] == "implicit_euler");
  CHECK(summary["linear_solver"] == "banded");
  CHECK(summary["linear_solver_reason"].get<std::string>().size() > 10);
  CHECK(summary["steps"] == 40);
  CHECK(summary["newton_iterations"] >= 40);
  CHECK(summary["retried_steps"] == 0);
  CHECK(summary["wall_seconds"] > 0.0);
  CHECK(summary["nodes"] == 3);
  CHECK(summary["dofs"] == 6);
  CHECK(summary["energies"]["kinetic"] > 0.0);
  CHECK(summary.count("failure") == 0);
  const Json& v_mid = summary["probes"]["v_mid"];
  for (const char* key : {"final", "min", "max", "t_min", "t_max"}) CHECK(v_mid[key].is_number());
  CHECK(v_mid["unit"] == "m/s");
  CHECK(v_mid["min"] <= v_mid["final"]);
}

TEST_CASE("an earlier run is replaced, what else lies in its folder is not touched") {
  const TemporaryFolder temporary;
  const RunFolder folder(temporary.path());
  run_scene(folder, Scenario::parse(kSpheres));
  write(folder.path() / "notes.txt", "mine");
  run_scene(folder, Scenario::parse(kSpheres, "spheres", {{"title", "Second"}}));
  CHECK(summary_of(folder)["title"] == "Second");
  CHECK(fs::exists(folder.path() / "notes.txt"));
}

TEST_CASE("a folder that holds no run is not touched") {
  const TemporaryFolder temporary;
  const RunFolder folder(temporary.path());
  write(folder.path() / "thesis.tex", "do not delete");
  CHECK_THROWS_AS(run_scene(folder, Scenario::parse(kSpheres)), IoError);
  CHECK_FALSE(fs::exists(folder.results()));
  const RunFolder file(folder.path() / "thesis.tex");
  CHECK_THROWS_AS(run_scene(file, Scenario::parse(kSpheres)), IoError);
}

TEST_CASE("a file of a run's name that der did not write is not replaced") {
  const TemporaryFolder temporary;
  const RunFolder folder(temporary.path() / "run");
  const Scenario scenario = Scenario::parse(kSpheres);
  const auto refused = [&](const fs::path& file, const std::string& text) {
    CAPTURE(file);
    write(file, text);
    try {
      run_scene(folder, scenario);
      FAIL("it was replaced");
    } catch (const IoError& error) {
      CHECK(std::string(error.what()).find("'" + file.string() + "'") != std::string::npos);
    }
    CHECK(text_of(file) == text);
    fs::remove(file);
  };
  fs::create_directories(folder.path());
  refused(folder.results(), "results of somebody else");
  refused(folder.summary(), R"({"status": "of somebody else"})");
  run_scene(folder, scenario);
  refused(folder.summary(), "[]");
  refused(folder.path_table(), "a,b\n1,2\n");
  refused(folder.scene(), "# with my comments\n" + kSpheres);
  run_scene(folder, scenario);
  CHECK(summary_of(folder)["status"] == "completed");
}

TEST_CASE("a link at the place of a temporary file is not written through") {
  const TemporaryFolder temporary;
  const RunFolder folder(temporary.path() / "run");
  run_scene(folder, Scenario::parse(kSpheres));
  const fs::path precious = temporary.path() / "precious";
  write(precious, "mine");
  for (const fs::path& file : {folder.results(), folder.summary(), folder.scene()}) {
    fs::create_symlink(precious, fs::path(file) += ".tmp");
  }
  run_scene(folder, Scenario::parse(kSpheres));
  CHECK(text_of(precious) == "mine");
  CHECK(summary_of(folder)["status"] == "completed");
  const RunFolder fresh(temporary.path() / "fresh");
  fs::create_directories(fresh.path());
  fs::create_symlink(precious, fs::path(fresh.results()) += ".tmp");
  fs::create_symlink(precious, fresh.path() / "results.lock");
  CHECK_THROWS_AS(run_scene(fresh, Scenario::parse(kSpheres)), IoError);
  CHECK(text_of(precious) == "mine");
}

TEST_CASE("a folder that a killed program has left is used again") {
  const TemporaryFolder temporary;
  const RunFolder folder(temporary.path());
  write(folder.path() / "results.lock", "");
  write(folder.path() / "results.h5.tmp", "the beginning of a file");
  run_scene(folder, Scenario::parse(kSpheres));
  CHECK(files_in(folder.path()) ==
        std::vector<std::string>{"results.h5", "scene.yaml", "summary.json"});
}

TEST_CASE("a run whose file is replaced meanwhile says that its results are lost") {
  const TemporaryFolder temporary;
  const RunFolder folder(temporary.path() / "run");
  CHECK_THROWS_WITH_AS(run_scene(folder, Scenario::parse(kSpheres), false,
                                 [&](const Simulation&) {
                                   fs::remove(folder.results());
                                   write(folder.results(), "another's");
                                   return true;
                                 }),
                       doctest::Contains("its results are lost"), IoError);
  CHECK(text_of(folder.results()) == "another's");
}

TEST_CASE("a run that would fill the disk is refused before anything is touched") {
  const TemporaryFolder temporary;
  const RunFolder folder(temporary.path());
  run_scene(folder, Scenario::parse(kSpheres));
  const Scenario endless = Scenario::parse(kSpheres, "spheres",
                                           {{"time.duration", "9e5"},
                                            {"time.step", "1e-3"},
                                            {"output.every", "1e-3"},
                                            {"rods.0.nodes", "10001"}});
  CHECK_THROWS_WITH_AS(run_scene(folder, endless), doctest::Contains("raise output.every"),
                       IoError);
  CHECK(summary_of(folder)["status"] == "completed");
}

TEST_CASE("the announced size of the results is about what they take") {
  const TemporaryFolder temporary;
  const RunFolder folder(temporary.path());
  for (const char* every : {"0.01", "0.0002"}) {
    const Scenario scenario =
        Scenario::parse(kSpheres, "spheres",
                        {{"time.duration", "2"}, {"time.step", "0.0002"}, {"output.every", every}});
    run_scene(folder, scenario);
    const Simulation simulation(scenario);
    const auto size = static_cast<double>(fs::file_size(folder.results()));
    CHECK(expected_bytes(simulation) > 0.5 * size);
    CHECK(expected_bytes(simulation) < 1.5 * size);
  }
}

TEST_CASE("a folder whose run goes on is not touched") {
  const TemporaryFolder temporary;
  const RunFolder folder(temporary.path());
  const Scenario scenario = Scenario::parse(kSpheres);
  run_scene(folder, scenario, false, [&](const Simulation&) {
    CHECK_THROWS_AS(run_scene(folder, scenario), IoError);
    CHECK_THROWS_AS(check_resumable(folder, scenario), IoError);
    return false;
  });
  CHECK(summary_of(folder)["status"] == "stopped");
}

TEST_CASE("the summary of an earlier run does not survive into one that fails") {
  const TemporaryFolder temporary;
  const RunFolder folder(temporary.path());
  const Scenario good = cantilever("tip: {rod: arm, at: end, quantity: y}");
  CHECK(run_scene(folder, good).status == "static_converged");
  CHECK(summary_of(folder)["unstable_directions"] == 0);
  CHECK(run_scene(folder, good.with({{"supports", "[]"}})).status == "not_held");
  const Json summary = summary_of(folder);
  CHECK(summary["status"] == "not_held");
  CHECK(summary["failure"]["message"].get<std::string>().size() > 20);
  CHECK(summary["failure"]["time"] == 0.0);
  CHECK(summary["probes"].empty());
  CHECK(read_head(folder.results()).status == "not_held");
}

TEST_CASE("while a run goes on there is no summary") {
  const TemporaryFolder temporary;
  const RunFolder folder(temporary.path());
  const Scenario scenario = Scenario::parse(kSpheres);
  run_scene(folder, scenario);
  run_scene(folder, scenario, false, [&](const Simulation&) {
    CHECK_FALSE(fs::exists(folder.summary()));
    return false;
  });
  run_scene(folder, scenario, true, [&](const Simulation&) {
    CHECK_FALSE(fs::exists(folder.summary()));
    return true;
  });
  CHECK(summary_of(folder)["status"] == "completed");
  CHECK(summary_of(folder)["steps"] == 20);
}

TEST_CASE("which runs can be resumed") {
  const TemporaryFolder temporary;
  const RunFolder folder(temporary.path());
  const Scenario scenario = Scenario::parse(kSpheres);
  CHECK_THROWS_AS(check_resumable(folder, scenario), IoError);  // there is none

  run_scene(folder, scenario, false, stop_at_once);
  CHECK(check_resumable(folder, scenario).step == 1);
  try {
    check_resumable(folder, scenario.with({{"time.step", "0.005"}}));
    FAIL("a changed scene was accepted");
  } catch (const ResumeError& error) {
    const std::string message = error.what();
    CHECK(message.find("0.01") != std::string::npos);
    CHECK(message.find("0.005") != std::string::npos);
  }

  run_scene(folder, scenario);
  CHECK(check_resumable(folder, scenario).status == "completed");

  const Scenario unstable = scenario.with({{"time.integrator", "explicit_euler"},
                                           {"time.step", "1e-4"},
                                           {"time.allow_unstable", "true"},
                                           {"time.duration", "10"},
                                           {"output.every", "0.05"}});
  CHECK(run_scene(folder, unstable).status == "diverged");
  CHECK_THROWS_AS(check_resumable(folder, unstable), ResumeError);
}

}  // namespace der::test
