#include "der/output/flush_timer.hpp"

#include <algorithm>

namespace der {
namespace {

constexpr FlushTimer::Seconds kCheckInterval{0.5e-3};
constexpr std::int64_t kLargestStride = 1 << 16;

}  // namespace

bool FlushTimer::check() {
  const auto now = Clock::now();
  if (now - last_check_ < kCheckInterval) {
    stride_ = std::min(2 * stride_, kLargestStride);
  } else {
    stride_ = std::max<std::int64_t>(stride_ / 2, 1);
  }
  last_check_ = now;
  countdown_ = stride_;
  if (last_due_ && now - *last_due_ < interval_) return false;
  last_due_ = now;
  return true;
}

}  // namespace der
