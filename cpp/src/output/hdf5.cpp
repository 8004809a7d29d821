#include "output/hdf5.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <system_error>

#include "der/output/io_error.hpp"

namespace der::hdf5 {
namespace {

std::recursive_mutex& library_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

/// Keeps the first entry of HDF5's error stack, the one nearest to the cause.
herr_t keep_cause(unsigned depth, const H5E_error2_t* entry, void* text) {
  if (depth == 0 && entry->desc != nullptr) *static_cast<std::string*>(text) = entry->desc;
  return 0;
}

/// What stands between `before` and the next quote; empty if it is not there.
std::string quoted_after(const std::string& text, const std::string& before) {
  const auto found = text.find(before);
  if (found == std::string::npos) return "";
  const auto start = found + before.size();
  return text.substr(start, text.find('\'', start) - start);
}

/// HDF5 reports a failed system call with buffer addresses and all; a person wants the file and the
/// reason.
std::string readable(const std::string& cause) {
  const std::string file = quoted_after(cause, "name = '");
  const std::string reason = quoted_after(cause, "error message = '");
  if (reason.empty()) return cause;
  return file.empty() ? reason : "'" + file + "': " + reason;
}

[[noreturn]] void throw_error(const std::string& action) {
  std::string cause;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_cause, &cause);
  throw IoError("cannot " + action + (cause.empty() ? "" : ": " + readable(cause)));
}

Handle property_list(hid_t kind) { return {H5Pcreate(kind), H5Pclose, "create a property list"}; }

Handle text_type(std::size_t size) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "create a text type");
  check(H5Tset_size(type.id(), size), "create a text type");
  check(H5Tset_cset(type.id(), H5T_CSET_UTF8), "create a text type");
  return type;
}

Handle scalar_space() { return {H5Screate(H5S_SCALAR), H5Sclose, "create a data space"}; }

Handle simple_space(const std::vector<hsize_t>& dimensions, const hsize_t* maximum) {
  return {H5Screate_simple(static_cast<int>(dimensions.size()), dimensions.data(), maximum),
          H5Sclose, "create a data space"};
}

Handle writable_attribute(hid_t object, const std::string& name, hid_t type) {
  const std::string action = "write attribute '" + name + "'";
  if (has_attribute(object, name)) {
    return {H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, action};
  }
  return {H5Acreate2(object, name.c_str(), type, scalar_space().id(), H5P_DEFAULT, H5P_DEFAULT),
          H5Aclose, action};
}

template <class T>
void write_number(hid_t object, const std::string& name, T value) {
  const Handle attribute = writable_attribute(object, name, native_type<T>());
  check(H5Awrite(attribute.id(), native_type<T>(), &value), "write attribute '" + name + "'");
}

Handle open_attribute(hid_t object, const std::string& name) {
  return {H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, "read attribute '" + name + "'"};
}

Handle uncached_access() {
  Handle access = property_list(H5P_DATASET_ACCESS);
  check(H5Pset_chunk_cache(access.id(), 0, 0, H5D_CHUNK_CACHE_W0_DEFAULT), "set the chunk cache");
  return access;
}

}  // namespace

Session::Session() : lock_(library_mutex()) {
  // HDF5's own handler at the end of a process crashes when a file could not be closed, as on a
  // full disk. It is not needed: every handle is closed by its owner.
  [[maybe_unused]] static const herr_t without_exit_handler = H5dont_atexit();
  H5Eget_auto2(H5E_DEFAULT, &print_, &print_data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Session::~Session() { H5Eset_auto2(H5E_DEFAULT, print_, print_data_); }

Handle::Handle(hid_t id, Close close, const std::string& action) : id_(id), close_(close) {
  if (id < 0) throw_error(action);
}

Handle& Handle::operator=(Handle&& other) noexcept {
  if (this != &other) {
    reset();
    id_ = std::exchange(other.id_, H5I_INVALID_HID);
    close_ = other.close_;
  }
  return *this;
}

void Handle::reset() noexcept {
  if (id_ >= 0) close_(id_);
  id_ = H5I_INVALID_HID;
}

void check(herr_t result, const std::string& action) {
  if (result < 0) throw_error(action);
}

Handle create_file(const std::filesystem::path& path) {
  return {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose,
          "create '" + path.string() + "'"};
}

Handle open_file(const std::filesystem::path& path, unsigned flags) {
  return {H5Fopen(path.c_str(), flags, H5P_DEFAULT), H5Fclose, "open '" + path.string() + "'"};
}

Handle create_group(hid_t parent, const std::string& name) {
  return {H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
          "create group '" + name + "'"};
}

void flush(hid_t file, const std::filesystem::path& path) {
  const std::string action = "write '" + path.string() + "'";
  // HDF5 writes its directory first and then lengthens the file; a process killed in between would
  // leave a file that is shorter than its directory says, which does not open.
  hsize_t size = 0;
  check(H5Fget_filesize(file, &size), action);
  std::error_code error;
  if (std::filesystem::file_size(path, error) < size) {
    std::filesystem::resize_file(path, size, error);
  }
  if (error) throw IoError("cannot " + action + ": " + error.message());
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), action);
}

void abandon(hid_t file) noexcept {
  void* handle = nullptr;
  if (H5Fget_vfd_handle(file, H5P_DEFAULT, &handle) < 0) return;
  const int memory = ::memfd_create("der-abandoned", MFD_CLOEXEC);
  if (memory < 0) return;
  ::dup2(memory, *static_cast<int*>(handle));
  ::close(memory);
}

bool exists(hid_t parent, const std::string& name) {
  return H5Lexists(parent, name.c_str(), H5P_DEFAULT) > 0;
}

std::vector<std::string> names_in(hid_t parent, const std::string& group) {
  const Handle opened(H5Gopen2(parent, group.c_str(), H5P_DEFAULT), H5Gclose,
                      "open '" + group + "'");
  H5G_info_t info;
  check(H5Gget_info(opened.id(), &info), "list '" + group + "'");
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const auto read = [&](char* text, std::size_t size) {
      return H5Lget_name_by_idx(opened.id(), ".", H5_INDEX_NAME, H5_ITER_INC, i, text, size,
                                H5P_DEFAULT);
    };
    std::string name(static_cast<std::size_t>(std::max<ssize_t>(0, read(nullptr, 0))), '\0');
    if (read(name.data(), name.size() + 1) < 0) check(-1, "list '" + group + "'");
    names.push_back(std::move(name));
  }
  return names;
}

bool has_attribute(hid_t object, const std::string& name) {
  return H5Aexists(object, name.c_str()) > 0;
}

void write_attribute(hid_t object, const std::string& name, const std::string& value) {
  const Handle type = text_type(H5T_VARIABLE);
  const Handle attribute = writable_attribute(object, name, type.id());
  const char* text = value.c_str();
  check(H5Awrite(attribute.id(), type.id(), static_cast<const void*>(&text)),
        "write attribute '" + name + "'");
}

void write_attribute(hid_t object, const std::string& name, double value) {
  write_number(object, name, value);
}

void write_attribute(hid_t object, const std::string& name, std::int64_t value) {
  write_number(object, name, value);
}

std::string read_string_attribute(hid_t object, const std::string& name) {
  const Handle attribute = open_attribute(object, name);
  char* text = nullptr;
  check(H5Aread(attribute.id(), text_type(H5T_VARIABLE).id(), static_cast<void*>(&text)),
        "read attribute '" + name + "'");
  std::string result = text == nullptr ? "" : text;
  if (text != nullptr) H5free_memory(text);  // HDF5 has allocated it
  return result;
}

std::int64_t read_integer_attribute(hid_t object, const std::string& name) {
  const Handle attribute = open_attribute(object, name);
  std::int64_t value = 0;
  check(H5Aread(attribute.id(), H5T_NATIVE_INT64, &value), "read attribute '" + name + "'");
  return value;
}

void write_text(hid_t parent, const std::string& name, const std::string& text) {
  const Handle type = text_type(text.size() + 1);
  const Handle dataset = create_fixed(parent, name, type.id(), {});
  check(H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()),
        "write dataset '" + name + "'");
}

std::string read_text(hid_t parent, const std::string& name) {
  const Handle dataset = open_dataset(parent, name);
  const Handle type(H5Dget_type(dataset.id()), H5Tclose, "read dataset '" + name + "'");
  std::string text(H5Tget_size(type.id()), '\0');
  check(H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()),
        "read dataset '" + name + "'");
  return text.substr(0, text.find('\0'));
}

Handle create_fixed(hid_t parent, const std::string& name, hid_t type,
                    const std::vector<hsize_t>& dimensions) {
  const Handle space = dimensions.empty() ? scalar_space() : simple_space(dimensions, nullptr);
  const Handle creation = property_list(H5P_DATASET_CREATE);
  check(H5Pset_alloc_time(creation.id(), H5D_ALLOC_TIME_EARLY), "lay out '" + name + "'");
  return {
      H5Dcreate2(parent, name.c_str(), type, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT),
      H5Dclose, "create dataset '" + name + "'"};
}

Handle open_dataset(hid_t parent, const std::string& name) {
  return {H5Dopen2(parent, name.c_str(), uncached_access().id()), H5Dclose,
          "open dataset '" + name + "'"};
}

std::vector<hsize_t> dimensions_of(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), H5Sclose, "read the size of a dataset");
  std::vector<hsize_t> dimensions(
      static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space.id()))));
  H5Sget_simple_extent_dims(space.id(), dimensions.data(), nullptr);
  return dimensions;
}

hsize_t length_of(hid_t dataset) {
  const auto dimensions = dimensions_of(dataset);
  return std::accumulate(dimensions.begin(), dimensions.end(), hsize_t{1},
                         std::multiplies<hsize_t>());
}

std::vector<double> read_row(hid_t dataset, hsize_t row) {
  std::vector<hsize_t> block = dimensions_of(dataset);
  std::vector<hsize_t> start(block.size(), 0);
  start.front() = row;
  block.front() = 1;
  const Handle file_space(H5Dget_space(dataset), H5Sclose, "read a row");
  check(H5Sselect_hyperslab(file_space.id(), H5S_SELECT_SET, start.data(), nullptr, block.data(),
                            nullptr),
        "read a row");
  const Handle memory_space = simple_space(block, nullptr);
  std::vector<double> values(
      std::accumulate(block.begin(), block.end(), hsize_t{1}, std::multiplies<hsize_t>()));
  check(H5Dread(dataset, H5T_NATIVE_DOUBLE, memory_space.id(), file_space.id(), H5P_DEFAULT,
                values.data()),
        "read a row");
  return values;
}

Column Column::create(hid_t parent, const std::string& name, hid_t type,
                      const std::vector<hsize_t>& row, hsize_t chunk_rows) {
  std::vector<hsize_t> dimensions{0};
  dimensions.insert(dimensions.end(), row.begin(), row.end());
  std::vector<hsize_t> maximum = dimensions;
  maximum.front() = H5S_UNLIMITED;
  std::vector<hsize_t> chunk = dimensions;
  chunk.front() = chunk_rows;

  const std::string action = "create dataset '" + name + "'";
  const Handle space = simple_space(dimensions, maximum.data());
  const Handle creation = property_list(H5P_DATASET_CREATE);
  check(H5Pset_chunk(creation.id(), static_cast<int>(chunk.size()), chunk.data()), action);
  check(H5Pset_fill_time(creation.id(), H5D_FILL_TIME_NEVER), action);
  Handle dataset(H5Dcreate2(parent, name.c_str(), type, space.id(), H5P_DEFAULT, creation.id(),
                            uncached_access().id()),
                 H5Dclose, action);
  return {std::move(dataset), std::move(dimensions)};
}

Column Column::open(hid_t parent, const std::string& name) {
  Handle dataset = open_dataset(parent, name);
  std::vector<hsize_t> dimensions = dimensions_of(dataset.id());
  return {std::move(dataset), std::move(dimensions)};
}

void Column::resize(hsize_t count) {
  if (count == rows()) return;
  dimensions_.front() = count;
  check(H5Dset_extent(dataset_.id(), dimensions_.data()), "resize a dataset");
}

void Column::append_raw(hid_t type, const void* data, hsize_t count) {
  if (count == 0) return;
  std::vector<hsize_t> start(dimensions_.size(), 0);
  start.front() = rows();
  std::vector<hsize_t> block = dimensions_;
  block.front() = count;
  resize(rows() + count);
  const Handle file_space(H5Dget_space(dataset_.id()), H5Sclose, "append to a dataset");
  check(H5Sselect_hyperslab(file_space.id(), H5S_SELECT_SET, start.data(), nullptr, block.data(),
                            nullptr),
        "append to a dataset");
  const Handle memory_space = simple_space(block, nullptr);
  check(H5Dwrite(dataset_.id(), type, memory_space.id(), file_space.id(), H5P_DEFAULT, data),
        "append to a dataset");
}

}  // namespace der::hdf5
