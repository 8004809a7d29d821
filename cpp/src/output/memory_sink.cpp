#include "der/output/memory_sink.hpp"

namespace der {
namespace {

void append(std::vector<double>& rows, const Eigen::Ref<const Vector>& row) {
  rows.insert(rows.end(), row.data(), row.data() + row.size());
}

}  // namespace

void MemorySink::write(const Frame& frame) {
  times.push_back(frame.time);
  steps.push_back(frame.step);
  append(positions, frame.positions);
  append(velocities, frame.velocities);
  append(theta, frame.theta);
  append(spin, frame.spin);
  append(section_frames, frame.section_frames);
  append(turns, frame.turns);
  const auto& terms = frame.energies.values();
  energies.insert(energies.end(), terms.begin(), terms.end());
  const auto works = ledger(frame.work, frame.energies);
  work.insert(work.end(), works.begin(), works.end());
  append(probes, frame.probes);
}

}  // namespace der
