#include "output/run_format.hpp"
#include "der/scenario/scenario.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "der/catalog/run_status.hpp"
#include "der/output/run_arrays.hpp"
#include "der/version.hpp"

namespace der {
namespace {

/// Rods that can meet at a node, on average.
constexpr hsize_t kMostShared = 64;

using hdf5::Handle;

/// Room for any status, so that the last one is written over the first.
constexpr std::size_t kStatusLength = 32;

/// The array of a group of modes that has a vector for each node, not one value for each mode.
constexpr const char* kShapes = "shapes";
/// The array of a path that was tested against motion out of its plane.
constexpr const char* kOutOfPlane = "unstable_out_of_plane";

template <class T>
void write_rod_array(hid_t group, const std::string& name, const std::vector<T>& values) {
  write_array(group, name, Array<T>{{values.size()}, values}, unit_of_array("rods/" + name));
}

void write_rod(hid_t rods, const RodMesh& rod) {
  const Handle group = hdf5::create_group(rods, rod.name);
  write_rod_array(group.id(), "nodes", rod.nodes);
  write_rod_array(group.id(), "arc_length", rod.arc_length);
  write_rod_array(group.id(), "rest_turning_angle", rod.rest_turning_angle);
  write_rod_array(group.id(), "sphere_radius", rod.sphere_radius);
  const bool is_angle = rod.curvature == scenario::CurvatureMeasure::Angle;
  hdf5::write_attribute(group.id(), "curvature", std::string(is_angle ? "angle" : "tangent"));
  hdf5::write_attribute(group.id(), "radius", rod.draw_radius);
  if (rod.closed) hdf5::write_attribute(group.id(), "closed", std::int64_t{1});
  hdf5::write_attribute(group.id(), "EA", rod.EA);
  hdf5::write_attribute(group.id(), "EI", rod.EI);
}

SavedRod read_rod(hid_t rods, const std::string& name) {
  const Handle group = hdf5::open_group(rods, name);
  SavedRod rod{name, read_array<Index>(group.id(), "nodes").values,
               read_array<double>(group.id(), "arc_length").values,
               hdf5::has_attribute(group.id(), "closed")};
  if (rod.nodes.empty() || rod.nodes.size() != rod.arc_length.size()) {
    throw IoError("rod '" + name + "' has other numbers of nodes and of arc lengths");
  }
  return rod;
}

std::string unit_of(hid_t group, const std::string& name) {
  return hdf5::read_text_attribute(hdf5::open_dataset(group, name).id(), "unit");
}

Dataset read_dataset(hid_t group, const std::string& group_name, const std::string& name,
                     const std::vector<hsize_t>& dimensions) {
  Array<double> array = read_array<double>(group, name);
  if (array.dimensions != dimensions) {
    throw IoError("'" + group_name + "/" + name + "' has another shape than it should have");
  }
  return {group_name + "/" + name,
          unit_of(group, name),
          {dimensions.begin(), dimensions.end()},
          std::move(array.values)};
}

/// Throws IoError unless all values are whole numbers from 0 to `largest`.
void check_whole(const Dataset& dataset, double largest) {
  for (const double value : dataset.values) {
    const bool in_range = value >= 0.0 && value <= largest;
    if (!in_range || value != std::floor(value)) {
      throw IoError("'" + dataset.name + "' holds a value that is not a whole number in its range");
    }
  }
}

void check_path(const std::vector<Dataset>& datasets) {
  for (const Dataset& dataset : datasets) {
    if (dataset.name == "path/event") {
      check_whole(dataset, static_cast<double>(PathEvent::OutOfPlane));
    }
    if (dataset.name == "path/branch" || dataset.name == "path/unstable_directions" ||
        dataset.name == "path/unstable_out_of_plane") {
      check_whole(dataset, std::numeric_limits<Index>::max());
    }
  }
}

/// The format's number, or 0 if it is not a run file.
std::int64_t format_of(hid_t file) {
  if (!hdf5::has_attribute(file, "format_version")) return 0;
  return hdf5::read_integer_attribute(file, "format_version");
}

}  // namespace

void write_head(hid_t file, const Scenario& scenario, const Model& model) {
  const scenario::Scene& scene = scenario.scene();
  hdf5::write_attribute(file, "format_version", kFormatVersion);
  hdf5::write_attribute(file, "der_version", std::string(version));
  write_status(file, run_status::kRunning);
  hdf5::write_attribute(file, "title", scene.title);
  hdf5::write_attribute(file, "analysis", std::string(scene.analysis_name()));
  hdf5::write_attribute(file, "model", model.name);
  hdf5::write_attribute(file, "dimension", std::int64_t{model.dimension});
  hdf5::write_attribute(file, "rotations", std::int64_t{model.dofs.num_rotations()});
  write_text(file, "scene", scenario.to_yaml());
  const Handle rods = hdf5::create_group(file, "rods");
  for (const RodMesh& rod : model.rods) write_rod(rods.id(), rod);
}

void write_status(hid_t file, const std::string& status) {
  hdf5::write_attribute_of_length(file, "status", status, kStatusLength);
}

std::vector<SavedRod> read_rods(hid_t file, hsize_t nodes) {
  const Handle group = hdf5::open_group(file, "rods");
  std::vector<SavedRod> rods;
  std::set<std::vector<Index>> node_lists;
  hsize_t found = 0;
  for (const std::string& name : hdf5::names_in(group.id())) {
    rods.push_back(read_rod(group.id(), name));
    found += rods.back().nodes.size();
    if (found > kMostShared * nodes) break;  // one rod under many names would fill the memory
    // Rods that meet share nodes, but only bars of one edge share them all.
    if (rods.back().nodes.size() > 2 && !node_lists.insert(rods.back().nodes).second) {
      throw IoError("its rod '" + name + "' has the nodes of another one");
    }
  }
  if (found < nodes || found > kMostShared * nodes) {
    throw IoError("its rods have " + std::to_string(found) + " nodes" +
                  (found > nodes ? " or more" : "") + ", and its frames " + std::to_string(nodes));
  }
  return rods;
}

void write_datasets(hid_t file, const std::vector<Dataset>& datasets) {
  for (const Dataset& dataset : datasets) {
    const auto slash = dataset.name.find('/');
    const std::string name = dataset.name.substr(0, slash);
    const Handle group =
        hdf5::exists(file, name) ? hdf5::open_group(file, name) : hdf5::create_group(file, name);
    write_array(group.id(), dataset.name.substr(slash + 1),
                Array<double>{{dataset.shape.begin(), dataset.shape.end()}, dataset.values},
                dataset.unit);
  }
}

std::vector<Dataset> read_datasets(hid_t file, hsize_t nodes, hsize_t dimension, hsize_t frames) {
  std::vector<Dataset> datasets;
  for (const char* kind : {"modes", "buckling", "path"}) {
    if (!hdf5::exists(file, kind)) continue;
    const Handle group = hdf5::open_group(file, kind);
    const std::vector<std::string> names = names_in_group(kind);
    const bool has_shapes = std::find(names.begin(), names.end(), kShapes) != names.end();
    const hsize_t items =
        has_shapes ? read_array<double>(group.id(), names.front()).values.size() : frames;
    for (const std::string& name : names) {
      if (name == kOutOfPlane && !hdf5::exists(group.id(), name)) continue;
      const std::vector<hsize_t> shape =
          name == kShapes ? std::vector<hsize_t>{items, nodes, dimension} : std::vector{items};
      datasets.push_back(read_dataset(group.id(), kind, name, shape));
    }
  }
  check_path(datasets);
  return datasets;
}

void check_format(hid_t file, const std::filesystem::path& path) {
  const std::int64_t format = naming(path, [&] { return format_of(file); });
  if (format == kFormatVersion) return;
  const std::string what = "'" + path.string() + "' ";
  const std::string here = "; this is der " + std::string(version) + ", which reads format " +
                           std::to_string(kFormatVersion) + ": ";
  if (format <= 0) throw IoError(what + "is not a run file of der");
  if (format < kFormatVersion) {
    throw IoError(what + "was written by an older der, in format " + std::to_string(format) + here +
                  "run its scene again (scene.yaml beside it), or read it with the der that wrote "
                  "it");
  }
  throw IoError(what + "was written by a newer der, in format " + std::to_string(format) + here +
                "install a newer der to read it");
}

bool is_run_file(const std::filesystem::path& path) {
  const hdf5::Session session;
  try {
    return format_of(hdf5::open_to_read(path).id()) > 0;
  } catch (const IoError&) {
    return false;
  }
}

std::string read_scene(const std::filesystem::path& path) {
  const hdf5::Session session;
  try {
    return read_text_unchecked(hdf5::open_to_read(path).id(), "scene");
  } catch (const IoError&) {
    return {};
  }
}

}  // namespace der
