#include "der/solvers/joint_rotations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <type_traits>

#include "der/core/index.hpp"
#include "der/energies/arc_stretch.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/num_joints.hpp"
#include "der/energies/registry.hpp"
#include "der/energies/strain_rate.hpp"
#include "der/energies/viscous_term.hpp"
#include "der/kinematics/hermite.hpp"

namespace der {
namespace {

constexpr double kRounding = 1e-15;  // [rad], and of a rotation
constexpr int kMostIterations = 20;

template <class Kernel>
constexpr bool kIsDamped = NumJoints<Kernel>::value > 0 && StrainRate<Kernel>::kExists;

}  // namespace

/// The numbers of the rotations of an element among the free ones, -1 of a held one and of none.
template <class Kernel>
std::array<Index, 2> JointRotations::rotations_of(
    const std::array<Index, to_size(Kernel::kDofs)>& dofs) const {
  std::array<Index, 2> rotations{-1, -1};
  for (int i = 0; i < Kernel::kJoints; ++i) {
    rotations[to_size(i)] = number_of(dofs[to_size(Kernel::kDofs - Kernel::kJoints + i)]);
  }
  return rotations;
}

/// Calls use(list, e, rotations) for each element that rotations have a part in.
template <class Use>
void JointRotations::for_each_element(const Use& use) const {
  for_each_list(*model_.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (NumJoints<Kernel>::value > 0 && NumJoints<Kernel>::value < 3) {
      for (std::size_t e = 0; e < list.size(); ++e)
        use(list, e, rotations_of<Kernel>(list.dofs[e]));
    }
  });
}

/// Calls use(list, damped, rotations) for each of these with internal damping.
template <class Use>
void JointRotations::for_each_damped(const Use& use) const {
  for_each_list(*model_.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (kIsDamped<Kernel>) {
      for (const DampedElement& damped : list.damped) {
        use(list, damped, rotations_of<Kernel>(list.dofs[damped.element]));
      }
    }
  });
}

/// Calls use(number, dof) for each free rotation.
template <class Use>
void JointRotations::for_each_free(const Use& use) const {
  for (std::size_t i = 0; i < free_.size(); ++i) use(static_cast<Index>(i), free_[i]);
}

Index JointRotations::number_of(Index dof) const {
  return number_[to_size(dof - model_.dofs.rotation(0))];
}

/// A rotation lags behind where the bending beside it is damped.
void JointRotations::find_lagging(const Model& model) {
  lags_.assign(to_size(model.dofs.num_rotations()), false);
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (kIsDamped<Kernel>) {
      if (IsArcStretch<Kernel>::value) return;
      for (const DampedElement& damped : list.damped) {
        const auto& dofs = list.dofs[damped.element];
        for (auto dof = dofs.end() - Kernel::kJoints; dof != dofs.end(); ++dof) {
          lags_[to_size(*dof - model.dofs.rotation(0))] = true;
        }
      }
    }
  });
}

JointRotations::JointRotations(const Model& model) : model_(model) {
  const DofMap& dofs = model.dofs;
  find_lagging(model);
  if (model.dimension == 3 && model.has_rotations()) {
    in_space_ = std::make_unique<SpatialJointRotations>(model);
    return;
  }
  for (Index i = 0; i < dofs.num_rotations(); ++i) {
    const bool is_free = dofs.is_free(dofs.rotation(i));
    if (is_free && lags(i)) ++num_lagging_;
    number_.push_back(is_free ? static_cast<Index>(free_.size()) : -1);
    if (is_free) free_.push_back(dofs.rotation(i));
  }
  const auto acts_here = [&](const ControlledForce& force) {
    return force.dof >= dofs.rotation(0) && dofs.is_free(force.dof);
  };
  std::copy_if(model.controlled_forces.begin(), model.controlled_forces.end(),
               std::back_inserter(moments_), acts_here);
  const auto couple = [&](const auto& /*list*/, const auto& /*element*/, const auto& rotations) {
    if (rotations[0] >= 0 && rotations[1] >= 0) couplings_.push_back({rotations[0], rotations[1]});
  };
  for_each_element(couple);
  for_each_damped(couple);
  const auto size = static_cast<Index>(free_.size());
  for (Vector* each :
       {&reference_, &residual_, &stiffness_, &step_, &direction_, &along_, &remains_, &scaled_}) {
    each->setZero(size);
  }
  here_ = {Vector::Zero(model.num_dofs()), Vector::Zero(model.tables.size())};
  velocities_.setZero(model.num_dofs());
}

void JointRotations::begin_system() {
  residual_.setZero();
  clear_matrix();
}

void JointRotations::clear_matrix() {
  stiffness_.setZero();
  for (Coupling& coupling : couplings_) coupling.value = 0.0;
}

/// Keeps the rotations that lag behind, or all others, as they are: the solution is 0 there.
void JointRotations::keep(bool lagging) {
  const auto is_kept = [&](Index i) {
    return lags(free_[to_size(i)] - model_.dofs.rotation(0)) == lagging;
  };
  for_each_free([&](Index i, Index /*dof*/) {
    if (!is_kept(i)) return;
    residual_[i] = 0.0;
    stiffness_[i] = 1.0;
  });
  for (Coupling& coupling : couplings_) {
    if (is_kept(coupling.a) || is_kept(coupling.b)) coupling.value = 0.0;
  }
}

/// Adds the gradient of the energy, and the stiffness, by the free rotations.
void JointRotations::add_elastic() {
  auto coupling = couplings_.begin();
  for_each_element([&](const auto& list, std::size_t e, const auto& rotations) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    constexpr Index kFirst = Kernel::kDofs - Kernel::kJoints;
    LocalTerm<Kernel::kDofs> term;
    evaluate_element<Kernel, Derivatives::Hessian>(list.constants[e], here_,
                                                   gather(list.dofs[e], here_.coordinates), term);
    for (Index i = 0; i < Kernel::kJoints; ++i) {
      const Index number = rotations[to_size(i)];
      if (number < 0) continue;
      residual_[number] += term.gradient[kFirst + i];
      stiffness_[number] += term.hessian(kFirst + i, kFirst + i);
    }
    if constexpr (Kernel::kJoints == 2) {
      if (rotations[0] >= 0 && rotations[1] >= 0) {
        (coupling++)->value = term.hessian(kFirst + 1, kFirst);
      }
    }
  });
}

/// Adds the moments of internal damping at the velocities, and `rate_factor` times their
/// derivatives by the rates of the free rotations.
void JointRotations::add_viscous(double rate_factor) {
  const Vector none;
  auto coupling = couplings_.end();
  for_each_damped([&](const auto& /*list*/, const auto& /*damped*/, const auto& rotations) {
    if (rotations[0] >= 0 && rotations[1] >= 0) --coupling;
  });
  for_each_damped([&](const auto& list, const DampedElement& damped, const auto& rotations) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    constexpr Index kFirst = Kernel::kDofs - Kernel::kJoints;
    const auto term = viscous_term(list, damped, {here_, velocities_, none});
    const auto matrix = viscous_matrix(list, damped, here_);
    for (Index i = 0; i < Kernel::kJoints; ++i) {
      const Index number = rotations[to_size(i)];
      if (number < 0) continue;
      residual_[number] += term.gradient[kFirst + i];
      stiffness_[number] += rate_factor * matrix(kFirst + i, kFirst + i);
    }
    if constexpr (Kernel::kJoints == 2) {
      if (rotations[0] >= 0 && rotations[1] >= 0) {
        (coupling++)->value = rate_factor * matrix(kFirst + 1, kFirst);
      }
    }
  });
}

void JointRotations::subtract_moments(const Vector& extra_force) {
  for (const auto& [dof, control, weight] : moments_) {
    residual_[number_of(dof)] -= weight * here_.controls[control];
  }
  for_each_free([&](Index i, Index dof) { residual_[i] -= extra_force[dof]; });
}

/// By conjugate gradients, with the diagonal as preconditioner: the stiffness by rotations is
/// positive. The damping of a hinge alone leaves the common rate of its sides alone, and so does
/// this.
void JointRotations::solve() {
  constexpr double kSmall = 1e-14;
  constexpr double kSingular = 1e-12;
  if (couplings_.empty()) {
    step_ = residual_.cwiseQuotient(stiffness_);
    return;
  }
  step_.setZero();
  remains_ = residual_;
  double slope = 0.0;
  const Index most = 2 * static_cast<Index>(free_.size()) + 10;
  for (Index i = 0; i < most; ++i) {
    scaled_ = remains_.cwiseQuotient(stiffness_);
    const double before = slope;
    slope = remains_.dot(scaled_);
    if (i == 0) {
      direction_ = scaled_;
    } else {
      direction_ = scaled_ + slope / before * direction_;
    }
    along_ = stiffness_.cwiseProduct(direction_);
    for (const auto& [first, second, value] : couplings_) {
      along_[first] += value * direction_[second];
      along_[second] += value * direction_[first];
    }
    const double curvature = direction_.dot(along_);
    if (!(curvature > kSingular * direction_.cwiseAbs2().dot(stiffness_))) return;
    const double way = slope / curvature;
    step_ += way * direction_;
    remains_ -= way * along_;
    if (remains_.lpNorm<Eigen::Infinity>() <= kSmall * residual_.lpNorm<Eigen::Infinity>()) return;
  }
}

/// Takes the step from the rotations in `coordinates`; returns whether it was one of rounding.
bool JointRotations::take(Vector& coordinates) const {
  bool settled = true;
  for_each_free([&](Index i, Index dof) {
    double& rotation = coordinates[dof];
    rotation -= step_[i];
    settled = settled && std::abs(step_[i]) <= 8.0 * kRounding * (1.0 + std::abs(rotation));
  });
  return settled;
}

double JointRotations::settle(const Vector& controls, const Vector& extra_force,
                              Vector& coordinates, Which which) {
  if (in_space_) return in_space_->settle(controls, extra_force, coordinates);
  double work = 0.0;
  const bool some = which == Which::Undamped && any_lags();
  if (free_.size() == (some ? num_lagging_ : 0)) return work;
  here_.controls = controls;
  const auto add_work = [&](double sign) {
    for (const auto& [dof, control, weight] : moments_) {
      work += sign * weight * controls[control] * coordinates[dof];
    }
    for (const Index dof : free_) work += sign * extra_force[dof] * coordinates[dof];
  };
  add_work(-1.0);
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    here_.coordinates = coordinates;
    begin_system();
    add_elastic();
    subtract_moments(extra_force);
    if (some) keep(true);
    solve();
    if (take(coordinates)) break;
  }
  add_work(1.0);
  return work;
}

void JointRotations::set_rates(const Configuration& here, const Vector& extra_force,
                               Vector& velocities) {
  if (!any_lags()) return;
  here_.coordinates = here.coordinates;
  here_.controls = here.controls;
  velocities_ = velocities;
  begin_system();
  add_elastic();
  subtract_moments(extra_force);
  clear_matrix();
  add_viscous(1.0);
  keep(false);
  solve();
  for_each_free([&](Index i, Index dof) { velocities[dof] -= step_[i]; });
}

/// Solves for the rotations of `here_`, whose rates are `rate_factor` times what they are beyond
/// the reference.
void JointRotations::solve_stage(double rate_factor, const Vector& extra_force) {
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    for_each_free([&](Index i, Index dof) {
      velocities_[dof] = rate_factor * (here_.coordinates[dof] - reference_[i]);
    });
    begin_system();
    add_elastic();
    add_viscous(rate_factor);
    subtract_moments(extra_force);
    solve();
    if (take(here_.coordinates)) break;
  }
  for_each_free([&](Index i, Index dof) {
    velocities_[dof] = rate_factor * (here_.coordinates[dof] - reference_[i]);
  });
}

JointRotations::Works JointRotations::advance(const Motion& motion, Vector& coordinates,
                                              Vector& velocities) {
  constexpr double kDiagonal = 1.0 - 0.70710678118654752;
  // Not a structured binding: lambdas do not capture its names before C++20 (clang 14).
  const Vector& start = motion.start;
  const Vector& start_rate = motion.start_rate;
  const double dt = motion.dt;
  const Vector& extra_force = motion.state.extra_force;
  const double rate_factor = 1.0 / (kDiagonal * dt);
  for_each_free([&](Index i, Index dof) { reference_[i] = start[dof]; });
  for (const double part : {kDiagonal, 1.0}) {
    const Hermite weight(part, dt);
    here_.coordinates = weight.value(start, coordinates, start_rate, velocities);
    velocities_ = weight.rate(start, coordinates, start_rate, velocities);
    for_each_free([&](Index i, Index dof) { here_.coordinates[dof] = reference_[i]; });
    evaluate_controls(model_, motion.state, motion.state.time + part * dt, here_.controls);
    solve_stage(rate_factor, extra_force);
    if (part == 1.0) break;
    for_each_free([&](Index i, Index dof) {
      reference_[i] = start[dof] + (1.0 - kDiagonal) * dt * velocities_[dof];
    });
  }
  // The moments at the end on the way there.
  Works works;
  begin_system();
  add_elastic();
  const auto way = [&](Index dof) { return here_.coordinates[dof] - coordinates[dof]; };
  for (const auto& [dof, control, weight] : moments_) {
    works.loads += weight * here_.controls[control] * way(dof);
  }
  for_each_free([&](Index i, Index dof) {
    works.loads += extra_force[dof] * way(dof);
    works.drag -= residual_[i] * way(dof);
  });
  works.drag += works.loads;
  for_each_free([&](Index /*i*/, Index dof) {
    coordinates[dof] = here_.coordinates[dof];
    velocities[dof] = velocities_[dof];
  });
  return works;
}

}  // namespace der
