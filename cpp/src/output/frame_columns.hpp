#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "der/core/types.hpp"
#include "der/kinematics/frame_block.hpp"
#include "der/model/state.hpp"
#include "der/output/frame_data.hpp"
#include "output/column.hpp"

namespace der {

/// Sizes and names of the parts of a frame.
struct FrameLayout {
  hsize_t nodes = 0;
  hsize_t dimension = 0;
  hsize_t sections = 0;  ///< edges that have a section; 0: the model has none
  hsize_t turns = 0;     ///< edges whose whole turns are followed
  std::vector<std::string> probe_names;
  std::vector<std::string> probe_units;  ///< one a probe, to create the columns
  /// Rotations of joints among the degrees of freedom. Frames keep them with the turns.
  hsize_t rotations = 0;

  [[nodiscard]] std::size_t num_positions() const {
    return static_cast<std::size_t>(nodes * dimension);
  }
  [[nodiscard]] std::size_t num_dofs() const {
    return num_positions() + static_cast<std::size_t>(sections + rotations);
  }
  /// Numbers of the frames of all sections.
  [[nodiscard]] std::size_t frame_numbers() const {
    return static_cast<std::size_t>(FrameBlock::kSize * sections);
  }
};

/// One frame as it is saved: pointers to a row of each quantity.
struct FrameRow {
  double time = 0.0;
  std::int64_t step = 0;
  const double* positions = nullptr;
  const double* velocities = nullptr;
  const double* theta = nullptr;  ///< of as many sections as the layout has, and so the next two
  const double* spin = nullptr;
  const double* section_frames = nullptr;
  const double* turns = nullptr;
  const double* energies = nullptr;
  const double* work = nullptr;
  const double* probes = nullptr;
};
/// Row number `frame` of frames that are laid out so.
FrameRow row_of(const FrameData& data, std::size_t frame, const FrameLayout& layout);

/// The columns of a run file that have one row a frame: times, steps, positions, velocities, angles
/// and frames of sections and turns of edges if there are any, energies, works, probes, and the
/// checksum of each row.
class FrameColumns {
 public:
  /// `frames`: how many there will be, as far as one can tell.
  static FrameColumns create(hid_t file, const FrameLayout& layout, hsize_t frames);
  /// Opens those of a file, whatever their size, with the probes in alphabetical order. Throws
  /// IoError where they do not fit together.
  static FrameColumns open(hid_t file);
  /// Opens the columns with the probes in the order of `layout`. Throws IoError too if the file has
  /// other nodes or probes.
  static FrameColumns open(hid_t file, const FrameLayout& layout);

  [[nodiscard]] const FrameLayout& layout() const { return layout_; }
  /// Frames that are whole.
  [[nodiscard]] hsize_t size() const { return time_.rows(); }
  /// Bytes that a frame takes.
  [[nodiscard]] std::size_t bytes_per_frame() const;
  /// Frames that wait to be written.
  [[nodiscard]] hsize_t waiting() const { return waiting_; }

  void push(const FrameRow& row);
  /// All but the times, which count the frames that are whole.
  void write_data();
  void write_times();
  /// Drops frames from `count` on.
  void resize_times(hsize_t count) { time_.resize(count); }
  void resize_data(hsize_t count);

  [[nodiscard]] std::vector<double> times() const { return time_.read(0, size()); }
  /// Frames [first, first + count). Throws IoError where a checksum differs or a time is not a
  /// finite number or comes after a later one.
  [[nodiscard]] FrameData read(hsize_t first, hsize_t count) const;

 private:
  /// Columns of one group, and their numbers in the alphabetical order of their names, in which
  /// checksums take them.
  struct Group {
    std::vector<Column<double>> columns;
    std::vector<std::size_t> order;
  };
  static Group create_group(hid_t file, const std::string& name,
                            const std::vector<std::string>& names,
                            const std::vector<std::string>& units, hsize_t chunk_rows);
  /// With the names and units of `run_arrays`.
  static Group create_group(hid_t file, const std::string& name, hsize_t chunk_rows);
  static Group open_group(hid_t file, const std::string& name,
                          const std::vector<std::string>& names);
  [[nodiscard]] std::uint64_t checksum(const FrameRow& row) const;
  template <class F>
  void for_each_data_column(F&& f);

  FrameLayout layout_;
  Column<double> time_, positions_, velocities_;
  Column<std::int64_t> step_;
  std::vector<Column<double>> sections_;  // theta, spin and frames; none without sections
  std::vector<Column<double>> turns_;     // one, or none if no edge is followed
  Group energies_, work_, probes_;
  Column<std::uint64_t> checksum_;
  hsize_t waiting_ = 0;
};

}  // namespace der
