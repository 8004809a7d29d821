#include "der/batch/thread_team.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <system_error>
#include <thread>
#include <vector>

namespace der {
namespace {

/// A thread takes this share of its fair share at once: little is left to wait for at the end, and
/// asking for more costs nothing beside the work.
constexpr std::size_t kPortions = 16;

constexpr std::chrono::milliseconds kBeat{50};

int team_size(int wanted, std::size_t most) {
  const auto size = wanted > 0 ? static_cast<std::size_t>(wanted)
                               : static_cast<std::size_t>(std::thread::hardware_concurrency());
  return static_cast<int>(std::max<std::size_t>(1, std::min(size, most)));
}

}  // namespace

struct ThreadTeam::Crew {
  const pid_t process = getpid();
  std::mutex mutex;
  std::condition_variable begins;
  std::condition_variable has_ended;
  Call* call = nullptr;  // null: there is nothing to take part in
  const Work* work = nullptr;
  std::uint64_t number = 0;  // of the call
  int at_work = 0;
  bool leaves = false;
  std::vector<std::thread> threads;

  void begin(Call& next, const Work& its_work) {
    {
      const std::lock_guard lock(mutex);
      call = &next;
      work = &its_work;
      ++number;
    }
    begins.notify_all();
  }

  void live() {
    std::uint64_t last = 0;
    std::unique_lock lock(mutex);
    while (true) {
      begins.wait(lock, [&] { return leaves || (call != nullptr && number != last); });
      if (leaves) return;
      last = number;
      ++at_work;
      Call& mine = *call;
      const Work& my_work = *work;
      lock.unlock();
      take_part(mine, my_work, false);
      lock.lock();
      if (--at_work == 0) has_ended.notify_one();
    }
  }

  /// Those who have not begun by now do not begin any more.
  void end(Call& ended, const std::function<void()>& beat) {
    std::unique_lock lock(mutex);
    call = nullptr;
    while (!has_ended.wait_for(lock, kBeat, [&] { return at_work == 0; })) {
      lock.unlock();
      try {
        if (beat) beat();
      } catch (...) {
        give_up(ended);
      }
      lock.lock();
    }
  }
};

ThreadTeam::ThreadTeam(int size, std::size_t most) : size_(team_size(size, most)) {}

ThreadTeam::~ThreadTeam() {
  abandon_crew_of_another_process();
  if (!crew_) return;
  {
    const std::lock_guard lock(crew_->mutex);
    crew_->leaves = true;
  }
  crew_->begins.notify_all();
  for (std::thread& thread : crew_->threads) thread.join();
}

/// Its threads are not here, and its lock may be held for ever: it is left in memory.
void ThreadTeam::abandon_crew_of_another_process() {
  if (!crew_ || crew_->process == getpid()) return;
  [[maybe_unused]] const Crew* const left = crew_.release();
}

void ThreadTeam::start_crew() {
  crew_ = std::make_unique<Crew>();
  try {
    for (int i = 1; i < size_; ++i) {
      crew_->threads.emplace_back([crew = crew_.get()] { crew->live(); });
    }
  } catch (const std::system_error&) {
    // The process may have no more: fewer do the same work.
  }
}

void ThreadTeam::give_up(Call& call) {
  const std::lock_guard lock(call.mutex_);
  if (!call.error_) call.error_ = std::current_exception();
  call.given_up_ = true;
}

void ThreadTeam::take_part(Call& call, const Work& work, bool on_caller) {
  try {
    while (!call.is_given_up()) {
      const std::size_t first = call.next_.fetch_add(call.stride_);
      if (first >= call.count_) return;
      const std::size_t end = std::min(first + call.stride_, call.count_);
      for (std::size_t item = first; item < end && !call.is_given_up(); ++item) {
        work(item, on_caller, call);
      }
    }
  } catch (...) {
    give_up(call);
  }
}

void ThreadTeam::for_each(std::size_t count, const Work& work, const std::function<void()>& beat) {
  Call call;
  call.count_ = count;
  call.stride_ = std::max<std::size_t>(1, count / (kPortions * static_cast<std::size_t>(size_)));
  if (size_ == 1 || count < 2) {
    take_part(call, work, true);
  } else {
    abandon_crew_of_another_process();
    if (!crew_) start_crew();
    crew_->begin(call, work);
    take_part(call, work, true);
    crew_->end(call, beat);
  }
  if (call.error_) std::rethrow_exception(call.error_);
}

}  // namespace der
