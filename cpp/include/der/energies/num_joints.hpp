#pragma once

#include <type_traits>

namespace der {

/// Number of rotations of joints among the coordinates of a kernel, behind those of its nodes.
template <class Kernel, class = void>
struct NumJoints : std::integral_constant<int, 0> {};
template <class Kernel>
struct NumJoints<Kernel, std::void_t<decltype(Kernel::kJoints)>>
    : std::integral_constant<int, Kernel::kJoints> {};

}  // namespace der
