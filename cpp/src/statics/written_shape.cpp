#include "der/statics/written_shape.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "der/core/constants.hpp"
#include "der/core/index.hpp"
#include "der/loads/external_force.hpp"
#include "der/statics/stiffness.hpp"
#include "der/supports/section_chain.hpp"
#include "der/supports/written_turns.hpp"

namespace der {
namespace {

using Link = SectionChain::Link;

/// Finds the angles of sections in a written shape, whose nodes stay where they are.
class WrittenSections {
 public:
  WrittenSections(const Model& model, const Assembler& assembler, LinearSolver& solver,
                  const CancelCallback& beat, State& state)
      : model_(model),
        assembler_(assembler),
        stiffness_(model, assembler, solver, beat),
        state_(state),
        chains_(section_chains(model)) {
    const Configuration here = configuration_of(model, state);
    controls_ = here.controls;
    external_force(model, here, state.extra_force, force_);
    state_.followed = unwrapped_of_reference(model);
    lay_frames(model_, chains_, here, state_.followed.tail(model_.initial_frames.size()));
  }

  void find() {
    std::vector<double> turns;
    for (const SectionChain& chain : chains_) {
      turns.push_back(chain.has_end() ? reference_turn(model_, chain, here()) : 0.0);
      twist_evenly(chain, turns.back());
    }
    balance_sections();
    for (std::size_t i = 0; i < chains_.size(); ++i) {
      if (chains_[i].has_end()) find_turn(chains_[i], turns[i]);
    }
  }

 private:
  [[nodiscard]] Configuration here() const { return configuration_of(model_, state_); }
  double& angle(Index edge) { return state_.positions[model_.framed_edges[to_size(edge)].theta]; }
  double& reference_twist(const Link& link) {
    return state_.followed[num_turns(model_) + link.twist];
  }

  /// Sets the angles of a chain, and the reference twist at its end, so that one torque twists it
  /// from end to end: none where an end is not held. The reference twists add up to `turn` [rad].
  void twist_evenly(const SectionChain& chain, double turn) {
    const Link& end = chain.links.back();
    double twist = turn;
    double rest = 0.0;
    double length = 0.0;
    double others = 0.0;  // reference twists but that at the end
    for (const Link& link : chain.links) {
      twist += link.offset(controls_);
      rest += link.vertex->rest.twist;
      length += link.vertex->twist_length;
      if (&link != &end) others += reference_twist(link);
    }
    if (chain.has_end()) reference_twist(end) = turn - others;
    const double rate = chain.keeps_twist() ? (twist - rest) / length : 0.0;
    const auto strain = [&](const Link& link) {
      return link.vertex->rest.twist + rate * link.vertex->twist_length;
    };
    for (const Link& link : chain.links) {
      if (&link == &end && chain.has_end()) break;
      const double before = link.leaves_clamp() ? 0.0 : angle(link.before);
      angle(link.after) = before + strain(link) - link.offset(controls_) - reference_twist(link);
    }
    if (chain.start_is_held() || !chain.end_is_held()) return;
    const double shift =
        end.offset(controls_) + reference_twist(end) - strain(end) - angle(end.before);
    for (const Link& link : chain.links) {
      if (!link.leaves_clamp()) angle(link.before) += shift;
    }
  }

  /// Turns the sections to where no torque on them is left over, by Newton's method downhill.
  void balance_sections() {
    constexpr int kMostSteps = 100;
    constexpr double kLargestStep = 0.5;  // [rad]
    constexpr double kSolved = 1e-11;     // [rad]
    follow(model_, state_);
    Configuration shape = here();
    for (int i = 0; i < kMostSteps; ++i) {
      stiffness_.evaluate(shape);
      const Vector turned = newton_step();
      const double largest = turned.lpNorm<Eigen::Infinity>();
      if (!(largest > kSolved)) break;
      shape.coordinates += std::min(1.0, kLargestStep / largest) * turned;
    }
    state_.positions = shape.coordinates;
  }

  /// By how much the sections turn [rad], all degrees of freedom: downhill, with the least of the
  /// shifts of their stiffness that makes it positive definite.
  Vector newton_step() {
    constexpr double kHeld = 1e9;     // what holds the nodes, over the stiffness of edges
    constexpr double kLeast = 1e-12;  // shift, over the stiffness against turning
    constexpr double kMost = 1e2;
    Mass shift{Vector::Zero(model_.num_dofs()), {}};
    for (double size = kLeast; size < kMost; size = std::max(1e-3, 10.0 * size)) {
      for (const DofBlock& block : model_.dofs.blocks()) {
        const double share = block.kind == DofKind::Position ? kHeld : size;
        shift.lumped.segment(block.first, block.count)
            .setConstant(share * assembler_.largest_diagonal(block, stiffness_.values()));
      }
      const Inertia inertia = stiffness_.factorize(1.0, shift);
      if (inertia.factorised && inertia.negative_pivots == 0) break;
    }
    Vector torque = force_ - stiffness_.gradient();
    torque.head(model_.dofs.num_positions()).setZero();
    Vector free = torque(model_.dofs.free());
    stiffness_.solve(free);
    Vector turned = Vector::Zero(model_.num_dofs());
    turned(model_.dofs.free()) = free;
    turned.head(model_.dofs.num_positions()).setZero();
    return turned;
  }

  /// The force [N] that is left over on the free nodes of a chain, at the shape evaluated last.
  [[nodiscard]] double unbalanced(const SectionChain& chain) const {
    const Vector force = force_ - stiffness_.gradient();
    double sum = 0.0;
    const auto add = [&](Index node) {
      for (Index dof = node; dof < node + model_.dimension; ++dof) {
        if (model_.dofs.is_free(dof)) sum += force[dof] * force[dof];
      }
    };
    for (const Link& link : chain.links) {
      if (link.before >= 0) add(model_.framed_edges[to_size(link.before)].end);
    }
    return std::sqrt(sum);
  }

  /// Twists a chain by two turns more or less, as often as that leaves the nodes in balance, where
  /// they were not.
  void find_turn(const SectionChain& chain, double turn) {
    constexpr int kMostTurns = 10;
    constexpr double kBalanced = 0.1;     // share of the force left over
    constexpr double kNegligible = 1e-6;  // of the force that two turns more exert
    const double first = unbalanced(chain);
    const double length = chain.rod->rest_length();
    if (first <= kNegligible * 4.0 * kPi * chain.rod->GJ / (length * length)) return;
    const Vector positions = state_.positions;
    const Vector followed = state_.followed;
    double least = kBalanced * first;
    Vector best_positions = positions;
    Vector best_followed = followed;
    for (const double way : {1.0, -1.0}) {
      double last = first;
      for (int i = 1; i <= kMostTurns; ++i) {
        twist_evenly(chain, turn + way * 4.0 * kPi * i);
        balance_sections();
        const double left = unbalanced(chain);
        if (left >= last) break;
        last = left;
        if (left >= least) continue;
        least = left;
        best_positions = state_.positions;
        best_followed = state_.followed;
      }
    }
    state_.positions = best_positions;
    state_.followed = best_followed;
  }

  const Model& model_;
  const Assembler& assembler_;
  Stiffness stiffness_;
  State& state_;
  const std::vector<SectionChain> chains_;
  Vector controls_;
  Vector force_;  // of the loads [N]
};

}  // namespace

void follow_written_shape(const Model& model, const Assembler& assembler, LinearSolver& solver,
                          bool angles_are_written, const CancelCallback& beat, State& state) {
  if (model.framed_edges.empty()) {
    follow_written(model, state);
  } else if (angles_are_written) {
    follow_written_angles(model, state);
  } else if (!lost_angles(model, state)) {
    follow(model, state);
  } else {
    WrittenSections(model, assembler, solver, beat, state).find();
    follow(model, state);
  }
}

}  // namespace der
