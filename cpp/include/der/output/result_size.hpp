#pragma once

#include <filesystem>

#include "der/simulation.hpp"

namespace der {

/// Number of frames of a whole run over time; 1 for the other analyses. A continuation saves one
/// for each point of its path, whose number is not known beforehand.
double expected_frames(const Simulation& simulation);

/// Approximate size [bytes] of one more frame in the result file.
double bytes_per_frame(const Simulation& simulation);

/// Approximate size [bytes] of the result file.
double expected_bytes(const Simulation& simulation);

/// Throws IoError, which says what to change, where the disk has less room than a result file of
/// this size takes, in place of the one that may be there.
void check_room(double bytes, const std::filesystem::path& file);

/// "1.5 GB"
std::string format_bytes(double bytes);

}  // namespace der
