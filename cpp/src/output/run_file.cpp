#include "der/output/run_file.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <utility>
#include <vector>

#include "der/catalog/run_status.hpp"
#include "der/model/followed.hpp"
#include "der/output/flush_timer.hpp"
#include "der/output/io_error.hpp"
#include "der/output/recorder.hpp"
#include "der/output/result_size.hpp"
#include "der/output/saved_run.hpp"
#include "output/checkpoint_store.hpp"
#include "output/frame_columns.hpp"
#include "output/run_format.hpp"

namespace der {
namespace {

using hdf5::Handle;
using Seconds = std::chrono::duration<double>;

constexpr Seconds kFlushInterval{0.05};
/// Flushing may take this share of a run's time on a slow disk.
constexpr double kFlushShare = 0.05;
/// A checkpoint is written this often even when no frame is due.
constexpr Seconds kCheckpointInterval{10.0};
/// Frames are written out early when they take this much memory.
constexpr std::size_t kLargestBatch = std::size_t{8} << 20;  // [bytes]
/// Frames that chunks are laid out for at most.
constexpr double kMostFrames = 1e15;

FrameLayout layout_of(const Model& model) {
  return {static_cast<hsize_t>(model.num_nodes),
          static_cast<hsize_t>(model.dimension),
          model.has_sections() ? static_cast<hsize_t>(model.framed_edges.size()) : 0,
          static_cast<hsize_t>(num_saved_turns(model)),
          {},
          {},
          static_cast<hsize_t>(model.dofs.num_rotations())};
}

FrameLayout layout_of(const Simulation& simulation, const Recorder& recorder) {
  FrameLayout layout = layout_of(simulation.model());
  for (const Probe& probe : recorder.probes()) {
    layout.probe_names.push_back(probe.name());
    layout.probe_units.push_back(probe.unit());
  }
  return layout;
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
  /// Whether the frames that have gathered are too many to keep in memory.
  [[nodiscard]] bool full() const {
    return frames_.waiting() * frames_.bytes_per_frame() >= kLargestBatch;
  }
  [[nodiscard]] bool due();
  void commit(const Simulation& simulation, const Recorder& recorder);
  /// To be called after an error of any of the others: leaves the file as it was flushed last.
  void abandon() {
    hdf5::abandon(file_.id());
    abandoned_ = true;
  }
  [[nodiscard]] bool abandoned() const { return abandoned_; }
  void add(const std::vector<Dataset>& datasets) { write_datasets(file_.id(), datasets); }
  void set_status(const std::string& status);
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Throws IoError if the path names another file by now.
  void check_place() const;
  /// Writes the frames that have gathered: all but /time first, so that the length of /time counts
  /// the frames that are whole.
  void commit_frames();

 private:
  explicit Writer(const std::filesystem::path& path) : path_(std::filesystem::absolute(path)) {}
  void go_on(Simulation& simulation, Recorder& recorder);
  void truncate(hsize_t frames);
  [[nodiscard]] hsize_t frames_up_to(double time, const StepPlan& plan) const;
  void flush() { hdf5::flush(file_.id()); }

  std::filesystem::path path_;
  Handle file_;
  FrameColumns frames_;
  CheckpointStore checkpoints_;
  bool abandoned_ = false;
  bool ahead_of_checkpoint_ = false;  // frames, written or not, that are later than it
  FlushTimer pacer_{kFlushInterval};
  std::chrono::steady_clock::time_point last_checkpoint_;
};

std::unique_ptr<RunFile::Writer> RunFile::Writer::create(const std::filesystem::path& path,
                                                         const Simulation& simulation,
                                                         const Recorder& recorder) {
  std::unique_ptr<Writer> writer(new Writer(path));
  writer->file_ = create_run_file(writer->path_, [&](hid_t file) {
    write_head(file, simulation.scenario(), simulation.model());
    // An interrupted run ends with a frame off the beat.
    const double frames = std::min(kMostFrames, 1.0 + expected_frames(simulation));
    writer->frames_ =
        FrameColumns::create(file, layout_of(simulation, recorder), static_cast<hsize_t>(frames));
    writer->checkpoints_ = CheckpointStore::create(file, writer->frames_.layout().num_dofs(),
                                                   recorder.probes().size());
  });
  return writer;
}

std::unique_ptr<RunFile::Writer> RunFile::Writer::resume(const std::filesystem::path& path,
                                                         Simulation& simulation,
                                                         Recorder& recorder) {
  std::unique_ptr<Writer> writer(new Writer(path));
  writer->file_ = hdf5::open_to_write(path);
  check_format(writer->file_.id(), path);
  naming(path, [&] { writer->go_on(simulation, recorder); });
  return writer;
}

void RunFile::Writer::go_on(Simulation& simulation, Recorder& recorder) {
  frames_ = FrameColumns::open(file_.id(), layout_of(simulation, recorder));
  checkpoints_ =
      CheckpointStore::open(file_.id(), frames_.layout().num_dofs(), recorder.probes().size());
  const auto checkpoint = checkpoints_.read();
  if (!checkpoint) throw IoError("it holds no checkpoint to resume from");
  truncate(frames_up_to(checkpoint->state.time, simulation.plan()));
  set_status(run_status::kRunning);
  recorder.restore(*checkpoint, simulation);
}

/// Frames that an uninterrupted run would have saved up to `time`: an interrupted one ends with one
/// more, off the beat.
hsize_t RunFile::Writer::frames_up_to(double time, const StepPlan& plan) const {
  const std::vector<double> times = frames_.times();
  hsize_t count = 0;
  for (const double saved : times) {
    if (saved <= time && plan.is_frame(saved)) ++count;
  }
  return count;
}

void RunFile::Writer::truncate(hsize_t frames) {
  frames_.resize_times(frames);
  flush();
  frames_.resize_data(frames);
  flush();
}

void RunFile::Writer::add(const Frame& frame) {
  const auto works = ledger(frame.work, frame.energies);
  frames_.push({frame.time, frame.step, frame.positions.data(), frame.velocities.data(),
                frame.theta.data(), frame.spin.data(), frame.section_frames.data(),
                frame.turns.data(), frame.energies.values().data(), works.data(),
                frame.probes.data()});
  ahead_of_checkpoint_ = true;
}

bool RunFile::Writer::due() {
  if (!pacer_.due()) return false;
  return ahead_of_checkpoint_ ||
         std::chrono::steady_clock::now() - last_checkpoint_ >= kCheckpointInterval;
}

void RunFile::Writer::commit(const Simulation& simulation, const Recorder& recorder) {
  const auto start = std::chrono::steady_clock::now();
  checkpoints_.write(recorder.checkpoint(simulation));
  commit_frames();
  checkpoints_.publish();
  ahead_of_checkpoint_ = false;
  flush();
  last_checkpoint_ = std::chrono::steady_clock::now();
  const Seconds cost = last_checkpoint_ - start;
  pacer_.set_interval(std::max(kFlushInterval, cost / kFlushShare));
}

void RunFile::Writer::commit_frames() {
  frames_.write_data();
  flush();
  frames_.write_times();
  flush();
}

void RunFile::Writer::set_status(const std::string& status) {
  write_status(file_.id(), status);
  flush();
}

void RunFile::Writer::check_place() const {
  if (hdf5::is_named(file_.id(), path_)) return;
  throw IoError("'" + path_.string() +
                "' was removed or replaced while the run was writing it: its results are lost. Run "
                "again into a folder that no other program uses");
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
    writing(writer_->path(), operation);
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

void RunFile::write(const Frame& frame) {
  writer_->add(frame);
  // Without a checkpoint: an adaptive step hands over its frames when it is at its end already.
  if (writer_->full()) guarded([&] { writer_->commit_frames(); });
}

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
  const hdf5::Session session;
  writer_->check_place();
}

void write_run(const std::filesystem::path& path, const Scenario& scenario, const Model& model,
               const SavedRun& run) {
  const hdf5::Session session;
  create_run_file(path, [&](hid_t file) {
    write_head(file, scenario, model);
    FrameLayout layout = layout_of(model);
    layout.probe_names = run.probe_names;
    layout.probe_units = run.probe_units;
    const std::size_t frames = run.frames.num_frames();
    FrameColumns columns =
        FrameColumns::create(file, layout, std::max<hsize_t>(1, static_cast<hsize_t>(frames)));
    for (std::size_t i = 0; i < frames; ++i) {
      columns.push(row_of(run.frames, i, columns.layout()));
    }
    columns.write_data();
    columns.write_times();
    write_datasets(file, run.data);
    write_status(file, run.status);
  });
}

}  // namespace der
