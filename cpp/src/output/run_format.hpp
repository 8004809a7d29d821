#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "der/model/model.hpp"
#include "der/output/io_error.hpp"
#include "der/output/saved_run.hpp"
#include "der/scenario/reader.hpp"
#include "output/fixed_data.hpp"
#include "output/hdf5.hpp"
#include "output/whole_file.hpp"

namespace der {

/// The parts of a run file besides frames and checkpoints (layout: docs/results.md).

/// Version of the layout; readers refuse what they do not know.
constexpr std::int64_t kFormatVersion = 6;

/// Attributes of the file, the scene, and the rods.
void write_head(hid_t file, const Scenario& scenario, const Model& model);
void write_status(hid_t file, const std::string& status);
/// Throws IoError unless they have that many nodes together.
std::vector<SavedRod> read_rods(hid_t file, hsize_t nodes);

/// Writes what an analysis found, in groups of their own.
void write_datasets(hid_t file, const std::vector<Dataset>& datasets);
/// Throws IoError where their shapes do not fit one another, the nodes or the frames.
std::vector<Dataset> read_datasets(hid_t file, hsize_t nodes, hsize_t dimension, hsize_t frames);

/// Throws IoError, which says what to do, if the file is of another format.
void check_format(hid_t file, const std::filesystem::path& path);

/// Does something with a file, and names it in the IoErrors of that.
template <class F>
auto naming(const std::filesystem::path& path, F&& read) {
  try {
    return read();
  } catch (const IoError& error) {
    throw IoError("'" + path.string() + "' cannot be used: " + error.what());
  }
}

/// Writes into a file, and names it in the IoErrors of that.
template <class F>
void writing(const std::filesystem::path& path, F&& write) {
  try {
    write();
  } catch (const IoError& error) {
    throw IoError("cannot write '" + path.string() + "': " + error.what());
  }
}

/// Creates a run file: `fill(file)` writes what it begins with. No other program sees it before
/// that is done, and a process killed meanwhile leaves none.
template <class F>
hdf5::Handle create_run_file(const std::filesystem::path& path, F&& fill) {
  const std::filesystem::path temporary = temporary_name(path);
  remove_file(temporary);
  hdf5::Handle file = hdf5::create_file(temporary);
  try {
    writing(path, [&] {
      fill(file.id());
      hdf5::flush(file.id());
    });
    publish(temporary, path);
  } catch (...) {
    hdf5::abandon(file.id());
    remove_file(temporary);
    throw;
  }
  return file;
}

}  // namespace der
