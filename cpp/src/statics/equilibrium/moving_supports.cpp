#include "statics/equilibrium/moving_supports.hpp"

#include <algorithm>
#include <cmath>

#include "der/model/prescribed_motion.hpp"
#include "der/statics/potential.hpp"
#include "der/supports/clamp.hpp"
#include "statics/equilibrium/winding.hpp"

namespace der::statics {
namespace {

/// A step changes no edge, and turns no clamp [rad], by more than this.
constexpr double kLargestStep = 0.3;
/// The first step of supports that need several, as a fraction of the whole motion.
constexpr double kFirstTrial = 1e-9;
/// A clamp has not moved yet if the edge beside it differs from its direction by less than this
/// [rad]: that much the rod may bend there.
constexpr double kBentBesideClamp = 1.0;

/// The controls with all clamps at their initial angles.
Vector reference_controls(const Model& model, Vector controls) {
  for_each_turning_control(model, [&](Index control) { controls[control] = 0.0; });
  return controls;
}

/// The controls with each clamp of a planar rod turned as far as the edge beside it.
Vector present_controls(const Model& model, Vector controls, const Vector& followed) {
  for (const RodMesh& rod : model.rods) {
    for (const Clamp& clamp : rod.clamps) {
      if (clamp.followed < 0) continue;
      const double turn = followed[clamp.followed];
      if (std::abs(turn - controls[clamp.rotation]) > kBentBesideClamp) {
        controls[clamp.rotation] = turn;
      }
    }
  }
  return controls;
}

/// Whether all nodes that are free lie where they are drawn; the rotations of joints follow them.
bool is_as_drawn(const Model& model, const Vector& positions) {
  const std::vector<Index>& free = model.dofs.free();
  return std::all_of(free.begin(), free.end(), [&](Index dof) {
    return dof >= model.dofs.rotation(0) || positions[dof] == model.initial_positions[dof];
  });
}

}  // namespace

std::vector<double> move_supports(const Model& model, const StaticLoads& loads, const Vector& start,
                                  const Equilibrate& equilibrate, Shape& shape) {
  const bool as_drawn = is_as_drawn(model, shape.positions);
  if (as_drawn) shape = {model.initial_positions, unwrapped_of_reference(model)};
  const StaticLoads before{as_drawn ? reference_controls(model, loads.controls) : start, {}};
  before.follow(model, shape);

  const Vector target_controls = loads.at(model, shape).controls;
  Vector target = shape.positions;
  apply_prescribed_motion(model, target_controls, target);
  const Vector displacement = target - shape.positions;
  const Vector controls = before.at(model, shape).controls;
  const Vector rotation =
      target_controls - (as_drawn ? controls : present_controls(model, controls, shape.followed));
  const Index joints = model.dofs.num_rotations();
  const double longest =
      kLargestStep / std::max({largest_edge_change(model, displacement),
                               displacement.tail(joints).lpNorm<Eigen::Infinity>(),
                               rotation.lpNorm<Eigen::Infinity>()});
  std::vector<double> whole_turns;
  if (!rotation.isZero(0.0)) {
    whole_turns = planar_whole_turns(model, {shape.positions, target_controls - rotation});
  }
  double step = longest < 1.0 ? kFirstTrial : 1.0;
  for (double done = step; done < 1.0; done += step) {
    shape.positions += step * displacement;
    const StaticLoads on_the_way{target_controls - (1.0 - done) * rotation, loads.force};
    equilibrate(on_the_way, shape);
    // Where no equilibrium was found, too: a clamp that gets ahead of its frames loses whole turns.
    if (!model.framed_edges.empty()) on_the_way.follow(model, shape);
    step = std::min({2.0 * step, longest, 1.0 - done});
  }
  apply_prescribed_motion(model, target_controls, shape.positions);
  loads.follow(model, shape);
  return whole_turns;
}

}  // namespace der::statics
