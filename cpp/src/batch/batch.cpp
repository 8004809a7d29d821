#include "der/batch/batch.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "batch/refusals.hpp"
#include "der/output/start.hpp"
#include "der/scenario/scenario.hpp"

namespace der {
namespace {

/// Thrown by work that is given up because something else was thrown before, which the team keeps.
struct GivenUp {};

/// A member that has failed takes no part, whatever is written into its rows.
constexpr const char* kWayOut = "bring the member back to a good state with 'reset'";

Index to_row(std::size_t member) { return static_cast<Index>(member); }

Scenario scenario_of(std::size_t member, const Scenario& scenario,
                     const std::vector<Variation>& variations) {
  if (variations.empty()) return scenario;
  std::vector<ValueOverride> values;
  for (const Variation& variation : variations) {
    values.emplace_back(variation.path, variation.values[member]);
  }
  return with_values(scenario, values);
}

void check(std::size_t members, const std::vector<Variation>& variations) {
  if (members == 0) throw Error("model_error", "a batch has at least one member");
  for (const Variation& variation : variations) {
    if (variation.values.size() == members) continue;
    throw Error("model_error",
                fmt::format("'{}' varies over {} values, but the batch has {} members: give one "
                            "value for each",
                            variation.path, variation.values.size(), members));
  }
}

using Names = std::vector<std::string>;

/// Probes with their quantities.
Names probes_of(const Simulation& member) {
  Names names;
  for (const scenario::Probe& probe : member.scenario().scene().output.probes) {
    names.push_back(fmt::format("{} ({})", probe.name, probe.quantity));
  }
  return names;
}

/// The components of loads and supports that programs can set, with their units.
Names controls_of(const Simulation& member) {
  Names names;
  for (const NamedControl& control : member.model().named) {
    for (const ControlComponent& component : control.components) {
      names.push_back(fmt::format("{}.{} ({})", control.name, component.name, component.unit));
    }
  }
  return names;
}

/// One name stands for one thing in all members.
void check_names(const char* what, const Names& here, const Names& first) {
  if (here == first) return;
  const auto list = [](const Names& names) {
    return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
  };
  throw Error("model_error",
              fmt::format("it has other {} than member 0: {} in place of {}; the members of a "
                          "batch have the same names and units",
                          what, list(here), list(first)));
}

void check_names(const Simulation& member, const Simulation& first) {
  check_names("probes", probes_of(member), probes_of(first));
  check_names("named loads and supports", controls_of(member), controls_of(first));
}

}  // namespace

Batch::Batch(const Scenario& scenario, std::size_t members,
             const std::vector<Variation>& variations, int threads, const CancelCallback& beat)
    : team_(threads, members) {
  check(members, variations);
  members_.resize(members);
  build(scenario, variations, beat);
  std::vector<Simulation*> simulations;
  simulations.reserve(members);
  for (const Member& member : members_) simulations.push_back(member.simulation.get());
  groups_ = MemberGroups::make(simulations, team_.size());
  make_arrays();
  if (variations.empty()) {
    start_alike(beat);
  } else {
    start_each(beat);
  }
}

void Batch::build(const Scenario& scenario, const std::vector<Variation>& variations,
                  const CancelCallback& beat) {
  Refusals refusals;
  Member& first = members_.front();
  refusals.attempt(0, [&] {
    first.simulation = std::make_unique<Simulation>(scenario_of(0, scenario, variations));
  });
  refusals.raise();
  all(
      [&](std::size_t number, const auto& /*look*/) {
        if (number == 0) return;
        refusals.attempt(number, [&] {
          members_[number].simulation = std::make_unique<Simulation>(
              scenario_of(number, scenario, variations), *first.simulation);
          check_names(*members_[number].simulation, *first.simulation);
        });
      },
      beat);
  refusals.raise();
  for (const Member& member : members_) member.simulation->set_recovery_hint(kWayOut);
}

/// Members of one scene have one start.
void Batch::start_alike(const CancelCallback& beat) {
  Member& first = members_.front();
  start(0, [&] { poll_cancel(beat); });
  for (std::size_t number = 1; number < size(); ++number) {
    Member& member = members_[number];
    member.start = first.start;
    if (!first.start) {
      failed_[number] = 1;
      failures_[number] = failures_.at(0);
    } else if (!first.simulation->scenario().scene().start_from.empty()) {
      member.simulation->restore(*first.start);
    }
    write_rows(number);
  }
}

void Batch::start_each(const CancelCallback& beat) {
  Refusals refusals;
  all([&](std::size_t number,
          const auto& look) { refusals.attempt(number, [&] { start(number, look); }); },
      beat);
  refusals.raise();
}

void Batch::make_arrays() {
  const Index rows = to_row(size());
  for (RowMatrix* array : {&positions_, &velocities_, &extra_force_}) {
    array->setZero(rows, model().num_dofs());
  }
  time_.setZero(rows);
  step_count_.assign(size(), 0);
  failed_.assign(size(), 0);
  unreliable_.assign(size(), 0);
}

void Batch::start(std::size_t number, const CancelCallback& look) {
  Member& member = members_[number];
  try {
    apply_start(*member.simulation, look);
    member.start = std::make_shared<const State>(member.simulation->state());
  } catch (const NotConvergedError& error) {
    fail(number, error);
  }
  write_rows(number);
}

const Simulation& Batch::member(std::size_t number) const {
  if (number < size()) return *members_[number].simulation;
  throw Error("model_error", fmt::format("the batch has the members 0 to {}, but no member {}",
                                         size() - 1, number));
}

void Batch::poll_cancel(const CancelCallback& beat) {
  if (beat && pacer_.due()) beat();
}

void Batch::look(bool on_caller, const ThreadTeam::Call& call, const CancelCallback& beat) {
  if (on_caller) poll_cancel(beat);
  if (call.is_given_up()) throw GivenUp{};
}

template <class Work>
void Batch::all(const Work& work, const CancelCallback& beat) {
  team_.for_each(
      size(),
      [&](std::size_t number, bool on_caller, const ThreadTeam::Call& call) {
        work(number, [&] { look(on_caller, call, beat); });
        if (on_caller) poll_cancel(beat);
      },
      beat);
}

template <class Work>
void Batch::all_that_go_on(const Work& work, const CancelCallback& beat) {
  team_.for_each(
      size(),
      [&](std::size_t number, bool on_caller, const ThreadTeam::Call& call) {
        if (failed_[number] != 0) return;
        take_rows(number);
        try {
          work(number, [&] { look(on_caller, call, beat); });
        } catch (const Error& error) {
          fail(number, error);
        } catch (...) {
          write_rows(number);
          throw;
        }
        write_rows(number);
      },
      beat);
}

void Batch::step(std::int64_t count, const CancelCallback& beat) {
  if (!members_.front().simulation->scenario().scene().is_dynamic()) {
    throw Error("model_error", "a static scene has no time steps: use equilibrium()");
  }
  if (groups_) return step_in_lanes(count, beat);
  all_that_go_on(
      [&](std::size_t number, const auto& look) {
        Simulation& simulation = *members_[number].simulation;
        for (std::int64_t i = 0; i < count; ++i) {
          look();
          simulation.step();
        }
      },
      beat);
}

void Batch::step_in_lanes(std::int64_t count, const CancelCallback& beat) {
  const auto lanes = static_cast<std::size_t>(groups_->lanes());
  const auto work = [&](std::size_t group, bool on_caller, const ThreadTeam::Call& call) {
    std::int64_t left = count;
    const auto between_steps = [&] {
      if (on_caller) poll_cancel(beat);
    };
    const auto goes_on = [&] {
      between_steps();
      return left-- > 0 && !call.is_given_up();
    };
    std::vector<std::size_t> stepped;
    const auto takes_part = [&](std::size_t number) {
      if (failed_[number] != 0) return false;
      stepped.push_back(number);
      take_rows(number);
      return true;
    };
    const auto write_all = [&] {
      for (const std::size_t number : stepped) write_rows(number);
    };
    try {
      groups_->step(group, takes_part, goes_on, between_steps,
                    [&](std::size_t number, const Error& error) { fail(number, error); });
    } catch (...) {
      write_all();
      throw;
    }
    write_all();
  };
  team_.for_each((size() + lanes - 1) / lanes, work, beat);
}

std::vector<std::optional<EquilibriumReport>> Batch::equilibrium(bool leave_saddles,
                                                                 const CancelCallback& beat) {
  std::vector<std::optional<EquilibriumReport>> reports(size());
  all_that_go_on(
      [&](std::size_t number, const auto& look) {
        reports[number] = members_[number].simulation->equilibrium(leave_saddles, look);
      },
      beat);
  return reports;
}

template <class Change>
void Batch::change_ramps(const Change& change) {
  std::vector<std::vector<Ramp>> before;
  before.reserve(size());
  try {
    for (std::size_t number = 0; number < size(); ++number) {
      before.push_back(state(number).ramps);
      if (failed_[number] != 0) continue;
      take_rows(number);  // a simulation sees first what was written before
      change(*members_[number].simulation, to_row(number));
    }
  } catch (const Error& error) {
    for (std::size_t number = 0; number < before.size(); ++number) {
      state(number).ramps = std::move(before[number]);
    }
    throw Error(error.status(), fmt::format("member {}: {}", before.size() - 1, error.what()));
  }
}

void Batch::set(const std::vector<Setting>& settings, std::optional<double> over) {
  std::vector<double> values;
  change_ramps([&](Simulation& simulation, Index row) {
    for (const Setting& setting : settings) {
      const auto of_member = setting.values.row(row);
      values.assign(of_member.data(), of_member.data() + of_member.size());
      simulation.set(setting.name, values, over);
    }
  });
}

std::vector<std::string> Batch::take_warnings() {
  std::vector<std::string> warnings;
  std::size_t others = 0;
  for (std::size_t number = 0; number < size(); ++number) {
    const std::vector<std::string> own = members_[number].simulation->take_warnings();
    if (!warnings.empty() && !own.empty()) {
      ++others;
      continue;
    }
    for (const std::string& text : own) {
      warnings.push_back(fmt::format("member {}: {}", number, text));
    }
  }
  if (others > 0) warnings.back() += fmt::format(" (and likewise in {} more members)", others);
  return warnings;
}

void Batch::prescribe(std::size_t support, const std::vector<Prescription>& prescriptions) {
  change_ramps([&](Simulation& simulation, Index row) {
    for (const Prescription& prescription : prescriptions) {
      simulation.prescribe(support, prescription.component, prescription.values[row]);
    }
  });
}

RowMatrix Batch::value(const std::string& name) const {
  const std::size_t components = members_.front().simulation->settable(name).size();
  RowMatrix values(to_row(size()), static_cast<Index>(components));
  for (std::size_t number = 0; number < size(); ++number) {
    const std::vector<double> of_member = members_[number].simulation->value(name);
    std::copy_n(of_member.begin(), components, values.row(to_row(number)).data());
  }
  return values;
}

State Batch::save(std::size_t member) {
  static_cast<void>(this->member(member));
  take_rows(member);
  return members_[member].simulation->save();
}

void Batch::reset(std::size_t member, const State* saved) {
  static_cast<void>(this->member(member));
  const State* const wanted = saved != nullptr ? saved : members_[member].start.get();
  if (wanted == nullptr) return;
  members_[member].simulation->restore(*wanted);
  if (failed_[member] != 0) {
    failed_[member] = 0;
    failures_.erase(member);
  }
  write_rows(member);
}

void Batch::fail(std::size_t number, const Error& error) {
  const std::lock_guard lock(mutex_);
  failed_[number] = 1;
  failures_[number] = {error.status(), state(number).time, error.what(), std::current_exception()};
}

void Batch::take_rows(std::size_t number) {
  State& state = this->state(number);
  const Index row = to_row(number);
  const Eigen::Index dofs = positions_.cols();
  std::copy_n(positions_.row(row).data(), dofs, state.positions.data());
  std::copy_n(velocities_.row(row).data(), dofs, state.velocities.data());
  std::copy_n(extra_force_.row(row).data(), dofs, state.extra_force.data());
}

void Batch::write_rows(std::size_t number) {
  const State& state = this->state(number);
  const Index row = to_row(number);
  const Eigen::Index dofs = positions_.cols();
  std::copy_n(state.positions.data(), dofs, positions_.row(row).data());
  std::copy_n(state.velocities.data(), dofs, velocities_.row(row).data());
  std::copy_n(state.extra_force.data(), dofs, extra_force_.row(row).data());
  time_[row] = state.time;
  step_count_[number] = state.step;
  unreliable_[number] = state.audit.unreliable_from >= 0.0 ? 1 : 0;
  read_probes(number);
}

void Batch::read_probes(std::size_t number) {
  const Member& member = members_[number];
  member.simulation->follow_writes();
  for (std::size_t i = 0; i < member.probes.size(); ++i) {
    probes_(static_cast<Index>(i), to_row(number)) =
        member.probes[i].value(member.simulation->model(), member.simulation->state());
  }
}

RowMatrix& Batch::probes(const CancelCallback& beat) {
  const std::size_t count = members_.front().simulation->scenario().scene().output.probes.size();
  if (probes_.size() == 0) probes_.setZero(static_cast<Index>(count), to_row(size()));
  all(
      [&](std::size_t number, const auto& /*look*/) {
        Member& member = members_[number];
        if (member.probes.empty()) {
          member.probes =
              make_probes(member.simulation->scenario().scene(), member.simulation->model());
        }
        take_rows(number);
        read_probes(number);
      },
      beat);
  return probes_;
}

std::vector<std::string> Batch::probe_names() const {
  Names names;
  for (const auto& probe : members_.front().simulation->scenario().scene().output.probes) {
    names.push_back(probe.name);
  }
  return names;
}

}  // namespace der
