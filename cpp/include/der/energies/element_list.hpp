#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "der/core/types.hpp"

namespace der {

/// The internal damping of an element: the rates of its strains, those of StrainRate, bear the
/// loads `viscosity` times these, [N s/m] of an extension, [N m s] of curvatures and twist over its
/// cell. Of one strain the first entry counts. It is symmetric, with no negative eigenvalue but
/// that of an arc (ArcStretch), which takes out a part of another element.
struct DampedElement {
  std::size_t element = 0;  ///< its number in the list
  Mat3 viscosity = Mat3::Zero();
};

/// All elements of one kind: for each, the degrees of freedom it acts on (in the order in which its
/// kernel takes them) and its constants. Elements hold indices into a graph of nodes and edges, so
/// nothing here knows about chains.
///
/// A `Kernel` is a struct with
///   static constexpr int kDofs;              number of coordinates of the stencil
///   static constexpr EnergyTerm kTerm;       what its energy is counted under
///   struct Constants;                        of one element, fixed during a run
///   template <Derivatives D>
///   static void evaluate(const Constants&, const Configuration& here,
///                        const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out);
/// and, if its energy changes with a translation of the element, so that statics count it as a
/// support, the stiffness [N/m] against moving along x (0), y (1) or z (2), 0 where it does not
/// hold:
///   static double holding_stiffness(const Constants&, int component);
/// Kernels that members of a batch evaluate in lanes are written for every number type. Their
/// `evaluate` above calls, with `values` of the constants, one of the numbers that they compute
/// with:
///   template <class T> struct Values;        with fields(), a tuple of references to its members
///   static Values<double> values(const Constants&, const Vector& controls);
///   template <Derivatives D, class T>
///   static void evaluate(const Values<T>&, const Eigen::Matrix<T, kDofs, 1>& x,
///                        LocalTerm<kDofs, T>& out);
template <class Kernel>
struct ElementList {
  using KernelType = Kernel;
  std::vector<std::array<Index, Kernel::kDofs>> dofs;
  std::vector<typename Kernel::Constants> constants;
  std::vector<DampedElement> damped;  ///< those with internal damping

  [[nodiscard]] std::size_t size() const noexcept { return dofs.size(); }
  void add(const std::array<Index, Kernel::kDofs>& element_dofs,
           const typename Kernel::Constants& element_constants) {
    dofs.push_back(element_dofs);
    constants.push_back(element_constants);
  }
};

template <class Kernel, class = void>
struct HoldsElement : std::false_type {};
template <class Kernel>
struct HoldsElement<Kernel, std::void_t<decltype(&Kernel::holding_stiffness)>> : std::true_type {};

}  // namespace der
