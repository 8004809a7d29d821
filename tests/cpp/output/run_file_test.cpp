// The HDF5 file of a run: the same numbers as in memory, in the documented layout, and enough to go
// on with an interrupted run bit for bit.
#include "der/output/run_file.hpp"

#include <doctest/doctest.h>
#include <hdf5.h>

#include <string>
#include <vector>

#include "der/output/io_error.hpp"
#include "der/output/memory_sink.hpp"
#include "der/output/recorder.hpp"
#include "der/output/run.hpp"
#include "der/output/saved_run.hpp"
#include "der/steppers/stepper.hpp"
#include "model/same_state.hpp"
#include "output/output_scenes.hpp"

namespace der::test {
namespace {

namespace fs = std::filesystem;

/// Reads a file with plain HDF5, apart from the code under test.
class Reader {
 public:
  explicit Reader(const fs::path& path)
      : file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)) {
    REQUIRE(file_ >= 0);
  }
  ~Reader() { H5Fclose(file_); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  [[nodiscard]] std::vector<hsize_t> shape(const std::string& name) const {
    const hid_t dataset = H5Dopen2(file_, name.c_str(), H5P_DEFAULT);
    REQUIRE(dataset >= 0);
    const hid_t space = H5Dget_space(dataset);
    std::vector<hsize_t> dimensions(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
    H5Sget_simple_extent_dims(space, dimensions.data(), nullptr);
    H5Sclose(space);
    H5Dclose(dataset);
    return dimensions;
  }
  [[nodiscard]] std::vector<double> values(const std::string& name) const {
    std::size_t count = 1;
    for (const hsize_t length : shape(name)) count *= length;
    std::vector<double> data(count);
    const hid_t dataset = H5Dopen2(file_, name.c_str(), H5P_DEFAULT);
    CHECK(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data()) >= 0);
    H5Dclose(dataset);
    return data;
  }
  /// Names of all datasets without an attribute `unit`.
  [[nodiscard]] std::vector<std::string> without_unit() const {
    std::vector<std::string> names;
    H5Ovisit(file_, H5_INDEX_NAME, H5_ITER_INC, visit, &names);
    return names;
  }

 private:
  static herr_t visit(hid_t file, const char* name, const H5O_info_t* info, void* names) {
    if (info->type == H5O_TYPE_DATASET && H5Aexists_by_name(file, name, "unit", H5P_DEFAULT) <= 0) {
      static_cast<std::vector<std::string>*>(names)->emplace_back(name);
    }
    return 0;
  }
  hid_t file_;
};

struct Written {
  MemorySink memory;
  RunOutcome outcome;
  std::vector<ProbeSummary> summaries;
};

/// Runs the scene into a file (and memory); from its checkpoint if `resume`.
void run_to_file(const fs::path& path, const Scenario& scenario, bool resume, Written& written,
                 const StepCallback& callback = {}) {
  Simulation simulation(scenario);
  Recorder recorder(simulation);
  const auto file = resume ? RunFile::resume(path, simulation, recorder)
                           : RunFile::create(path, simulation, recorder);
  recorder.add(*file);
  recorder.add(written.memory);
  written.outcome = run(simulation, recorder, callback);
  file->finish(written.outcome.status, simulation, recorder);
  written.summaries = recorder.summaries();
}

const std::vector<std::string> kColumns{"time",
                                        "step",
                                        "positions",
                                        "velocities",
                                        "energies/kinetic",
                                        "energies/bend",
                                        "energies/stretch",
                                        "energies/spring",
                                        "energies/gravity",
                                        "work/loads",
                                        "work/supports",
                                        "work/drag",
                                        "work/numerical",
                                        "work/solver",
                                        "probes/v_mid",
                                        "probes/y_mid",
                                        "probes/angle",
                                        "probes/kinetic"};

void check_same_file(const fs::path& a, const fs::path& b) {
  const Reader first(a);
  const Reader second(b);
  for (const std::string& name : kColumns) {
    CAPTURE(name);
    CHECK(first.shape(name) == second.shape(name));
    CHECK(first.values(name) == second.values(name));
  }
}

void check_same(const ProbeSummary& a, const ProbeSummary& b) {
  CHECK(a.final == b.final);
  CHECK(a.min == b.min);
  CHECK(a.max == b.max);
  CHECK(a.t_min == b.t_min);
  CHECK(a.t_max == b.t_max);
}

/// One energy at each frame, from memory.
std::vector<double> energy_of(const Written& written, EnergyTerm term) {
  std::vector<double> values;
  for (std::size_t i = row_of(term); i < written.memory.energies.size(); i += kEnergyTerms.size()) {
    values.push_back(written.memory.energies[i]);
  }
  return values;
}

}  // namespace

TEST_CASE("a run file holds what a run keeps in memory") {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "results.h5";
  Written written;
  run_to_file(path, Scenario::parse(kSpheres), false, written);

  const Reader file(path);
  CHECK(file.shape("positions") == std::vector<hsize_t>{8, 3, 2});
  CHECK(file.shape("velocities") == std::vector<hsize_t>{8, 3, 2});
  CHECK(file.shape("time") == std::vector<hsize_t>{8});
  CHECK(file.values("time") == written.memory.times);
  CHECK(file.values("positions") == written.memory.positions);
  CHECK(file.values("velocities") == written.memory.velocities);
  for (const EnergyTermInfo& row : kEnergyTerms) {
    CHECK(file.values("energies/" + std::string(row.name)) == energy_of(written, row.term));
  }
  const auto angle = file.values("probes/angle");
  for (std::size_t i = 0; i < angle.size(); ++i)
    CHECK(angle[i] == written.memory.probes[4 * i + 2]);
  CHECK(file.values("rods/rod/arc_length") == std::vector<double>{0.0, 0.05, 0.1});
  CHECK(file.values("rods/rod/sphere_radius") == std::vector<double>{0.005, 0.025, 0.005});
  CHECK(file.values("rods/rod/nodes") == std::vector<double>{0, 1, 2});
  CHECK(file.without_unit().empty());
}

TEST_CASE("the head of a run file says what ran and how it ended") {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "results.h5";
  const Scenario scenario = Scenario::parse(kSpheres);
  Written written;
  run_to_file(path, scenario, false, written);
  const RunFileHead head = read_head(path);
  CHECK(head.status == "completed");
  CHECK(head.scene == scenario.to_yaml());
  CHECK(head.step == 20);
  CHECK(head.time == 0.2);
}

TEST_CASE("an abandoned run file says that it was running, with all frames so far") {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "results.h5";
  {
    Simulation simulation(Scenario::parse(kSpheres));
    Recorder recorder(simulation);
    const auto file = RunFile::create(path, simulation, recorder);
    recorder.add(*file);
    recorder.observe(simulation);
    for (int i = 0; i < 10; ++i) {
      simulation.step();
      recorder.observe(simulation);
    }
  }
  CHECK(read_head(path).status == "running");
  CHECK(Reader(path).values("step") == std::vector<double>{0, 3, 6, 9});
}

TEST_CASE("a stopped and resumed run is the uninterrupted one, bit for bit, with every stepper") {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "parts.h5";
  const fs::path whole_path = folder.path() / "whole.h5";
  for (const StepperInfo& stepper : stepper_registry()) {
    CAPTURE(stepper.name);
    std::vector<Override> overrides{{"time.integrator", std::string(stepper.name)}};
    if (!stepper.implicit) {
      for (const auto& [key, value] :
           {Override{"time.step", "1e-5"}, {"time.duration", "2e-4"}, {"output.every", "3e-5"}}) {
        overrides.emplace_back(key, value);
      }
    }
    const Scenario scenario = Scenario::parse(kSpheres, "spheres", overrides);
    Written whole;
    run_to_file(whole_path, scenario, false, whole);
    for (const std::int64_t stop : {1, 3, 7, 18, 19}) {
      CAPTURE(stop);
      Written part;
      run_to_file(path, scenario, false, part,
                  [&](const Simulation& now) { return now.state().step < stop; });
      CHECK(part.outcome.status == "stopped");
      CHECK(read_head(path).step == stop);
      Written rest;
      run_to_file(path, scenario, true, rest);
      CHECK(rest.outcome.status == "completed");
      check_same_file(path, whole_path);
      for (std::size_t i = 0; i < whole.summaries.size(); ++i) {
        check_same(rest.summaries[i], whole.summaries[i]);
      }
      CHECK(rest.outcome.counters.steps == 20);
      CHECK(rest.outcome.counters.newton_iterations == whole.outcome.counters.newton_iterations);
      CHECK(rest.outcome.wall_seconds > part.outcome.wall_seconds);
    }
  }
}

TEST_CASE("a run interrupted many times is the uninterrupted one") {
  const TemporaryFolder folder;
  const Scenario scenario = Scenario::parse(kSpheres);
  Written whole;
  run_to_file(folder.path() / "whole.h5", scenario, false, whole);
  const fs::path path = folder.path() / "parts.h5";
  bool resume = false;
  for (std::int64_t stop = 2; stop < 24; stop += 2) {
    Written part;
    run_to_file(path, scenario, resume, part,
                [&](const Simulation& now) { return now.state().step < stop; });
    resume = true;
  }
  check_same_file(path, folder.path() / "whole.h5");
}

TEST_CASE("what a multi-step stepper remembers and outside forces are part of a checkpoint") {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "results.h5";
  const Scenario scenario = Scenario::parse(kSpheres);
  State saved;
  {
    Simulation simulation(scenario);
    Recorder recorder(simulation);
    const auto file = RunFile::create(path, simulation, recorder);
    recorder.add(*file);
    recorder.observe(simulation);
    simulation.step();
    simulation.state().memory =
        Bdf2Memory{Vector::LinSpaced(6, 0.1, 0.7), Vector::LinSpaced(6, 1.0, 2.0)};
    simulation.state().extra_force = Vector::LinSpaced(6, -1.0, 1.0) / 3.0;
    simulation.state().accelerations = Vector::LinSpaced(6, 0.1, 1.0) / 7.0;
    simulation.state().last_step = 0.1 / 3.0;
    recorder.observe(simulation);
    saved = simulation.state();
    file->finish("stopped", simulation, recorder);
  }
  Simulation simulation(scenario);
  Recorder recorder(simulation);
  const auto file = RunFile::resume(path, simulation, recorder);
  CHECK(first_difference(simulation.state(), saved).empty());
}

TEST_CASE("a run that outgrows one chunk is written and read back whole") {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "results.h5";
  // 40001 frames of 8 bytes are more than the 256 KiB of a scalar's chunk.
  const Scenario scenario =
      Scenario::parse(kSpheres, "spheres",
                      {{"time.duration", "40"}, {"time.step", "0.001"}, {"output.every", "0.001"}});
  Written written;
  run_to_file(path, scenario, false, written);
  const Reader file(path);
  CHECK(file.values("time") == written.memory.times);
  CHECK(file.values("energies/bend") == energy_of(written, EnergyTerm::Bend));
  CHECK(file.values("positions") == written.memory.positions);
}

TEST_CASE("files that are no run files, and folders that do not exist, are clear errors") {
  const TemporaryFolder folder;
  CHECK_THROWS_AS(read_head(folder.path() / "none.h5"), IoError);
  const fs::path other = folder.path() / "other.h5";
  H5Fclose(H5Fcreate(other.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  CHECK_THROWS_AS(read_head(other), IoError);
  Simulation simulation(Scenario::parse(kSpheres));
  const Recorder recorder(simulation);
  CHECK_THROWS_AS(RunFile::create(folder.path() / "no" / "results.h5", simulation, recorder),
                  IoError);
}

TEST_CASE("frames that come without a step in between are not kept in memory") {
  Simulation simulation(Scenario::parse(kSpheres, "spheres", {{"rods.rod.nodes", "10001"}}));
  Recorder recorder(simulation);
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "results.h5";
  const auto file = RunFile::create(path, simulation, recorder);
  const auto empty = fs::file_size(path);
  Vector values = Vector::Zero(static_cast<Index>(recorder.probes().size()));
  const Vector none;
  const State& state = simulation.state();
  for (int i = 0; i < 100; ++i) {  // of 320 kB each
    file->write({1e-9 * i,
                 0,
                 state.positions,
                 state.velocities,
                 none,
                 none,
                 none,
                 none,
                 {},
                 state.work,
                 values});
  }
  CHECK(fs::file_size(path) > empty + 20'000'000);
}

}  // namespace der::test
