#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "der/core/lanes.hpp"
#include "der/core/types.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/spatial_bend.hpp"

namespace der {

/// Whether a kernel is written for every number type (energies/element_list.hpp).
template <class Kernel, class = void>
struct HasValues : std::false_type {};
template <class Kernel>
struct HasValues<Kernel, std::void_t<typename Kernel::template Values<double>>> : std::true_type {};

/// Whether members of a batch evaluate a kernel in lanes.
template <class Kernel>
struct GoesInLanes : HasValues<Kernel> {};
template <class Kernel, class PivotKind>
struct GoesInLanes<FromPivot<Kernel, PivotKind>> : HasValues<Kernel> {};

/// Whether the values of a kernel change from step to step, with the frames of edges.
template <class Kernel>
struct FollowsFrames : std::false_type {};
template <class Curvature, class AVertex>
struct FollowsFrames<SpatialBend<Curvature, AVertex>> : std::true_type {};
template <class Curvature>
struct FollowsFrames<SpatialClamp<Curvature>> : std::true_type {};
template <class Kernel, class PivotKind>
struct FollowsFrames<FromPivot<Kernel, PivotKind>> : FollowsFrames<Kernel> {};

template <class T>
void set_lane(T& all, int lane, double value) {
  all.set_lane(lane, value);
}
template <class T, int Rows, int Columns>
void set_lane(Eigen::Matrix<T, Rows, Columns>& all, int lane,
              const Eigen::Matrix<double, Rows, Columns>& value) {
  for (Index i = 0; i < all.size(); ++i) all(i).set_lane(lane, value(i));
}
template <class Fields, class Numbers, std::size_t... I>
void set_lane(const Fields& all, int lane, const Numbers& value,
              std::index_sequence<I...> /*fields*/) {
  (set_lane(std::get<I>(all), lane, std::get<I>(value)), ...);
}

/// Values of a kernel of which lane l has those of `of(l)`.
template <class Kernel, class T, class Of>
typename Kernel::template Values<T> values_in_lanes(const Of& of) {
  typename Kernel::template Values<T> all;
  const auto fields = all.fields();
  for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
    typename Kernel::template Values<double> one = of(lane);
    set_lane(fields, lane, one.fields(),
             std::make_index_sequence<std::tuple_size_v<decltype(fields)>>{});
  }
  return all;
}

}  // namespace der
