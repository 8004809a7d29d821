#include "output/checkpoint_store.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "der/output/io_error.hpp"
#include "output/checksum.hpp"

namespace der {
namespace {

using hdf5::Handle;

constexpr hsize_t kHistoryChunk = 4096;
constexpr hsize_t kSummaryValues = 5;  // of a ProbeSummary
constexpr std::size_t kRampValues = 5;
constexpr hsize_t kCounters = 5;     // of Counters
constexpr hsize_t kWorkValues = 5;   // of Work
constexpr hsize_t kAuditValues = 6;  // of EnergyAudit

Handle with_unit(Handle dataset, const std::string& unit) {
  hdf5::write_attribute(dataset.id(), "unit", unit);
  return dataset;
}

template <class T>
Handle create_values(hid_t group, const std::string& name, const std::vector<hsize_t>& dimensions,
                     const std::string& unit) {
  return with_unit(hdf5::create_fixed(group, name, hdf5::native_type<T>(), dimensions), unit);
}

template <class T>
Handle open_values(hid_t group, const std::string& name, const std::vector<hsize_t>& dimensions) {
  return hdf5::open_dataset(group, name, hdf5::native_type<T>(), dimensions);
}

std::string slot_name(std::size_t slot) { return std::to_string(slot); }

template <class T>
T read_one(const Handle& dataset) {
  T value{};
  hdf5::read_all(dataset.id(), &value);
  return value;
}

template <class T>
std::vector<T> read_values(const Handle& dataset, hsize_t count) {
  std::vector<T> data(count);
  hdf5::read_all(dataset.id(), data.data());
  return data;
}

Vector read_dofs(const Handle& dataset, hsize_t count) {
  Vector vector(static_cast<Index>(count));
  hdf5::read_all(dataset.id(), vector.data());
  return vector;
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

std::array<double, kWorkValues> flatten(const Work& work) {
  const auto& [start, loads, supports, drag, solver] = work;
  return {start, loads, supports, drag, solver};
}

std::array<double, kAuditValues> flatten(const EnergyAudit& audit) {
  const auto& [exchanged, created, written, folded_from, folded_node, unreliable_from] = audit;
  return {exchanged, created, written, folded_from, folded_node, unreliable_from};
}

std::array<std::int64_t, kCounters> flatten(const Counters& all) {
  const auto& [steps, newton_iterations, retried_steps, rejected_steps, most_pieces] = all;
  return {steps, newton_iterations, retried_steps, rejected_steps, most_pieces};
}

std::vector<double> flatten(const std::vector<Ramp>& ramps) {
  std::vector<double> flat;
  for (const auto& [control, from_time, to_time, from, to] : ramps) {
    flat.insert(flat.end(), {static_cast<double>(control), from_time, to_time, from, to});
  }
  return flat;
}

std::vector<Ramp> to_ramps(const std::vector<double>& flat) {
  if (flat.size() % kRampValues != 0) throw IoError("a ramp of the checkpoint is not whole");
  std::vector<Ramp> ramps;
  for (std::size_t i = 0; i < flat.size(); i += kRampValues) {
    const double control = flat[i];
    const bool in_range = control >= 0.0 && control <= std::numeric_limits<Index>::max();
    if (!in_range || control != std::floor(control)) {
      throw IoError("a ramp of the checkpoint is of no control");
    }
    ramps.push_back(
        {static_cast<Index>(control), flat[i + 1], flat[i + 2], flat[i + 3], flat[i + 4]});
  }
  return ramps;
}

std::vector<Vector> to_history(const std::vector<double>& flat,
                               const std::vector<std::int64_t>& lengths) {
  std::vector<Vector> history;
  std::size_t next = 0;
  for (const std::int64_t length : lengths) {
    if (length < 0 || static_cast<std::uint64_t>(length) > flat.size() - next) {
      throw IoError("the history of the checkpoint is not whole");
    }
    history.emplace_back(Eigen::Map<const Vector>(flat.data() + next, length));
    next += static_cast<std::size_t>(length);
  }
  if (next != flat.size()) throw IoError("the history of the checkpoint is longer than it says");
  return history;
}

/// Taken apart so that a new member of State does not compile until it is saved, read and summed.
std::uint64_t checksum_of(const Checkpoint& checkpoint) {
  Checksum sum;
  const auto add = [&](const auto& numbers) {
    sum.add(numbers.data(), static_cast<std::size_t>(numbers.size()));
  };
  const auto& [time, step, positions, velocities, extra_force, accelerations, last_step, history,
               next_step, last_error, work, audit, ramps, turns] = checkpoint.state;
  sum.add(time);
  sum.add(step);
  for (const Vector* vector : {&positions, &velocities, &extra_force, &accelerations}) {
    add(*vector);
  }
  sum.add(last_step);
  sum.add(next_step);
  sum.add(last_error);
  add(flatten(work));
  add(flatten(audit));
  add(flatten(checkpoint.extremes));
  add(flatten(checkpoint.counters));
  sum.add(checkpoint.wall_seconds);
  for (const Vector& vector : history) {
    sum.add(std::int64_t{vector.size()});
    add(vector);
  }
  add(flatten(ramps));
  add(turns);
  return sum.value();
}

/// Throws IoError for a state that no run comes to.
void check_state(const State& state) {
  const bool numbers = std::isfinite(state.time) && state.positions.allFinite() &&
                       state.velocities.allFinite() && state.accelerations.allFinite() &&
                       state.turns.allFinite();
  if (!numbers) throw IoError("the checkpoint holds what is not a finite number");
  if (state.step < 0 || state.time < 0.0) {
    throw IoError("the checkpoint is of a negative time or number of steps");
  }
}

}  // namespace

CheckpointStore::Slot CheckpointStore::create_slot(hid_t group, hsize_t num_dofs,
                                                   hsize_t num_probes) {
  const std::vector<hsize_t> dofs{num_dofs};
  Slot slot;
  slot.time = create_values<double>(group, "time", {}, "s");
  slot.step = create_values<std::int64_t>(group, "step", {}, "");
  slot.positions = create_values<double>(group, "positions", dofs, "m");
  slot.velocities = create_values<double>(group, "velocities", dofs, "m/s");
  slot.extra_force = create_values<double>(group, "extra_force", dofs, "N");
  slot.accelerations = create_values<double>(group, "accelerations", dofs, "m/s^2");
  slot.last_step = create_values<double>(group, "last_step", {}, "s");
  slot.next_step = create_values<double>(group, "next_step", {}, "s");
  slot.last_error = create_values<double>(group, "last_error", {}, "");
  slot.work = create_values<double>(group, "work", {kWorkValues}, "J");
  slot.audit = create_values<double>(group, "energy_audit", {kAuditValues}, "");
  if (num_probes > 0) {
    slot.extremes = create_values<double>(group, "extremes", {num_probes, kSummaryValues}, "");
  }
  slot.counters = create_values<std::int64_t>(group, "counters", {kCounters}, "");
  slot.wall_seconds = create_values<double>(group, "wall_seconds", {}, "s");
  slot.history = Column<double>::create(group, "history", {}, "", kHistoryChunk);
  slot.history_lengths =
      Column<std::int64_t>::create(group, "history_lengths", {}, "", kHistoryChunk);
  slot.ramps = Column<double>::create(group, "ramps", {}, "", kHistoryChunk);
  slot.turns = Column<double>::create(group, "turns", {}, "rad", kHistoryChunk);
  slot.checksum = create_values<std::uint64_t>(group, "checksum", {}, "");
  return slot;
}

CheckpointStore::Slot CheckpointStore::open_slot(hid_t group, hsize_t num_dofs,
                                                 hsize_t num_probes) {
  const std::vector<hsize_t> dofs{num_dofs};
  Slot slot;
  slot.time = open_values<double>(group, "time", {});
  slot.step = open_values<std::int64_t>(group, "step", {});
  slot.positions = open_values<double>(group, "positions", dofs);
  slot.velocities = open_values<double>(group, "velocities", dofs);
  slot.extra_force = open_values<double>(group, "extra_force", dofs);
  slot.accelerations = open_values<double>(group, "accelerations", dofs);
  slot.last_step = open_values<double>(group, "last_step", {});
  slot.next_step = open_values<double>(group, "next_step", {});
  slot.last_error = open_values<double>(group, "last_error", {});
  slot.work = open_values<double>(group, "work", {kWorkValues});
  slot.audit = open_values<double>(group, "energy_audit", {kAuditValues});
  if (num_probes > 0) {
    slot.extremes = open_values<double>(group, "extremes", {num_probes, kSummaryValues});
  }
  slot.counters = open_values<std::int64_t>(group, "counters", {kCounters});
  slot.wall_seconds = open_values<double>(group, "wall_seconds", {});
  slot.history = Column<double>::open(group, "history", {});
  slot.history_lengths = Column<std::int64_t>::open(group, "history_lengths", {});
  slot.ramps = Column<double>::open(group, "ramps", {});
  slot.turns = Column<double>::open(group, "turns", {});
  slot.checksum = open_values<std::uint64_t>(group, "checksum", {});
  return slot;
}

CheckpointStore CheckpointStore::create(hid_t file, hsize_t num_dofs, hsize_t num_probes) {
  CheckpointStore store;
  store.num_dofs_ = num_dofs;
  store.num_probes_ = num_probes;
  const Handle group = hdf5::create_group(file, "checkpoint");
  for (std::size_t i = 0; i < store.slots_.size(); ++i) {
    const Handle slot = hdf5::create_group(group.id(), slot_name(i));
    store.slots_[i] = create_slot(slot.id(), num_dofs, num_probes);
  }
  store.current_ = create_values<std::int64_t>(group.id(), "current", {}, "");
  hdf5::write_all(store.current_.id(), &store.published_);
  return store;
}

bool CheckpointStore::is_in(hid_t file) { return hdf5::exists(file, "checkpoint"); }

CheckpointStore CheckpointStore::open(hid_t file, hsize_t num_dofs, hsize_t num_probes) {
  CheckpointStore store;
  store.num_dofs_ = num_dofs;
  store.num_probes_ = num_probes;
  const Handle group = hdf5::open_group(file, "checkpoint");
  for (std::size_t i = 0; i < store.slots_.size(); ++i) {
    const Handle slot = hdf5::open_group(group.id(), slot_name(i));
    store.slots_[i] = open_slot(slot.id(), num_dofs, num_probes);
  }
  store.current_ = open_values<std::int64_t>(group.id(), "current", {});
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
  const State& state = checkpoint.state;
  hdf5::write_all(slot.time.id(), &state.time);
  hdf5::write_all(slot.step.id(), &state.step);
  hdf5::write_all(slot.positions.id(), state.positions.data());
  hdf5::write_all(slot.velocities.id(), state.velocities.data());
  hdf5::write_all(slot.extra_force.id(), state.extra_force.data());
  hdf5::write_all(slot.accelerations.id(), state.accelerations.data());
  hdf5::write_all(slot.last_step.id(), &state.last_step);
  hdf5::write_all(slot.next_step.id(), &state.next_step);
  hdf5::write_all(slot.last_error.id(), &state.last_error);
  hdf5::write_all(slot.work.id(), flatten(state.work).data());
  hdf5::write_all(slot.audit.id(), flatten(state.audit).data());
  const auto extremes = flatten(checkpoint.extremes);
  if (!extremes.empty()) hdf5::write_all(slot.extremes.id(), extremes.data());
  hdf5::write_all(slot.counters.id(), flatten(checkpoint.counters).data());
  hdf5::write_all(slot.wall_seconds.id(), &checkpoint.wall_seconds);

  std::vector<double> flat;
  std::vector<std::int64_t> lengths;
  for (const Vector& vector : state.history) {
    flat.insert(flat.end(), vector.data(), vector.data() + vector.size());
    lengths.push_back(vector.size());
  }
  slot.history.assign(flat);
  slot.history_lengths.assign(lengths);
  slot.ramps.assign(flatten(state.ramps));
  slot.turns.assign(std::vector<double>(state.turns.begin(), state.turns.end()));
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
  State& state = checkpoint.state;
  state.time = read_one<double>(slot.time);
  state.step = read_one<std::int64_t>(slot.step);
  state.positions = read_dofs(slot.positions, num_dofs_);
  state.velocities = read_dofs(slot.velocities, num_dofs_);
  state.extra_force = read_dofs(slot.extra_force, num_dofs_);
  state.accelerations = read_dofs(slot.accelerations, num_dofs_);
  state.last_step = read_one<double>(slot.last_step);
  state.next_step = read_one<double>(slot.next_step);
  state.last_error = read_one<double>(slot.last_error);
  const auto works = read_values<double>(slot.work, kWorkValues);
  state.work = {works[0], works[1], works[2], works[3], works[4]};
  const auto audit = read_values<double>(slot.audit, kAuditValues);
  state.audit = {audit[0], audit[1], audit[2], audit[3], audit[4], audit[5]};
  if (num_probes_ > 0) {
    checkpoint.extremes =
        unflatten(read_values<double>(slot.extremes, num_probes_ * kSummaryValues));
  }
  const auto counters = read_values<std::int64_t>(slot.counters, kCounters);
  checkpoint.counters = {counters[0], counters[1], counters[2], counters[3], counters[4]};
  checkpoint.wall_seconds = read_one<double>(slot.wall_seconds);
  state.history = to_history(slot.history.read(0, slot.history.rows()),
                             slot.history_lengths.read(0, slot.history_lengths.rows()));
  state.ramps = to_ramps(slot.ramps.read(0, slot.ramps.rows()));
  const std::vector<double> turns = slot.turns.read(0, slot.turns.rows());
  state.turns = Eigen::Map<const Vector>(turns.data(), static_cast<Index>(turns.size()));
  if (checksum_of(checkpoint) != read_one<std::uint64_t>(slot.checksum)) {
    throw IoError("the checkpoint is damaged: its checksum is another one");
  }
  check_state(state);
  return checkpoint;
}

}  // namespace der
