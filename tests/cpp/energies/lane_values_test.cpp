// Kernels in lanes: each lane has, to the last bit, what the kernel gives of its element alone.
#include "der/energies/lane_values.hpp"

#include <doctest/doctest.h>

#include <array>

#include "der/assembly/member_lanes.hpp"
#include "der/core/index.hpp"
#include "der/core/sanitizer.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/registry.hpp"
#include "energies/sample_elements.hpp"

namespace der::test {
namespace {

constexpr int kSamples = 50;

/// Gives `other` what is the same in all lanes.
template <class Kernel>
struct Share {
  static void from(const typename Kernel::Constants& /*first*/,
                   typename Kernel::Constants& /*other*/) {}
};
template <class Curvature>
struct Share<SpatialClamp<Curvature>> {
  using Constants = typename SpatialClamp<Curvature>::Constants;
  static void from(const Constants& first, Constants& other) {
    other.side = first.side;
    other.holds_section = first.holds_section;
  }
};
template <class Kernel, class PivotKind>
struct Share<FromPivot<Kernel, PivotKind>> {
  using Constants = typename FromPivot<Kernel, PivotKind>::Constants;
  static void from(const Constants& first, Constants& other) {
    Share<Kernel>::from(first.element, other.element);
  }
};

template <Derivatives D, class Kernel, class T>
void check_lanes(Shape shape, Random& random) {
  constexpr int n = Kernel::kDofs;
  constexpr int lanes = LaneTraits<T>::kCount;
  std::array<typename Kernel::Constants, to_size(lanes)> constants;
  std::array<Configuration, to_size(lanes)> here;
  Eigen::Matrix<double, n, lanes> alone;
  Eigen::Matrix<T, n, 1> x;
  for (int lane = 0; lane < lanes; ++lane) {
    constants[to_size(lane)] = sample_constants(Kernel{}, random);
    Share<Kernel>::from(constants[0], constants[to_size(lane)]);
    here[to_size(lane)] = sample_configuration(random);
    alone.col(lane) = sample_positions<Kernel>(shape, random);
    sample_frames(Kernel{}, constants[to_size(lane)], alone.col(lane), random, here[to_size(lane)]);
    for (int i = 0; i < n; ++i) x[i].set_lane(lane, alone(i, lane));
  }
  const auto values = values_in_lanes<Kernel, T>([&](int lane) {
    return Kernel::values(constants[to_size(lane)], here[to_size(lane)].controls);
  });
  LocalTerm<n, T> all;
  Kernel::template evaluate<D, T>(values, x, all);
  for (int lane = 0; lane < lanes; ++lane) {
    LocalTerm<n> one;
    evaluate_element<Kernel, D>(constants[to_size(lane)], here[to_size(lane)], alone.col(lane),
                                one);
    CHECK(all.energy.lane(lane) == one.energy);
    if constexpr (D == Derivatives::Energy) continue;
    for (int i = 0; i < n; ++i) CHECK(all.gradient[i].lane(lane) == one.gradient[i]);
    if constexpr (D == Derivatives::Gradient) continue;
    for (int column = 0; column < n; ++column) {
      for (int row = column; row < n; ++row) {
        CHECK(all.hessian(row, column).lane(lane) == one.hessian(row, column));
      }
    }
  }
}

template <class Kernel, class T>
void check_lanes() {
  Random random(20261124);
  for (const Shape shape : kShapes) {
    for (int i = 0; i < kSamples; ++i) {
      check_lanes<Derivatives::Energy, Kernel, T>(shape, random);
      check_lanes<Derivatives::Gradient, Kernel, T>(shape, random);
      check_lanes<Derivatives::Hessian, Kernel, T>(shape, random);
    }
  }
}

}  // namespace

// About bits alone: with sanitizers the compiler takes minutes for all kernels.
#if !DER_HAS_SANITIZER
TEST_CASE("each lane has the bits of its element alone") {
  int kinds = 0;
  for_each_list(ElementLists{}, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (GoesInLanes<Kernel>::value) {
      ++kinds;
#define DER_CHECK_LANES(T) check_lanes<Kernel, T>();
      DER_FOR_MEMBER_LANES(DER_CHECK_LANES)
#undef DER_CHECK_LANES
    }
  });
  CHECK(kinds == 38);
}
#endif

}  // namespace der::test
