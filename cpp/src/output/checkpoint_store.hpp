#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "der/output/checkpoint.hpp"
#include "output/column.hpp"
#include "output/hdf5.hpp"

namespace der {

/// The group /checkpoint of a run file. It has two slots that are written in turn, and `current`
/// names the one that is whole: a process killed while it writes one leaves the other.
class CheckpointStore {
 public:
  static CheckpointStore create(hid_t file, hsize_t num_dofs, hsize_t num_probes);
  /// True if the file has checkpoints: a saved result has none.
  static bool is_in(hid_t file);
  /// Throws IoError where the group is not as `create` makes it for so many degrees of freedom and
  /// probes.
  static CheckpointStore open(hid_t file, hsize_t num_dofs, hsize_t num_probes);

  /// Writes the slot that is not current. Flush the file, then call `publish`, then flush again.
  void write(const Checkpoint& checkpoint);
  /// Makes the slot written last the current one.
  void publish();
  /// The current checkpoint; none if nothing was ever published. Throws IoError where it is
  /// damaged or holds what no run has.
  [[nodiscard]] std::optional<Checkpoint> read() const;

 private:
  struct Slot {
    hdf5::Handle time, step, positions, velocities, extra_force, accelerations, last_step;
    hdf5::Handle next_step, last_error, work;
    hdf5::Handle audit, extremes, counters, wall_seconds;
    Column<double> history;                // all vectors one behind the other
    Column<std::int64_t> history_lengths;  // of each vector
    Column<double> ramps;                  // five numbers each
    Column<double> turns;
    hdf5::Handle checksum;  // of all these numbers
  };
  static Slot create_slot(hid_t group, hsize_t num_dofs, hsize_t num_probes);
  static Slot open_slot(hid_t group, hsize_t num_dofs, hsize_t num_probes);

  std::array<Slot, 2> slots_;
  hdf5::Handle current_;
  hsize_t num_dofs_ = 0;
  hsize_t num_probes_ = 0;
  std::int64_t written_ = -1;    // slot written last
  std::int64_t published_ = -1;  // value of /checkpoint/current
};

}  // namespace der
