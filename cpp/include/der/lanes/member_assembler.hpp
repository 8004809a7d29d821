#pragma once

#include <array>
#include <memory>
#include <vector>

#include "der/assembly/assembler.hpp"
#include "der/assembly/planar_chain.hpp"
#include "der/assembly/spatial_chain.hpp"
#include "der/lanes/loose_lanes.hpp"
#include "der/lanes/member_controls.hpp"
#include "der/lanes/member_model.hpp"

namespace der {

/// The assemblers of the members.
template <class T>
using MemberAssemblers = std::array<const Assembler*, to_size(LaneTraits<T>::kCount)>;

/// Assembler for several members: chains in lanes, and the other elements where their kernels are
/// for lanes, else one by one. Each member has, to the last bit, what its Assembler gives.
template <class T>
class MemberAssembler {
 public:
  /// Elements that are evaluated one by one read the `controls`.
  MemberAssembler(const MemberModel<T>& model, const MemberAssemblers<T>& assemblers,
                  const MemberControls<T>& controls);

  /// The size of an array of values, spare slot included.
  [[nodiscard]] Index num_values() const { return assembler_.num_values(); }
  /// Takes the frames of edges from the controls, at the start of a step.
  void follow_frames();
  /// Sets `gradient` (all degrees of freedom) [N]; `frames`: the blocks of all edges.
  void gradient(const MemberVector<T>& coordinates, const MemberVector<T>& frames,
                MemberVector<T>& gradient) const;
  /// Sets `gradient` likewise, and `values` to `inertia` times the mass matrix and the Hessian.
  void system(const T& inertia, const MemberVector<T>& coordinates, const MemberVector<T>& frames,
              MemberVector<T>& gradient, MemberVector<T>& values) const;
  /// Puts into `values` the tensions that `step`, which led to `coordinates`, predicted
  /// (PredictedTension).
  void use_predicted_tension(const MemberVector<T>& coordinates, const MemberVector<T>& step,
                             MemberVector<T>& values) const;
  /// The sum over kinds of degrees of freedom of the largest stiffness on the diagonal of `values`
  /// times the largest coordinate [N].
  [[nodiscard]] T largest_elastic_force(const MemberVector<T>& coordinates,
                                        const MemberVector<T>& values) const;
  /// Adds `factor` times the damping to the diagonal.
  void add_damping(const T& factor, MemberVector<T>& values) const;

 private:
  void set_masses(const MemberAssemblers<T>& assemblers);
  template <Derivatives D>
  void add_chains(const MemberVector<T>& coordinates, const MemberVector<T>& frames, T* gradient,
                  T* values) const;
  template <int Dim>
  void set_edges();
  template <int Dim>
  void use_predicted_tension_in(const MemberVector<T>& coordinates, const MemberVector<T>& step,
                                MemberVector<T>& values) const;

  const MemberModel<T>& model_;
  const Assembler& assembler_;  // of the first: they share what is needed of it
  bool has_loose_;
  const MemberControls<T>& controls_;
  std::vector<PlanarChainConstants<T>> planar_chains_;
  std::vector<SpatialChainConstants<T>> spatial_chains_;
  std::vector<std::unique_ptr<OffChainKind<T>>> loose_;
  std::vector<Index> mass_slots_;  // of the entries of the mass matrix
  MemberVector<T> masses_;
  // Constants of the plain stretch elements.
  MemberVector<T> EA_;
  MemberVector<T> rest_length_;
};

}  // namespace der
