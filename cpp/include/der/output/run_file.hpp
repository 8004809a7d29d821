#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "der/output/checkpoint.hpp"
#include "der/output/datasets.hpp"
#include "der/output/frame.hpp"

namespace der {

/// The HDF5 file of a run (layout: docs/results.md), written while the run goes on. Frames gather
/// in memory and are written out together, at most about 50 ms after they came, in an order in
/// which a process killed at any moment leaves a readable file: data first, then the length of
/// /time, then the mark that names the valid checkpoint. Throws IoError.
class RunFile : public FrameSink {
 public:
  /// Starts a new file, replacing one that is there.
  static std::unique_ptr<RunFile> create(const std::filesystem::path& path,
                                         const Simulation& simulation, const Recorder& recorder);
  /// Opens the file of an interrupted run of the same scene to go on with it: frames behind the
  /// checkpoint are dropped, `recorder` and `simulation` are put back to it.
  static std::unique_ptr<RunFile> resume(const std::filesystem::path& path, Simulation& simulation,
                                         Recorder& recorder);
  /// Writes what has gathered; the status stays "running" unless `finish` was called.
  ~RunFile() override;

  void write(const Frame& frame) override;
  void stepped(const Simulation& simulation, const Recorder& recorder) override;
  /// Writes what an analysis found besides frames.
  void add(const std::vector<Dataset>& datasets);
  /// To be called at the end of the run: writes all out, with the final status.
  void finish(const std::string& status, const Simulation& simulation, const Recorder& recorder);

 private:
  class Writer;
  explicit RunFile(std::unique_ptr<Writer> writer);
  template <class F>
  void guarded(F&& operation);
  std::unique_ptr<Writer> writer_;
};

/// What the head of a run file says.
struct RunFileHead {
  std::string der_version;
  std::string status;     ///< "running" while it is written, and after a kill
  std::string scene;      ///< YAML text of the scene as run
  std::int64_t step = 0;  ///< of the checkpoint; -1: there is none
  double time = 0.0;      ///< [s] of the checkpoint
};
RunFileHead read_head(const std::filesystem::path& path);

/// A rod of a run file.
struct SavedRod {
  std::string name;
  std::vector<Index> nodes;
  std::vector<double> arc_length;  ///< rest arc length of each node [m]
};

/// The last whole frame of a run file, and whose it is.
struct LastFrame {
  Vector positions;   ///< [m]
  Vector velocities;  ///< [m/s]
  std::vector<SavedRod> rods;
  std::string scene;  ///< text of the scene
  Vector turns;       ///< as in the state, of that scene's model [rad]; none if not known
};
LastFrame read_last_frame(const std::filesystem::path& path);

}  // namespace der
