#pragma once

#include <cstdint>
#include <string>
#include <string_view>

/// Numbers as people read them.
namespace der::app {

/// "12,300"
std::string format_count(std::int64_t number);
/// "1 step", "12,300 steps"
std::string format_count(std::int64_t number, std::string_view what);
/// Time spent: "12.3 ms", "1.23 s", "3 min 5 s"
std::string format_seconds(double seconds);
/// Time to go: "12 s", "3:05 min", "2:03:04 h"
std::string format_time_left(double seconds);
/// `time` with as many decimals as make a thousandth of `duration` visible.
std::string format_time(double time, double duration);

}  // namespace der::app
