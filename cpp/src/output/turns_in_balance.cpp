#include "output/turns_in_balance.hpp"

#include <Eigen/QR>
#include <cmath>

#include "der/core/constants.hpp"
#include "der/core/index.hpp"
#include "der/energies/circulatory_load.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/rotational_spring.hpp"
#include "der/loads/external_force.hpp"
#include "output/acting_elements.hpp"

namespace der {
namespace {

constexpr double kTurn = 2.0 * kPi;

Vector on_free(const Model& model, const Vector& all) {
  Vector free(model.num_free());
  for (Index i = 0; i < model.num_free(); ++i) free[i] = all[model.dofs.free()[to_size(i)]];
  return free;
}

/// The forces that the balance of the free nodes lacks [N].
Vector out_of_balance(const Model& model, const State& state, const Configuration& here) {
  Vector missing;
  external_force(model, here, state.extra_force, missing);
  missing = -missing;
  const ActingElements all(model, [](Index) { return true; });
  all.for_each_gradient(model, here,
                        [&](auto /*kernel*/, const auto& /*constants*/, const auto& dofs,
                            const auto& /*coordinates*/, const auto& gradient) {
                          for (std::size_t i = 0; i < dofs.size(); ++i) {
                            missing[dofs[i]] += gradient[static_cast<Index>(i)];
                          }
                        });
  add_circulatory_forces(circulatory_loads(*model.elements), here, -1.0, missing);
  return on_free(model, missing);
}

/// Adds the change of these forces by one more turn of a followed edge [N].
template <class Kernel>
void add_change_by_turn(const Model& model, Index control, const Configuration& here,
                        Vector& change) {
  const auto& springs = elements_of<Kernel>(*model.elements);
  Configuration wound = here;
  wound.controls[control] += kTurn;
  LocalTerm<Kernel::kDofs> before;
  LocalTerm<Kernel::kDofs> after;
  for (std::size_t i = 0; i < springs.size(); ++i) {
    const auto x = gather(springs.dofs[i], here.coordinates);
    evaluate_element<Kernel, Derivatives::Gradient>(springs.constants[i], here, x, before);
    evaluate_element<Kernel, Derivatives::Gradient>(springs.constants[i], wound, x, after);
    for (std::size_t k = 0; k < springs.dofs[i].size(); ++k) {
      const auto component = static_cast<Index>(k);
      change[springs.dofs[i][k]] += after.gradient[component] - before.gradient[component];
    }
  }
}

Vector change_by_turn(const Model& model, Index control, const Configuration& here) {
  Vector change = Vector::Zero(model.num_dofs());
  add_change_by_turn<RotationalSpring<1>>(model, control, here, change);
  add_change_by_turn<RotationalSpring<2>>(model, control, here, change);
  add_change_by_turn<FromPivot<RotationalSpring<1>>>(model, control, here, change);
  add_change_by_turn<FromPivot<RotationalSpring<2>>>(model, control, here, change);
  return on_free(model, change);
}

}  // namespace

void find_turns_in_balance(const Model& model, State& state) {
  const auto count = static_cast<Index>(model.followed_edges.size());
  if (count == 0) return;
  const Configuration here = configuration_of(model, state);
  const Vector missing = out_of_balance(model, state, here);
  Eigen::MatrixXd changes(missing.size(), count);
  for (Index i = 0; i < count; ++i) {
    changes.col(i) = change_by_turn(model, model.followed_edges[to_size(i)].turn, here);
  }
  // All at once, as springs may be neighbours. Edges on which no spring winds up change nothing.
  const Vector turns = -changes.completeOrthogonalDecomposition().solve(missing);
  for (Index i = 0; i < count; ++i) state.followed[i] += kTurn * std::round(turns[i]);
}

}  // namespace der
