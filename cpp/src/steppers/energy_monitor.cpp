#include "der/steppers/energy_monitor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <tuple>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/isotropic_bend.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/energies/spatial_bend.hpp"

namespace der {
namespace {

// Shares of the energy exchanged.
constexpr double kDoubtful = 0.05;
constexpr double kUnstable = 0.5;
/// Share of the energy held below which a change is rounding.
constexpr double kEnergyRounding = 1e-10;
/// Strain of all edges whose energy is rounding, in a structure at rest too.
constexpr double kRoundingStrain = 1e-10;

double strain_energy(const Model& model, double strain) {
  double energy = 0.0;
  for (const RodMesh& rod : model.rods) {
    energy += 0.5 * rod.EA * strain * strain * rod.rest_length();
  }
  return energy;
}

/// Faster than comparing numbers. A zero that has changed its sign counts as another number.
bool same_bits(const Vector& a, const Vector& b) {
  const auto bytes = static_cast<std::size_t>(a.size()) * sizeof(double);
  return bytes == 0 || std::memcmp(a.data(), b.data(), bytes) == 0;  // no data where empty
}

/// The two edges that an element of bending lies between.
template <int Dim>
struct Corner {
  Eigen::Matrix<double, Dim, 1> before;
  Eigen::Matrix<double, Dim, 1> after;

  template <class Dofs>
  Corner(const Dofs& dofs, const Vector& positions)
      : before(positions.segment<Dim>(dofs[Dim]) - positions.segment<Dim>(dofs[0])),
        after(positions.segment<Dim>(dofs[2 * Dim]) - positions.segment<Dim>(dofs[Dim])) {}

  /// Times both lengths.
  [[nodiscard]] double cosine() const { return before.dot(after); }
  /// The sine, likewise, times the axis.
  [[nodiscard]] Vec3 binormal() const {
    Vec3 a = Vec3::Zero();
    Vec3 b = Vec3::Zero();
    a.head<Dim>() = before;
    b.head<Dim>() = after;
    return a.cross(b);
  }
};

template <int Dim, class Kernel>
Index folded_node_of(const Model& model, const Vector& before, const Vector& after) {
  for (const auto& dofs : elements_of<Kernel>(*model.elements).dofs) {
    const Corner<Dim> now(dofs, after);
    if (now.cosine() >= 0.0) continue;
    const Corner<Dim> then(dofs, before);
    if (then.cosine() < 0.0 && now.binormal().dot(then.binormal()) < 0.0) {
      return model.dofs.node_of(dofs[Dim]);
    }
  }
  return -1;
}

template <int Dim, class... Kernels>
Index first_folded_node(const Model& model, const Vector& before, const Vector& after) {
  Index found = -1;
  ((found = found >= 0 ? found : folded_node_of<Dim, Kernels>(model, before, after)), ...);
  return found;
}

/// The first node whose turning angle has gone through half a turn; -1 if there is none.
Index folded_node(const Model& model, const Vector& before, const Vector& after) {
  using Planar = PlanarBend<AngleCurvature>;
  using Isotropic = IsotropicBend<AngleCurvature>;
  using Spatial = SpatialBend<AngleCurvature>;
  return model.dimension == 2
             ? first_folded_node<2, Planar, FromPivot<Planar>>(model, before, after)
             : first_folded_node<3, Isotropic, FromSpatialPivot<Isotropic>, Spatial,
                                 FromSpatialPivot<Spatial>>(model, before, after);
}

std::string created_text(const EnergyAudit& audit, const std::string& times) {
  return fmt::format(
      "the integrator created {:.2g} J, {} the energy exchanged in the run ({:.2g} J)",
      audit.created, times, audit.exchanged);
}

std::string times_text(double share) {
  if (share < 1.0) return fmt::format("{:.0f} % of", 100.0 * share);
  if (share < 1.5) return "as much as";
  if (share < 2.5) return "twice";
  return fmt::format("{:.2g} times", share);
}

}  // namespace

EnergyMonitor::EnergyMonitor(const Model& model)
    : model_(model),
      rounding_(strain_energy(model, kRoundingStrain)),
      here_{Vector::Zero(model.num_dofs()), Vector::Zero(model.tables.size())},
      positions_(Vector::Zero(model.num_dofs())),
      velocities_(Vector::Zero(model.num_dofs())) {}

void EnergyMonitor::begin(const State& state) { keep(state); }

bool EnergyMonitor::has_written_shape(const State& state) const {
  return !same_bits(state.positions, positions_);
}

bool EnergyMonitor::has_external_writes(const State& state) const {
  return has_written_shape(state) || !same_bits(state.velocities, velocities_);
}

bool EnergyMonitor::has_written_angles(const State& state) const {
  const Index first = model_.dofs.num_positions();
  const Index angles = model_.dofs.num_angles();
  return !same_bits(state.positions.segment(first, angles), positions_.segment(first, angles));
}

double EnergyMonitor::energy_before_writes(const State& state) {
  configuration_of(model_, state, here_);
  here_.coordinates = positions_;
  return energies(model_, here_, velocities_).total();
}

void EnergyMonitor::enter_written(double before, State& state) {
  configuration_of(model_, state, here_);
  state.audit.written += energies(model_, here_, state.velocities).total() - before;
}

void EnergyMonitor::after_step(State& state) {
  EnergyAudit& audit = state.audit;
  if (audit.folded_from < 0.0) {
    const Index node = folded_node(model_, positions_, state.positions);
    if (node >= 0) {
      audit.folded_from = state.time;
      audit.folded_node = node;
      if (audit.unreliable_from < 0.0) audit.unreliable_from = state.time;
    }
  }
  keep(state);
}

void EnergyMonitor::keep(const State& state) {
  positions_ = state.positions;
  velocities_ = state.velocities;
}

Energies EnergyMonitor::energies_of(const State& state) {
  configuration_of(model_, state, here_);
  return energies(model_, here_, state.velocities);
}

void EnergyMonitor::enter_energies(const Energies& now, State& state) const {
  const double kinetic = now[EnergyTerm::Kinetic];
  const Work& work = state.work;
  EnergyAudit& audit = state.audit;
  const double created = -numerical_loss(work, now) - audit.written;
  const double out_of_nothing = std::max(created, 0.0);
  audit.exchanged =
      std::max({audit.exchanged, kinetic - out_of_nothing, work.drag - out_of_nothing,
                std::abs(work.loads), std::abs(work.supports), std::abs(work.actuation)});
  const double held =
      std::abs(work.start) + kinetic + now.elastic() + std::abs(now[EnergyTerm::Gravity]);
  if (!(created > std::max(kEnergyRounding * held, rounding_))) return;
  audit.created = std::max(audit.created, created);
  if (audit.unreliable_from < 0.0 && is_doubtful(audit)) audit.unreliable_from = state.time;
}

bool is_doubtful(const EnergyAudit& audit) { return audit.created > kDoubtful * audit.exchanged; }

bool is_unstable(const EnergyAudit& audit) { return audit.created > kUnstable * audit.exchanged; }

std::string describe(const Model& model, const EnergyAudit& audit) {
  std::string text;
  if (audit.folded_from >= 0.0) {
    const NodePlace place = place_of(model, static_cast<Index>(audit.folded_node));
    text = fmt::format(
        "node {} of rod '{}' folded over at t = {:.4g} s, where the turning angle jumps by a whole "
        "turn",
        place.place, place.rod, audit.folded_from);
  }
  // Without a fold it is the energy, though the run may have exchanged more since.
  if (!is_doubtful(audit) && !text.empty()) return text;
  return text + (text.empty() ? "" : ", and ") +
         created_text(audit, times_text(audit.created / audit.exchanged));
}

}  // namespace der
