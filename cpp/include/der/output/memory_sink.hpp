#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "der/output/frame.hpp"

namespace der {

/// Keeps the saved instants in memory, every quantity contiguous with one row a frame.
class MemorySink : public FrameSink {
 public:
  void write(const Frame& frame) override;

  [[nodiscard]] std::size_t num_frames() const { return times.size(); }

  std::vector<double> times;  ///< [s]
  std::vector<std::int64_t> steps;
  std::vector<double> positions;   ///< frames x (nodes * dimension) [m]
  std::vector<double> velocities;  ///< frames x (nodes * dimension) [m/s]
  std::vector<double> energies;    ///< frames x kEnergyNames [J]
  std::vector<double> work;        ///< frames x kLedgerNames [J]
  std::vector<double> probes;      ///< frames x probes, in the order of the scene
};

}  // namespace der
