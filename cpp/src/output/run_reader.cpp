#include <algorithm>
#include <optional>
#include <utility>

#include "der/catalog/run_status.hpp"
#include "der/output/io_error.hpp"
#include "der/output/saved_run.hpp"
#include "output/checkpoint_store.hpp"
#include "output/frame_columns.hpp"
#include "output/run_format.hpp"

namespace der {
namespace {

using hdf5::Handle;

/// Opens a run file of this version to read it.
Handle open_run_file(const std::filesystem::path& path) {
  Handle file = hdf5::open_to_read(path);
  check_format(file.id(), path);
  return file;
}

/// The values of nodes, then those of edges.
Vector joined(const std::vector<double>& nodes, const std::vector<double>& edges) {
  Vector all(static_cast<Index>(nodes.size() + edges.size()));
  std::copy(edges.begin(), edges.end(), std::copy(nodes.begin(), nodes.end(), all.begin()));
  return all;
}

/// Throws IoError if the rods have nodes that the frames do not, or another number of edges than
/// there are sections.
void check_rods(const std::vector<SavedRod>& rods, const FrameLayout& layout) {
  hsize_t edges = 0;
  for (const SavedRod& rod : rods) {
    edges += rod.closed ? rod.nodes.size() : rod.nodes.size() - 1;
    for (const Index node : rod.nodes) {
      if (node < 0 || static_cast<hsize_t>(node) >= layout.nodes) {
        throw IoError("rod '" + rod.name + "' has a node " + std::to_string(node) + " of " +
                      std::to_string(layout.nodes));
      }
    }
  }
  if (layout.sections > 0 && layout.sections != edges) {
    throw IoError("'sections/theta' has " + std::to_string(layout.sections) +
                  " edges and the rods have " + std::to_string(edges));
  }
}

std::vector<std::string> probe_units(hid_t file, const std::vector<std::string>& names) {
  const Handle group = hdf5::open_group(file, "probes");
  std::vector<std::string> units;
  for (const std::string& name : names) {
    units.push_back(hdf5::read_text_attribute(hdf5::open_dataset(group.id(), name).id(), "unit"));
  }
  return units;
}

/// None where Python has saved a result, and before the first one is written.
std::optional<Checkpoint> read_checkpoint(hid_t file, const FrameColumns& columns) {
  if (!CheckpointStore::is_in(file)) return std::nullopt;
  return CheckpointStore::open(file, columns.layout().num_dofs(),
                               columns.layout().probe_names.size())
      .read();
}

RunFileHead read_head(hid_t file) {
  RunFileHead head;
  head.der_version = hdf5::read_text_attribute(file, "der_version");
  head.status = hdf5::read_text_attribute(file, "status");
  head.scene = read_text(file, "scene");
  if (const auto checkpoint = read_checkpoint(file, FrameColumns::open(file))) {
    head.has_checkpoint = true;
    head.step = checkpoint->state.step;
    head.time = checkpoint->state.time;
  }
  return head;
}

LastFrame last_frame_in(hid_t file) {
  const FrameColumns columns = FrameColumns::open(file);
  if (columns.size() == 0) throw IoError("it holds no frame");
  const FrameData frame = columns.read(columns.size() - 1, 1);
  LastFrame last;
  last.time = frame.times.back();
  last.model = hdf5::read_text_attribute(file, "model");
  last.positions = joined(frame.positions, frame.theta);
  last.velocities = joined(frame.velocities, frame.spin);
  last.rods = read_rods(file, columns.layout().nodes);
  last.scene = read_text(file, "scene");
  check_rods(last.rods, columns.layout());
  last.section_frames = joined(frame.section_frames, {});
  last.turns = joined(frame.turns, {});
  return last;
}

SavedRun read_run(hid_t file) {
  const FrameColumns columns = FrameColumns::open(file);
  const FrameLayout& layout = columns.layout();
  SavedRun run;
  run.status = hdf5::read_text_attribute(file, "status");
  run.scene = read_text(file, "scene");
  run.dimension = static_cast<Index>(layout.dimension);
  run.sections = static_cast<Index>(layout.sections);
  run.turns = static_cast<Index>(layout.turns);
  run.probe_names = layout.probe_names;
  run.probe_units = probe_units(file, layout.probe_names);
  run.frames = columns.read(0, columns.size());
  // A run that goes on or was killed may have them in part.
  if (run.status != run_status::kRunning) {
    run.data = read_datasets(file, layout.nodes, layout.dimension, columns.size());
  }
  check_rods(read_rods(file, layout.nodes), layout);
  return run;
}

}  // namespace

RunFileHead read_head(const std::filesystem::path& path) {
  const hdf5::Session session;
  const Handle file = open_run_file(path);
  return naming(path, [&] { return read_head(file.id()); });
}

LastFrame read_last_frame(const std::filesystem::path& path) {
  const hdf5::Session session;
  const Handle file = open_run_file(path);
  return naming(path, [&] { return last_frame_in(file.id()); });
}

SavedRun read_run(const std::filesystem::path& path) {
  const hdf5::Session session;
  const Handle file = open_run_file(path);
  return naming(path, [&] { return read_run(file.id()); });
}

}  // namespace der
