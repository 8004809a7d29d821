#pragma once

#include <array>
#include <complex>
#include <limits>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/steppers/tableau.hpp"

namespace der {

/// The controls at the stages of an implicit step. Stages beyond the step's end extrapolate tables
/// that have a kink there.
///
/// Supports move in a stage as the method moves the rod: by its rule for the integral of their
/// velocities. Where the tables have them at the stage's time the rod is not yet, by the method's
/// error in a stage, dt^2 u''/2 and the like. That is small, but a short edge beside a clamp would
/// resist it with its whole stiffness, EI/l^3. A tangent that turns about an axis is integrated as
/// a vector, as the rod beside it: between two of its directions it is within the circle on which
/// it turns.
class StageControls {
 public:
  explicit StageControls(const Model& model);

  /// Begins a step of `dt` [s] from `state` in stages of a tableau.
  void begin_step(const State& state, double dt, const Tableau& tableau);
  /// Begins a step whose one stage is at a share of it, on straight ways.
  void begin_step(const State& state, double dt);
  /// The stage to which what follows belongs; -1: the tables count.
  void enter_stage(Index stage) { stage_ = stage; }
  /// Sets `controls` to those at `time` [s] of a step that begins at `state`.
  void evaluate(const State& state, double time, Vector& controls);
  /// Velocity [m/s] in the stage of a degree of freedom that a support holds; `mean` [m/s] is that
  /// of the step.
  [[nodiscard]] double velocity(const HeldDof& held, double mean) const;

 private:
  /// At each stage.
  template <class T>
  using Rates = std::array<T, to_size(Tableau::kMaxStages)>;

  /// A control that moves a support.
  struct Motion {
    Index control = 0;
    double start = 0.0;  // value at the start of the step
    Rates<double> rate{};
  };
  /// A tangent that turns about an axis, as a point on the unit circle about it, which is 1 at the
  /// start of the step.
  struct Turn {
    std::size_t motion = 0;  // its angle
    Index inset = 0;         // HeldFrame::inset
    bool is_mean = true;     // whether it leaves its circle
    Rates<std::complex<double>> rate{};
  };
  void find_means(const State& state, double dt);
  void find_turns(double dt);
  void move(const State& state, double time, Vector& controls) const;
  /// Changes rates whose integral over the step is to be that of `mean`.
  template <class T>
  void end_at(const T& mean, Rates<T>& rates) const;
  /// The integral of rates to a stage, over the length of the step.
  template <class T>
  [[nodiscard]] T integral(const Rates<T>& rates, Index stage) const;

  const Model& model_;
  const Tableau* tableau_ = nullptr;
  std::vector<Motion> motions_;
  std::vector<Turn> turns_;
  Index stage_ = -1;
  Vector start_;
  Vector end_;
  double step_end_ = std::numeric_limits<double>::infinity();
};

}  // namespace der
