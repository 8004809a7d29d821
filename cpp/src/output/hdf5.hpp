#pragma once

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

/// A small layer over the C API of HDF5: handles that close themselves, errors that become IoError,
/// and the few operations that a run file needs.
namespace der::hdf5 {

/// To be held around every use of this layer: not every build of HDF5 is thread-safe, and it prints
/// its errors unless told otherwise.
class Session {
 public:
  Session();
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

 private:
  std::unique_lock<std::recursive_mutex> lock_;
  H5E_auto2_t print_ = nullptr;
  void* print_data_ = nullptr;
};

/// Owns an HDF5 identifier.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  /// Throws IoError ("cannot <action>: <what HDF5 says>") if `id` is not valid.
  Handle(hid_t id, Close close, const std::string& action);
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  [[nodiscard]] hid_t id() const { return id_; }
  void reset() noexcept;

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

/// Throws IoError ("cannot <action>: <what HDF5 says>") if an HDF5 call has failed.
void check(herr_t result, const std::string& action);

/// The type of which numbers are stored, and no other is read.
template <class T>
hid_t native_type();
template <>
inline hid_t native_type<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
inline hid_t native_type<int>() {
  return H5T_NATIVE_INT;
}
template <>
inline hid_t native_type<std::int64_t>() {
  return H5T_NATIVE_INT64;
}
template <>
inline hid_t native_type<std::uint64_t>() {
  return H5T_NATIVE_UINT64;
}

/// A new file; there must be none of that name, nor a link. In the format of HDF5 1.8, which every
/// reader knows, which has checksums over all that describes the data, and which carries no "still
/// open" mark that would lock a killed run's file.
Handle create_file(const std::filesystem::path& path);
Handle open_to_read(const std::filesystem::path& path);
Handle open_to_write(const std::filesystem::path& path);
/// True if `path` still names the file that is open.
bool is_named(hid_t file, const std::filesystem::path& path);
/// Writes all out and lets the file on disk be as long as its own directory says, in an order in
/// which a process killed on the way leaves a file that opens.
void flush(hid_t file);

/// Keeps what HDF5 still wants to write, when it closes the file or before, from the file on disk.
/// After a write that failed (a full disk) that would be half of a change, which makes the file
/// unreadable; without it the file stays as it was flushed last.
void abandon(hid_t file) noexcept;

/// Texts of `size` bytes in UTF-8, filled up with zeros.
Handle text_type(std::size_t size);

bool exists(hid_t parent, const std::string& name);
Handle create_group(hid_t parent, const std::string& name);
Handle open_group(hid_t parent, const std::string& name);
/// Names of what a group holds, in alphabetical order.
std::vector<std::string> names_in(hid_t group);

/// Attributes hold one number, or one text of fixed length: those of variable length lie elsewhere
/// in a file, where no checksum covers them. Reading throws IoError where the attribute is of
/// another type or extent.
bool has_attribute(hid_t object, const std::string& name);
void write_attribute(hid_t object, const std::string& name, const std::string& value);
void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, std::int64_t value);
void write_attribute(hid_t object, const std::string& name, std::uint64_t value);
std::string read_text_attribute(hid_t object, const std::string& name);
std::int64_t read_integer_attribute(hid_t object, const std::string& name);
std::uint64_t read_unsigned_attribute(hid_t object, const std::string& name);

/// A text attribute that can be written again in place, with a text of at most `length` bytes.
void write_attribute_of_length(hid_t object, const std::string& name, const std::string& value,
                               std::size_t length);

/// A dataset of fixed size whose place in the file is set at once, so that writing it again changes
/// nothing but its values. No dimensions: a scalar.
Handle create_fixed(hid_t parent, const std::string& name, hid_t type,
                    const std::vector<hsize_t>& dimensions);
/// A dataset that grows along its first dimension, from no rows. `row`: the dimensions of one row,
/// none for scalars. `chunk_rows`: rows that are laid out together.
Handle create_growing(hid_t parent, const std::string& name, hid_t type,
                      const std::vector<hsize_t>& row, hsize_t chunk_rows);

/// Opens a dataset that lies in this file and nowhere else. Throws IoError for one that is stored
/// otherwise than der does, in other files or behind filters.
Handle open_dataset(hid_t parent, const std::string& name);
/// Opens a dataset likewise; throws IoError if it is of another type.
Handle open_dataset(hid_t parent, const std::string& name, hid_t type);
/// Opens a dataset likewise; throws IoError if it has another type or other dimensions.
Handle open_dataset(hid_t parent, const std::string& name, hid_t type,
                    const std::vector<hsize_t>& dimensions);
std::vector<hsize_t> dimensions_of(hid_t dataset);
/// Throws IoError where `rows` of `row_length` values each are more than the dataset's file can
/// hold: memory for them must not be asked for.
void check_stored(hid_t dataset, hsize_t rows, hsize_t row_length);
/// Product of the dimensions. Throws as `check_stored` does.
hsize_t stored_length(hid_t dataset);

template <class T>
void write_all(hid_t dataset, const T* data) {
  check(H5Dwrite(dataset, native_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "write data");
}

/// `dataset` must have been opened with the type of T and the dimensions of `data`.
template <class T>
void read_all(hid_t dataset, T* data) {
  check(H5Dread(dataset, native_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "read data");
}

/// All numbers of a dataset, flat. Throws IoError where it is of another type.
template <class T>
std::vector<T> read_vector(hid_t parent, const std::string& name) {
  const Handle dataset = open_dataset(parent, name, native_type<T>());
  std::vector<T> data(stored_length(dataset.id()));
  if (!data.empty()) read_all(dataset.id(), data.data());
  return data;
}

/// Rows [first, first + count) of a dataset, as T. Throws IoError where the file cannot hold them.
void read_rows(hid_t dataset, hid_t type, hsize_t first, hsize_t count, void* data);
void write_rows(hid_t dataset, hid_t type, hsize_t first, hsize_t count, const void* data);

}  // namespace der::hdf5
