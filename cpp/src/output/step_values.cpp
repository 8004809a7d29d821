#include "der/output/step_values.hpp"

namespace der {

StepValues::StepValues(const std::vector<Probe>& probes) {
  for (std::size_t i = 0; i < probes.size(); ++i) {
    if (probes[i].amplifies_noise()) parabolas_.push_back({i});
  }
}

void StepValues::read(const std::vector<Probe>& probes, double start, Simulation& simulation,
                      State& scratch) {
  start_ = start;
  length_ = simulation.state().time - start;
  const auto read_at = [&](double u, double Parabola::* value) {
    simulation.interpolate(start_ + u * length_, scratch);
    for (Parabola& parabola : parabolas_) {
      parabola.*value = probes[parabola.probe].value(simulation.model(), scratch);
    }
  };
  if (parabolas_.empty()) return;
  read_at(0.0, &Parabola::start);
  read_at(0.5, &Parabola::middle);
  read_at(1.0, &Parabola::end);
}

void StepValues::enter(double time, Vector& values) const {
  const double u = (time - start_) / length_;
  for (const Parabola& parabola : parabolas_) {
    values[static_cast<Index>(parabola.probe)] = (1.0 - u) * (1.0 - 2.0 * u) * parabola.start +
                                                 4.0 * u * (1.0 - u) * parabola.middle +
                                                 u * (2.0 * u - 1.0) * parabola.end;
  }
}

}  // namespace der
