#pragma once

#include <hdf5.h>

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

/// A new file in the oldest format that serves, which every reader knows and which carries no
/// "still open" mark that would lock a killed run's file.
Handle create_file(const std::filesystem::path& path);
Handle open_file(const std::filesystem::path& path, unsigned flags);
Handle create_group(hid_t parent, const std::string& name);
/// Writes all out and lets the file on disk be as long as its own directory says, in an order in
/// which a process killed on the way leaves a file that opens.
void flush(hid_t file, const std::filesystem::path& path);

/// Keeps what HDF5 still wants to write, when it closes the file or before, from the file on disk.
/// After a write that failed (a full disk) that would be half of a change, which makes the file
/// unreadable; without it the file stays as it was flushed last.
void abandon(hid_t file) noexcept;

bool exists(hid_t parent, const std::string& name);
/// Names of what a group holds, in alphabetical order.
std::vector<std::string> names_in(hid_t parent, const std::string& group);
bool has_attribute(hid_t object, const std::string& name);

/// Attributes. Writing replaces one that is there.
void write_attribute(hid_t object, const std::string& name, const std::string& value);
void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, std::int64_t value);
std::string read_string_attribute(hid_t object, const std::string& name);
std::int64_t read_integer_attribute(hid_t object, const std::string& name);

/// A dataset that holds one text.
void write_text(hid_t parent, const std::string& name, const std::string& text);
std::string read_text(hid_t parent, const std::string& name);

/// A dataset of fixed size whose place in the file is set at once, so that writing it again changes
/// nothing but its values. No dimensions: a scalar.
Handle create_fixed(hid_t parent, const std::string& name, hid_t type,
                    const std::vector<hsize_t>& dimensions);

Handle open_dataset(hid_t parent, const std::string& name);
std::vector<hsize_t> dimensions_of(hid_t dataset);
hsize_t length_of(hid_t dataset);

template <class T>
void write_all(hid_t dataset, const T* data) {
  check(H5Dwrite(dataset, native_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "write data");
}

template <class T>
void read_all(hid_t dataset, T* data) {
  check(H5Dread(dataset, native_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "read data");
}

template <class T>
std::vector<T> read_vector(hid_t dataset) {
  std::vector<T> data(length_of(dataset));
  if (!data.empty()) read_all(dataset, data.data());
  return data;
}

/// Row number `row` of a dataset of doubles, flat.
std::vector<double> read_row(hid_t dataset, hsize_t row);

/// A dataset that grows by rows along its first dimension. Nothing is cached on our side of the
/// operating system, so an appended row is one write at its place in the file.
class Column {
 public:
  Column() = default;
  /// `row`: the dimensions of one row, none for scalars. `chunk_rows`: rows that are laid out
  /// together.
  static Column create(hid_t parent, const std::string& name, hid_t type,
                       const std::vector<hsize_t>& row, hsize_t chunk_rows);
  static Column open(hid_t parent, const std::string& name);

  [[nodiscard]] hsize_t rows() const { return dimensions_.front(); }
  [[nodiscard]] hid_t id() const { return dataset_.id(); }
  /// Drops rows from `count` on (or adds rows of no defined value).
  void resize(hsize_t count);

  template <class T>
  void append(const T* data, hsize_t count) {
    append_raw(native_type<T>(), data, count);
  }
  template <class T>
  void assign(const std::vector<T>& data) {
    resize(data.size());
    if (!data.empty()) write_all(dataset_.id(), data.data());
  }

 private:
  Column(Handle dataset, std::vector<hsize_t> dimensions)
      : dataset_(std::move(dataset)), dimensions_(std::move(dimensions)) {}
  void append_raw(hid_t type, const void* data, hsize_t count);

  Handle dataset_;
  std::vector<hsize_t> dimensions_;
};

}  // namespace der::hdf5
