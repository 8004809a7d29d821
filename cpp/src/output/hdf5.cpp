#include "output/hdf5.hpp"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "der/output/io_error.hpp"

namespace der::hdf5 {
namespace {

/// Largest size of attributes that are read [bytes].
constexpr std::size_t kLongestText = std::size_t{1} << 16;

std::recursive_mutex& library_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

/// Keeps the first entry of HDF5's error stack, the one nearest to the cause.
herr_t keep_cause(unsigned depth, const H5E_error2_t* entry, void* text) {
  if (depth == 0 && entry->desc != nullptr) *static_cast<std::string*>(text) = entry->desc;
  return 0;
}

/// The text between `before` and the next quote; empty if `before` does not occur.
std::string quoted_after(const std::string& text, const std::string& before) {
  const auto found = text.find(before);
  if (found == std::string::npos) return "";
  const auto start = found + before.size();
  return text.substr(start, text.find('\'', start) - start);
}

/// HDF5 reports a failed system call with buffer addresses and all; a person wants the reason. The
/// file's name is not taken from there: it may have been renamed since.
std::string readable(const std::string& cause) {
  const std::string reason = quoted_after(cause, "error message = '");
  return reason.empty() ? cause : reason;
}

[[noreturn]] void throw_error(const std::string& action) {
  std::string cause;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_cause, &cause);
  throw IoError("cannot " + action + (cause.empty() ? "" : ": " + readable(cause)));
}

Handle property_list(hid_t kind) { return {H5Pcreate(kind), H5Pclose, "create a property list"}; }

Handle scalar_space() { return {H5Screate(H5S_SCALAR), H5Sclose, "create a data space"}; }

Handle simple_space(const std::vector<hsize_t>& dimensions, const hsize_t* maximum) {
  return {H5Screate_simple(static_cast<int>(dimensions.size()), dimensions.data(), maximum),
          H5Sclose, "create a data space"};
}

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw IoError("'" + name + "' " + what);
}

std::string in_words(const std::vector<hsize_t>& dimensions) {
  if (dimensions.empty()) return "one value";
  std::string text;
  for (const hsize_t length : dimensions) {
    text += (text.empty() ? "" : " x ") + std::to_string(length);
  }
  return text;
}

/// A new attribute of one value, or the one that is there.
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

/// An attribute of one value.
Handle open_attribute(hid_t object, const std::string& name) {
  Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose,
                   "read attribute '" + name + "'");
  const Handle space(H5Aget_space(attribute.id()), H5Sclose, "read attribute '" + name + "'");
  if (H5Sget_simple_extent_type(space.id()) != H5S_SCALAR) {
    refuse(name, "should be an attribute of one value");
  }
  return attribute;
}

template <class T>
T read_number(hid_t object, const std::string& name) {
  const Handle attribute = open_attribute(object, name);
  const Handle type(H5Aget_type(attribute.id()), H5Tclose, "read attribute '" + name + "'");
  if (H5Tequal(type.id(), native_type<T>()) <= 0) refuse(name, "is an attribute of another type");
  T value{};
  check(H5Aread(attribute.id(), native_type<T>(), &value), "read attribute '" + name + "'");
  return value;
}

Handle uncached_access() {
  Handle access = property_list(H5P_DATASET_ACCESS);
  check(H5Pset_chunk_cache(access.id(), 0, 0, H5D_CHUNK_CACHE_W0_DEFAULT), "set the chunk cache");
  return access;
}

/// Modification times are left out: they would be written with every frame.
Handle plain_creation() {
  Handle creation = property_list(H5P_DATASET_CREATE);
  check(H5Pset_obj_track_times(creation.id(), false), "create a dataset");
  return creation;
}

/// True if the data are in this file as they are, not in another one nor behind a filter.
bool is_plain(hid_t dataset) {
  const Handle creation(H5Dget_create_plist(dataset), H5Pclose, "read how data are stored");
  const H5D_layout_t layout = H5Pget_layout(creation.id());
  return (layout == H5D_CONTIGUOUS || layout == H5D_CHUNKED) &&
         H5Pget_nfilters(creation.id()) == 0 && H5Pget_external_count(creation.id()) == 0;
}

/// A link to another file is not accepted.
void check_link(hid_t parent, const std::string& name) {
  H5L_info_t info;
  check(H5Lget_info(parent, name.c_str(), &info, H5P_DEFAULT), "find '" + name + "'");
  if (info.type != H5L_TYPE_HARD) refuse(name, "is a link");
}

hsize_t file_size(hid_t object) {
  const Handle file(H5Iget_file_id(object), H5Fclose, "read the size of a file");
  hsize_t size = 0;
  check(H5Fget_filesize(file.id(), &size), "read the size of a file");
  return size;
}

hsize_t bytes_of_a_value(hid_t dataset) {
  const Handle type(H5Dget_type(dataset), H5Tclose, "read a type");
  return H5Tget_size(type.id());
}

/// Rows [first, first + count) of a dataset in its file.
struct RowSelection {
  Handle in_file, in_memory;
};
RowSelection select_rows(hid_t dataset, hsize_t first, hsize_t count) {
  std::vector<hsize_t> block = dimensions_of(dataset);
  std::vector<hsize_t> start(block.size(), 0);
  start.front() = first;
  block.front() = count;
  Handle in_file(H5Dget_space(dataset), H5Sclose, "select rows");
  check(H5Sselect_hyperslab(in_file.id(), H5S_SELECT_SET, start.data(), nullptr, block.data(),
                            nullptr),
        "select rows");
  return {std::move(in_file), simple_space(block, nullptr)};
}

/// Descriptor of an open file in the operating system.
int descriptor(hid_t file) {
  void* handle = nullptr;
  check(H5Fget_vfd_handle(file, H5P_DEFAULT, &handle), "find an open file");
  return *static_cast<int*>(handle);
}

Handle open_any_file(const std::filesystem::path& path, unsigned flags, hid_t access) {
  return {H5Fopen(path.c_str(), flags, access), H5Fclose, "open '" + path.string() + "'"};
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
  const Handle access = property_list(H5P_FILE_ACCESS);
  check(H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18), "choose a file format");
  return {H5Fcreate(path.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, access.id()), H5Fclose,
          "create '" + path.string() + "'"};
}

Handle open_to_read(const std::filesystem::path& path) {
  const Handle access = property_list(H5P_FILE_ACCESS);
#if H5_VERSION_GE(1, 10, 7)
  // A run that goes on can be read: what it has flushed is whole.
  check(H5Pset_file_locking(access.id(), false, true), "open a file without a lock");
#endif
  return open_any_file(path, H5F_ACC_RDONLY, access.id());
}

Handle open_to_write(const std::filesystem::path& path) {
  const Handle access = property_list(H5P_FILE_ACCESS);
  check(H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18), "choose a file format");
  return open_any_file(path, H5F_ACC_RDWR, access.id());
}

bool is_named(hid_t file, const std::filesystem::path& path) {
  struct stat opened{};
  struct stat named{};
  return ::fstat(descriptor(file), &opened) == 0 && ::stat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

void flush(hid_t file) {
  const std::string action = "flush it";
  // HDF5 writes its directory first and then lengthens the file; a process killed in between would
  // leave a file that is shorter than its directory says, which does not open.
  hsize_t size = 0;
  check(H5Fget_filesize(file, &size), action);
  const int open = descriptor(file);
  struct stat on_disk{};
  bool good = ::fstat(open, &on_disk) == 0;
  if (good && static_cast<hsize_t>(on_disk.st_size) < size) {
    good = ::ftruncate(open, static_cast<off_t>(size)) == 0;
  }
  if (!good) {
    throw IoError("cannot " + action + ": " + std::generic_category().message(errno));
  }
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

Handle text_type(std::size_t size) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "create a text type");
  check(H5Tset_size(type.id(), size), "create a text type");
  check(H5Tset_cset(type.id(), H5T_CSET_UTF8), "create a text type");
  return type;
}

bool exists(hid_t parent, const std::string& name) {
  return H5Lexists(parent, name.c_str(), H5P_DEFAULT) > 0;
}

Handle create_group(hid_t parent, const std::string& name) {
  return {H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
          "create group '" + name + "'"};
}

Handle open_group(hid_t parent, const std::string& name) {
  check_link(parent, name);
  return {H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose, "open group '" + name + "'"};
}

std::vector<std::string> names_in(hid_t group) {
  // In the order of the file, and sorted here: for sorted ones HDF5 1.10 makes a table of links,
  // which it frees before it has filled it where a link is damaged.
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    try {
      static_cast<std::vector<std::string>*>(list)->emplace_back(name);
      return 0;
    } catch (...) {
      return -1;  // nothing is thrown through HDF5
    }
  };
  std::vector<std::string> names;
  check(H5Literate(group, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, add, &names), "list a group");
  std::sort(names.begin(), names.end());
  return names;
}

bool has_attribute(hid_t object, const std::string& name) {
  return H5Aexists(object, name.c_str()) > 0;
}

void write_attribute(hid_t object, const std::string& name, const std::string& value) {
  write_attribute_of_length(object, name, value, value.size());
}

void write_attribute_of_length(hid_t object, const std::string& name, const std::string& value,
                               std::size_t length) {
  std::string padded = value;
  padded.resize(std::max<std::size_t>(1, length), '\0');
  const Handle type = text_type(padded.size());
  const Handle attribute = writable_attribute(object, name, type.id());
  check(H5Awrite(attribute.id(), type.id(), padded.data()), "write attribute '" + name + "'");
}

void write_attribute(hid_t object, const std::string& name, double value) {
  write_number(object, name, value);
}

void write_attribute(hid_t object, const std::string& name, std::int64_t value) {
  write_number(object, name, value);
}

void write_attribute(hid_t object, const std::string& name, std::uint64_t value) {
  write_number(object, name, value);
}

std::string read_text_attribute(hid_t object, const std::string& name) {
  const Handle attribute = open_attribute(object, name);
  const Handle type(H5Aget_type(attribute.id()), H5Tclose, "read attribute '" + name + "'");
  if (H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) != 0) {
    refuse(name, "should be an attribute of text of fixed length");
  }
  const std::size_t length = H5Tget_size(type.id());
  if (length > kLongestText) refuse(name, "is longer than an attribute can be");
  std::string text(length, '\0');
  check(H5Aread(attribute.id(), type.id(), text.data()), "read attribute '" + name + "'");
  return text.substr(0, text.find('\0'));
}

std::int64_t read_integer_attribute(hid_t object, const std::string& name) {
  return read_number<std::int64_t>(object, name);
}

std::uint64_t read_unsigned_attribute(hid_t object, const std::string& name) {
  return read_number<std::uint64_t>(object, name);
}

Handle create_fixed(hid_t parent, const std::string& name, hid_t type,
                    const std::vector<hsize_t>& dimensions) {
  const Handle space = dimensions.empty() ? scalar_space() : simple_space(dimensions, nullptr);
  const Handle creation = plain_creation();
  check(H5Pset_alloc_time(creation.id(), H5D_ALLOC_TIME_EARLY), "lay out '" + name + "'");
  return {
      H5Dcreate2(parent, name.c_str(), type, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT),
      H5Dclose, "create dataset '" + name + "'"};
}

Handle create_growing(hid_t parent, const std::string& name, hid_t type,
                      const std::vector<hsize_t>& row, hsize_t chunk_rows) {
  std::vector<hsize_t> dimensions{0};
  dimensions.insert(dimensions.end(), row.begin(), row.end());
  std::vector<hsize_t> maximum = dimensions;
  maximum.front() = H5S_UNLIMITED;
  std::vector<hsize_t> chunk = dimensions;
  chunk.front() = chunk_rows;

  const std::string action = "create dataset '" + name + "'";
  const Handle space = simple_space(dimensions, maximum.data());
  const Handle creation = plain_creation();
  check(H5Pset_chunk(creation.id(), static_cast<int>(chunk.size()), chunk.data()), action);
  check(H5Pset_fill_time(creation.id(), H5D_FILL_TIME_NEVER), action);
  return {H5Dcreate2(parent, name.c_str(), type, space.id(), H5P_DEFAULT, creation.id(),
                     uncached_access().id()),
          H5Dclose, action};
}

Handle open_dataset(hid_t parent, const std::string& name) {
  check_link(parent, name);
  Handle dataset(H5Dopen2(parent, name.c_str(), uncached_access().id()), H5Dclose,
                 "open dataset '" + name + "'");
  if (!is_plain(dataset.id())) refuse(name, "is not stored as der stores it");
  return dataset;
}

Handle open_dataset(hid_t parent, const std::string& name, hid_t type) {
  Handle dataset = open_dataset(parent, name);
  const Handle stored(H5Dget_type(dataset.id()), H5Tclose, "open dataset '" + name + "'");
  if (H5Tequal(stored.id(), type) <= 0) refuse(name, "holds values of another type");
  return dataset;
}

Handle open_dataset(hid_t parent, const std::string& name, hid_t type,
                    const std::vector<hsize_t>& dimensions) {
  Handle dataset = open_dataset(parent, name, type);
  const Handle space(H5Dget_space(dataset.id()), H5Sclose, "open dataset '" + name + "'");
  const std::vector<hsize_t> stored = dimensions_of(dataset.id());
  if (H5Sget_simple_extent_type(space.id()) == H5S_NULL || stored != dimensions) {
    refuse(name, "holds " + in_words(stored) + " and should hold " + in_words(dimensions));
  }
  return dataset;
}

std::vector<hsize_t> dimensions_of(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), H5Sclose, "read the size of a dataset");
  std::vector<hsize_t> dimensions(
      static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space.id()))));
  H5Sget_simple_extent_dims(space.id(), dimensions.data(), nullptr);
  return dimensions;
}

void check_stored(hid_t dataset, hsize_t rows, hsize_t row_length) {
  if (rows > file_size(dataset) / bytes_of_a_value(dataset) / row_length) {
    throw IoError("a dataset claims more values than its file can hold");
  }
}

hsize_t stored_length(hid_t dataset) {
  hsize_t values = 1;
  for (const hsize_t length : dimensions_of(dataset)) {
    if (length == 0) return 0;
    check_stored(dataset, values, length);  // step by step: the product must not overflow
    values *= length;
  }
  return values;
}

void read_rows(hid_t dataset, hid_t type, hsize_t first, hsize_t count, void* data) {
  if (count == 0) return;
  const RowSelection rows = select_rows(dataset, first, count);
  check(H5Dread(dataset, type, rows.in_memory.id(), rows.in_file.id(), H5P_DEFAULT, data),
        "read rows");
}

void write_rows(hid_t dataset, hid_t type, hsize_t first, hsize_t count, const void* data) {
  if (count == 0) return;
  const RowSelection rows = select_rows(dataset, first, count);
  check(H5Dwrite(dataset, type, rows.in_memory.id(), rows.in_file.id(), H5P_DEFAULT, data),
        "append to a dataset");
}

}  // namespace der::hdf5
