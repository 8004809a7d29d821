#include "der/app/progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>

#include "der/app/format.hpp"
#include "der/app/terminal.hpp"

namespace der::app {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr Seconds kInterval{0.1};
/// A run shorter than this shows no progress.
constexpr Seconds kPatience{0.3};
/// The speed is averaged over about this time.
constexpr Seconds kMemory{3.0};
constexpr int kLongestBar = 30;
constexpr int kShortestBar = 6;

std::string bar(double share, int width) {
  const int full = static_cast<int>(std::floor(share * width));
  return fmt::format("[{:#<{}}{:-<{}}]", "", full, "", width - full);
}

}  // namespace

std::string progress_line(double share, const std::vector<std::string>& details,
                          std::optional<double> seconds_left, int width) {
  const std::string percent = fmt::format("{:3.0f} %", std::floor(100.0 * share));
  const std::string left =
      seconds_left ? "  " + format_time_left(*seconds_left) + " left" : std::string();
  for (std::size_t kept = details.size() + 1; kept-- > 0;) {
    std::string tail;
    for (std::size_t i = 0; i < kept; ++i) tail += "  " + details[i];
    tail += left;
    const int room = width - static_cast<int>(percent.size() + tail.size()) - 3;
    if (room >= kShortestBar) {
      return percent + " " + bar(share, std::min(room, kLongestBar)) + tail;
    }
  }
  return percent.substr(0, static_cast<std::size_t>(std::max(0, width)));
}

std::string progress_line(const RunPosition& p, double steps_per_second, int width) {
  const double share =
      static_cast<double>(p.step) / static_cast<double>(std::max<std::int64_t>(1, p.total_steps));
  std::vector<std::string> details{
      fmt::format("t = {} of {:g} s", format_time(p.time, p.duration), p.duration)};
  std::optional<double> left;
  if (steps_per_second > 0.0) {
    details.push_back(format_count(std::llround(steps_per_second)) + " steps/s");
    left = static_cast<double>(p.total_steps - p.step) / steps_per_second;
  }
  return progress_line(share, details, left, width);
}

Progress::Progress(bool enabled) : enabled_(enabled && is_terminal(stderr)), pacer_(kInterval) {}

void Progress::measure_speed(std::int64_t step, Clock::time_point now) {
  const Seconds passed = now - last_time_;
  if (last_step_ >= 0 && passed.count() > 0.0) {
    const double recent = static_cast<double>(step - last_step_) / passed.count();
    const double weight = 1.0 - std::exp(-passed / kMemory);
    speed_ = speed_ > 0.0 ? speed_ + weight * (recent - speed_) : recent;
  }
  last_step_ = step;
  last_time_ = now;
}

void Progress::show(const RunPosition& position) {
  const auto now = Clock::now();
  measure_speed(position.step, now);
  if (now - start_ < kPatience) return;
  // One column is left free: a full line would wrap on some terminals.
  const std::string line = progress_line(position, speed_, terminal_width(stderr) - 1);
  std::fputs(("\r\x1b[K" + line).c_str(), stderr);
  std::fflush(stderr);
  shown_ = true;
}

void Progress::clear() {
  if (!shown_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  shown_ = false;
}

}  // namespace der::app
