#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "der/output/io_error.hpp"
#include "output/hdf5.hpp"

namespace der {

/// A dataset that grows by rows along its first dimension, and the rows that are not in it yet.
/// Nothing is cached between it and the operating system, so appended rows are one write at their
/// place in the file.
template <class T>
class Column {
 public:
  Column() = default;
  /// `row`: the dimensions of one row, none for scalars. `chunk_rows`: rows that are laid out
  /// together.
  static Column create(hid_t parent, const std::string& name, const std::vector<hsize_t>& row,
                       const std::string& unit, hsize_t chunk_rows) {
    hdf5::Handle dataset =
        hdf5::create_growing(parent, name, hdf5::native_type<T>(), row, chunk_rows);
    hdf5::write_attribute(dataset.id(), "unit", unit);
    return {std::move(dataset), row, 0};
  }
  /// Throws IoError where the dataset is of another type, has other rows, or more of them than its
  /// file can hold: HDF5 goes through all of them when they are dropped.
  static Column open(hid_t parent, const std::string& name, const std::vector<hsize_t>& row) {
    hdf5::Handle dataset = hdf5::open_dataset(parent, name, hdf5::native_type<T>());
    std::vector<hsize_t> dimensions = hdf5::dimensions_of(dataset.id());
    const hsize_t rows = dimensions.empty() ? 0 : dimensions.front();
    if (dimensions.empty() ||
        std::vector<hsize_t>(dimensions.begin() + 1, dimensions.end()) != row) {
      throw IoError("the rows of '" + name + "' are of another size than they should be");
    }
    Column column(std::move(dataset), row, rows);
    hdf5::check_stored(column.id(), rows, column.row_length());
    return column;
  }

  [[nodiscard]] hsize_t rows() const { return rows_; }
  [[nodiscard]] hid_t id() const { return dataset_.id(); }
  [[nodiscard]] std::size_t row_length() const {
    std::size_t length = 1;
    for (const hsize_t entries : row_) length *= static_cast<std::size_t>(entries);
    return length;
  }

  void push(T value) { waiting_.push_back(value); }
  void push(const T* row) { waiting_.insert(waiting_.end(), row, row + row_length()); }
  /// Writes the rows that wait.
  void write() {
    const hsize_t count = waiting_.size() / row_length();
    const hsize_t first = rows_;
    resize(rows_ + count);
    hdf5::write_rows(dataset_.id(), hdf5::native_type<T>(), first, count, waiting_.data());
    waiting_.clear();
  }
  /// Drops rows from `count` on (or adds rows of no defined value).
  void resize(hsize_t count) {
    if (count == rows_) return;
    std::vector<hsize_t> dimensions{count};
    dimensions.insert(dimensions.end(), row_.begin(), row_.end());
    hdf5::check(H5Dset_extent(dataset_.id(), dimensions.data()), "resize a dataset");
    rows_ = count;
  }
  /// Replaces all that is there.
  void assign(const std::vector<T>& data) {
    resize(0);
    waiting_ = data;
    write();
  }
  /// Rows [first, first + count), flat. Throws IoError where there are not so many.
  [[nodiscard]] std::vector<T> read(hsize_t first, hsize_t count) const {
    if (first > rows_ || count > rows_ - first) throw IoError("a dataset has too few rows");
    hdf5::check_stored(dataset_.id(), count, row_length());
    std::vector<T> data(count * row_length());
    hdf5::read_rows(dataset_.id(), hdf5::native_type<T>(), first, count, data.data());
    return data;
  }

 private:
  Column(hdf5::Handle dataset, std::vector<hsize_t> row, hsize_t rows)
      : dataset_(std::move(dataset)), row_(std::move(row)), rows_(rows) {}

  hdf5::Handle dataset_;
  std::vector<hsize_t> row_;
  hsize_t rows_ = 0;
  std::vector<T> waiting_;
};

}  // namespace der
