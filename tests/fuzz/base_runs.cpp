#include "base_runs.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "der/output/recorder.hpp"
#include "der/output/run_folder.hpp"
#include "der/simulation.hpp"

namespace der::fuzz {
namespace {

namespace fs = std::filesystem;

const char* const kPlanar = R"(
rods:
  - name: rod
    nodes: 3
    from: [0, 0]
    to: [0.1, 0]
    cross_section: {circle: {radius: 0.001}}
    material: {youngs_modulus: 1e9, density: 1000}
  - name: other
    nodes: 2
    from: [0, 1]
    to: [0.1, 1]
    cross_section: {circle: {radius: 0.001}}
    material: {youngs_modulus: 1e9, density: 1000}
supports:
  - {name: wall, rod: rod, at: start, clamp: true}
loads:
  - gravity: [0, -9.8]
time: {duration: 0.06, step: 0.01, integrator: implicit_euler}
output:
  every: 0.02
  probes:
    y: {rod: rod, at: middle, quantity: y}
    kinetic: {quantity: kinetic_energy}
)";

const char* const kSpatial = R"(
model: spatial
rods:
  - name: strip
    nodes: 4
    from: [0, 0, 0]
    to: [0.3, 0.1, 0.2]
    cross_section: {rectangle: {width: 0.02, height: 0.002}, director: [0, 0, 1]}
    material: {youngs_modulus: 1e8, poissons_ratio: 0.3, density: 1000}
    natural_curvature: [1.0, 2.0]
supports:
  - {rod: strip, at: start, clamp: true}
loads:
  - gravity: [0, 0, -9.8]
time: {duration: 0.012, step: 0.002, integrator: bdf2}
output:
  every: 0.004
  probes:
    twist: {rod: strip, at: 0.1, quantity: twist}
)";

const std::string kColumn = R"(
rods:
  - name: arm
    nodes: 7
    from: [0, 0]
    to: [1, 0]
    cross_section: {stiffness: {EA: 1e4, EI: 1, GJ: 1, mass_per_length: 1}}
supports:
  - {rod: arm, at: start, clamp: true}
loads:
  - point_force: {rod: arm, at: end, force: [-1, 0.1]}
output: {probes: {tip: {rod: arm, at: end, quantity: y}}}
)";

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

BaseRun run_of(const std::string& scene) {
  const RunFolder folder{fs::path(scratch_folder()) / "base"};
  fs::remove_all(folder.path());
  Simulation simulation(Scenario::parse(scene));
  Recorder recorder(simulation);
  run_in_folder(folder, simulation, recorder,
                [](const Simulation& now) { return now.state().step < 4; });
  return {scene, bytes_of(folder.results())};
}

}  // namespace

const std::string& scratch_folder() {
  struct Scratch {
    std::string path = (fs::temp_directory_path() / "der-fuzz-XXXXXX").string();
    Scratch() {
      if (::mkdtemp(path.data()) == nullptr) std::abort();
    }
    ~Scratch() {
      std::error_code ignored;
      fs::remove_all(path, ignored);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
  };
  static const Scratch scratch;
  return scratch.path;
}

const std::vector<BaseRun>& base_runs() {
  static const std::vector<BaseRun> all{
      run_of(kPlanar), run_of(kSpatial), run_of(kColumn + "analysis: modes\n"),
      run_of(kColumn + "analysis: {continuation: {to: 2, points: 3}}\n")};
  return all;
}

}  // namespace der::fuzz
