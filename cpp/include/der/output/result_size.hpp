#pragma once

#include <filesystem>

#include "der/simulation.hpp"

namespace der {

/// Frames of a whole run over time; 1 for the other analyses, but that a continuation saves one for
/// each point of its path, however many these will be.
double expected_frames(const Simulation& simulation);

/// About how many bytes the result file of a frame more takes.
double bytes_per_frame(const Simulation& simulation);

/// About how many bytes the result file will have.
double expected_bytes(const Simulation& simulation);

/// Throws IoError, which says what to change, where the disk has less room than a result file of
/// this size takes, in place of the one that may be there.
void check_room(double bytes, const std::filesystem::path& file);

/// "1.5 GB"
std::string format_bytes(double bytes);

}  // namespace der
