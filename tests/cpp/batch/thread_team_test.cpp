// Threads that share out items.
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "der/batch/thread_team.hpp"

namespace der::test {
namespace {

const auto no_beat = [] {};

TEST_CASE("a team does every item once, call after call") {
  for (const int size : {1, 2, 3, 16}) {
    ThreadTeam team(size);
    CHECK(team.size() == size);
    for (const std::size_t count : {0U, 1U, 2U, 17U, 1000U}) {
      std::vector<int> done(count, 0);
      team.for_each(
          count, [&](std::size_t item, bool, const ThreadTeam::Call&) { ++done[item]; }, no_beat);
      CHECK(std::all_of(done.begin(), done.end(), [](int times) { return times == 1; }));
    }
  }
}

TEST_CASE("what an item throws ends the call, and the team goes on") {
  ThreadTeam team(4);
  std::atomic<int> done{0};
  const auto work = [&](std::size_t item, bool, const ThreadTeam::Call&) {
    if (item == 5) throw std::runtime_error("item 5");
    ++done;
  };
  CHECK_THROWS_WITH_AS(team.for_each(100000, work, no_beat), "item 5", std::runtime_error);
  CHECK(done < 99999);
  done = 0;
  team.for_each(100, [&](std::size_t, bool, const ThreadTeam::Call&) { ++done; }, no_beat);
  CHECK(done == 100);
}

TEST_CASE("the caller beats while it waits for others, and what that throws ends their work") {
  ThreadTeam team(2);
  std::atomic<bool> other_works{false};
  const auto work = [&](std::size_t, bool on_caller, const ThreadTeam::Call& call) {
    other_works = other_works || !on_caller;
    // The caller leaves an item to the other thread, which works until it is told to end.
    while (on_caller ? !other_works : !call.is_given_up()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  int beats = 0;
  const auto stop = [&] {
    if (++beats == 2) throw std::runtime_error("stop");
  };
  CHECK_THROWS_WITH_AS(team.for_each(2, work, stop), "stop", std::runtime_error);
}

}  // namespace
}  // namespace der::test
