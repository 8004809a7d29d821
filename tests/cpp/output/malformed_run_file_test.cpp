// Run files whose content is wrong: each is refused with an IoError that names the file, and none
// is trusted. Under the sanitizers this also shows that no memory is touched on the way.
#include <doctest/doctest.h>
#include <hdf5.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "der/output/io_error.hpp"
#include "der/output/recorder.hpp"
#include "der/output/run.hpp"
#include "der/output/run_file.hpp"
#include "der/output/saved_run.hpp"
#include "output/output_scenes.hpp"

namespace der::test {
namespace {

namespace fs = std::filesystem;
using Dimensions = std::vector<hsize_t>;

/// A file with frames, probes and a checkpoint.
void write_run_file(const fs::path& path, const std::string& scene = kSpheres) {
  Simulation simulation(Scenario::parse(scene));
  Recorder recorder(simulation);
  const auto file = RunFile::create(path, simulation, recorder);
  recorder.add(*file);
  run(simulation, recorder, [](const Simulation& now) { return now.state().step < 10; });
  file->finish("stopped", simulation, recorder);
}

hid_t space_of(const Dimensions& dimensions) {
  if (dimensions.empty()) return H5Screate(H5S_SCALAR);
  return H5Screate_simple(static_cast<int>(dimensions.size()), dimensions.data(), nullptr);
}

/// An attribute of another type or extent, with zeros or texts in it.
void put_attribute(hid_t file, const char* object, const char* name, hid_t type,
                   const Dimensions& dimensions) {
  const hid_t opened = H5Oopen(file, object, H5P_DEFAULT);
  H5Adelete(opened, name);
  const hid_t space = space_of(dimensions);
  const hid_t attribute = H5Acreate2(opened, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  std::size_t count = 1;
  for (const hsize_t length : dimensions) count *= length;
  if (H5Tis_variable_str(type) > 0) {
    H5Awrite(attribute, type, std::vector<const char*>(count, "running").data());
  } else {
    H5Awrite(attribute, type, std::vector<char>(count * H5Tget_size(type), '\0').data());
  }
  H5Aclose(attribute);
  H5Sclose(space);
  H5Oclose(opened);
}

void put_integer_attribute(hid_t file, const char* name, std::int64_t value) {
  const hid_t attribute = H5Aopen(file, name, H5P_DEFAULT);
  H5Awrite(attribute, H5T_NATIVE_INT64, &value);
  H5Aclose(attribute);
}

/// A dataset of another type or extent in place of one, all zeros.
void put_dataset(hid_t file, const char* name, hid_t type, const Dimensions& dimensions,
                 hid_t creation = H5P_DEFAULT) {
  H5Ldelete(file, name, H5P_DEFAULT);
  const hid_t space = space_of(dimensions);
  const hid_t dataset = H5Dcreate2(file, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
  H5Dclose(dataset);
  H5Sclose(space);
}

void put_compressed(hid_t file, const char* name, const Dimensions& dimensions) {
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(creation, static_cast<int>(dimensions.size()), dimensions.data());
  H5Pset_fletcher32(creation);
  put_dataset(file, name, H5T_NATIVE_DOUBLE, dimensions, creation);
  H5Pclose(creation);
}

void put_external(hid_t file, const char* name) {
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_external(creation, "/etc/passwd", 0, 32);
  put_dataset(file, name, H5T_NATIVE_DOUBLE, {4}, creation);
  H5Pclose(creation);
}

void put_group(hid_t file, const char* name) {
  H5Ldelete(file, name, H5P_DEFAULT);
  H5Gclose(H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
}

/// Values over what is there.
template <class T>
void overwrite(hid_t file, const char* name, hid_t type, T value) {
  const hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);
  const hid_t space = H5Dget_space(dataset);
  const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
  H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, std::vector<T>(count, value).data());
  H5Sclose(space);
  H5Dclose(dataset);
}

void set_length(hid_t file, const char* name, const Dimensions& dimensions) {
  const hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);
  H5Dset_extent(dataset, dimensions.data());
  H5Dclose(dataset);
}

hid_t variable_text() {
  static const hid_t type = [] {
    const hid_t text = H5Tcopy(H5T_C_S1);
    H5Tset_size(text, H5T_VARIABLE);
    return text;
  }();
  return type;
}

struct Mistake {
  std::string name;
  std::function<void(hid_t)> make;
};

/// One that the message names, by a word of it.
struct NamedMistake {
  std::string name;
  std::string said;
  std::function<void(hid_t)> make;
};

std::function<void(hid_t)> dataset(const char* name, const Dimensions& dimensions) {
  return [=](hid_t file) { put_dataset(file, name, H5T_NATIVE_DOUBLE, dimensions); };
}
std::function<void(hid_t)> without(const char* name) {
  return [=](hid_t file) { H5Ldelete(file, name, H5P_DEFAULT); };
}
std::function<void(hid_t)> changed(const char* name) {
  return [=](hid_t file) { overwrite(file, name, H5T_NATIVE_DOUBLE, 0.25); };
}

/// Mistakes in a run of `kWound`, which follows the turns of an edge.
const std::vector<NamedMistake>& turn_mistakes() {
  static const std::vector<NamedMistake> all{
      {"none", "checksum", without("turns")},
      {"a list", "'turns'", dataset("turns", {3})},
      {"of no edges", "'turns'", dataset("turns", {3, 0})},
      {"too short", "too few rows", [](hid_t file) { set_length(file, "turns", {1, 1}); }},
      {"changed", "checksum", changed("turns")},
  };
  return all;
}

/// Mistakes in a run of `kStrip`.
const std::vector<NamedMistake>& section_mistakes() {
  const hsize_t edges = 5;
  static const std::vector<NamedMistake> all{
      {"no group", "no group 'sections'", without("sections")},
      {"of a planar run", "'dimension'",
       [](hid_t file) { put_integer_attribute(file, "dimension", 4); }},
      {"in two dimensions", "'positions'",
       [](hid_t file) { put_integer_attribute(file, "dimension", 2); }},
      {"theta: none", "'theta'", without("sections/theta")},
      {"theta: a list", "'sections/theta'", dataset("sections/theta", {edges})},
      {"theta: of no edges", "'sections/theta'", dataset("sections/theta", {3, 0})},
      {"theta: of other edges", "'spin'", dataset("sections/theta", {3, edges + 1})},
      {"all: of other edges", "the rods have 5",
       [=](hid_t file) {
         H5Ldelete(file, "checkpoint", H5P_DEFAULT);
         for (const char* name : {"sections/theta", "sections/spin"}) {
           put_dataset(file, name, H5T_NATIVE_DOUBLE, {0, edges + 1});
         }
         put_dataset(file, "sections/frames", H5T_NATIVE_DOUBLE, {0, edges + 1, 8});
         for (const char* name : {"time", "step", "checksum", "probes/z", "probes/twist"}) {
           set_length(file, name, {0});
         }
       }},
      {"theta: too short", "too few rows",
       [=](hid_t file) { set_length(file, "sections/theta", {1, edges}); }},
      {"theta: changed", "checksum", changed("sections/theta")},
      {"spin: a list", "'spin'", dataset("sections/spin", {3})},
      {"spin: changed", "checksum", changed("sections/spin")},
      {"frames: of 7 numbers", "'frames'", dataset("sections/frames", {3, edges, 7})},
      {"frames: a table", "'frames'", dataset("sections/frames", {3, edges})},
      {"frames: of other edges", "'frames'", dataset("sections/frames", {3, edges + 1, 8})},
      {"frames: changed", "checksum", changed("sections/frames")},
  };
  return all;
}

const std::vector<Mistake>& mistakes() {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto attribute = [](const char* object, const char* name, hid_t type,
                            const Dimensions& dimensions) {
    return [=](hid_t file) { put_attribute(file, object, name, type, dimensions); };
  };
  const auto dataset = [](const char* name, hid_t type, const Dimensions& dimensions) {
    return [=](hid_t file) { put_dataset(file, name, type, dimensions); };
  };
  static const std::vector<Mistake> all{
      {"format_version: 50 numbers", attribute("/", "format_version", H5T_NATIVE_INT64, {50})},
      {"format_version: a double", attribute("/", "format_version", H5T_NATIVE_DOUBLE, {})},
      {"format_version: a text", attribute("/", "format_version", variable_text(), {})},
      {"format_version: none", [](hid_t file) { H5Adelete(file, "format_version"); }},
      {"format_version: older",
       [](hid_t file) { put_integer_attribute(file, "format_version", 4); }},
      {"format_version: newer",
       [](hid_t file) { put_integer_attribute(file, "format_version", 99); }},
      {"format_version: negative",
       [](hid_t file) { put_integer_attribute(file, "format_version", -1); }},
      {"status: of variable length", attribute("/", "status", variable_text(), {})},
      {"status: 9 texts", attribute("/", "status", variable_text(), {9})},
      {"status: a number", attribute("/", "status", H5T_NATIVE_INT64, {})},
      {"status: none", [](hid_t file) { H5Adelete(file, "status"); }},
      {"model: none", [](hid_t file) { H5Adelete(file, "model"); }},
      {"model: a number", attribute("/", "model", H5T_NATIVE_INT64, {})},
      {"dimension: none", [](hid_t file) { H5Adelete(file, "dimension"); }},
      {"rotations: none", [](hid_t file) { H5Adelete(file, "rotations"); }},
      {"rotations: negative", [](hid_t file) { put_integer_attribute(file, "rotations", -1); }},
      {"rotations: of no joint", [](hid_t file) { put_integer_attribute(file, "rotations", 1); }},
      {"sections of a planar run",
       [](hid_t file) {
         H5Gclose(H5Gcreate2(file, "sections", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
       }},
      {"scene: of variable length", dataset("scene", variable_text(), {})},
      {"scene: a list", dataset("scene", H5T_C_S1, {40})},
      {"scene: a number", dataset("scene", H5T_NATIVE_INT64, {})},
      {"scene: a group", [](hid_t file) { put_group(file, "scene"); }},
      {"scene: none", without("scene")},
      {"time: of floats", dataset("time", H5T_NATIVE_FLOAT, {5})},
      {"time: of integers", dataset("time", H5T_NATIVE_INT64, {5})},
      {"time: a table", dataset("time", H5T_NATIVE_DOUBLE, {5, 2})},
      {"time: one value", dataset("time", H5T_NATIVE_DOUBLE, {})},
      {"time: none", without("time")},
      {"time: longer than the rest", [](hid_t file) { set_length(file, "time", {500}); }},
      {"time: of 1e15 rows", [](hid_t file) { set_length(file, "time", {1000000000000000U}); }},
      {"time: changed", [](hid_t file) { overwrite(file, "time", H5T_NATIVE_DOUBLE, 0.25); }},
      {"time: not a number", [](hid_t file) { overwrite(file, "time", H5T_NATIVE_DOUBLE, kNan); }},
      {"time: in another file", [](hid_t file) { put_external(file, "time"); }},
      {"time: a link to another file",
       [](hid_t file) {
         H5Ldelete(file, "time", H5P_DEFAULT);
         H5Lcreate_external("other.h5", "/time", file, "time", H5P_DEFAULT, H5P_DEFAULT);
       }},
      {"time: a link",
       [](hid_t file) {
         H5Ldelete(file, "time", H5P_DEFAULT);
         H5Lcreate_soft("/energies/bend", file, "time", H5P_DEFAULT, H5P_DEFAULT);
       }},
      {"step: of doubles", dataset("step", H5T_NATIVE_DOUBLE, {5})},
      {"step: of 1e15 rows", [](hid_t file) { set_length(file, "step", {1000000000000000U}); }},
      {"step: too short", [](hid_t file) { set_length(file, "step", {1}); }},
      {"positions: a list", dataset("positions", H5T_NATIVE_DOUBLE, {30})},
      {"positions: of no nodes", dataset("positions", H5T_NATIVE_DOUBLE, {5, 0, 2})},
      {"positions: of other nodes", dataset("positions", H5T_NATIVE_DOUBLE, {5, 4, 2})},
      {"positions: in three dimensions", dataset("positions", H5T_NATIVE_DOUBLE, {5, 3, 3})},
      {"positions: behind a filter",
       [](hid_t file) { put_compressed(file, "positions", {5, 3, 2}); }},
      {"positions: changed",
       [](hid_t file) { overwrite(file, "positions", H5T_NATIVE_DOUBLE, 0.5); }},
      {"velocities: of integers", dataset("velocities", H5T_NATIVE_INT64, {5, 3, 2})},
      {"velocities: none", without("velocities")},
      {"energies: a list", dataset("energies", H5T_NATIVE_DOUBLE, {5})},
      {"energies: without one", without("energies/bend")},
      {"work: a table", dataset("work/loads", H5T_NATIVE_DOUBLE, {5, 5})},
      {"probes: none", without("probes")},
      {"probes: without one", without("probes/y_mid")},
      {"probes: of floats", dataset("probes/y_mid", H5T_NATIVE_FLOAT, {5})},
      {"probes: unit of 9 texts", attribute("probes/y_mid", "unit", variable_text(), {9})},
      {"checksum: none", without("checksum")},
      {"checksum: signed", dataset("checksum", H5T_NATIVE_INT64, {5})},
      {"rods: none", without("rods")},
      {"rods: without one", without("rods/rod")},
      {"rods: one under two names",
       [](hid_t file) {
         H5Lcreate_hard(file, "rods/rod", file, "rods/again", H5P_DEFAULT, H5P_DEFAULT);
       }},
      {"rods: nodes of doubles", dataset("rods/rod/nodes", H5T_NATIVE_DOUBLE, {3})},
      {"rods: nodes without a checksum", dataset("rods/rod/nodes", H5T_NATIVE_INT, {3})},
      {"rods: nodes changed",
       [](hid_t file) { overwrite(file, "rods/rod/nodes", H5T_NATIVE_INT, 1000000); }},
      {"rods: arc lengths changed",
       [](hid_t file) { overwrite(file, "rods/rod/arc_length", H5T_NATIVE_DOUBLE, kNan); }},
      {"modes: of no shape",
       [](hid_t file) {
         put_group(file, "modes");
         put_dataset(file, "modes/frequencies", H5T_NATIVE_DOUBLE, {3});
       }},
      {"checkpoint: current of 7",
       [](hid_t file) {
         overwrite(file, "checkpoint/current", H5T_NATIVE_INT64, std::int64_t{7});
       }},
      {"checkpoint: current of -5",
       [](hid_t file) {
         overwrite(file, "checkpoint/current", H5T_NATIVE_INT64, std::int64_t{-5});
       }},
      {"checkpoint: current of 50 numbers", dataset("checkpoint/current", H5T_NATIVE_INT64, {50})},
      {"checkpoint: a slot missing", without("checkpoint/0")},
      {"checkpoint: positions too short",
       [](hid_t file) {
         for (const char* name : {"checkpoint/0/positions", "checkpoint/1/positions"}) {
           put_dataset(file, name, H5T_NATIVE_DOUBLE, {2});
         }
       }},
      {"checkpoint: time of 50 numbers",
       [](hid_t file) {
         for (const char* name : {"checkpoint/0/time", "checkpoint/1/time"}) {
           put_dataset(file, name, H5T_NATIVE_DOUBLE, {50});
         }
       }},
      {"checkpoint: time changed",
       [](hid_t file) {
         for (const char* name : {"checkpoint/0/time", "checkpoint/1/time"}) {
           overwrite(file, name, H5T_NATIVE_DOUBLE, kNan);
         }
       }},
      {"checkpoint: counters too short",
       [](hid_t file) {
         for (const char* name : {"checkpoint/0/counters", "checkpoint/1/counters"}) {
           put_dataset(file, name, H5T_NATIVE_INT64, {2});
         }
       }},
      {"checkpoint: extremes of another shape",
       [](hid_t file) {
         for (const char* name : {"checkpoint/0/extremes", "checkpoint/1/extremes"}) {
           put_dataset(file, name, H5T_NATIVE_DOUBLE, {4, 4});
         }
       }},
      {"checkpoint: a memory without its values",
       [](hid_t file) {
         for (const char* name : {"checkpoint/0/memory_kind", "checkpoint/1/memory_kind"}) {
           overwrite(file, name, H5T_NATIVE_INT64, std::int64_t{1});
         }
       }},
      {"checkpoint: an unknown memory",
       [](hid_t file) {
         for (const char* name : {"checkpoint/0/memory_kind", "checkpoint/1/memory_kind"}) {
           overwrite(file, name, H5T_NATIVE_INT64, std::int64_t{1} << 40);
         }
       }},
      {"checkpoint: a negative memory",
       [](hid_t file) {
         for (const char* name : {"checkpoint/0/memory_kind", "checkpoint/1/memory_kind"}) {
           overwrite(file, name, H5T_NATIVE_INT64, std::int64_t{-1});
         }
       }},
      {"checkpoint: values of no memory",
       [](hid_t file) {
         for (const char* name : {"checkpoint/0/memory", "checkpoint/1/memory"}) {
           set_length(file, name, {3});
         }
       }},
      {"checkpoint: version 50 numbers",
       attribute("checkpoint", "version", H5T_NATIVE_INT64, {50})},
      {"checkpoint: version of no state", attribute("checkpoint", "version", H5T_NATIVE_INT64, {})},
      {"checkpoint: without a version",
       [](hid_t file) { H5Adelete_by_name(file, "checkpoint", "version", H5P_DEFAULT); }},
      {"checkpoint: a part of a ramp",
       [](hid_t file) {
         for (const char* name : {"checkpoint/0/ramps", "checkpoint/1/ramps"}) {
           set_length(file, name, {3});
         }
       }},
  };
  return all;
}

void mend(const fs::path& path, const std::function<void(hid_t)>& change) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  REQUIRE(file >= 0);
  H5E_auto2_t print = nullptr;
  void* data = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &print, &data);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // of attributes that are deleted and not there
  change(file);
  H5Eset_auto2(H5E_DEFAULT, print, data);
  REQUIRE(H5Fclose(file) >= 0);
}

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void put_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// All data of a run file, as one text; throws IoError.
std::string all_of(const fs::path& path) {
  std::string text;
  const auto add = [&](const auto& values) {
    text.append(reinterpret_cast<const char*>(values.data()),
                sizeof(values[0]) * static_cast<std::size_t>(values.size()));
  };
  const RunFileHead head = read_head(path);
  text += head.der_version + head.status + head.scene + std::to_string(head.step) +
          std::to_string(head.time);
  const SavedRun run = read_run(path);
  for (const auto* names : {&run.probe_names, &run.probe_units}) {
    for (const std::string& name : *names) text += name + ",";
  }
  add(run.frames.times);
  add(run.frames.steps);
  for (const auto* values : {&run.frames.positions, &run.frames.velocities, &run.frames.theta,
                             &run.frames.spin, &run.frames.section_frames, &run.frames.turns,
                             &run.frames.energies, &run.frames.work, &run.frames.probes}) {
    add(*values);
  }
  const LastFrame last = read_last_frame(path);
  add(last.positions);
  add(last.velocities);
  for (const SavedRod& rod : last.rods) {
    text += rod.name;
    add(rod.nodes);
    add(rod.arc_length);
  }
  return text;
}

/// The message with which a file is refused; empty if it is not.
std::string refusal(const std::function<void()>& read) {
  try {
    read();
  } catch (const IoError& error) {
    return error.what();
  }
  return {};
}

void resume(const fs::path& path, const std::string& scene = kSpheres) {
  Simulation simulation(Scenario::parse(scene));
  Recorder recorder(simulation);
  RunFile::resume(path, simulation, recorder);
}

}  // namespace

TEST_CASE("run files of wrong content are refused and named") {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "results.h5";
  write_run_file(path);
  const std::string good = bytes_of(path);
  CHECK(refusal([&] { all_of(path); }).empty());
  for (const Mistake& mistake : mistakes()) {
    CAPTURE(mistake.name);
    put_bytes(path, good);
    mend(path, mistake.make);
    const std::string message = refusal([&] { all_of(path); });
    CHECK(message.find(path.string()) != std::string::npos);
    // A resumed run may accept damaged data that it does not read.
    refusal([&] { resume(path); });
  }
}

void check_named(const std::string& scene, const std::vector<NamedMistake>& mistakes) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "results.h5";
  write_run_file(path, scene);
  const std::string good = bytes_of(path);
  CHECK(refusal([&] { all_of(path); }).empty());
  for (const NamedMistake& mistake : mistakes) {
    CAPTURE(mistake.name);
    put_bytes(path, good);
    mend(path, mistake.make);
    const std::string message = refusal([&] { all_of(path); });
    CAPTURE(message);
    CHECK(message.find(path.string()) != std::string::npos);
    CHECK(message.find(mistake.said) != std::string::npos);
    refusal([&] { resume(path, scene); });
  }
}

TEST_CASE("sections that do not fit are refused by name") {
  check_named(kStrip, section_mistakes());
}

TEST_CASE("turns that do not fit are refused by name") { check_named(kWound, turn_mistakes()); }

TEST_CASE("the message tells an older file from a newer one") {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "results.h5";
  write_run_file(path);
  mend(path, [](hid_t file) { put_integer_attribute(file, "format_version", 4); });
  CHECK(refusal([&] { read_run(path); }).find("run its scene again") != std::string::npos);
  mend(path, [](hid_t file) { put_integer_attribute(file, "format_version", 99); });
  CHECK(refusal([&] { read_run(path); }).find("install a newer der") != std::string::npos);
}

TEST_CASE("the message names the version of a checkpoint that is not ours") {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "results.h5";
  write_run_file(path);
  mend(path, [](hid_t file) { H5Adelete_by_name(file, "checkpoint", "version", H5P_DEFAULT); });
  for (const std::string& message :
       {refusal([&] { read_head(path); }), refusal([&] { resume(path); })}) {
    CHECK(message.find("checkpoint is of version 1") != std::string::npos);
    CHECK(message.find("run its scene again") != std::string::npos);
  }
  CHECK(refusal([&] { read_run(path); }).empty());  // the frames are as good as ever
}

TEST_CASE("numbers that no run has are refused although their checksums are right") {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "results.h5";
  const auto written_by = [&](const std::function<void(State&)>& spoil) {
    Simulation simulation(Scenario::parse(kSpheres));
    Recorder recorder(simulation);
    const auto file = RunFile::create(path, simulation, recorder);
    recorder.add(*file);
    recorder.observe(simulation);
    spoil(simulation.state());
    file->finish("stopped", simulation, recorder);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& spoil : std::vector<std::function<void(State&)>>{
           [&](State& state) { state.time = nan; },
           [&](State& state) { state.time = -1.0; },
           [&](State& state) { state.step = -3; },
           [&](State& state) { state.positions[0] = nan; },
           [&](State& state) { state.ramps = {{-1, 0.0, 1.0, 0.0, 1.0}}; },
           [&](State& state) { state.accelerations[0] = nan; },
           [&](State& state) {
             state.memory = StabilityMemory{Vector::Constant(state.positions.size(), nan)};
           },
       }) {
    written_by(spoil);
    CHECK_FALSE(refusal([&] { read_head(path); }).empty());
    CHECK_FALSE(refusal([&] { resume(path); }).empty());
  }

  const auto frames_at = [&](double first, double second) {
    Simulation simulation(Scenario::parse(kSpheres));
    Recorder recorder(simulation);
    const auto file = RunFile::create(path, simulation, recorder);
    const State& state = simulation.state();
    const Vector probes = Vector::Zero(4);
    const Vector none;
    for (const double time : {first, second}) {
      file->write({time,
                   0,
                   state.positions,
                   state.velocities,
                   none,
                   none,
                   none,
                   none,
                   {},
                   state.work,
                   probes});
    }
  };
  for (const auto& [first, second] : {std::pair{0.0, nan}, {nan, 1.0}, {1.0, 0.5}}) {
    frames_at(first, second);
    CHECK_FALSE(refusal([&] { read_run(path); }).empty());
  }
  frames_at(0.5, 1.0);
  CHECK(refusal([&] { read_run(path); }).empty());
}

TEST_CASE("a single flipped bit of a run file is seen, or changes nothing that is read") {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "results.h5";
  write_run_file(path);
  std::string bytes = bytes_of(path);
  const std::string expected = all_of(path);
  // A prime stride meets all bits of bytes and words; DER_BIT_STRIDE=1 takes every bit of the file.
  const char* stride_given = std::getenv("DER_BIT_STRIDE");
  const std::size_t stride = stride_given == nullptr ? 401 : std::stoul(stride_given);
  int seen = 0;
  for (std::size_t bit = 3; bit < 8 * bytes.size(); bit += stride) {
    std::fstream out(path, std::ios::binary | std::ios::in | std::ios::out);
    const std::size_t place = bit / 8;
    const char flipped = static_cast<char>(bytes[place] ^ (1 << (bit % 8)));
    out.seekp(static_cast<std::streamoff>(place)).put(flipped).flush();
    std::string found;
    const std::string message = refusal([&] { found = all_of(path); });
    seen += message.empty() ? 0 : 1;
    CAPTURE(bit);
    if (message.empty()) CHECK((found == expected));
    out.seekp(static_cast<std::streamoff>(place)).put(bytes[place]).flush();
  }
  CHECK(seen > 100);
  MESSAGE(seen << " of " << 8 * bytes.size() / stride << " flipped bits were seen");
}

TEST_CASE("a file that was cut off is refused or read as it was") {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "results.h5";
  write_run_file(path);
  const std::string bytes = bytes_of(path);
  for (std::size_t part = 0; part < 40; ++part) {
    put_bytes(path, bytes.substr(0, bytes.size() * part / 40));
    CHECK_FALSE(refusal([&] { all_of(path); }).empty());
  }
}

}  // namespace der::test
