#include "output/checkpoint_store.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>

#include "der/model/fields.hpp"
#include "der/output/io_error.hpp"
#include "output/checksum.hpp"

namespace der {
namespace {

using hdf5::Handle;
using Dimensions = std::vector<hsize_t>;

constexpr hsize_t kGrowingChunk = 4096;

/// Makes the datasets of a new slot.
struct Creator {
  hid_t group;
  template <class Number>
  [[nodiscard]] Handle fixed(const std::string& name, const std::string& unit,
                             const Dimensions& dimensions) const {
    Handle dataset = hdf5::create_fixed(group, name, hdf5::native_type<Number>(), dimensions);
    hdf5::write_attribute(dataset.id(), "unit", unit);
    return dataset;
  }
  [[nodiscard]] Column<double> growing(const std::string& name, const std::string& unit) const {
    return Column<double>::create(group, name, {}, unit, kGrowingChunk);
  }
};

/// Finds those of a slot that is there.
struct Opener {
  hid_t group;
  template <class Number>
  [[nodiscard]] Handle fixed(const std::string& name, const std::string& /*unit*/,
                             const Dimensions& dimensions) const {
    return hdf5::open_dataset(group, name, hdf5::native_type<Number>(), dimensions);
  }
  [[nodiscard]] Column<double> growing(const std::string& name, const std::string& /*unit*/) const {
    return Column<double>::open(group, name, {});
  }
};

/// Calls `visit(field, value)` for all that has a dataset of its own: the fields of a checkpoint,
/// and in place of its state the fields of that.
template <class AnyCheckpoint, class Visitor>
void for_each_dataset(AnyCheckpoint& checkpoint, Visitor&& visit) {
  for_each_field(checkpoint, [&](const auto& field, auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, State>) {
      for_each_field(value, visit);
    } else {
      visit(field, value);
    }
  });
}

template <class Struct>
constexpr hsize_t kNumFields = std::tuple_size_v<decltype(Struct::fields())>;

template <class Value>
constexpr bool is_of_integers() {
  if constexpr (HasFields<Value>::value) {
    return std::apply(
        [](const auto&... f) {
          const Value* none = nullptr;
          return (std::is_same_v<std::decay_t<decltype(none->*f.member)>, std::int64_t> && ...);
        },
        Value::fields());
  } else {
    return std::is_same_v<Value, std::int64_t>;
  }
}

/// The type that the numbers of a field are stored as.
template <class Value>
using StoredAs = std::conditional_t<is_of_integers<Value>(), std::int64_t, double>;

/// The extent of a field's dataset; none where it grows.
template <class Value>
std::optional<Dimensions> dimensions_of(Extent extent, hsize_t num_dofs, hsize_t num_probes) {
  if constexpr (std::is_arithmetic_v<Value>) {
    return Dimensions{};
  } else if constexpr (HasFields<Value>::value) {
    return Dimensions{kNumFields<Value>};
  } else if constexpr (IsList<Value>::value) {
    if (extent == Extent::Probes)
      return Dimensions{num_probes, kNumFields<typename Value::value_type>};
  } else {
    if (extent == Extent::Dofs) return Dimensions{num_dofs};
  }
  return std::nullopt;
}

/// Appends the numbers of a value to `row`.
template <class Number, class Value>
void pack(const Value& value, std::vector<Number>& row) {
  if constexpr (std::is_arithmetic_v<Value>) {
    static_assert(std::is_same_v<Value, Number> || std::is_same_v<Value, Index>);
    row.push_back(static_cast<Number>(value));
  } else if constexpr (std::is_same_v<Value, Vector>) {
    row.insert(row.end(), value.begin(), value.end());
  } else if constexpr (IsList<Value>::value) {
    for (const auto& item : value) pack(item, row);
  } else if constexpr (IsVariant<Value>::value) {
    std::visit([&](const auto& held) { pack(held, row); }, value);
  } else {
    for_each_field(value, [&](const auto& /*field*/, const auto& member) { pack(member, row); });
  }
}

/// Takes values from a row of numbers, as `pack` has put them in.
template <class Number>
class Unpacker {
 public:
  Unpacker(std::string name, std::vector<Number> row, hsize_t num_dofs)
      : name_(std::move(name)), row_(std::move(row)), num_dofs_(num_dofs) {}

  /// A list takes all that is left, and so does a Vector that is not one of degrees of freedom.
  template <class Value>
  void take(Extent extent, Value& value) {
    if constexpr (std::is_arithmetic_v<Value>) {
      value = to<Value>(*take(1));
    } else if constexpr (std::is_same_v<Value, Vector>) {
      const std::size_t length = extent == Extent::Dofs ? num_dofs_ : left();
      value = Eigen::Map<const Vector>(take(length), static_cast<Eigen::Index>(length));
    } else if constexpr (IsList<Value>::value) {
      while (left() > 0) take(Extent::Any, value.emplace_back());
    } else if constexpr (IsVariant<Value>::value) {
      std::visit([&](auto& held) { take(Extent::Any, held); }, value);
    } else {
      for_each_field(value, [&](const auto& field, auto& member) { take(field.extent, member); });
    }
  }
  void finish() const {
    if (left() > 0) throw IoError("'" + name_ + "' of the checkpoint is longer than it should be");
  }

 private:
  [[nodiscard]] std::size_t left() const { return row_.size() - next_; }
  const Number* take(std::size_t count) {
    if (count > left()) throw IoError("'" + name_ + "' of the checkpoint is not whole");
    next_ += count;
    return row_.data() + (next_ - count);
  }
  template <class Value>
  Value to(Number number) const {
    if constexpr (std::is_same_v<Value, Number>) {
      return number;
    } else {
      using Limits = std::numeric_limits<Value>;
      if (!(number >= Limits::min() && number <= Limits::max()) || number != std::floor(number)) {
        throw IoError("'" + name_ + "' of the checkpoint has " + std::to_string(number) +
                      " for a whole number");
      }
      return static_cast<Value>(number);
    }
  }

  std::string name_;
  std::vector<Number> row_;
  std::size_t next_ = 0;
  std::size_t num_dofs_;
};

template <class T>
T read_one(const Handle& dataset) {
  T value{};
  hdf5::read_all(dataset.id(), &value);
  return value;
}

template <class Number>
std::vector<Number> read_fixed(const Handle& dataset) {
  if (dataset.id() == H5I_INVALID_HID) return {};  // of no numbers
  std::vector<Number> row(hdf5::stored_length(dataset.id()));
  hdf5::read_all(dataset.id(), row.data());
  return row;
}

std::uint64_t checksum_of(const Checkpoint& checkpoint) {
  Checksum sum;
  for_each_value(checkpoint, [&](const auto& /*field*/, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, Vector>) {
      sum.add(value.data(), static_cast<std::size_t>(value.size()));
    } else if constexpr (std::is_same_v<Value, double>) {
      sum.add(value);
    } else {
      sum.add(std::int64_t{value});
    }
  });
  return sum.value();
}

/// Throws IoError for a state that no run can reach.
void check_state(const State& state) {
  const std::string wrong = find_wrong_value(state);
  if (!wrong.empty()) throw IoError("the checkpoint is not valid: " + wrong);
  if (!state.positions.allFinite() || !state.velocities.allFinite()) {
    throw IoError("the checkpoint holds a value that is not finite");
  }
}

void check_version(hid_t group) {
  // Before there were versions, what a stepper remembers was stored in another way.
  const std::int64_t found =
      hdf5::has_attribute(group, "version") ? hdf5::read_integer_attribute(group, "version") : 1;
  if (found == kStateVersion) return;
  throw IoError("its checkpoint is of version " + std::to_string(found) +
                ", and this der reads version " + std::to_string(kStateVersion) +
                ": run its scene again, or go on with the der that wrote it");
}

std::string slot_name(std::size_t slot) { return std::to_string(slot); }

}  // namespace

template <class Maker>
CheckpointStore::Slot CheckpointStore::make_slot(const Maker& maker) const {
  Slot slot;
  const Checkpoint none;
  for_each_dataset(none, [&](const auto& field, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    Dataset& dataset = slot.datasets.emplace_back();
    const auto dimensions = dimensions_of<Value>(field.extent, num_dofs_, num_probes_);
    if (!dimensions) {
      dataset.growing = maker.growing(field.name, field.unit);
    } else if (dimensions->empty() || dimensions->front() > 0) {
      dataset.fixed = maker.template fixed<StoredAs<Value>>(field.name, field.unit, *dimensions);
    }
    if constexpr (IsVariant<Value>::value) {
      dataset.kind = maker.template fixed<std::int64_t>(field.name + std::string("_kind"), "", {});
    }
  });
  slot.checksum = maker.template fixed<std::uint64_t>("checksum", "", {});
  return slot;
}

CheckpointStore CheckpointStore::create(hid_t file, hsize_t num_dofs, hsize_t num_probes) {
  CheckpointStore store;
  store.num_dofs_ = num_dofs;
  store.num_probes_ = num_probes;
  const Handle group = hdf5::create_group(file, "checkpoint");
  hdf5::write_attribute(group.id(), "version", kStateVersion);
  for (std::size_t i = 0; i < store.slots_.size(); ++i) {
    const Handle slot = hdf5::create_group(group.id(), slot_name(i));
    store.slots_[i] = store.make_slot(Creator{slot.id()});
  }
  store.current_ = Creator{group.id()}.fixed<std::int64_t>("current", "", {});
  hdf5::write_all(store.current_.id(), &store.published_);
  return store;
}

bool CheckpointStore::is_in(hid_t file) { return hdf5::exists(file, "checkpoint"); }

CheckpointStore CheckpointStore::open(hid_t file, hsize_t num_dofs, hsize_t num_probes) {
  CheckpointStore store;
  store.num_dofs_ = num_dofs;
  store.num_probes_ = num_probes;
  const Handle group = hdf5::open_group(file, "checkpoint");
  check_version(group.id());
  for (std::size_t i = 0; i < store.slots_.size(); ++i) {
    const Handle slot = hdf5::open_group(group.id(), slot_name(i));
    store.slots_[i] = store.make_slot(Opener{slot.id()});
  }
  store.current_ = Opener{group.id()}.fixed<std::int64_t>("current", "", {});
  store.published_ = read_one<std::int64_t>(store.current_);
  if (store.published_ < -1 || store.published_ > 1) {
    throw IoError("'checkpoint/current' is " + std::to_string(store.published_) +
                  " and should be -1, 0 or 1");
  }
  return store;
}

void CheckpointStore::write(const Checkpoint& checkpoint) {
  written_ = published_ == 0 ? 1 : 0;
  Slot& slot = slots_[static_cast<std::size_t>(written_)];
  auto dataset = slot.datasets.begin();
  for_each_dataset(checkpoint, [&](const auto& /*field*/, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    std::vector<StoredAs<Value>> row;
    pack(value, row);
    if constexpr (IsVariant<Value>::value) {
      const auto kind = static_cast<std::int64_t>(value.index());
      hdf5::write_all(dataset->kind.id(), &kind);
    }
    if (dataset->growing.id() != H5I_INVALID_HID) {
      if constexpr (std::is_same_v<StoredAs<Value>, double>) dataset->growing.assign(row);
    } else if (!row.empty()) {
      hdf5::write_all(dataset->fixed.id(), row.data());
    }
    ++dataset;
  });
  const std::uint64_t checksum = checksum_of(checkpoint);
  hdf5::write_all(slot.checksum.id(), &checksum);
}

void CheckpointStore::publish() {
  published_ = written_;
  hdf5::write_all(current_.id(), &published_);
}

std::optional<Checkpoint> CheckpointStore::read() const {
  if (published_ < 0) return std::nullopt;
  const Slot& slot = slots_[static_cast<std::size_t>(published_)];
  Checkpoint checkpoint;
  auto dataset = slot.datasets.begin();
  for_each_dataset(checkpoint, [&](const auto& field, auto& value) {
    using Value = std::decay_t<decltype(value)>;
    using Number = StoredAs<Value>;
    std::vector<Number> row;
    if (dataset->growing.id() == H5I_INVALID_HID) {
      row = read_fixed<Number>(dataset->fixed);
    } else if constexpr (std::is_same_v<Number, double>) {
      row = dataset->growing.read(0, dataset->growing.rows());
    }
    if constexpr (IsVariant<Value>::value) {
      const auto kind = read_one<std::int64_t>(dataset->kind);
      if (!emplace_alternative(value, kind)) {
        throw IoError("'" + std::string(field.name) + "_kind' of the checkpoint is " +
                      std::to_string(kind) + ", which no stepper has");
      }
    }
    Unpacker<Number> unpacker(field.name, std::move(row), num_dofs_);
    unpacker.take(field.extent, value);
    unpacker.finish();
    ++dataset;
  });
  if (checksum_of(checkpoint) != read_one<std::uint64_t>(slot.checksum)) {
    throw IoError("the checkpoint is damaged: its checksum is another one");
  }
  check_state(checkpoint.state);
  return checkpoint;
}

}  // namespace der
