#include "run_file_edits.hpp"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <type_traits>
#include <variant>

namespace der::fuzz {
namespace {

namespace fs = std::filesystem;
using Dimensions = std::vector<hsize_t>;

constexpr std::size_t kBytesOfAnEdit = 12;
constexpr std::size_t kMostEdits = 16;
/// Edits write no more than this.
constexpr hsize_t kMostBytes = hsize_t{1} << 20;
constexpr int kMostLinks = 300;

/// Closes an identifier at the end; edits that HDF5 refuses do nothing.
class Open {
 public:
  Open(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Open() {
    if (id_ >= 0) close_(id_);
  }
  Open(const Open&) = delete;
  Open& operator=(const Open&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: as the C API wants it

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

template <class T>
T bits(std::uint64_t value) {
  static_assert(sizeof(T) == sizeof(value));
  T result;
  std::memcpy(&result, &value, sizeof(result));
  return result;
}

/// Paths of all objects but the root, as HDF5 visits them.
std::vector<std::string> objects_in(hid_t file) {
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5O_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, add, &names, H5O_INFO_BASIC);
  return names;
}

/// One length from each byte of a number: small ones, and powers of two up to 2^55.
Dimensions dimensions_from(unsigned rank, std::uint64_t value) {
  Dimensions dimensions;
  for (unsigned i = 0; i < rank; ++i) {
    const auto byte = static_cast<unsigned>((value >> (8 * i)) & 0xff);
    dimensions.push_back(byte < 200 ? byte : hsize_t{1} << (byte - 200));
  }
  return dimensions;
}

hid_t text_of_length(std::size_t length) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, length);
  return type;
}

hid_t type_from(unsigned kind) {
  switch (kind % 9) {
    case 0:
      return H5Tcopy(H5T_NATIVE_DOUBLE);
    case 1:
      return H5Tcopy(H5T_NATIVE_INT64);
    case 2:
      return H5Tcopy(H5T_NATIVE_INT);
    case 3:
      return H5Tcopy(H5T_NATIVE_UINT64);
    case 4:
      return H5Tcopy(H5T_NATIVE_FLOAT);
    case 5:
      return text_of_length(1 + kind / 9);
    case 6:
      return text_of_length(H5T_VARIABLE);
    case 7:
      return text_of_length(std::size_t{1} << (kind / 9));
    default:
      return H5Tvlen_create(H5T_NATIVE_DOUBLE);
  }
}

hid_t space_from(unsigned rank, std::uint64_t value) {
  if (rank == 4) return H5Screate(H5S_NULL);
  if (rank == 0) return H5Screate(H5S_SCALAR);
  const Dimensions dimensions = dimensions_from(rank, value);
  return H5Screate_simple(static_cast<int>(rank), dimensions.data(), nullptr);
}

const std::string& word(std::uint64_t number) {
  static const std::array<std::string, 9> words{"running",
                                                "stopped",
                                                "completed",
                                                "spatial",
                                                "planar",
                                                "",
                                                std::string("\xff\x00\x01", 3),
                                                std::string(70000, 'x'),
                                                "rods: []"};
  return words[number % words.size()];
}

/// An object of the file, or the root.
hid_t open_object(hid_t file, const std::string& name) {
  return H5Oopen(file, name.c_str(), H5P_DEFAULT);
}

std::string attribute_name(hid_t object, unsigned number) {
  H5O_info_t info;
  if (H5Oget_info2(object, &info, H5O_INFO_NUM_ATTRS) < 0 || info.num_attrs == 0) return {};
  std::array<char, 64> name{};
  H5Aget_name_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, number % info.num_attrs, name.data(),
                     name.size(), H5P_DEFAULT);
  return name.data();
}

/// How many values of so many bytes an attribute or dataset has; 0 if they are too many to write.
std::size_t num_values(hid_t space, std::size_t bytes) {
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  if (count < 0 || bytes == 0 || static_cast<hsize_t>(count) > kMostBytes / bytes) return 0;
  return static_cast<std::size_t>(count);
}

/// The same text, cut or filled up to its type's length, for all values of an attribute.
std::string repeated_text(hid_t type, hid_t space, std::uint64_t number) {
  const std::size_t length = H5Tget_size(type);
  const std::size_t count = num_values(space, length);
  if (count == 0) return {};
  std::string text = word(number);
  text.resize(length);
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

/// The same bytes for all values of an attribute or dataset, if these are numbers.
std::vector<std::uint64_t> repeated(hid_t type, hid_t space, std::uint64_t value) {
  const H5T_class_t kind = H5Tget_class(type);
  if (kind != H5T_INTEGER && kind != H5T_FLOAT) return {};
  return std::vector<std::uint64_t>(num_values(space, sizeof(value)), value);
}

void set_attribute(hid_t object, const Edit& edit) {
  const Open attribute(H5Aopen(object, attribute_name(object, edit.part).c_str(), H5P_DEFAULT),
                       H5Aclose);
  if (attribute < 0) return;
  const Open type(H5Aget_type(attribute), H5Tclose);
  const Open space(H5Aget_space(attribute), H5Sclose);
  if (H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0) {
    const std::string texts = repeated_text(type, space, edit.value);
    if (!texts.empty()) H5Awrite(attribute, type, texts.data());
  } else if (const auto values = repeated(type, space, edit.value); !values.empty()) {
    H5Awrite(attribute, type, values.data());
  }
}

void replace_attribute(hid_t object, const Edit& edit) {
  const std::string name = attribute_name(object, edit.part);
  if (name.empty()) return;
  H5Adelete(object, name.c_str());
  const Open type(type_from(edit.kind), H5Tclose);
  const Open space(space_from(static_cast<unsigned>(edit.value & 0xff) % 5, edit.value >> 8),
                   H5Sclose);
  // HDF5 makes the whole message in memory before it says that an attribute is too large for it.
  if (H5Sget_simple_extent_npoints(space) > 0 && num_values(space, H5Tget_size(type)) == 0) return;
  const Open attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
                       H5Aclose);
}

void remove_attribute(hid_t object, const Edit& edit) {
  if (const std::string name = attribute_name(object, edit.part); !name.empty()) {
    H5Adelete(object, name.c_str());
  }
}

/// A dataset of another type, extent and layout in place of an object.
void replace_dataset(hid_t file, const std::string& name, const Edit& edit) {
  const auto rank = static_cast<unsigned>(edit.part) % 5;
  const Open type(type_from(edit.kind), H5Tclose);
  const Open space(space_from(rank, edit.value), H5Sclose);
  const Open creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const auto layout = (edit.part / 5) % 5;
  if (layout > 0 && rank > 0 && rank < 4) {
    const Dimensions chunk = dimensions_from(rank, edit.value >> (8 * rank));
    H5Pset_chunk(creation, static_cast<int>(rank), chunk.data());
  }
  if (layout == 2) H5Pset_fletcher32(creation);
  if (layout == 3) H5Pset_layout(creation, H5D_COMPACT);
  if (layout == 4) H5Pset_external(creation, "/etc/hostname", 0, 32);
  H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  const Open dataset(
      H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose);
}

void overwrite(hid_t file, const std::string& name, const Edit& edit) {
  const Open dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (dataset < 0) return;
  const Open type(H5Dget_type(dataset), H5Tclose);
  const Open space(H5Dget_space(dataset), H5Sclose);
  auto values = repeated(type, space, edit.value);
  if (values.empty()) return;
  if (edit.kind % 2 == 1) {  // one of them
    H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    values[edit.part % values.size()] = edit.value;
  }
  H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
}

void set_extent(hid_t file, const std::string& name, const Edit& edit) {
  const Open dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (dataset < 0) return;
  const Open space(H5Dget_space(dataset), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank <= 0) return;
  Dimensions dimensions(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space, dimensions.data(), nullptr);
  // HDF5 goes through all chunks of a dataset that becomes smaller.
  if (H5Sget_simple_extent_npoints(space) > static_cast<hssize_t>(kMostBytes)) return;
  dimensions[edit.part % dimensions.size()] = edit.kind % 2 == 0 ? edit.value % 64 : edit.value;
  H5Dset_extent(dataset, dimensions.data());
}

/// A link in place of an object: to another one, to itself, to another file.
void link(hid_t file, const std::string& name, const std::string& target, const Edit& edit) {
  const std::string aside = name + (edit.value % 2 == 0 ? "" : "_");
  if (target != aside) H5Ldelete(file, aside.c_str(), H5P_DEFAULT);
  switch (edit.kind % 4) {
    case 0:
      H5Lcreate_hard(file, target.c_str(), file, aside.c_str(), H5P_DEFAULT, H5P_DEFAULT);
      return;
    case 1:
      H5Lcreate_soft(("/" + target).c_str(), file, aside.c_str(), H5P_DEFAULT, H5P_DEFAULT);
      return;
    case 2:
      H5Lcreate_external("other.h5", target.c_str(), file, aside.c_str(), H5P_DEFAULT, H5P_DEFAULT);
      return;
    default:
      for (int i = 0; i < kMostLinks; ++i) {
        H5Lcreate_hard(file, target.c_str(), file, (aside + std::to_string(i)).c_str(), H5P_DEFAULT,
                       H5P_DEFAULT);
      }
  }
}

void put_group(hid_t file, const std::string& name) {
  H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  const Open group(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
}

/// A text dataset of one value, or an attribute that der writes as a text.
void put_text(hid_t file, const std::string& name, const Edit& edit) {
  const std::string& text = word(edit.value);
  const Open type(text_of_length(std::max<std::size_t>(1, text.size())), H5Tclose);
  const Open space(H5Screate(H5S_SCALAR), H5Sclose);
  if (edit.kind % 2 == 0) {
    H5Ldelete(file, name.c_str(), H5P_DEFAULT);
    const Open dataset(
        H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose);
    H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data());
  } else {
    const Open object(open_object(file, edit.kind % 4 == 1 ? "/" : name), H5Oclose);
    if (object < 0) return;
    const std::string attribute_is = attribute_name(object, edit.part);
    H5Adelete(object, attribute_is.c_str());
    const Open attribute(
        H5Acreate2(object, attribute_is.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    H5Awrite(attribute, type, text.data());
  }
}

/// Edits of numbers that der writes, of objects of HDF5, of bytes. Inputs name them by number,
/// modulo how many there are: another one would change what the regressions mean.
enum What : std::uint8_t {
  kStateNumber,
  kStateRamp,
  kStateMemory,
  kSetAttribute,
  kReplaceAttribute,
  kRemoveAttribute,
  kRemove,
  kReplaceDataset,
  kOverwrite,
  kSetExtent,
  kLink,
  kMove,
  kPutGroup,
  kPutText,
  kByte,
  kLength,
  kEnd
};

What what(const Edit& edit) { return static_cast<What>(edit.what % kEnd); }

void edit_object(hid_t file, const Edit& edit) {
  const std::vector<std::string> names = objects_in(file);
  if (names.size() < 2) return;
  const std::string& name = names[edit.object % names.size()];  // the first one is the root
  const std::string& other = names[edit.part % names.size()];
  const Open object(open_object(file, name), H5Oclose);
  switch (what(edit)) {
    case kSetAttribute:
      return set_attribute(object, edit);
    case kReplaceAttribute:
      return replace_attribute(object, edit);
    case kRemoveAttribute:
      return remove_attribute(object, edit);
    case kRemove:
      H5Ldelete(file, name.c_str(), H5P_DEFAULT);
      return;
    case kReplaceDataset:
      return replace_dataset(file, name, edit);
    case kOverwrite:
      return overwrite(file, name, edit);
    case kSetExtent:
      return set_extent(file, name, edit);
    case kLink:
      return link(file, name, other, edit);
    case kMove:
      H5Ldelete(file, other.c_str(), H5P_DEFAULT);
      H5Lmove(file, name.c_str(), file, other.c_str(), H5P_DEFAULT, H5P_DEFAULT);
      return;
    case kPutGroup:
      return put_group(file, name);
    case kPutText:
      return put_text(file, name, edit);
    default:
      return;
  }
}

/// Some bytes of a file, or its length.
void edit_bytes(const std::string& path, const Edit& edit) {
  const std::uintmax_t size = fs::file_size(path);
  if (size == 0) return;
  if (what(edit) == kLength) {
    fs::resize_file(path, edit.value % (2 * size));
    return;
  }
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(static_cast<std::streamoff>((edit.value >> 32) % size));
  const auto bytes = static_cast<std::uint32_t>(edit.value);
  file.write(reinterpret_cast<const char*>(&bytes), 1 + edit.kind % 4);
}

/// Puts the same numbers into each Vector of what a stepper remembers.
template <class Memory>
void fill(Memory& memory, const Vector& numbers) {
  for_each_field(memory, [&](const auto& /*field*/, auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Vector>) value = numbers;
  });
}

}  // namespace

Edits parse_edits(const std::uint8_t* data, std::size_t size) {
  Edits edits;
  if (size < 2) return edits;
  edits.base = data[0];
  edits.successor = data[1];
  for (std::size_t at = 2; at + kBytesOfAnEdit <= size && edits.all.size() < kMostEdits;
       at += kBytesOfAnEdit) {
    Edit& edit =
        edits.all.emplace_back(Edit{data[at], data[at + 1], data[at + 2], data[at + 3], 0});
    std::memcpy(&edit.value, data + at + 4, sizeof(edit.value));
  }
  return edits;
}

bool is_of_state(const Edit& edit) { return what(edit) <= kStateMemory; }

void edit_state(State& state, const Edit& edit) {
  if (what(edit) == kStateRamp) {
    const auto number = bits<double>(edit.value);
    state.ramps.push_back({edit.part, number, number, number, number, 0.0, 0.0, 0.0});
    return;
  }
  if (what(edit) == kStateMemory) {
    constexpr auto kinds = static_cast<std::int64_t>(std::variant_size_v<StepperMemory>);
    emplace_alternative(state.memory, edit.kind % kinds);
    const Vector numbers = Vector::Constant(edit.part % 32, bits<double>(edit.value));
    std::visit([&](auto& memory) { fill(memory, numbers); }, state.memory);
    return;
  }
  std::size_t field = 0;
  for_each_value(state, [&](const auto& /*field*/, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if (field++ != edit.object) return;
    auto& changed = const_cast<Value&>(value);  // NOLINT: the state itself is not const
    if constexpr (std::is_same_v<Value, Vector>) {
      if (changed.size() > 0) changed[edit.part % changed.size()] = bits<double>(edit.value);
    } else if constexpr (std::is_same_v<Value, double>) {
      changed = bits<double>(edit.value);
    } else if constexpr (std::is_same_v<Value, std::int64_t>) {
      if (&value == &state.step) changed = bits<std::int64_t>(edit.value);
    }
  });
}

void edit_file(const std::string& path, const std::vector<Edit>& edits) {
  H5E_auto2_t print = nullptr;
  void* data = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &print, &data);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  {
    const Open file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    for (const Edit& edit : edits) {
      if (file >= 0 && what(edit) < kByte) edit_object(file, edit);
    }
  }
  H5Eset_auto2(H5E_DEFAULT, print, data);
  for (const Edit& edit : edits) {
    if (what(edit) >= kByte) edit_bytes(path, edit);
  }
}

}  // namespace der::fuzz
