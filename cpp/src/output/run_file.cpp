#include "der/output/run_file.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "der/output/io_error.hpp"
#include "der/output/pacer.hpp"
#include "der/output/recorder.hpp"
#include "der/version.hpp"
#include "output/checkpoint_store.hpp"
#include "output/hdf5.hpp"

namespace der {
namespace {

using hdf5::Column;
using hdf5::Handle;
using Seconds = std::chrono::duration<double>;

/// Of the layout; readers refuse what they do not know.
constexpr std::int64_t kFormatVersion = 4;

constexpr Seconds kFlushInterval{0.05};
/// Flushing may take this share of a run's time on a slow disk.
constexpr double kFlushShare = 0.05;
/// A checkpoint is written this often even when no frame is due.
constexpr Seconds kCheckpointInterval{10.0};
/// Frames are written out early when they take this much memory.
constexpr std::size_t kLargestBatch = std::size_t{8} << 20;  // [bytes]

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

/// Frames of a whole run.
hsize_t expected_frames(const Simulation& simulation) {
  const StepPlan& plan = simulation.plan();
  if (plan.every == 0.0) return 1;  // a static scene
  return static_cast<hsize_t>(2.0 + simulation.scenario().scene().time.duration / plan.every);
}

/// A column of the file and the rows that are not in it yet.
template <class T>
class BufferedColumn {
 public:
  BufferedColumn() = default;
  explicit BufferedColumn(Column column) : column_(std::move(column)) {}

  void push(T value) { rows_.push_back(value); }
  void push(const Vector& row) { rows_.insert(rows_.end(), row.data(), row.data() + row.size()); }
  void write(hsize_t count) {
    column_.append(rows_.data(), count);
    rows_.clear();
  }
  void resize(hsize_t count) { column_.resize(count); }
  [[nodiscard]] const Column& column() const { return column_; }

 private:
  Column column_;
  std::vector<T> rows_;
};

void write_head(hid_t file, const Simulation& simulation) {
  const scenario::Scene& scene = simulation.scenario().scene();
  hdf5::write_attribute(file, "format_version", kFormatVersion);
  hdf5::write_attribute(file, "der_version", std::string(version));
  hdf5::write_attribute(file, "status", std::string("running"));
  hdf5::write_attribute(file, "title", scene.title);
  hdf5::write_attribute(file, "analysis", std::string(scene.analysis_name()));
  hdf5::write_attribute(file, "model", simulation.model().name);
  hdf5::write_attribute(file, "dimension", std::int64_t{simulation.model().dimension});
  hdf5::write_text(file, "scene", simulation.scenario().to_yaml());
  hdf5::write_attribute(hdf5::open_dataset(file, "scene").id(), "unit", std::string());
}

template <class T>
void write_list(hid_t group, const std::string& name, const std::vector<T>& values,
                const std::string& unit) {
  const Handle dataset = hdf5::create_fixed(group, name, hdf5::native_type<T>(), {values.size()});
  hdf5::write_all(dataset.id(), values.data());
  hdf5::write_attribute(dataset.id(), "unit", unit);
}

void write_rod(hid_t rods, const RodLayout& rod) {
  const Handle group = hdf5::create_group(rods, rod.name);
  write_list(group.id(), "nodes", rod.nodes, "");
  write_list(group.id(), "arc_length", rod.arc_length, "m");
  write_list(group.id(), "rest_turning_angle", rod.rest_turning_angle, "rad");
  write_list(group.id(), "sphere_radius", rod.sphere_radius, "m");
  const bool is_angle = rod.curvature == scenario::CurvatureMeasure::Angle;
  hdf5::write_attribute(group.id(), "curvature", std::string(is_angle ? "angle" : "tangent"));
  hdf5::write_attribute(group.id(), "radius", rod.draw_radius);
  hdf5::write_attribute(group.id(), "EA", rod.EA);
  hdf5::write_attribute(group.id(), "EI", rod.EI);
}

}  // namespace

/// All that RunFile does, out of sight of those who include its header.
class RunFile::Writer {
 public:
  static std::unique_ptr<Writer> create(const std::filesystem::path& path,
                                        const Simulation& simulation, const Recorder& recorder);
  static std::unique_ptr<Writer> resume(const std::filesystem::path& path, Simulation& simulation,
                                        Recorder& recorder);

  void add(const Frame& frame);
  [[nodiscard]] bool due();
  void commit(const Simulation& simulation, const Recorder& recorder);
  /// To be called after an error of any of the others: leaves the file as it was flushed last.
  void abandon() {
    hdf5::abandon(file_.id());
    abandoned_ = true;
  }
  [[nodiscard]] bool abandoned() const { return abandoned_; }
  void add(const std::vector<Dataset>& datasets);
  void set_status(const std::string& status);
  /// Writes the frames that have gathered: all but /time first, so that the length of /time counts
  /// the frames that are whole.
  void commit_frames();

 private:
  Writer(const std::filesystem::path& path, Handle file)
      : path_(std::filesystem::absolute(path)), file_(std::move(file)) {}
  void create_columns(const Simulation& simulation, const Recorder& recorder);
  void open_columns(const Recorder& recorder);
  void truncate(hsize_t frames);
  [[nodiscard]] hsize_t frames_up_to(double time, const StepPlan& plan) const;
  void flush() { hdf5::flush(file_.id(), path_); }
  template <class F>
  void for_each_data_column(F&& f);

  std::filesystem::path path_;
  Handle file_;
  BufferedColumn<double> time_, positions_, velocities_;
  BufferedColumn<std::int64_t> step_;
  std::vector<BufferedColumn<double>> energies_, work_, probes_;
  CheckpointStore checkpoints_;
  bool abandoned_ = false;
  hsize_t gathered_ = 0;  // frames not written yet
  std::size_t bytes_per_frame_ = 0;
  Pacer pacer_{kFlushInterval};
  std::chrono::steady_clock::time_point last_checkpoint_;
};

std::unique_ptr<RunFile::Writer> RunFile::Writer::create(const std::filesystem::path& path,
                                                         const Simulation& simulation,
                                                         const Recorder& recorder) {
  std::unique_ptr<Writer> writer(new Writer(path, hdf5::create_file(path)));
  const hid_t file = writer->file_.id();
  write_head(file, simulation);
  writer->create_columns(simulation, recorder);
  const Handle rods = hdf5::create_group(file, "rods");
  for (const RodLayout& rod : simulation.model().rods) write_rod(rods.id(), rod);
  writer->checkpoints_ =
      CheckpointStore::create(file, simulation.model(), recorder.probes().size());
  return writer;
}

void RunFile::Writer::create_columns(const Simulation& simulation, const Recorder& recorder) {
  const hsize_t total = expected_frames(simulation);
  const auto create = [&](hid_t group, const std::string& name, hid_t type,
                          const std::vector<hsize_t>& row, const std::string& unit,
                          hsize_t rows_per_chunk) {
    Column column = Column::create(group, name, type, row, rows_per_chunk);
    hdf5::write_attribute(column.id(), "unit", unit);
    return column;
  };
  const hsize_t scalar_chunk = chunk_rows(sizeof(double), total);
  const auto create_scalar = [&](hid_t group, const std::string& name, const std::string& unit) {
    return BufferedColumn<double>(create(group, name, H5T_NATIVE_DOUBLE, {}, unit, scalar_chunk));
  };
  const std::vector<hsize_t> row{static_cast<hsize_t>(simulation.model().num_nodes),
                                 static_cast<hsize_t>(simulation.model().dimension)};
  const auto create_vectors = [&](const std::string& name, const std::string& unit) {
    return BufferedColumn<double>(create(file_.id(), name, H5T_NATIVE_DOUBLE, row, unit,
                                         chunk_rows(sizeof(double) * row[0] * row[1], total)));
  };

  // One chunk for all times: its place in the index is written with the first frame and never
  // again.
  time_ = BufferedColumn<double>(
      create(file_.id(), "time", H5T_NATIVE_DOUBLE, {}, "s", std::min(total, kLargestTimeChunk)));
  step_ = BufferedColumn<std::int64_t>(
      create(file_.id(), "step", H5T_NATIVE_INT64, {}, "", scalar_chunk));
  positions_ = create_vectors("positions", "m");
  velocities_ = create_vectors("velocities", "m/s");
  const Handle energies = hdf5::create_group(file_.id(), "energies");
  for (const char* name : kEnergyNames) {
    energies_.push_back(create_scalar(energies.id(), name, "J"));
  }
  const Handle work = hdf5::create_group(file_.id(), "work");
  for (const char* name : kLedgerNames) {
    work_.push_back(create_scalar(work.id(), name, "J"));
  }
  const Handle probes = hdf5::create_group(file_.id(), "probes");
  for (const Probe& probe : recorder.probes()) {
    probes_.push_back(create_scalar(probes.id(), probe.name(), probe.unit()));
  }
}

std::unique_ptr<RunFile::Writer> RunFile::Writer::resume(const std::filesystem::path& path,
                                                         Simulation& simulation,
                                                         Recorder& recorder) {
  std::unique_ptr<Writer> writer(new Writer(path, hdf5::open_file(path, H5F_ACC_RDWR)));
  writer->open_columns(recorder);
  writer->checkpoints_ = CheckpointStore::open(writer->file_.id());
  const auto checkpoint = writer->checkpoints_.read();
  if (!checkpoint) throw IoError("'" + path.string() + "' holds no checkpoint to resume from");
  if (checkpoint->state.positions.size() != simulation.model().num_dofs() ||
      checkpoint->extremes.size() != recorder.probes().size()) {
    throw IoError("the checkpoint in '" + path.string() + "' does not fit the scene");
  }
  writer->truncate(writer->frames_up_to(checkpoint->state.time, simulation.plan()));
  writer->set_status("running");
  recorder.restore(*checkpoint, simulation);
  return writer;
}

void RunFile::Writer::open_columns(const Recorder& recorder) {
  const auto open = [&](const std::string& name) { return Column::open(file_.id(), name); };
  time_ = BufferedColumn<double>(open("time"));
  step_ = BufferedColumn<std::int64_t>(open("step"));
  positions_ = BufferedColumn<double>(open("positions"));
  velocities_ = BufferedColumn<double>(open("velocities"));
  for (const char* name : kEnergyNames) {
    energies_.emplace_back(open("energies/" + std::string(name)));
  }
  for (const char* name : kLedgerNames) work_.emplace_back(open("work/" + std::string(name)));
  for (const Probe& probe : recorder.probes()) {
    probes_.emplace_back(open("probes/" + probe.name()));
  }
}

template <class F>
void RunFile::Writer::for_each_data_column(F&& f) {
  f(step_);
  f(positions_);
  f(velocities_);
  for (auto& column : energies_) f(column);
  for (auto& column : work_) f(column);
  for (auto& column : probes_) f(column);
}

/// Frames that an uninterrupted run would have saved up to `time`: an interrupted one ends with one
/// more, off the beat.
hsize_t RunFile::Writer::frames_up_to(double time, const StepPlan& plan) const {
  const auto times = hdf5::read_vector<double>(time_.column().id());
  hsize_t count = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (times[i] <= time && plan.is_frame(times[i])) ++count;
  }
  return count;
}

void RunFile::Writer::truncate(hsize_t frames) {
  time_.resize(frames);
  flush();
  for_each_data_column([&](auto& column) { column.resize(frames); });
  flush();
}

void RunFile::Writer::add(const Frame& frame) {
  time_.push(frame.time);
  step_.push(frame.step);
  positions_.push(frame.positions);
  velocities_.push(frame.velocities);
  const auto energies = by_name(frame.energies);
  for (std::size_t i = 0; i < energies.size(); ++i) energies_[i].push(energies[i]);
  const auto works = ledger(frame.work, frame.energies);
  for (std::size_t i = 0; i < works.size(); ++i) work_[i].push(works[i]);
  for (std::size_t i = 0; i < probes_.size(); ++i)
    probes_[i].push(frame.probes[static_cast<Index>(i)]);
  ++gathered_;
  bytes_per_frame_ = sizeof(double) * (2 * static_cast<std::size_t>(frame.positions.size()) +
                                       probes_.size() + energies_.size() + work_.size() + 2);
}

bool RunFile::Writer::due() {
  if (gathered_ * bytes_per_frame_ >= kLargestBatch) return true;
  if (!pacer_.due()) return false;
  return gathered_ > 0 ||
         std::chrono::steady_clock::now() - last_checkpoint_ >= kCheckpointInterval;
}

void RunFile::Writer::commit(const Simulation& simulation, const Recorder& recorder) {
  const auto start = std::chrono::steady_clock::now();
  checkpoints_.write(recorder.checkpoint(simulation));
  commit_frames();
  checkpoints_.publish();
  flush();
  last_checkpoint_ = std::chrono::steady_clock::now();
  const Seconds cost = last_checkpoint_ - start;
  pacer_.set_interval(std::max(kFlushInterval, cost / kFlushShare));
}

void RunFile::Writer::commit_frames() {
  for_each_data_column([&](auto& column) { column.write(gathered_); });
  flush();
  time_.write(gathered_);
  gathered_ = 0;
  flush();
}

void RunFile::Writer::add(const std::vector<Dataset>& datasets) {
  for (const Dataset& dataset : datasets) {
    const auto slash = dataset.name.find('/');
    const std::string group = dataset.name.substr(0, slash);
    if (!hdf5::exists(file_.id(), group)) hdf5::create_group(file_.id(), group);
    const std::vector<hsize_t> dimensions(dataset.shape.begin(), dataset.shape.end());
    const Handle handle =
        hdf5::create_fixed(file_.id(), dataset.name, H5T_NATIVE_DOUBLE, dimensions);
    hdf5::write_all(handle.id(), dataset.values.data());
    hdf5::write_attribute(handle.id(), "unit", dataset.unit);
  }
}

void RunFile::Writer::set_status(const std::string& status) {
  hdf5::write_attribute(file_.id(), "status", status);
  flush();
}

RunFile::RunFile(std::unique_ptr<Writer> writer) : writer_(std::move(writer)) {}

std::unique_ptr<RunFile> RunFile::create(const std::filesystem::path& path,
                                         const Simulation& simulation, const Recorder& recorder) {
  const hdf5::Session session;
  return std::unique_ptr<RunFile>(new RunFile(Writer::create(path, simulation, recorder)));
}

std::unique_ptr<RunFile> RunFile::resume(const std::filesystem::path& path, Simulation& simulation,
                                         Recorder& recorder) {
  const hdf5::Session session;
  return std::unique_ptr<RunFile>(new RunFile(Writer::resume(path, simulation, recorder)));
}

/// Calls an operation that writes; if it fails, the file is left as it was flushed last.
template <class F>
void RunFile::guarded(F&& operation) {
  const hdf5::Session session;
  try {
    operation();
  } catch (...) {
    writer_->abandon();
    throw;
  }
}

RunFile::~RunFile() {
  const hdf5::Session session;
  try {
    if (!writer_->abandoned()) guarded([&] { writer_->commit_frames(); });
  } catch (const IoError&) {
    // The run is unwinding from another error, which is the one to report.
  }
  writer_.reset();
}

void RunFile::write(const Frame& frame) { writer_->add(frame); }

void RunFile::stepped(const Simulation& simulation, const Recorder& recorder) {
  if (writer_->due()) guarded([&] { writer_->commit(simulation, recorder); });
}

void RunFile::add(const std::vector<Dataset>& datasets) {
  guarded([&] { writer_->add(datasets); });
}

void RunFile::finish(const std::string& status, const Simulation& simulation,
                     const Recorder& recorder) {
  guarded([&] {
    writer_->commit(simulation, recorder);
    writer_->set_status(status);
  });
}

namespace {

/// Opens a run file to read it.
Handle open_run_file(const std::filesystem::path& path) {
  Handle file = hdf5::open_file(path, H5F_ACC_RDONLY);
  if (!hdf5::has_attribute(file.id(), "format_version") ||
      hdf5::read_integer_attribute(file.id(), "format_version") != kFormatVersion) {
    throw IoError("'" + path.string() + "' is not a run file of this version of der");
  }
  return file;
}

}  // namespace

RunFileHead read_head(const std::filesystem::path& path) {
  const hdf5::Session session;
  const Handle file = open_run_file(path);
  RunFileHead head;
  head.der_version = hdf5::read_string_attribute(file.id(), "der_version");
  head.status = hdf5::read_string_attribute(file.id(), "status");
  head.scene = hdf5::read_text(file.id(), "scene");
  if (const auto checkpoint = CheckpointStore::open(file.id()).read()) {
    head.step = checkpoint->state.step;
    head.time = checkpoint->state.time;
  }
  return head;
}

LastFrame read_last_frame(const std::filesystem::path& path) {
  const hdf5::Session session;
  const Handle file = open_run_file(path);
  const hsize_t frames = hdf5::length_of(hdf5::open_dataset(file.id(), "time").id());
  if (frames == 0) throw IoError("'" + path.string() + "' holds no frame");
  const auto read = [&](const char* name) {
    const auto row = hdf5::read_row(hdf5::open_dataset(file.id(), name).id(), frames - 1);
    return Vector(Eigen::Map<const Vector>(row.data(), static_cast<Index>(row.size())));
  };
  LastFrame last{read("positions"), read("velocities"), {}, {}, {}};
  last.scene = hdf5::read_text(file.id(), "scene");
  if (hdf5::exists(file.id(), "checkpoint")) {  // not where Python has saved a result
    if (const auto checkpoint = CheckpointStore::open(file.id()).read()) {
      last.turns = checkpoint->state.turns;
    }
  }
  for (const std::string& name : hdf5::names_in(file.id(), "rods")) {
    const std::string rod = "rods/" + name;
    last.rods.push_back(
        {name, hdf5::read_vector<Index>(hdf5::open_dataset(file.id(), rod + "/nodes").id()),
         hdf5::read_vector<double>(hdf5::open_dataset(file.id(), rod + "/arc_length").id())});
  }
  return last;
}

}  // namespace der
