#include "der/statics/written_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
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

  /// Returns the names of the rods whose whole turns the shape leaves open.
  std::set<std::string> find() {
    std::vector<ReferenceTurn> turns;
    for (const SectionChain& chain : chains_) {
      turns.push_back(chain.has_end() ? reference_turn(model_, chain, here()) : ReferenceTurn{});
      twist_evenly(chain, turns.back().turn);
    }
    balance_sections();
    std::set<std::string> open;
    for (std::size_t i = 0; i < chains_.size(); ++i) {
      const bool told = find_balance(chains_[i], turns[i].turn);
      // From there on the next value is about as near to the turns of the clamps.
      const bool near = std::abs(turns[i].turn - turns[i].of_clamps) < kPi;
      if (chains_[i].keeps_twist() && !told && !near) open.insert(chains_[i].rod->name);
    }
    return open;
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

  /// Turns the sections of a chain away from where `twist_evenly` put them: those far from what
  /// holds them by `most` [rad].
  void twist_unevenly(const SectionChain& chain, double most) {
    std::vector<Index> edges;
    if (!chain.links.front().leaves_clamp()) edges.push_back(chain.first_edge());
    for (const Link& link : chain.links) {
      const bool closes_ring = chain.is_ring() && &link == &chain.links.back();
      if (!link.arrives() && !closes_ring) edges.push_back(link.after);
    }
    const bool held_twice = chain.keeps_twist();
    const bool from_end = chain.end_is_held() && !chain.start_is_held();
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const double along = (static_cast<double>(i) + 0.5) / static_cast<double>(edges.size());
      const double share = held_twice ? std::sin(kPi * along) : (from_end ? 1.0 - along : along);
      angle(edges[i]) += most * share;
    }
  }

  /// Looks for sections that leave the nodes of a chain in balance, where they are not: twisted by
  /// two turns more or less, as often as that brings the nodes nearer to it, and from other starts,
  /// since sections that bend more easily one way than another may rest in several ways. Returns
  /// whether the shape tells the turns: far less force is left over than with any other number.
  bool find_balance(const SectionChain& chain, double turn) {
    constexpr int kMostTurns = 10;
    constexpr double kBalanced = 0.1;     // share of the force left over
    constexpr double kNegligible = 1e-6;  // of the force that two turns more exert
    constexpr std::array<double, 8> kStarts{1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 4.0, -4.0};
    const double length = chain.rod->rest_length();
    const double negligible = kNegligible * 4.0 * kPi * chain.rod->GJ / (length * length);
    struct Found {
      double left = std::numeric_limits<double>::infinity();  // [N]
      int turns = 0;                                          // pairs of them that are added
      Vector positions;
      Vector followed;
    };
    const double first = unbalanced(chain);
    const Found start{first, 0, state_.positions, state_.followed};
    Found best = start;
    std::map<int, double> least{{0, first}};  // [N] left over, by the pairs of turns
    const auto attempt = [&](int turns, double uneven) {
      twist_evenly(chain, turn + 4.0 * kPi * turns);
      twist_unevenly(chain, uneven * 0.5 * kPi);
      balance_sections();
      const double left = unbalanced(chain);
      const auto known = least.emplace(turns, left).first;
      known->second = std::min(known->second, left);
      if (left < best.left) best = {left, turns, state_.positions, state_.followed};
      return left;
    };
    const bool has_turns = chain.has_end() && chain.keeps_twist();
    if (has_turns) {
      for (const int way : {1, -1}) {
        double last = first;
        for (int i = 1; i <= kMostTurns; ++i) {
          const double left = attempt(way * i, 0.0);
          if (left >= last) break;
          last = left;
        }
      }
    }
    const int nearest = best.turns;
    for (const int turns : {nearest, nearest + 1, nearest - 1}) {
      for (const double uneven : kStarts) {
        if (best.left > negligible && (has_turns || turns == nearest)) attempt(turns, uneven);
      }
    }
    const bool better = best.left < kBalanced * first;
    const Found& taken = better ? best : start;
    state_.positions = taken.positions;
    state_.followed = taken.followed;
    return std::all_of(least.begin(), least.end(), [&](const auto& other) {
      return other.first == taken.turns || taken.left < kBalanced * other.second;
    });
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

std::vector<std::string> follow_written_shape(const Model& model, const Assembler& assembler,
                                              LinearSolver& solver, bool angles_are_written,
                                              const CancelCallback& beat, State& state) {
  std::vector<std::string> warnings;
  if (model.framed_edges.empty()) {
    follow_written(model, state);
  } else if (angles_are_written) {
    follow_written_angles(model, state);
  } else if (!lost_angles(model, state)) {
    follow(model, state);
  } else {
    for (const std::string& rod : WrittenSections(model, assembler, solver, beat, state).find()) {
      warnings.push_back(fmt::format(
          "the positions that were written do not tell by how many whole turns rod '{}' is "
          "twisted: the number nearest to the turns of its clamps was taken. Write theta as well",
          rod));
    }
    follow(model, state);
  }
  return warnings;
}

}  // namespace der
