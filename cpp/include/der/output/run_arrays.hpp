#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace der {

/// An array that a run file may hold.
struct RunArray {
  std::string name;  ///< with its group: "energies/bend"; arrays of each rod are in "rods"
  std::string unit;  ///< "" for a pure number
};

/// Every array of a run file but probes, which have units of their own, and checkpoints. Files,
/// exports and Python take names and units from here.
const std::vector<RunArray>& run_arrays();
/// Null for an unknown name.
const RunArray* find_run_array(std::string_view name);
/// The unit of an array. Throws Error for an unknown name.
const std::string& unit_of_array(std::string_view name);
/// Names of the arrays in a group, without the group.
std::vector<std::string> names_in_group(std::string_view group);

}  // namespace der
