#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "der/batch/thread_team.hpp"
#include "der/core/cancel_callback.hpp"
#include "der/core/error.hpp"
#include "der/core/types.hpp"
#include "der/lanes/member_groups.hpp"
#include "der/output/flush_timer.hpp"
#include "der/output/probe.hpp"
#include "der/scenario/value_override.hpp"
#include "der/simulation.hpp"

namespace der {

/// Rows follow one another in memory.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A value of the scene that differs from member to member.
struct Variation {
  std::string path;                     ///< as an override names it: `rods.arm.cross_section...`
  std::vector<scenario::Value> values;  ///< one for each member
};

/// Why a member goes on no more.
struct MemberFailure {
  std::string status;  ///< of the error, as in `summary.json`
  double time = 0.0;   ///< [s] of its last good state
  std::string message;
  std::exception_ptr error;  ///< as it was thrown
};

/// Many simulations of one scene, its members, advanced side by side by several threads.
///
/// Each member has to the last bit what a Simulation of its scene has, whatever the number of
/// threads: no member reads anything of another one that changes. Their numbers may differ, not
/// their structure (`structural_difference`), and what stays constant and is equal in all is there
/// once.
///
/// A member that fails is masked: it keeps its last good state and the reason, and takes no part
/// until it is reset. The others go on.
///
/// Positions, velocities and written forces stand in arrays with a row for each member, one entry a
/// degree of freedom. Programs read and write these between two calls; each call takes a member's
/// rows into its state before it does anything with it, and writes them back afterwards. One thread
/// at a time may call.
class Batch {
 public:
  /// A beat is called now and then in the caller's thread. What it throws ends a call early, each
  /// member between two of its steps, or in the state that it had before a search.
  ///
  /// `threads`: how many at once, of which there are no more than members; 0: as many as the
  /// process may run. Throws SceneError or Error where a member cannot be simulated, and names the
  /// first one. A member that does not get to the start that `start_from` asks for has failed.
  Batch(const Scenario& scenario, std::size_t members, const std::vector<Variation>& variations,
        int threads, const CancelCallback& beat);
  Batch(const Batch&) = delete;
  Batch& operator=(const Batch&) = delete;

  [[nodiscard]] std::size_t size() const { return members_.size(); }
  [[nodiscard]] int threads() const { return team_.size(); }
  /// How many members do their steps together, in the lanes of one register; 1: each alone.
  [[nodiscard]] int lanes() const { return groups_ ? groups_->lanes() : 1; }
  /// The simulation of a member; what its rows say may be newer.
  [[nodiscard]] const Simulation& member(std::size_t number) const;
  /// The model of the first member, of which all have the structure.
  [[nodiscard]] const Model& model() const { return members_.front().simulation->model(); }

  /// Advances every member by `count` steps of its scene. Throws Error if the scene is static.
  void step(std::int64_t count, const CancelCallback& beat);
  /// Moves every member to its equilibrium, as Simulation::equilibrium. The reports; none of
  /// members that have failed.
  std::vector<std::optional<EquilibriumReport>> equilibrium(bool leave_saddles,
                                                            const CancelCallback& beat);

  /// Values of one name of the scene, a row for each member.
  struct Setting {
    std::string name;
    RowMatrix values;
  };
  /// Sets all of these in every member that has not failed, as Simulation::set. Throws Error, which
  /// names the member, and then sets nothing.
  void set(const std::vector<Setting>& settings, std::optional<double> over);
  /// The warnings of `set` for the first such member, with the number of others.
  [[nodiscard]] std::vector<std::string> take_warnings();
  /// Values of a component that a support prescribes, one for each member.
  struct Prescription {
    std::string component;
    Vector values;
  };
  /// The same with Simulation::prescribe.
  void prescribe(std::size_t support, const std::vector<Prescription>& prescriptions);
  /// Present values of a name, a row for each member.
  [[nodiscard]] RowMatrix value(const std::string& name) const;

  /// A copy of a member's state, with what was written into its rows.
  [[nodiscard]] State save(std::size_t member);
  /// Brings a member to a state and takes it in again if it had failed; null: to its start. One
  /// that has not got to its start stays failed there. Throws Error where the state does not fit.
  void reset(std::size_t member, const State* saved);

  // Arrays that keep their place in memory for the life of the batch.
  [[nodiscard]] RowMatrix& positions() { return positions_; }      ///< [m]
  [[nodiscard]] RowMatrix& velocities() { return velocities_; }    ///< [m/s]
  [[nodiscard]] RowMatrix& extra_force() { return extra_force_; }  ///< [N]
  [[nodiscard]] Vector& time() { return time_; }                   ///< [s] of each member
  [[nodiscard]] std::vector<std::int64_t>& step_count() { return step_count_; }  ///< of each
  [[nodiscard]] std::vector<unsigned char>& failed() { return failed_; }         ///< 0 or 1
  /// Whether the time integrator of a member has created energy (EnergyMonitor): 0 or 1.
  [[nodiscard]] std::vector<unsigned char>& unreliable() { return unreliable_; }
  /// The scene's probes, a row for each with a value for each member, of the present rows. From the
  /// first time that they are asked for, every call keeps them up to date.
  RowMatrix& probes(const CancelCallback& beat);
  [[nodiscard]] std::vector<std::string> probe_names() const;

  /// By the numbers of the members.
  [[nodiscard]] const std::map<std::size_t, MemberFailure>& failures() const { return failures_; }

 private:
  struct Member {
    std::unique_ptr<Simulation> simulation;
    std::shared_ptr<const State> start;  // null: it has not got there
    std::vector<Probe> probes;           // none until they are asked for
  };

  void build(const Scenario& scenario, const std::vector<Variation>& variations,
             const CancelCallback& beat);
  void make_arrays();
  void start_alike(const CancelCallback& beat);
  void start_each(const CancelCallback& beat);
  void start(std::size_t number, const CancelCallback& look);
  void poll_cancel(const CancelCallback& beat);
  /// For long work on one thread: calls the beat if that is the caller's, and throws once the call
  /// is given up.
  void look(bool on_caller, const ThreadTeam::Call& call, const CancelCallback& beat);
  /// Calls `work(number, look)` for all members, on all threads, with `look()` as above.
  template <class Work>
  void all(const Work& work, const CancelCallback& beat);
  /// Calls `work(number, look)` for those that have not failed, with their rows in their states;
  /// one for which it throws Error has failed.
  template <class Work>
  void all_that_go_on(const Work& work, const CancelCallback& beat);
  /// Does `change` for all members that have not failed, or for none if it throws.
  template <class Change>
  void change_ramps(const Change& change);
  void step_in_lanes(std::int64_t count, const CancelCallback& beat);
  void fail(std::size_t number, const Error& error);
  void take_rows(std::size_t number);
  void write_rows(std::size_t number);
  void read_probes(std::size_t number);
  [[nodiscard]] State& state(std::size_t number) { return members_[number].simulation->state(); }

  ThreadTeam team_;
  FlushTimer pacer_{FlushTimer::Seconds{0.05}};  // of the beats between steps
  std::vector<Member> members_;
  std::unique_ptr<MemberGroups> groups_;  // null: no lanes
  RowMatrix positions_;
  RowMatrix velocities_;
  RowMatrix extra_force_;
  RowMatrix probes_;
  Vector time_;
  std::vector<std::int64_t> step_count_;
  std::vector<unsigned char> failed_;
  std::vector<unsigned char> unreliable_;
  std::mutex mutex_;  // of `failures_`
  std::map<std::size_t, MemberFailure> failures_;
};

}  // namespace der
