#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/state.hpp"
#include "der/output/checkpoint.hpp"
#include "der/output/crossing_monitor.hpp"
#include "der/output/frame.hpp"
#include "der/output/probe.hpp"
#include "der/output/step_values.hpp"
#include "der/output/strain_monitor.hpp"
#include "der/simulation.hpp"

namespace der {

/// Reads the probes after every step, keeps their extremes, and hands every saved instant to the
/// sinks: the start, every `output.every` seconds, and the last instant of the run. Adaptive steps
/// do not end at those times; then the frames are interpolated (output/step_values.hpp for what
/// supports bear).
class Recorder {
 public:
  /// The clock of `wall_seconds()` starts here.
  explicit Recorder(const Simulation& simulation);
  /// The sink must outlive the recorder's use.
  void add(FrameSink& sink) { sinks_.push_back(&sink); }

  /// To be called at the start and after each step; an instant that was seen before is not taken
  /// twice. Throws DivergedError if a value is not a finite number; such a state is not recorded.
  void observe(Simulation& simulation);
  /// To be called at the end, however the run ended: saves the present instant, if that has not
  /// been done and its values are finite.
  void finish(const Simulation& simulation);

  /// Resets the simulation and the recorder to a checkpoint, to continue from there.
  void restore(const Checkpoint& checkpoint, Simulation& simulation);
  /// A checkpoint of the instant that was observed last.
  [[nodiscard]] Checkpoint checkpoint(const Simulation& simulation) const;

  [[nodiscard]] const std::vector<Probe>& probes() const { return probes_; }
  /// One a probe; without meaning before the first `observe`.
  [[nodiscard]] const std::vector<ProbeSummary>& summaries() const { return summaries_; }
  /// False until the first `observe`.
  [[nodiscard]] bool has_data() const { return seen_time_.has_value(); }
  /// Energies [J] of the last saved instant; none before it.
  [[nodiscard]] const std::optional<Energies>& energies() const { return energies_; }
  /// Where a rod was seen first to pass through itself or another.
  [[nodiscard]] const std::optional<CrossingMonitor::Crossing>& crossing() const {
    return crossings_.found();
  }
  /// Where a rod was saved first with strains beyond a linear law.
  [[nodiscard]] const std::optional<StrainMonitor::Strained>& strained() const {
    return strains_.found();
  }
  /// Cost of the run so far, earlier parts of a resumed run included.
  [[nodiscard]] Counters counters(const Simulation& simulation) const;
  [[nodiscard]] double wall_seconds() const;

 private:
  /// Records and, if asked for, saves the instant `state`; `within` has values of the
  /// step that holds it. Throws as `observe` does.
  void record(const Simulation& simulation, const State& state, bool save,
              const StepValues* within = nullptr);
  void record_frames_between(Simulation& simulation);
  /// As `record`, but returns what is not a finite number, in words; empty if all is well.
  std::string try_record(const Simulation& simulation, const State& state, bool save,
                         const StepValues* within = nullptr);
  [[nodiscard]] std::string read_probes(const Simulation& simulation, const State& state,
                                        const StepValues* within);
  void update_extremes(double time);
  void hand_out(const Model& model, const State& state);

  std::vector<Probe> probes_;
  std::vector<ProbeSummary> summaries_;
  std::vector<FrameSink*> sinks_;
  Vector values_;       // of the probes, now
  StepValues in_step_;  // of the probes, in the last adaptive step
  CrossingMonitor crossings_;
  StrainMonitor strains_;
  std::optional<Energies> energies_;
  State between_;                     // within an adaptive step
  std::optional<double> seen_time_;   // [s] of the last instant recorded
  std::optional<double> saved_time_;  // [s] of the last instant handed to the sinks
  Counters counters_before_;          // of the earlier parts of a resumed run
  double seconds_before_ = 0.0;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace der
