#pragma once

#include <optional>

#include "der/lanes/member_model.hpp"
#include "der/solvers/member_band.hpp"

namespace der {

/// The mass matrices of several members, factorised once. Each member has, to the last bit, what
/// MassSolver gives without damping.
template <class T>
class MemberMass {
 public:
  /// Whether there are kernels for the mass matrix of a model.
  static bool suits(const Model& model);
  explicit MemberMass(const MemberModel<T>& model);

  /// Sets `b` (all degrees of freedom) to M^-1 b, zero on held ones.
  void solve(MemberVector<T>& b);

 private:
  const MemberModel<T>& model_;
  std::optional<MemberBand<T>> band_;  // none: the matrix is diagonal
  MemberVector<T> free_;
};

}  // namespace der
