#pragma once

#include "der/assembly/member_lanes.hpp"
#include "der/core/lane_pair.hpp"
#include "der/core/types.hpp"
#include "der/solvers/linear_solver.hpp"

namespace der {

/// The band matrices of several members, each in its lane, factorised as BandedLdlt and
/// TwistedLdlt do: of each member to the last bit as they would. Positive definite ones alone.
template <class T>
class MemberBand {
 public:
  /// Whether there are kernels for a matrix.
  static bool suits(const Pattern& pattern);
  /// For the values in the layout of TwistedLdlt or of BandedLdlt.
  MemberBand(const Pattern& pattern, Elimination order);

  /// The matrices' values, to be set before they are factorised, which overwrites them. They have a
  /// spare slot behind those of the layout.
  [[nodiscard]] MemberVector<T>& values() { return band_; }
  /// Factorises, and solves for the entries of `b`, in place. In each lane 1 if its matrix was
  /// positive definite, else 0: its solution is worth nothing then.
  T factorize_and_solve(MemberVector<T>& b);
  /// The same in two steps, for many right sides; for elimination from the start.
  T factorize();
  void solve(MemberVector<T>& b);

 private:
  struct Kernels {
    T (*factorize)(Index columns, T* band);
    void (*eliminate)(Index columns, const T* band, T* b);
    void (*substitute)(Index columns, const T* band, T* b);
    T (*factorize_and_eliminate)(Index columns, T* band, T* b);
    T (*factorize_and_eliminate_pairs)(Index columns, T* band, T* b);
    void (*substitute_pairs)(Index columns, const LanePair<T>* band, LanePair<T>* b);
  };
  static Kernels kernels_of(Index half_bandwidth);
  template <Index kWidth>
  static Kernels kernels();

  void clear_columns_behind();
  void take_right_side(const MemberVector<T>& b);
  void substitute(MemberVector<T>& b);
  T factorize_and_solve_from_both_ends(MemberVector<T>& b);
  [[nodiscard]] LanePair<T>* pairs(MemberVector<T>& numbers) {
    return reinterpret_cast<LanePair<T>*>(numbers.data());
  }

  Index size_ = 0;
  Index width_ = 0;
  Elimination order_;
  Index columns_ = 0;  ///< of each half (TwistedLdlt)
  Index padding_ = 0;
  Kernels kernels_;
  MemberVector<T> band_;        ///< of the halves in turns, if there are two
  MemberVector<T> right_side_;  ///< likewise
  MemberVector<T> middle_;
  MemberVector<T> middle_right_side_;
};

}  // namespace der
