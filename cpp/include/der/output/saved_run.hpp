#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/output/datasets.hpp"
#include "der/output/frame_data.hpp"
#include "der/scenario/reader.hpp"

namespace der {

/// Reading of run files (layout: docs/results.md). All functions check type, extent and checksum of
/// the data that they read, and throw IoError, which names the file and the error.

/// The head of a run file.
struct RunFileHead {
  std::string der_version;
  std::string status;     ///< "running" while it is written, and after a kill
  std::string scene;      ///< YAML text of the scene as run
  std::int64_t step = 0;  ///< of the checkpoint; 0 without one
  double time = 0.0;      ///< [s] of the checkpoint
  bool has_checkpoint = false;
};
RunFileHead read_head(const std::filesystem::path& path);

/// A rod of a run file.
struct SavedRod {
  std::string name;
  std::vector<Index> nodes;
  std::vector<double> arc_length;  ///< rest arc length of each node [m]
  bool closed = false;
};

/// The last complete frame of a run file, with its scene and rods.
struct LastFrame {
  std::string model;  ///< name of the model that it is a state of
  double time = 0.0;  ///< [s]
  /// One entry a degree of freedom, as in the state: components of the nodes' positions [m], then
  /// angles of the edges [rad] if there are sections.
  Vector positions;
  Vector velocities;  ///< [m/s] and [rad/s]
  std::vector<SavedRod> rods;
  std::string scene;  ///< YAML text of the scene as run
  Vector turns;       ///< of the edges that this scene's model follows [rad]
  Vector
      section_frames;  ///< blocks of the edges that `positions` count from; none without sections
};
LastFrame read_last_frame(const std::filesystem::path& path);

/// All that a run has recorded.
struct SavedRun {
  std::string status;
  std::string scene;  ///< YAML text of the scene as run
  Index dimension = 0;
  Index sections = 0;  ///< edges that have a section
  Index turns = 0;     ///< edges whose whole turns are followed
  std::vector<std::string> probe_names;
  std::vector<std::string> probe_units;
  FrameData frames;
  std::vector<Dataset> data;  ///< of an analysis
};
/// Reads every whole frame; the run may still go on. The probes are in alphabetical order.
SavedRun read_run(const std::filesystem::path& path);
/// Writes a run file without checkpoints, which cannot be resumed. `run.scene` is ignored.
void write_run(const std::filesystem::path& path, const Scenario& scenario, const Model& model,
               const SavedRun& run);

/// True if the file is the run file of any version of der.
bool is_run_file(const std::filesystem::path& path);
/// The scene of a run file of any version; empty if there is none to be read.
std::string read_scene(const std::filesystem::path& path);

}  // namespace der
