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
  /// Starts a new file, which takes the place of one that is there when its head is whole.
  static std::unique_ptr<RunFile> create(const std::filesystem::path& path,
                                         const Simulation& simulation, const Recorder& recorder);
  /// Opens the file of an interrupted run of the same scene to continue it: frames after the
  /// checkpoint are dropped, `recorder` and `simulation` are reset to it.
  static std::unique_ptr<RunFile> resume(const std::filesystem::path& path, Simulation& simulation,
                                         Recorder& recorder);
  /// Writes what has gathered; the status stays "running" unless `finish` was called.
  ~RunFile() override;

  void write(const Frame& frame) override;
  void stepped(const Simulation& simulation, const Recorder& recorder) override;
  /// Writes what an analysis found besides frames.
  void add(const std::vector<Dataset>& datasets);
  /// To be called at the end of the run: writes all out, with the final status. Throws IoError too
  /// where the path does not name this file any more, so that what was written is lost.
  void finish(const std::string& status, const Simulation& simulation, const Recorder& recorder);

 private:
  class Writer;
  explicit RunFile(std::unique_ptr<Writer> writer);
  template <class F>
  void guarded(F&& operation);
  std::unique_ptr<Writer> writer_;
};

}  // namespace der
