#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace der {

/// Saved instants of a run, every quantity contiguous with one row a frame.
struct FrameData {
  [[nodiscard]] std::size_t num_frames() const { return times.size(); }

  std::vector<double> times;  ///< [s]
  std::vector<std::int64_t> steps;
  std::vector<double> positions;       ///< frames x (nodes * dimension) [m]
  std::vector<double> velocities;      ///< frames x (nodes * dimension) [m/s]
  std::vector<double> theta;           ///< frames x edges [rad]; none without sections
  std::vector<double> spin;            ///< frames x edges [rad/s]
  std::vector<double> section_frames;  ///< frames x (edges * 8) (kinematics/frame_block.hpp)
  std::vector<double> turns;           ///< frames x followed edges, or joints [rad]
  std::vector<double> energies;        ///< frames x kEnergyTerms [J]
  std::vector<double> work;            ///< frames x kLedger [J]
  std::vector<double> probes;          ///< frames x probes
};

}  // namespace der
