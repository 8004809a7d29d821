#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "der/output/checkpoint.hpp"
#include "output/column.hpp"
#include "output/hdf5.hpp"

namespace der {

/// The group /checkpoint of a run file. It has two slots that are written in turn, and `current`
/// names the one that is whole: a process killed while it writes one leaves the other. A slot has a
/// dataset for each field of a checkpoint and of its state, by name.
class CheckpointStore {
 public:
  static CheckpointStore create(hid_t file, hsize_t num_dofs, hsize_t num_probes);
  /// True if the file has checkpoints: a saved result has none.
  static bool is_in(hid_t file);
  /// Throws IoError where the group is not as `create` makes it for so many degrees of freedom and
  /// probes, or of another version.
  static CheckpointStore open(hid_t file, hsize_t num_dofs, hsize_t num_probes);

  /// Writes the slot that is not current. Flush the file, then call `publish`, then flush again.
  void write(const Checkpoint& checkpoint);
  /// Makes the slot written last the current one.
  void publish();
  /// The current checkpoint; none if nothing was ever published. Throws IoError where it is
  /// damaged or holds what no run has.
  [[nodiscard]] std::optional<Checkpoint> read() const;

 private:
  /// The numbers of one field.
  struct Dataset {
    hdf5::Handle fixed;      // where there are always as many
    Column<double> growing;  // where not
    hdf5::Handle kind;       // of a variant: the number of its alternative
  };
  struct Slot {
    std::vector<Dataset> datasets;  // in the order of the fields
    hdf5::Handle checksum;          // of all their numbers
  };
  /// A slot by `maker`, which creates datasets or opens them.
  template <class Maker>
  [[nodiscard]] Slot make_slot(const Maker& maker) const;

  std::array<Slot, 2> slots_;
  hdf5::Handle current_;
  hsize_t num_dofs_ = 0;
  hsize_t num_probes_ = 0;
  std::int64_t written_ = -1;    // slot written last
  std::int64_t published_ = -1;  // value of /checkpoint/current
};

}  // namespace der
