#include "output/frame_columns.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "der/output/io_error.hpp"
#include "der/output/run_arrays.hpp"
#include "output/checksum.hpp"

namespace der {
namespace {

constexpr hsize_t kSmallestChunk = hsize_t{256} << 10;  // [bytes]
constexpr hsize_t kLargestChunk = hsize_t{1} << 30;     // [bytes]
/// A dataset with no more chunks than this has its chunk index in one node, which HDF5 writes at
/// once; a larger index is split over nodes that a killed process could leave half changed.
constexpr hsize_t kChunks = 60;
constexpr hsize_t kLargestTimeChunk = hsize_t{1} << 21;  // [rows]

/// Rows that are laid out together.
hsize_t chunk_rows(hsize_t row_bytes, hsize_t total_rows) {
  const hsize_t wanted = std::max(kSmallestChunk / row_bytes, (total_rows + kChunks - 1) / kChunks);
  const hsize_t largest = std::min(total_rows, kLargestChunk / row_bytes);
  return std::max<hsize_t>(1, std::min(wanted, largest));
}

hsize_t bytes_of(const std::vector<hsize_t>& row) {
  return std::accumulate(row.begin(), row.end(), hsize_t{sizeof(double)}, std::multiplies<>());
}

constexpr const char* kEnergies = "energies";
constexpr const char* kWork = "work";
constexpr const char* kSections = "sections";
constexpr const char* kTurns = "turns";

std::vector<std::size_t> alphabetical(const std::vector<std::string>& names) {
  std::vector<std::size_t> order(names.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return names[a] < names[b]; });
  return order;
}

/// Columns side by side as one table with a row a frame.
std::vector<double> table(const std::vector<Column<double>>& columns, hsize_t first,
                          hsize_t count) {
  std::vector<double> rows(columns.size() * count);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::vector<double> column = columns[i].read(first, count);
    for (std::size_t frame = 0; frame < count; ++frame) {
      rows[frame * columns.size() + i] = column[frame];
    }
  }
  return rows;
}

/// A dataset of the group of sections, and the dimensions of its rows.
struct SectionColumn {
  const char* name;
  std::vector<hsize_t> row;
};
std::vector<SectionColumn> section_columns(hsize_t sections) {
  return {{"theta", {sections}},
          {"spin", {sections}},
          {"frames", {sections, hsize_t{FrameBlock::kSize}}}};
}

/// Edges of which a dataset has an entry in each frame; errors call it `path`.
hsize_t edges_in(hid_t parent, const char* name, const std::string& path) {
  const hdf5::Handle dataset = hdf5::open_dataset(parent, name, hdf5::native_type<double>());
  const std::vector<hsize_t> dimensions = hdf5::dimensions_of(dataset.id());
  if (dimensions.size() != 2 || dimensions[1] == 0) {
    throw IoError("'" + path + "' should be frames x edges");
  }
  hdf5::check_stored(dataset.id(), 1, dimensions[1]);
  return dimensions[1];
}

/// Edges that have a section in a file; 0: its model has none.
hsize_t sections_in(hid_t file) {
  const bool expected = hdf5::read_text_attribute(file, "model") == "spatial";
  if (expected != hdf5::exists(file, kSections)) {
    throw IoError(expected ? "it is of the model 'spatial' and has no group 'sections'"
                           : "it has a group 'sections', which only the model 'spatial' writes");
  }
  if (!expected) return 0;
  const hdf5::Handle group = hdf5::open_group(file, kSections);
  return edges_in(group.id(), "theta", "sections/theta");
}

/// Edges whose turns are in a file.
hsize_t turns_in(hid_t file) {
  return hdf5::exists(file, kTurns) ? edges_in(file, kTurns, kTurns) : 0;
}

/// The layout of a file, with the probes in alphabetical order.
FrameLayout layout_in(hid_t file) {
  const hdf5::Handle positions = hdf5::open_dataset(file, "positions", hdf5::native_type<double>());
  const std::vector<hsize_t> dimensions = hdf5::dimensions_of(positions.id());
  const std::int64_t dimension = hdf5::read_integer_attribute(file, "dimension");
  if (dimension != 2 && dimension != 3) {
    throw IoError("its 'dimension' is " + std::to_string(dimension) + " and should be 2 or 3");
  }
  if (dimensions.size() != 3 || dimensions[1] == 0 ||
      dimensions[2] != static_cast<hsize_t>(dimension)) {
    throw IoError("'positions' should be frames x nodes x " + std::to_string(dimension));
  }
  hdf5::check_stored(positions.id(), 1, dimensions[1]);
  const hdf5::Handle probes = hdf5::open_group(file, "probes");
  std::vector<std::string> names = hdf5::names_in(probes.id());
  std::sort(names.begin(), names.end());
  FrameLayout layout{dimensions[1],  dimensions[2],    sections_in(file),
                     turns_in(file), std::move(names), {}};
  const std::int64_t rotations = hdf5::read_integer_attribute(file, "rotations");
  if (rotations < 0 || static_cast<hsize_t>(rotations) > layout.turns) {
    throw IoError("its 'rotations' are " + std::to_string(rotations) + " and should be 0 to " +
                  std::to_string(layout.turns));
  }
  layout.rotations = static_cast<hsize_t>(rotations);
  return layout;
}

void check_times(const std::vector<double>& times) {
  const bool finite =
      std::all_of(times.begin(), times.end(), [](double time) { return std::isfinite(time); });
  if (!finite) throw IoError("a time is not a finite number");
  if (!std::is_sorted(times.begin(), times.end())) throw IoError("the times do not ascend");
}

}  // namespace

FrameRow row_of(const FrameData& data, std::size_t frame, const FrameLayout& layout) {
  return {data.times[frame],
          data.steps[frame],
          data.positions.data() + frame * layout.num_positions(),
          data.velocities.data() + frame * layout.num_positions(),
          data.theta.data() + frame * layout.sections,
          data.spin.data() + frame * layout.sections,
          data.section_frames.data() + frame * layout.frame_numbers(),
          data.turns.data() + frame * layout.turns,
          data.energies.data() + frame * kEnergyTerms.size(),
          data.work.data() + frame * kLedger.size(),
          data.probes.data() + frame * layout.probe_names.size()};
}

FrameColumns::Group FrameColumns::create_group(hid_t file, const std::string& name,
                                               const std::vector<std::string>& names,
                                               const std::vector<std::string>& units,
                                               hsize_t chunk_rows) {
  const hdf5::Handle handle = hdf5::create_group(file, name);
  Group group{{}, alphabetical(names)};
  for (std::size_t i = 0; i < names.size(); ++i) {
    group.columns.push_back(
        Column<double>::create(handle.id(), names[i], {}, units[i], chunk_rows));
  }
  return group;
}

FrameColumns::Group FrameColumns::create_group(hid_t file, const std::string& name,
                                               hsize_t chunk_rows) {
  const std::vector<std::string> names = names_in_group(name);
  std::vector<std::string> units;
  for (const std::string& column : names) units.push_back(unit_of_array(name + '/' + column));
  return create_group(file, name, names, units, chunk_rows);
}

FrameColumns::Group FrameColumns::open_group(hid_t file, const std::string& name,
                                             const std::vector<std::string>& names) {
  const hdf5::Handle handle = hdf5::open_group(file, name);
  Group group{{}, alphabetical(names)};
  for (const std::string& column : names) {
    group.columns.push_back(Column<double>::open(handle.id(), column, {}));
  }
  return group;
}

FrameColumns FrameColumns::create(hid_t file, const FrameLayout& layout, hsize_t frames) {
  FrameColumns columns;
  columns.layout_ = layout;
  const std::vector<hsize_t> row{layout.nodes, layout.dimension};
  const hsize_t scalar_chunk = chunk_rows(sizeof(double), frames);
  const hsize_t vector_chunk = chunk_rows(bytes_of(row), frames);
  // One chunk for all times: its place in the index is written with the first frame and never
  // again.
  columns.time_ = Column<double>::create(file, "time", {}, unit_of_array("time"),
                                         std::min(frames, kLargestTimeChunk));
  columns.step_ =
      Column<std::int64_t>::create(file, "step", {}, unit_of_array("step"), scalar_chunk);
  columns.positions_ =
      Column<double>::create(file, "positions", row, unit_of_array("positions"), vector_chunk);
  columns.velocities_ =
      Column<double>::create(file, "velocities", row, unit_of_array("velocities"), vector_chunk);
  if (layout.sections > 0) {
    const hdf5::Handle group = hdf5::create_group(file, kSections);
    for (const auto& [name, entries] : section_columns(layout.sections)) {
      columns.sections_.push_back(Column<double>::create(
          group.id(), name, entries, unit_of_array(std::string(kSections) + '/' + name),
          chunk_rows(bytes_of(entries), frames)));
    }
  }
  if (layout.turns > 0) {
    const std::vector<hsize_t> entries{layout.turns};
    columns.turns_.push_back(Column<double>::create(file, kTurns, entries, unit_of_array(kTurns),
                                                    chunk_rows(bytes_of(entries), frames)));
  }
  columns.energies_ = create_group(file, kEnergies, scalar_chunk);
  columns.work_ = create_group(file, kWork, scalar_chunk);
  columns.probes_ =
      create_group(file, "probes", layout.probe_names, layout.probe_units, scalar_chunk);
  columns.checksum_ = Column<std::uint64_t>::create(file, "checksum", {}, "", scalar_chunk);
  return columns;
}

FrameColumns FrameColumns::open(hid_t file) { return open(file, layout_in(file)); }

FrameColumns FrameColumns::open(hid_t file, const FrameLayout& layout) {
  const FrameLayout there = layout_in(file);
  std::vector<std::string> names = layout.probe_names;
  std::sort(names.begin(), names.end());
  if (layout.nodes != there.nodes || layout.dimension != there.dimension ||
      layout.sections != there.sections || layout.turns != there.turns ||
      layout.rotations != there.rotations || names != there.probe_names) {
    throw IoError("its nodes, edges or probes are not those of the scene");
  }
  FrameColumns columns;
  columns.layout_ = layout;
  const std::vector<hsize_t> row{layout.nodes, layout.dimension};
  columns.time_ = Column<double>::open(file, "time", {});
  columns.step_ = Column<std::int64_t>::open(file, "step", {});
  columns.positions_ = Column<double>::open(file, "positions", row);
  columns.velocities_ = Column<double>::open(file, "velocities", row);
  if (layout.sections > 0) {
    const hdf5::Handle group = hdf5::open_group(file, kSections);
    for (const auto& [name, entries] : section_columns(layout.sections)) {
      columns.sections_.push_back(Column<double>::open(group.id(), name, entries));
    }
  }
  if (layout.turns > 0) {
    columns.turns_.push_back(Column<double>::open(file, kTurns, {layout.turns}));
  }
  columns.energies_ = open_group(file, kEnergies, names_in_group(kEnergies));
  columns.work_ = open_group(file, kWork, names_in_group(kWork));
  columns.probes_ = open_group(file, "probes", layout.probe_names);
  columns.checksum_ = Column<std::uint64_t>::open(file, "checksum", {});
  return columns;
}

std::size_t FrameColumns::bytes_per_frame() const {
  const std::size_t numbers = 2 * (layout_.num_positions() + layout_.sections) +
                              layout_.frame_numbers() + layout_.turns + energies_.columns.size() +
                              work_.columns.size() + probes_.columns.size() +
                              3;  // time, step, checksum
  return sizeof(double) * numbers;
}

template <class F>
void FrameColumns::for_each_data_column(F&& f) {
  f(step_);
  f(positions_);
  f(velocities_);
  for (auto& column : sections_) f(column);
  for (auto& column : turns_) f(column);
  for (Group* group : {&energies_, &work_, &probes_}) {
    for (auto& column : group->columns) f(column);
  }
  f(checksum_);
}

std::uint64_t FrameColumns::checksum(const FrameRow& row) const {
  Checksum sum;
  sum.add(row.time);
  sum.add(row.step);
  sum.add(row.positions, layout_.num_positions());
  sum.add(row.velocities, layout_.num_positions());
  if (layout_.sections > 0) {
    sum.add(row.theta, layout_.sections);
    sum.add(row.spin, layout_.sections);
    sum.add(row.section_frames, layout_.frame_numbers());
  }
  if (layout_.turns > 0) sum.add(row.turns, layout_.turns);
  for (const std::size_t i : energies_.order) sum.add(row.energies[i]);
  for (const std::size_t i : work_.order) sum.add(row.work[i]);
  for (const std::size_t i : probes_.order) sum.add(row.probes[i]);
  return sum.value();
}

void FrameColumns::push(const FrameRow& row) {
  time_.push(row.time);
  step_.push(row.step);
  positions_.push(row.positions);
  velocities_.push(row.velocities);
  if (layout_.sections > 0) {
    sections_[0].push(row.theta);
    sections_[1].push(row.spin);
    sections_[2].push(row.section_frames);
  }
  if (layout_.turns > 0) turns_[0].push(row.turns);
  const auto push_all = [](Group& group, const double* values) {
    for (std::size_t i = 0; i < group.columns.size(); ++i) group.columns[i].push(values[i]);
  };
  push_all(energies_, row.energies);
  push_all(work_, row.work);
  push_all(probes_, row.probes);
  checksum_.push(checksum(row));
  ++waiting_;
}

void FrameColumns::write_data() {
  for_each_data_column([](auto& column) { column.write(); });
}

void FrameColumns::write_times() {
  time_.write();
  waiting_ = 0;
}

void FrameColumns::resize_data(hsize_t count) {
  for_each_data_column([&](auto& column) { column.resize(count); });
}

FrameData FrameColumns::read(hsize_t first, hsize_t count) const {
  // Datasets can share their place in a file: all together must not be more than it holds, either.
  hdf5::check_stored(checksum_.id(), count, bytes_per_frame() / sizeof(double));
  FrameData data;
  data.times = time_.read(first, count);
  data.steps = step_.read(first, count);
  data.positions = positions_.read(first, count);
  data.velocities = velocities_.read(first, count);
  if (layout_.sections > 0) {
    data.theta = sections_[0].read(first, count);
    data.spin = sections_[1].read(first, count);
    data.section_frames = sections_[2].read(first, count);
  }
  if (layout_.turns > 0) data.turns = turns_[0].read(first, count);
  data.energies = table(energies_.columns, first, count);
  data.work = table(work_.columns, first, count);
  data.probes = table(probes_.columns, first, count);
  const std::vector<std::uint64_t> expected = checksum_.read(first, count);
  for (std::size_t frame = 0; frame < count; ++frame) {
    if (checksum(row_of(data, frame, layout_)) != expected[frame]) {
      throw IoError("frame " + std::to_string(first + frame) +
                    " is damaged: its checksum is another one");
    }
  }
  check_times(data.times);
  return data;
}

}  // namespace der
