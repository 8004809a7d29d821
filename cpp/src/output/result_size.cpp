#include "der/output/result_size.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <system_error>

#include "der/output/io_error.hpp"
#include "der/scenario/scenario.hpp"

namespace der {
namespace {

/// The size of a file without frames: its directory, and two checkpoints of six vectors.
constexpr double kDirectoryBytes = 30e3;
constexpr double kCheckpointVectors = 12.0;

/// Rounding error of a quotient: a whole number of intervals must not become one more.
constexpr double kRounding = 1e-12;

double num_dofs(const Simulation& simulation) {
  return static_cast<double>(simulation.model().num_dofs());
}

}  // namespace

double expected_frames(const Simulation& simulation) {
  const StepPlan& plan = simulation.plan();
  if (plan.every == 0.0) return 1.0;
  const double beats = simulation.scenario().scene().time.duration / plan.every;
  return 1.0 + std::ceil(beats * (1.0 - kRounding));
}

double bytes_per_frame(const Simulation& simulation) {
  const double numbers =
      2.0 * num_dofs(simulation) + static_cast<double>(simulation.model().initial_frames.size()) +
      static_cast<double>(kEnergyTerms.size() + kLedger.size()) +
      static_cast<double>(simulation.scenario().scene().output.probes.size()) + 3.0;
  return static_cast<double>(sizeof(double)) * numbers;
}

double expected_bytes(const Simulation& simulation) {
  return kDirectoryBytes + kCheckpointVectors * sizeof(double) * num_dofs(simulation) +
         expected_frames(simulation) * bytes_per_frame(simulation);
}

void check_room(double bytes, const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(file.parent_path(), error);
  if (error) return;  // not known
  double room = static_cast<double>(space.available);
  const auto replaced = std::filesystem::file_size(file, error);
  if (!error) room += static_cast<double>(replaced);
  if (bytes <= room) return;
  throw IoError(
      fmt::format("'{}' would take {}, and the disk has room for {}: raise output.every, shorten "
                  "time.duration, or name a folder on another disk",
                  file.string(), format_bytes(bytes), format_bytes(room)));
}

std::string format_bytes(double bytes) {
  constexpr std::array<const char*, 5> kUnits{"kB", "MB", "GB", "TB", "PB"};
  double number = bytes / 1e3;
  std::size_t unit = 0;
  while (number >= 999.5 && unit + 1 < kUnits.size()) {
    number /= 1e3;
    ++unit;
  }
  return fmt::format("{:.3g} {}", number, kUnits[unit]);
}

}  // namespace der
