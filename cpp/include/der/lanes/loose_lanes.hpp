#pragma once

#include <memory>
#include <vector>

#include "der/assembly/assembler.hpp"
#include "der/assembly/member_lanes.hpp"

namespace der {

/// The elements of one kind outside of chains, of several members in lanes.
template <class T>
class OffChainKind {
 public:
  OffChainKind() = default;
  OffChainKind(const OffChainKind&) = delete;
  OffChainKind& operator=(const OffChainKind&) = delete;
  virtual ~OffChainKind() = default;
  /// Takes the frames of edges from the controls of the members at the start of a step.
  virtual void follow(const MemberConfigurations<T>& here) = 0;
  /// Adds to `gradient` (all degrees of freedom).
  virtual void add_gradient(const MemberVector<T>& coordinates,
                            MemberVector<T>& gradient) const = 0;
  /// Adds to `gradient` likewise, and the Hessian to the matrix's `values`.
  virtual void add_hessian(const MemberVector<T>& coordinates, MemberVector<T>& gradient,
                           MemberVector<T>& values) const = 0;
};

/// All kinds that go in lanes (energies/lane_values.hpp) and that the models have outside of
/// chains. Their elements follow frames, but no other control (`suits_lanes`).
template <class T>
std::vector<std::unique_ptr<OffChainKind<T>>> loose_kinds(const Assembler& assembler,
                                                          const MemberModels<T>& models);

}  // namespace der
