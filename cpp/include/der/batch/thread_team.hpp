#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>

namespace der {

/// Threads that do many independent items of work together, each taking the next ones as soon as it
/// has done its last: which thread does which item is left to chance.
///
/// The caller's thread is one of the team. The others start when they are first needed, sleep
/// between two calls, and end with the team. A process that was forked from the one in which they
/// ran has none of them and starts its own.
class ThreadTeam {
 public:
  /// The data common to all items of one call.
  class Call {
   public:
    /// Whether an exception was thrown: work that goes on for long ends early then.
    [[nodiscard]] bool is_given_up() const { return given_up_.load(std::memory_order_relaxed); }

   private:
    friend class ThreadTeam;
    std::size_t count_ = 0;
    std::size_t stride_ = 1;  // items that a thread takes at once
    std::atomic<std::size_t> next_{0};
    std::atomic<bool> given_up_{false};
    std::mutex mutex_;          // of `error_`
    std::exception_ptr error_;  // the first
  };

  /// `on_caller` tells work that is done in the caller's thread.
  using Work = std::function<void(std::size_t item, bool on_caller, const Call& call)>;

  /// `size` threads, but no more than `most`; 0: as many as the process may run at once.
  explicit ThreadTeam(int size = 0, std::size_t most = std::numeric_limits<std::size_t>::max());
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  [[nodiscard]] int size() const { return size_; }

  /// Does `work` for each item from 0 to `count` - 1, and returns when all is done. The caller's
  /// thread calls `beat`, if there is one, now and then while it waits for others. The first
  /// exception that `work` or `beat` throws is thrown here, after the items that were begun have
  /// ended; the rest is then left undone.
  void for_each(std::size_t count, const Work& work, const std::function<void()>& beat);

 private:
  struct Crew;  // the threads besides the caller's
  void start_crew();
  void abandon_crew_of_another_process();
  static void take_part(Call& call, const Work& work, bool on_caller);
  static void give_up(Call& call);

  int size_;
  std::unique_ptr<Crew> crew_;  // null until it is needed
};

}  // namespace der
