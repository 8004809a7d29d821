#include "der/lanes/member_groups.hpp"

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

#include "der/core/error.hpp"
#include "der/core/loops.hpp"
#include "der/lanes/lane_set.hpp"
#include "der/lanes/member_energies.hpp"
#include "der/lanes/member_stage.hpp"
#include "der/lanes/member_state.hpp"
#include "der/lanes/member_stepper.hpp"
#include "der/lanes/members.hpp"
#include "der/scenario/scenario.hpp"
#include "der/solvers/twisted_ldlt.hpp"
#include "der/steppers/tableau.hpp"
#include "simulation/stepper_options.hpp"

namespace der {
namespace {

template <class T>
constexpr std::size_t kLanes = to_size(LaneTraits<T>::kCount);

Elimination order_of(const Pattern& pattern) {
  return TwistedLdlt::suits(pattern) ? Elimination::FromBothEnds : Elimination::FromStart;
}

/// Memory in which one group works at a time.
template <class T>
struct Workspace {
  explicit Workspace(const Simulation& like)
      : stepper(
            *find_tableau(like.integrator().name), like.model(),
            MemberStage<T>(like.model(), MemberBand<T>(like.pattern(), order_of(like.pattern())))),
        state(like.model()) {}

  MemberStepper<T> stepper;
  MemberState<T> state;
};

/// Steps of the members of a group, in a workspace.
template <class T>
class Session {
 public:
  using Simulations = std::array<Simulation*, kLanes<T>>;

  /// `lanes`: those whose members take part.
  Session(const Simulations& simulations, LaneSet lanes, Members<T>& members,
          Workspace<T>& workspace)
      : simulations_(simulations),
        members_(members),
        stepper_(workspace.stepper),
        state_(workspace.state),
        has_frames_(!members.frames.empty()),
        taking_part_(lanes) {
    stepper_.serve(members);
    for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
      const Simulation& simulation = *simulations_[to_size(lane)];
      state_.load(lane, simulation.state());
      if (lanes.has(lane) && simulation.has_external_writes()) alone_.add(lane);
    }
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session() {
    for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
      if (taking_part_.has(lane) && !alone_.has(lane)) store(lane);
    }
  }

  /// Does a step. False: nobody takes part any more. Steps that members do alone take a while:
  /// `between_steps()` is called before each.
  template <class Fail, class BetweenSteps>
  bool step(const Fail& fail, const BetweenSteps& between_steps) {
    std::array<double, kLanes<T>> ends{};
    T dt = 1.0;
    LaneSet together;
    for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
      if (!taking_part_.has(lane) || alone_.has(lane)) continue;
      const Simulation& simulation = *simulations_[to_size(lane)];
      if (const auto end = simulation.end_of_plain_step()) {
        together.add(lane);
        ends[to_size(lane)] = *end;
        dt.set_lane(lane, *end - simulation.state().time);
      }
    }
    const LaneSet done = together.empty() ? together : stepper_.step(together, dt, state_);
    if (has_frames_) store_frames(done);
    LaneSet due;
    for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
      if (done.has(lane) && simulations_[to_size(lane)]->enter_step(
                                ends[to_size(lane)], stepper_.newton_iterations(lane))) {
        due.add(lane);
      }
    }
    const LaneSet others = taking_part_.without(done);
    if (!due.empty()) watch_energies(due, fail);
    for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
      if (!others.has(lane)) continue;
      between_steps();
      attempt(lane, fail, [&] { step_alone(lane); });
    }
    return !taking_part_.empty();
  }

 private:
  /// Elements that are evaluated one by one see those of the members' states.
  void store_frames(LaneSet lanes) {
    for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
      if (lanes.has(lane)) state_.store_frames(lane, simulations_[to_size(lane)]->state());
    }
  }
  void store(int lane) {
    Simulation& simulation = *simulations_[to_size(lane)];
    state_.store(lane, simulation.state());
    simulation.keep_steps();
  }
  void step_alone(int lane) {
    Simulation& simulation = *simulations_[to_size(lane)];
    if (!alone_.has(lane)) store(lane);
    alone_.add(lane);  // its state is the one to keep until it is loaded again
    simulation.step();
    state_.load(lane, simulation.state());
    alone_.remove(lane);
  }
  /// A look at the energies is due in all members at once, most often.
  template <class Fail>
  void watch_energies(LaneSet due, const Fail& fail) {
    members_.controls.evaluate_at_states();
    const auto energies = member_energies(members_, state_.positions, state_.velocities);
    for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
      if (!due.has(lane)) continue;
      Simulation& simulation = *simulations_[to_size(lane)];
      state_.store_works(lane, simulation.state());
      attempt(lane, fail, [&] { simulation.watch_energy(energies[to_size(lane)]); });
      if (!taking_part_.has(lane)) store(lane);
    }
  }
  /// A member for which `work()` throws takes part no more.
  template <class Fail, class Work>
  void attempt(int lane, const Fail& fail, const Work& work) {
    try {
      work();
    } catch (const Error& error) {
      taking_part_.remove(lane);
      fail(lane, error);
    }
  }

  const Simulations& simulations_;
  Members<T>& members_;
  MemberStepper<T>& stepper_;
  MemberState<T>& state_;
  bool has_frames_;
  LaneSet taking_part_;
  /// Members whose state is not in their lane: programs have written into it, or they are in a step
  /// of their own.
  LaneSet alone_;
};

template <class T>
class Groups final : public MemberGroups {
 public:
  explicit Groups(std::vector<Simulation*> members)
      : members_(std::move(members)), groups_((members_.size() + kLanes<T> - 1) / kLanes<T>) {}

  [[nodiscard]] int lanes() const override { return LaneTraits<T>::kCount; }

  void step(std::size_t number, const std::function<bool(std::size_t)>& takes_part,
            const std::function<bool()>& goes_on, const std::function<void()>& between_steps,
            const Fail& fail) override {
    const std::size_t first = number * kLanes<T>;
    const std::size_t count = std::min(kLanes<T>, members_.size() - first);
    LaneSet lanes;
    for (std::size_t lane = 0; lane < count; ++lane) {
      if (takes_part(first + lane)) lanes.add(static_cast<int>(lane));
    }
    if (lanes.empty()) return;
    std::unique_ptr<Group>& group = groups_[number];
    if (!group) group = std::make_unique<Group>(members_, first, count);
    std::unique_ptr<Workspace<T>> workspace = take_workspace();
    {
      Session<T> session(group->simulations, lanes, group->members, *workspace);
      const auto fail_in_lane = [&](int lane, const Error& error) {
        fail(first + to_size(lane), error);
      };
      while (goes_on() && session.step(fail_in_lane, between_steps)) {
      }
    }
    give_back(std::move(workspace));
  }

 private:
  struct Group {
    Group(const std::vector<Simulation*>& all, std::size_t first, std::size_t count)
        : simulations(in_lanes_of(all, first, count)),
          members(each([](const Simulation& one) { return &one.model(); }),
                  each([](const Simulation& one) { return &one.state(); }),
                  each([](const Simulation& one) { return &one.assembler(); }),
                  each([](const Simulation& one) {
                    return stepper_options(one.scenario().scene()).newton;
                  }),
                  find_tableau(all[first]->integrator().name)->explicit_first) {}

    /// Lanes without a member of their own have that of the first.
    static typename Session<T>::Simulations in_lanes_of(const std::vector<Simulation*>& all,
                                                        std::size_t first, std::size_t count) {
      typename Session<T>::Simulations lanes;
      lanes.fill(all[first]);
      std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(first), count, lanes.begin());
      return lanes;
    }
    template <class Value>
    auto each(const Value& value) const {
      std::array<decltype(value(*simulations[0])), kLanes<T>> values;
      std::transform(simulations.begin(), simulations.end(), values.begin(),
                     [&](const Simulation* one) { return value(*one); });
      return values;
    }

    typename Session<T>::Simulations simulations;
    Members<T> members;
  };

  std::unique_ptr<Workspace<T>> take_workspace() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<Workspace<T>> workspace = std::move(idle_.back());
        idle_.pop_back();
        return workspace;
      }
    }
    return std::make_unique<Workspace<T>>(*members_.front());
  }
  void give_back(std::unique_ptr<Workspace<T>> workspace) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(workspace));
  }

  std::vector<Simulation*> members_;
  std::vector<std::unique_ptr<Group>> groups_;  // each is made when it is first stepped
  std::mutex mutex_;                            // of `idle_`
  std::vector<std::unique_ptr<Workspace<T>>> idle_;
};

/// Whether supports hold the same degrees of freedom in the same order, and they and gravity follow
/// the same tables.
bool follow_alike(const Model& first, const Model& other) {
  return first.tables.size() == other.tables.size() &&
         first.gravity_controls == other.gravity_controls &&
         std::equal(first.held.begin(), first.held.end(), other.held.begin(), other.held.end(),
                    [](const HeldDof& a, const HeldDof& b) {
                      return a.dof == b.dof && a.displacement == b.displacement;
                    });
}

/// Whether clamps hold the tangent, and the section, at the same places.
bool clamps_alike(const Model& first, const Model& other) {
  return std::equal(first.rods.begin(), first.rods.end(), other.rods.begin(),
                    [](const RodMesh& a, const RodMesh& b) {
                      return std::equal(a.clamps.begin(), a.clamps.end(), b.clamps.begin(),
                                        b.clamps.end(), [](const Clamp& x, const Clamp& y) {
                                          return x.place == y.place &&
                                                 x.holds_section == y.holds_section;
                                        });
                    });
}

/// Whether the steps of a member are of the same kind as those of the first one.
bool are_alike(const Simulation& first, const Simulation& other) {
  return first.integrator().name == other.integrator().name &&
         first.linear_solver() == other.linear_solver() &&
         first.model().damped == other.model().damped && !other.adaptive() &&
         suits_lanes(other.model()) && follow_alike(first.model(), other.model()) &&
         clamps_alike(first.model(), other.model());
}

/// Whether there are steps in lanes for members like this one.
bool has_plain_steps(const Simulation& like) {
  if (like.model().has_rotations()) return false;  // each step settles them
  const Tableau* tableau = find_tableau(like.integrator().name);
  if (tableau == nullptr || like.linear_solver() != "banded") return false;
  return MemberBand<FourLanes>::suits(like.pattern()) &&
         (!tableau->explicit_first || MemberMass<FourLanes>::suits(like.model()));
}

}  // namespace

std::unique_ptr<MemberGroups> MemberGroups::make(const std::vector<Simulation*>& members,
                                                 int threads) {
  const auto fills = [&](std::size_t lanes) {
    return members.size() >= lanes * static_cast<std::size_t>(threads);
  };
  const auto is_alike = [&](const Simulation* each) { return are_alike(*members.front(), *each); };
  if (!fills(4) || !std::all_of(members.begin(), members.end(), is_alike)) return nullptr;
  if (!has_plain_steps(*members.front())) return nullptr;
#ifdef DER_HAS_WIDE_LOOPS
  if (loops() == SimdLevel::Avx512 && fills(8))
    return std::make_unique<Groups<EightLanes>>(members);
#endif
  return std::make_unique<Groups<FourLanes>>(members);
}

}  // namespace der
