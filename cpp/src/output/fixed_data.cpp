#include "output/fixed_data.hpp"

#include <cstdint>

#include "der/output/io_error.hpp"
#include "output/checksum.hpp"

namespace der {
namespace {

using hdf5::Handle;

std::uint64_t checksum_of(const void* data, std::size_t size) {
  Checksum sum;
  sum.add_bytes(data, size);
  return sum.value();
}

void describe(const Handle& dataset, const std::string& unit, std::uint64_t checksum) {
  hdf5::write_attribute(dataset.id(), "unit", unit);
  hdf5::write_attribute(dataset.id(), "checksum", checksum);
}

void compare(const Handle& dataset, const std::string& name, std::uint64_t checksum) {
  if (hdf5::read_unsigned_attribute(dataset.id(), "checksum") != checksum) {
    throw IoError("'" + name + "' is damaged: its checksum is another one");
  }
}

Handle open_text(hid_t parent, const std::string& name) {
  Handle dataset = hdf5::open_dataset(parent, name);
  const Handle type(H5Dget_type(dataset.id()), H5Tclose, "read dataset '" + name + "'");
  const bool is_text = H5Tget_class(type.id()) == H5T_STRING && H5Tis_variable_str(type.id()) == 0;
  if (!is_text || !hdf5::dimensions_of(dataset.id()).empty()) {
    throw IoError("'" + name + "' should be one text of fixed length");
  }
  hdf5::check_stored(dataset.id(), 1, 1);
  return dataset;
}

std::string bytes_of(const Handle& dataset, const std::string& name) {
  const Handle type(H5Dget_type(dataset.id()), H5Tclose, "read dataset '" + name + "'");
  std::string bytes(H5Tget_size(type.id()), '\0');
  hdf5::check(H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()),
              "read dataset '" + name + "'");
  return bytes;
}

}  // namespace

template <class T>
void write_array(hid_t parent, const std::string& name, const Array<T>& array,
                 const std::string& unit) {
  const Handle dataset = hdf5::create_fixed(parent, name, hdf5::native_type<T>(), array.dimensions);
  if (!array.values.empty()) hdf5::write_all(dataset.id(), array.values.data());
  describe(dataset, unit, checksum_of(array.values.data(), sizeof(T) * array.values.size()));
}

template <class T>
Array<T> read_array(hid_t parent, const std::string& name) {
  const Handle dataset = hdf5::open_dataset(parent, name, hdf5::native_type<T>());
  Array<T> array{hdf5::dimensions_of(dataset.id()), {}};
  array.values.resize(hdf5::stored_length(dataset.id()));
  if (!array.values.empty()) hdf5::read_all(dataset.id(), array.values.data());
  compare(dataset, name, checksum_of(array.values.data(), sizeof(T) * array.values.size()));
  return array;
}

template void write_array(hid_t, const std::string&, const Array<int>&, const std::string&);
template void write_array(hid_t, const std::string&, const Array<double>&, const std::string&);
template Array<int> read_array(hid_t, const std::string&);
template Array<double> read_array(hid_t, const std::string&);

void write_text(hid_t parent, const std::string& name, const std::string& text) {
  const std::size_t size = text.size() + 1;  // with the zero at the end
  const Handle type = hdf5::text_type(size);
  const Handle dataset = hdf5::create_fixed(parent, name, type.id(), {});
  hdf5::check(H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()),
              "write dataset '" + name + "'");
  describe(dataset, "", checksum_of(text.c_str(), size));
}

std::string read_text(hid_t parent, const std::string& name) {
  const Handle dataset = open_text(parent, name);
  const std::string bytes = bytes_of(dataset, name);
  compare(dataset, name, checksum_of(bytes.data(), bytes.size()));
  return bytes.substr(0, bytes.find('\0'));
}

std::string read_text_unchecked(hid_t parent, const std::string& name) {
  const std::string bytes = bytes_of(open_text(parent, name), name);
  return bytes.substr(0, bytes.find('\0'));
}

}  // namespace der
