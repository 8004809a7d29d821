// Numbers side by side in a register: the operations that members in lanes need.
#include "der/core/lanes.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "der/assembly/member_lanes.hpp"
#include "der/core/sum_of.hpp"

namespace der::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST_CASE("the larger magnitude of each lane has NaN above infinity") {
  const FourLanes a(-3.0, 1.0, kInfinity, 0.0);
  const FourLanes b(2.0, -5.0, kNan, -0.0);
  const FourLanes larger = FourLanes::larger_magnitude(a, b);
  CHECK(larger.lane(0) == 3.0);
  CHECK(larger.lane(1) == 5.0);
  CHECK(std::isnan(larger.lane(2)));
  CHECK(larger.lane(3) == 0.0);
  CHECK_FALSE(std::signbit(larger.lane(3)));
}

TEST_CASE("positive are numbers above zero, infinity and NaN are not") {
  const EightLanes x(1.0, 0.0, -1.0, kInfinity, kNan, 1e-320, -kInfinity, 1e308);
  const EightLanes positive = EightLanes::is_positive(x);
  const double expected[] = {1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0};
  for (int lane = 0; lane < 8; ++lane) CHECK(positive.lane(lane) == expected[lane]);
}

TEST_CASE("a lane that is not selected keeps its number, whatever the other one is") {
  const FourLanes kept = FourLanes::select({1.0, 0.0, 1.0, 0.0}, {1.0, kNan, -0.0, 4.0}, 7.0);
  CHECK(kept.lane(0) == 1.0);
  CHECK(kept.lane(1) == 7.0);
  CHECK(std::signbit(kept.lane(2)));
  CHECK(kept.lane(3) == 7.0);
}

TEST_CASE("numbers of members go into their lanes and out again, and sums are those of one alone") {
  constexpr Index kSize = 11;
  Vector one(kSize);
  for (Index i = 0; i < kSize; ++i) one[i] = std::sin(1.0 + i) * std::pow(10.0, i % 5);
  MemberVector<EightLanes> all(kSize);
  for (int lane = 0; lane < 8; ++lane) all.set_lane(lane, (lane + 1) * one);
  Vector out(kSize);
  all.get_lane(5, out);
  CHECK(out == 6.0 * one);
  const EightLanes sums = sum_of<EightLanes>(kSize, [&](Index i) { return all[i]; });
  for (int lane = 0; lane < 8; ++lane) {
    const Vector own = (lane + 1) * one;
    CHECK(sums.lane(lane) == sum_of<double>(kSize, [&](Index i) { return own[i]; }));
  }
}

}  // namespace
}  // namespace der::test
