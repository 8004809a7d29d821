#pragma once

#include <cstddef>
#include <vector>

#include "der/output/probe.hpp"
#include "der/simulation.hpp"

namespace der {

/// Values within an adaptive step of the probes that amplify noise: on the parabolas through their
/// values at the ends of the step's halves.
///
/// The weights of a parabola lie between -1/8 and 1, so that the values are as smooth as those at
/// the ends of steps, however stiff the rod is. The error is h^3/125 times the third derivative.
class StepValues {
 public:
  explicit StepValues(const std::vector<Probe>& probes);

  /// Reads them in the last step of `simulation`, which started at `start` [s]. `scratch` is
  /// overwritten.
  void read(const std::vector<Probe>& probes, double start, Simulation& simulation, State& scratch);
  /// Sets those in `values`, one for each probe, to what they are at `time` [s] within the step.
  void enter(double time, Vector& values) const;

 private:
  struct Parabola {
    std::size_t probe = 0;
    double start = 0.0;
    double middle = 0.0;
    double end = 0.0;
  };
  double start_ = 0.0;   // [s]
  double length_ = 0.0;  // [s]
  std::vector<Parabola> parabolas_;
};

}  // namespace der
