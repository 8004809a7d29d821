#include "der/output/start.hpp"

#include <filesystem>
#include <string>

#include "der/output/io_error.hpp"
#include "der/output/run_file.hpp"
#include "der/output/run_folder.hpp"

namespace der {

void apply_start(Simulation& simulation) {
  const std::string& from = simulation.scenario().scene().start_from;
  if (from.empty()) return;
  if (from == "equilibrium") {
    simulation.equilibrium();
    return;
  }
  const RunFolder folder{std::filesystem::path(from)};
  const LastFrame last = read_last_frame(folder.results());
  State& state = simulation.state();
  if (last.positions.size() != state.positions.size()) {
    throw IoError("the run in '" + from + "' has " + std::to_string(last.positions.size()) +
                  " degrees of freedom and this scene " + std::to_string(state.positions.size()) +
                  ": start_from needs a run of the same rods");
  }
  state.positions = last.positions;
  state.velocities = last.velocities;
}

}  // namespace der
