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

Vector to_vector(const std::vector<double>& values) {
  return Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
}

void check_nodes(const std::vector<SavedRod>& rods, hsize_t nodes) {
  for (const SavedRod& rod : rods) {
    for (const Index node : rod.nodes) {
      if (node < 0 || static_cast<hsize_t>(node) >= nodes) {
        throw IoError("rod '" + rod.name + "' has a node " + std::to_string(node) + " of " +
                      std::to_string(nodes));
      }
    }
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
  return CheckpointStore::open(file, columns.num_dofs(), columns.layout().probe_names.size())
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

LastFrame read_last_frame(hid_t file) {
  const FrameColumns columns = FrameColumns::open(file);
  if (columns.size() == 0) throw IoError("it holds no frame");
  const FrameData frame = columns.read(columns.size() - 1, 1);
  LastFrame last;
  last.positions = to_vector(frame.positions);
  last.velocities = to_vector(frame.velocities);
  last.rods = read_rods(file);
  last.scene = read_text(file, "scene");
  check_nodes(last.rods, columns.layout().nodes);
  if (const auto checkpoint = read_checkpoint(file, columns))
    last.followed = checkpoint->state.followed;
  return last;
}

SavedRun read_run(hid_t file) {
  const FrameColumns columns = FrameColumns::open(file);
  const FrameLayout& layout = columns.layout();
  SavedRun run;
  run.status = hdf5::read_text_attribute(file, "status");
  run.scene = read_text(file, "scene");
  run.dimension = static_cast<Index>(layout.dimension);
  run.probe_names = layout.probe_names;
  run.probe_units = probe_units(file, layout.probe_names);
  run.frames = columns.read(0, columns.size());
  // A run that goes on or was killed may have them in part.
  if (run.status != run_status::kRunning) {
    run.data = read_datasets(file, layout.nodes, layout.dimension, columns.size());
  }
  check_nodes(read_rods(file), layout.nodes);
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
  return naming(path, [&] { return read_last_frame(file.id()); });
}

SavedRun read_run(const std::filesystem::path& path) {
  const hdf5::Session session;
  const Handle file = open_run_file(path);
  return naming(path, [&] { return read_run(file.id()); });
}

}  // namespace der
