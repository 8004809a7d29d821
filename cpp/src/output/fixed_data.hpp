#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "output/hdf5.hpp"

namespace der {

/// Data that are written into a run file once: datasets with two attributes, the unit and the
/// checksum of their bytes. Reading throws IoError if type or checksum do not match.

/// A list of numbers and its dimensions, the last one fastest.
template <class T>
struct Array {
  std::vector<hsize_t> dimensions;
  std::vector<T> values;
};

/// T: int or double.
template <class T>
void write_array(hid_t parent, const std::string& name, const Array<T>& array,
                 const std::string& unit);
template <class T>
Array<T> read_array(hid_t parent, const std::string& name);

/// One text.
void write_text(hid_t parent, const std::string& name, const std::string& text);
std::string read_text(hid_t parent, const std::string& name);
/// The text without a look at its checksum, which files of format 3 and before have not.
std::string read_text_unchecked(hid_t parent, const std::string& name);

}  // namespace der
