#include "der/output/run_arrays.hpp"

#include <algorithm>

#include "der/core/error.hpp"
#include "der/model/state.hpp"

namespace der {
namespace {

std::vector<RunArray> all_arrays() {
  std::vector<RunArray> rows{
      {"time", "s"},
      {"step", ""},
      {"positions", "m"},
      {"velocities", "m/s"},
      {"sections/theta", "rad"},
      {"sections/spin", "rad/s"},
      {"sections/frames", ""},
      {"turns", "rad"},
      {"rods/nodes", ""},
      {"rods/arc_length", "m"},
      {"rods/rest_turning_angle", "rad"},
      {"rods/sphere_radius", "m"},
      {"rods/radius", "m"},
      {"modes/frequencies", "Hz"},
      {"modes/growth_rates", "1/s"},
      {"modes/shapes", "kg^-1/2"},
      {"buckling/load_factors", ""},
      {"buckling/rotations", "rad"},
      {"buckling/strains", ""},
      {"buckling/shapes", ""},
      {"path/branch", ""},
      {"path/factor", ""},
      {"path/arc", ""},
      {"path/unstable_directions", ""},
      {"path/unstable_out_of_plane", ""},
      {"path/event", ""},
  };
  for (const EnergyTermInfo& row : kEnergyTerms) {
    rows.push_back({std::string("energies/") + row.name, kEnergyUnit});
  }
  for (const LedgerEntry& row : kLedger) {
    rows.push_back({std::string("work/") + row.name, kEnergyUnit});
  }
  return rows;
}

}  // namespace

const std::vector<RunArray>& run_arrays() {
  static const std::vector<RunArray> table = all_arrays();
  return table;
}

const RunArray* find_run_array(std::string_view name) {
  const auto& table = run_arrays();
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const RunArray& array) { return array.name == name; });
  return found == table.end() ? nullptr : &*found;
}

const std::string& unit_of_array(std::string_view name) {
  const RunArray* array = find_run_array(name);
  if (array == nullptr) {
    throw Error("model_error", "run files have no array '" + std::string(name) + "'");
  }
  return array->unit;
}

std::vector<std::string> names_in_group(std::string_view group) {
  const std::string prefix = std::string(group) + '/';
  std::vector<std::string> names;
  for (const RunArray& array : run_arrays()) {
    if (array.name.compare(0, prefix.size(), prefix) == 0) {
      names.push_back(array.name.substr(prefix.size()));
    }
  }
  return names;
}

}  // namespace der
