#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <vector>

#include "der/core/error.hpp"
#include "der/simulation.hpp"

namespace der {

/// Simulations of one structure, the members of a batch, whose steps are done side by side in the
/// lanes of the processor's widest registers: those of one group, which follow one another. Each
/// has, to the last bit, what `Simulation::step` gives.
///
/// Plain steps are done together: those of equal length in which full Newton steps converge. A
/// member for which that is not so does the step alone, as if there were no others.
///
/// Threads may work on several groups at a time.
class MemberGroups {
 public:
  virtual ~MemberGroups() = default;

  /// Null where steps like theirs are not done in lanes, or there would be fewer groups than
  /// threads.
  static std::unique_ptr<MemberGroups> make(const std::vector<Simulation*>& members, int threads);

  /// How many members a group has; the last one may have fewer.
  [[nodiscard]] virtual int lanes() const = 0;
  /// Called for a member that takes part no more, as `Simulation::step` throws for it.
  using Fail = std::function<void(std::size_t member, const Error& error)>;
  /// Does steps of the members of a group for which `takes_part(member)`, as long as `goes_on()`.
  /// `between_steps()` is called before each step that a member does alone. Whatever throws leaves
  /// each of them between two of its steps.
  virtual void step(std::size_t group, const std::function<bool(std::size_t)>& takes_part,
                    const std::function<bool()>& goes_on,
                    const std::function<void()>& between_steps, const Fail& fail) = 0;
};

}  // namespace der
