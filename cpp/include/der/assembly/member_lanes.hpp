#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <new>

#include "der/core/index.hpp"
#include "der/core/lanes.hpp"
#include "der/core/loops.hpp"
#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"

namespace der {

// Members of a batch that have models of one structure, in the lanes of one number type.

/// The models of the members, one for each lane.
template <class T>
using MemberModels = std::array<const Model*, to_size(LaneTraits<T>::kCount)>;

/// The configurations of the members, of which the controls are read.
template <class T>
using MemberConfigurations = std::array<Configuration, to_size(LaneTraits<T>::kCount)>;

/// Numbers of members, as many for each as a vector of one member has. The memory of wide registers
/// begins at a cache line.
template <class T>
class MemberVector {
 public:
  MemberVector() = default;
  explicit MemberVector(Index size) { resize(size); }

  /// Sets all to zero.
  void resize(Index size) {
    size_ = size;
    data_.reset(
        static_cast<T*>(::operator new(to_size(size) * sizeof(T), std::align_val_t{kCacheLine})));
    for (Index i = 0; i < size; ++i) new (&data_[to_size(i)]) T(0.0);
  }
  [[nodiscard]] Index size() const { return size_; }
  [[nodiscard]] T* data() { return data_.get(); }
  [[nodiscard]] const T* data() const { return data_.get(); }
  T& operator[](std::ptrdiff_t i) { return data_.get()[i]; }
  const T& operator[](std::ptrdiff_t i) const { return data_.get()[i]; }

  /// Puts the numbers of one member into its lane.
  void set_lane(int lane, const Vector& values) {
    for (Index i = 0; i < size_; ++i) data_[to_size(i)].set_lane(lane, values[i]);
  }
  /// Takes the numbers of one member out of its lane.
  void get_lane(int lane, Vector& values) const {
    for (Index i = 0; i < size_; ++i) values[i] = data_[to_size(i)].lane(lane);
  }

 private:
  static constexpr std::size_t kCacheLine = 64;
  struct Delete {
    void operator()(T* data) const { ::operator delete(data, std::align_val_t{kCacheLine}); }
  };
  std::unique_ptr<T[], Delete> data_;
  Index size_ = 0;
};

/// `along_edge` (model/edge.hpp) of each member.
template <int Dim, class T>
Eigen::Matrix<T, Dim, 1> along_edge(const Edge& edge, const MemberVector<T>& field) {
  Eigen::Matrix<T, Dim, 1> vector;
  for (int c = 0; c < Dim; ++c) vector[c] = field[edge.last + c] - field[edge.first + c];
  return vector;
}

// Compiles what INSTANTIATE(T) names for each number type of members: eight lanes are there where
// loops for AVX-512 are.
#ifdef DER_HAS_WIDE_LOOPS
#define DER_FOR_MEMBER_LANES(INSTANTIATE) INSTANTIATE(FourLanes) INSTANTIATE(EightLanes)
#else
#define DER_FOR_MEMBER_LANES(INSTANTIATE) INSTANTIATE(FourLanes)
#endif

/// `dispatch_simd` of a loop over members: eight lanes need AVX-512, four run on every processor.
template <class T, class Loop>
auto run_member_loop(const Loop& loop) {
#ifdef DER_HAS_WIDE_LOOPS
  if constexpr (LaneTraits<T>::kCount == 8) return compiled::avx512(loop);
#endif
  return dispatch_simd(loop);
}

}  // namespace der
