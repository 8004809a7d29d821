#include "der/output/recorder.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "der/core/error.hpp"

namespace der {
namespace {

bool is_finite(const Energies& e) {
  return std::isfinite(e.kinetic) && std::isfinite(e.stretch) && std::isfinite(e.bend) &&
         std::isfinite(e.gravity);
}

}  // namespace

std::int64_t steps_between_frames(const scenario::Scene& scene) {
  if (!scene.is_dynamic()) return 1;
  return std::max<std::int64_t>(1, std::llround(scene.output.every / scene.time.step));
}

Recorder::Recorder(const Simulation& simulation)
    : probes_(make_probes(simulation.scenario().scene(), simulation.model())),
      summaries_(probes_.size()),
      values_(static_cast<Index>(probes_.size())),
      every_(steps_between_frames(simulation.scenario().scene())),
      start_(std::chrono::steady_clock::now()) {}

void Recorder::observe(const Simulation& simulation) {
  const State& state = simulation.state();
  if (state.time == seen_time_) return;
  const bool frame_due = state.step % every_ == 0 || simulation.finished();
  const std::string problem = record(simulation, frame_due);
  if (!problem.empty()) {
    throw DivergedError("the motion diverged: at t = " + std::to_string(state.time) + " s " +
                        problem + " is not a finite number. A smaller time.step may help.");
  }
  for (FrameSink* sink : sinks_) sink->stepped(simulation, *this);
}

void Recorder::finish(const Simulation& simulation) {
  if (simulation.state().time != saved_time_) record(simulation, true);
}

std::string Recorder::record(const Simulation& simulation, bool save) {
  const State& state = simulation.state();
  std::string problem = read_probes(simulation);
  if (!problem.empty()) return problem;
  if (save) {
    const Energies energy = der::energies(simulation.model(), state);
    if (!is_finite(energy)) return "the energy";
    if (!state.positions.allFinite() || !state.velocities.allFinite()) return "the motion";
    energies_ = energy;
    hand_out(state);
  }
  update_extremes(state.time);
  seen_time_ = state.time;
  return {};
}

std::string Recorder::read_probes(const Simulation& simulation) {
  for (std::size_t i = 0; i < probes_.size(); ++i) {
    const double value = probes_[i].value(simulation.model(), simulation.state());
    if (!std::isfinite(value)) return "probe '" + probes_[i].name() + "'";
    values_[static_cast<Index>(i)] = value;
  }
  return {};
}

void Recorder::hand_out(const State& state) {
  const Frame frame{state.time, state.step, state.positions, state.velocities, *energies_, values_};
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
  // Of the earlier part only the regular frames are kept, so any other one is not saved yet.
  saved_time_.reset();
  if (checkpoint.state.step % every_ == 0) saved_time_ = seen_time_;
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
  return total;
}

double Recorder::wall_seconds() const {
  const std::chrono::duration<double> part = std::chrono::steady_clock::now() - start_;
  return seconds_before_ + part.count();
}

}  // namespace der
