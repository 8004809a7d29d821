#include "der/output/recorder.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "der/catalog/steppers.hpp"
#include "der/core/error.hpp"
#include "der/model/followed.hpp"
#include "der/scenario/scenario.hpp"

namespace der {
namespace {

/// The cost of a step per node, against one of an implicit stepper of one stage in the spatial
/// model (measured with 21 to 1001 nodes).
double cost_of_step(const Simulation& simulation) {
  const Model& model = simulation.model();
  const StepperInfo& stepper = simulation.integrator();
  const double in_model = model.has_sections() ? 1.0 : model.dimension == 3 ? 0.35 : 0.16;
  return in_model * (stepper.implicit ? stepper.step_cost : 0.2);
}

/// Where a watch for crossings begins; null where what has brought the structure there is to be
/// told as well: equilibria.
const State* start_of_watch(const Simulation& simulation) {
  const scenario::Scene& scene = simulation.scenario().scene();
  const State& state = simulation.state();
  const bool moves = scene.is_dynamic() && (scene.start_from.empty() || state.step > 0);
  return moves ? &state : nullptr;
}

bool is_finite(const Energies& e) {
  const auto& values = e.values();
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace

Recorder::Recorder(const Simulation& simulation)
    : probes_(make_probes(simulation.scenario().scene(), simulation.model())),
      summaries_(probes_.size()),
      values_(static_cast<Index>(probes_.size())),
      in_step_(probes_),
      crossings_(simulation.model(), start_of_watch(simulation), cost_of_step(simulation)),
      start_(std::chrono::steady_clock::now()) {}

void Recorder::observe(Simulation& simulation) {
  const State& state = simulation.state();
  if (state.time == seen_time_) return;
  if (simulation.adaptive() && has_data()) record_frames_between(simulation);
  record(simulation, state, simulation.finished() || simulation.plan().is_frame(state.time));
  if (simulation.scenario().scene().is_dynamic()) {
    crossings_.after_step(simulation.model(), state);
  } else {
    crossings_.look(simulation.model(), state);
  }
  for (FrameSink* sink : sinks_) sink->stepped(simulation, *this);
}

/// The frames due since the instant seen last and before the present one.
void Recorder::record_frames_between(Simulation& simulation) {
  const StepPlan& plan = simulation.plan();
  const auto [first, last] = plan.frames_between(*seen_time_, simulation.state().time);
  if (first <= last) in_step_.read(probes_, *seen_time_, simulation, between_);
  for (std::int64_t frame = first; frame <= last; ++frame) {
    simulation.interpolate(static_cast<double>(frame) * plan.every, between_);
    record(simulation, between_, true, &in_step_);
  }
}

void Recorder::finish(const Simulation& simulation) {
  crossings_.look(simulation.model(), simulation.state());
  if (simulation.state().time != saved_time_) try_record(simulation, simulation.state(), true);
}

void Recorder::record(const Simulation& simulation, const State& state, bool save,
                      const StepValues* within) {
  const std::string problem = try_record(simulation, state, save, within);
  if (problem.empty()) return;
  throw DivergedError("the motion diverged: at t = " + std::to_string(state.time) + " s " +
                      problem + " is not a finite number. A smaller time.step may help.");
}

std::string Recorder::try_record(const Simulation& simulation, const State& state, bool save,
                                 const StepValues* within) {
  std::string problem = read_probes(simulation, state, within);
  if (!problem.empty()) return problem;
  if (save) {
    const Energies energy = der::energies(simulation.model(), state);
    if (!is_finite(energy)) return "the energy";
    if (!state.positions.allFinite() || !state.velocities.allFinite()) return "the motion";
    energies_ = energy;
    strains_.look(simulation.model(), state);
    hand_out(simulation.model(), state);
  }
  update_extremes(state.time);
  seen_time_ = state.time;
  return {};
}

std::string Recorder::read_probes(const Simulation& simulation, const State& state,
                                  const StepValues* within) {
  if (within != nullptr) within->enter(state.time, values_);
  for (std::size_t i = 0; i < probes_.size(); ++i) {
    double& value = values_[static_cast<Index>(i)];
    if (within == nullptr || !probes_[i].amplifies_noise()) {
      value = probes_[i].value(simulation.model(), state);
    }
    if (!std::isfinite(value)) return "probe '" + probes_[i].name() + "'";
  }
  return {};
}

void Recorder::hand_out(const Model& model, const State& state) {
  const Index positions = model.dofs.num_positions();
  const Index angles = model.dofs.num_angles();
  const Frame frame{state.time,
                    state.step,
                    state.positions.head(positions),
                    state.velocities.head(positions),
                    state.positions.segment(positions, angles),
                    state.velocities.segment(positions, angles),
                    edge_frames(model, state.followed),
                    saved_turns(model, state),
                    *energies_,
                    state.work,
                    values_};
  for (FrameSink* sink : sinks_) sink->write(frame);
  saved_time_ = state.time;
}

void Recorder::update_extremes(double time) {
  const bool first = !has_data();
  for (std::size_t i = 0; i < summaries_.size(); ++i) {
    ProbeSummary& summary = summaries_[i];
    const double value = values_[static_cast<Index>(i)];
    summary.final = value;
    if (first || value < summary.min) {
      summary.min = value;
      summary.t_min = time;
    }
    if (first || value > summary.max) {
      summary.max = value;
      summary.t_max = time;
    }
  }
}

void Recorder::restore(const Checkpoint& checkpoint, Simulation& simulation) {
  simulation.restore(checkpoint.state);
  summaries_ = checkpoint.extremes;
  for (std::size_t i = 0; i < summaries_.size(); ++i) {
    values_[static_cast<Index>(i)] = summaries_[i].final;
  }
  energies_ = der::energies(simulation.model(), checkpoint.state);
  seen_time_ = checkpoint.state.time;
  // Only the regular frames of the earlier part are kept, so any other one is not saved yet.
  saved_time_.reset();
  if (simulation.plan().is_frame(checkpoint.state.time)) {
    saved_time_ = seen_time_;
  }
  counters_before_ = checkpoint.counters;
  seconds_before_ = checkpoint.wall_seconds;
}

Checkpoint Recorder::checkpoint(const Simulation& simulation) const {
  return {simulation.state(), summaries_, counters(simulation), wall_seconds()};
}

Counters Recorder::counters(const Simulation& simulation) const {
  Counters total = simulation.counters();
  total.steps += counters_before_.steps;
  total.newton_iterations += counters_before_.newton_iterations;
  total.retried_steps += counters_before_.retried_steps;
  total.rejected_steps += counters_before_.rejected_steps;
  total.most_pieces = std::max(total.most_pieces, counters_before_.most_pieces);
  return total;
}

double Recorder::wall_seconds() const {
  const std::chrono::duration<double> part = std::chrono::steady_clock::now() - start_;
  return seconds_before_ + part.count();
}

}  // namespace der
