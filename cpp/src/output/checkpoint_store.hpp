#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "der/output/checkpoint.hpp"
#include "output/hdf5.hpp"

namespace der {

/// The group /checkpoint of a run file. It has two slots that are written in turn, and `current`
/// names the one that is whole: a process killed while it writes one leaves the other.
class CheckpointStore {
 public:
  static CheckpointStore create(hid_t file, const Model& model, std::size_t num_probes);
  static CheckpointStore open(hid_t file);

  /// Writes the slot that is not current. Flush the file, then call `publish`, then flush again.
  void write(const Checkpoint& checkpoint);
  /// Makes the slot written last the current one.
  void publish();
  /// The current checkpoint; none if nothing was ever published.
  [[nodiscard]] std::optional<Checkpoint> read() const;

 private:
  struct Slot {
    hdf5::Handle time, step, positions, velocities, extra_force, accelerations, last_step;
    hdf5::Handle next_step, last_error, work;
    hdf5::Handle audit, extremes, counters, wall_seconds;
    hdf5::Column history;          // all vectors one behind the other
    hdf5::Column history_lengths;  // of each vector
    hdf5::Column ramps;            // five numbers each
  };
  static Slot create_slot(hid_t group, const Model& model, std::size_t num_probes);
  static Slot open_slot(hid_t group);

  std::array<Slot, 2> slots_;
  hdf5::Handle current_;
  std::int64_t written_ = -1;    // slot written last
  std::int64_t published_ = -1;  // value of /checkpoint/current
};

}  // namespace der
