#include "output/checkpoint_store.hpp"

#include <algorithm>
#include <string>

namespace der {
namespace {

using hdf5::Column;
using hdf5::Handle;

constexpr hsize_t kHistoryChunk = 4096;
constexpr hsize_t kSummaryValues = 5;  // of a ProbeSummary
constexpr std::size_t kRampValues = 5;
constexpr hsize_t kCounters = 5;     // of Counters
constexpr hsize_t kWorkValues = 5;   // of Work
constexpr hsize_t kAuditValues = 4;  // of EnergyAudit

Handle with_unit(Handle dataset, const std::string& unit) {
  hdf5::write_attribute(dataset.id(), "unit", unit);
  return dataset;
}

Handle create_doubles(hid_t group, const std::string& name, const std::vector<hsize_t>& dimensions,
                      const std::string& unit) {
  return with_unit(hdf5::create_fixed(group, name, H5T_NATIVE_DOUBLE, dimensions), unit);
}

Column create_list(hid_t group, const std::string& name, hid_t type) {
  Column column = Column::create(group, name, type, {}, kHistoryChunk);
  hdf5::write_attribute(column.id(), "unit", std::string());
  return column;
}

Handle open_group(hid_t parent, const std::string& name) {
  return {H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose, "open group '" + name + "'"};
}

std::string slot_name(std::size_t slot) { return std::to_string(slot); }

void read_into(Vector& vector, hid_t dataset) {
  const auto data = hdf5::read_vector<double>(dataset);
  vector = Eigen::Map<const Vector>(data.data(), static_cast<Index>(data.size()));
}

template <class T>
T read_one(hid_t dataset) {
  T value{};
  hdf5::read_all(dataset, &value);
  return value;
}

std::vector<double> flatten(const std::vector<ProbeSummary>& extremes) {
  std::vector<double> flat;
  for (const ProbeSummary& e : extremes) {
    flat.insert(flat.end(), {e.final, e.min, e.max, e.t_min, e.t_max});
  }
  return flat;
}

std::vector<ProbeSummary> unflatten(const std::vector<double>& flat) {
  std::vector<ProbeSummary> extremes;
  for (std::size_t i = 0; i + kSummaryValues <= flat.size(); i += kSummaryValues) {
    extremes.push_back({flat[i], flat[i + 1], flat[i + 2], flat[i + 3], flat[i + 4]});
  }
  return extremes;
}

}  // namespace

CheckpointStore::Slot CheckpointStore::create_slot(hid_t group, const Model& model,
                                                   std::size_t num_probes) {
  const std::vector<hsize_t> dofs{static_cast<hsize_t>(model.num_dofs())};
  Slot slot;
  slot.time = create_doubles(group, "time", {}, "s");
  slot.step = with_unit(hdf5::create_fixed(group, "step", H5T_NATIVE_INT64, {}), "");
  slot.positions = create_doubles(group, "positions", dofs, "m");
  slot.velocities = create_doubles(group, "velocities", dofs, "m/s");
  slot.extra_force = create_doubles(group, "extra_force", dofs, "N");
  slot.accelerations = create_doubles(group, "accelerations", dofs, "m/s^2");
  slot.last_step = create_doubles(group, "last_step", {}, "s");
  slot.next_step = create_doubles(group, "next_step", {}, "s");
  slot.last_error = create_doubles(group, "last_error", {}, "");
  slot.work = create_doubles(group, "work", {kWorkValues}, "J");
  slot.audit = create_doubles(group, "energy_audit", {kAuditValues}, "");
  if (num_probes > 0) {
    slot.extremes = create_doubles(group, "extremes", {num_probes, kSummaryValues}, "");
  }
  slot.counters =
      with_unit(hdf5::create_fixed(group, "counters", H5T_NATIVE_INT64, {kCounters}), "");
  slot.wall_seconds = create_doubles(group, "wall_seconds", {}, "s");
  slot.history = create_list(group, "history", H5T_NATIVE_DOUBLE);
  slot.history_lengths = create_list(group, "history_lengths", H5T_NATIVE_INT64);
  slot.ramps = create_list(group, "ramps", H5T_NATIVE_DOUBLE);
  return slot;
}

CheckpointStore::Slot CheckpointStore::open_slot(hid_t group) {
  Slot slot;
  slot.time = hdf5::open_dataset(group, "time");
  slot.step = hdf5::open_dataset(group, "step");
  slot.positions = hdf5::open_dataset(group, "positions");
  slot.velocities = hdf5::open_dataset(group, "velocities");
  slot.extra_force = hdf5::open_dataset(group, "extra_force");
  slot.accelerations = hdf5::open_dataset(group, "accelerations");
  slot.last_step = hdf5::open_dataset(group, "last_step");
  slot.next_step = hdf5::open_dataset(group, "next_step");
  slot.last_error = hdf5::open_dataset(group, "last_error");
  slot.work = hdf5::open_dataset(group, "work");
  slot.audit = hdf5::open_dataset(group, "energy_audit");
  if (hdf5::exists(group, "extremes")) slot.extremes = hdf5::open_dataset(group, "extremes");
  slot.counters = hdf5::open_dataset(group, "counters");
  slot.wall_seconds = hdf5::open_dataset(group, "wall_seconds");
  slot.history = Column::open(group, "history");
  slot.history_lengths = Column::open(group, "history_lengths");
  slot.ramps = Column::open(group, "ramps");
  return slot;
}

CheckpointStore CheckpointStore::create(hid_t file, const Model& model, std::size_t num_probes) {
  CheckpointStore store;
  const Handle group = hdf5::create_group(file, "checkpoint");
  for (std::size_t i = 0; i < store.slots_.size(); ++i) {
    const Handle slot = hdf5::create_group(group.id(), slot_name(i));
    store.slots_[i] = create_slot(slot.id(), model, num_probes);
  }
  store.current_ = with_unit(hdf5::create_fixed(group.id(), "current", H5T_NATIVE_INT64, {}), "");
  hdf5::write_all(store.current_.id(), &store.published_);
  return store;
}

CheckpointStore CheckpointStore::open(hid_t file) {
  CheckpointStore store;
  const Handle group = open_group(file, "checkpoint");
  for (std::size_t i = 0; i < store.slots_.size(); ++i) {
    store.slots_[i] = open_slot(open_group(group.id(), slot_name(i)).id());
  }
  store.current_ = hdf5::open_dataset(group.id(), "current");
  store.published_ = read_one<std::int64_t>(store.current_.id());
  return store;
}

void CheckpointStore::write(const Checkpoint& checkpoint) {
  written_ = published_ == 0 ? 1 : 0;
  Slot& slot = slots_[static_cast<std::size_t>(written_)];
  // Taken apart so that a new member of State does not compile until it is saved here and read
  // below.
  const auto& [time, step, positions, velocities, extra_force, accelerations, last_step, history,
               next_step, last_error, work, audit, ramps] = checkpoint.state;
  hdf5::write_all(slot.time.id(), &time);
  hdf5::write_all(slot.step.id(), &step);
  hdf5::write_all(slot.positions.id(), positions.data());
  hdf5::write_all(slot.velocities.id(), velocities.data());
  hdf5::write_all(slot.extra_force.id(), extra_force.data());
  hdf5::write_all(slot.accelerations.id(), accelerations.data());
  hdf5::write_all(slot.last_step.id(), &last_step);
  hdf5::write_all(slot.next_step.id(), &next_step);
  hdf5::write_all(slot.last_error.id(), &last_error);
  const auto& [start, loads, supports, drag, solver] = work;
  const std::array<double, kWorkValues> works{start, loads, supports, drag, solver};
  hdf5::write_all(slot.work.id(), works.data());
  const auto& [exchanged, created, written, unreliable_from] = audit;
  const std::array<double, kAuditValues> audited{exchanged, created, written, unreliable_from};
  hdf5::write_all(slot.audit.id(), audited.data());
  const auto extremes = flatten(checkpoint.extremes);
  if (!extremes.empty()) hdf5::write_all(slot.extremes.id(), extremes.data());
  const auto& [steps, newton_iterations, retried_steps, rejected_steps, most_pieces] =
      checkpoint.counters;
  const std::array<std::int64_t, kCounters> counters{steps, newton_iterations, retried_steps,
                                                     rejected_steps, most_pieces};
  hdf5::write_all(slot.counters.id(), counters.data());
  hdf5::write_all(slot.wall_seconds.id(), &checkpoint.wall_seconds);

  std::vector<double> flat;
  std::vector<std::int64_t> lengths;
  for (const Vector& vector : history) {
    flat.insert(flat.end(), vector.data(), vector.data() + vector.size());
    lengths.push_back(vector.size());
  }
  slot.history.assign(flat);
  slot.history_lengths.assign(lengths);

  std::vector<double> moved;
  for (const auto& [control, from_time, to_time, from, to] : ramps) {
    moved.insert(moved.end(), {static_cast<double>(control), from_time, to_time, from, to});
  }
  slot.ramps.assign(moved);
}

void CheckpointStore::publish() {
  published_ = written_;
  hdf5::write_all(current_.id(), &published_);
}

std::optional<Checkpoint> CheckpointStore::read() const {
  if (published_ < 0) return std::nullopt;
  const Slot& slot = slots_[static_cast<std::size_t>(published_)];
  Checkpoint checkpoint;
  State& state = checkpoint.state;
  state.time = read_one<double>(slot.time.id());
  state.step = read_one<std::int64_t>(slot.step.id());
  read_into(state.positions, slot.positions.id());
  read_into(state.velocities, slot.velocities.id());
  read_into(state.extra_force, slot.extra_force.id());
  read_into(state.accelerations, slot.accelerations.id());
  state.last_step = read_one<double>(slot.last_step.id());
  state.next_step = read_one<double>(slot.next_step.id());
  state.last_error = read_one<double>(slot.last_error.id());
  const auto works = hdf5::read_vector<double>(slot.work.id());
  state.work = {works.at(0), works.at(1), works.at(2), works.at(3), works.at(4)};
  const auto audited = hdf5::read_vector<double>(slot.audit.id());
  state.audit = {audited.at(0), audited.at(1), audited.at(2), audited.at(3)};
  if (slot.extremes.id() >= 0) {
    checkpoint.extremes = unflatten(hdf5::read_vector<double>(slot.extremes.id()));
  }
  const auto counters = hdf5::read_vector<std::int64_t>(slot.counters.id());
  checkpoint.counters = {counters.at(0), counters.at(1), counters.at(2), counters.at(3),
                         counters.at(4)};
  checkpoint.wall_seconds = read_one<double>(slot.wall_seconds.id());

  const auto history = hdf5::read_vector<double>(slot.history.id());
  const double* next = history.data();
  for (const auto length : hdf5::read_vector<std::int64_t>(slot.history_lengths.id())) {
    state.history.emplace_back(Eigen::Map<const Vector>(next, static_cast<Index>(length)));
    next += length;
  }

  const auto ramps = hdf5::read_vector<double>(slot.ramps.id());
  for (std::size_t i = 0; i + kRampValues <= ramps.size(); i += kRampValues) {
    state.ramps.push_back(
        {static_cast<Index>(ramps[i]), ramps[i + 1], ramps[i + 2], ramps[i + 3], ramps[i + 4]});
  }
  return checkpoint;
}

}  // namespace der
