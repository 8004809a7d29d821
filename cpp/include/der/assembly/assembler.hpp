#pragma once

#include <array>
#include <memory>
#include <vector>

#include "der/assembly/loose_elements.hpp"
#include "der/assembly/pattern.hpp"
#include "der/core/strided.hpp"
#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"

namespace der {

class PlanarChain;
class SpatialChain;

/// Sums the elements of a model into a gradient over all degrees of freedom and a Hessian over the
/// free ones, straight into the solver's array of values: chains as a whole, the other elements one
/// by one. The scatter maps are built once; assembling allocates nothing. Entries of held degrees
/// of freedom go to one spare slot at the end of the values.
class Assembler {
 public:
  Assembler(const Model& model, const MatrixLayout& layout);
  /// That of a model of the same structure (`structural_difference`) with the same layout: it
  /// shares the scatter maps.
  Assembler(const Model& model, const Assembler& like);
  ~Assembler();
  Assembler(const Assembler&) = delete;
  Assembler& operator=(const Assembler&) = delete;

  /// Length of the array of values that `gradient_and_hessian` fills, spare slot included.
  [[nodiscard]] Index num_values() const { return num_values_; }
  /// Number of plain stretch elements, those that begin and end at nodes.
  [[nodiscard]] Index num_plain_edges() const;

  /// Sets `gradient` (all degrees of freedom) [N] of the potential energy of all elements, less the
  /// forces of circulatory loads. These have no part in the Hessian
  /// (energies/circulatory_load.hpp).
  void gradient(const Configuration& here, Vector& gradient) const;
  /// Sets `gradient` likewise, and `values` to the Hessian [N/m].
  void gradient_and_hessian(const Configuration& here, Vector& gradient, Vector& values) const;
  /// Sets `gradient` likewise, and adds the Hessian to `values`.
  void add_hessian(const Configuration& here, Vector& gradient, Vector& values) const;
  /// A member of a batch in its lane, at coordinates besides those of `here`.
  struct LooseMember {
    const Model* model = nullptr;
    const Configuration* here = nullptr;
    Strided<const double> coordinates;
    Strided<double> gradient;
    Strided<double> values;
  };
  /// Adds to the gradients of `count` members, and for the Hessian to their values, what elements
  /// give that are neither in chains nor of a kernel for lanes (energies/lane_values.hpp). The
  /// members' models have the structure of this one.
  void add_loose_gradient(const LooseMember* members, int count) const;
  void add_loose_hessian(const LooseMember* members, int count) const;
  [[nodiscard]] bool has_loose() const;  ///< whether there are such elements
  /// All elements of a kind outside of chains.
  template <class Kernel>
  [[nodiscard]] const OffChainElements<Kernel>& loose() const;
  [[nodiscard]] const std::vector<PlanarChain>& planar_chains() const;
  [[nodiscard]] const std::vector<SpatialChain>& spatial_chains() const;
  /// Slots of the lower triangle of every plain stretch element, column by column.
  template <int Dim>
  using EdgeSlots = std::vector<std::array<Index, Dim * (2 * Dim + 1)>>;
  template <int Dim>
  [[nodiscard]] const EdgeSlots<Dim>& edge_slots() const;
  /// Slot on the diagonal of every free degree of freedom.
  [[nodiscard]] const std::vector<Index>& diagonal_slots() const;

  /// The largest entry, by size, on the diagonal of `values` among the free degrees of freedom of a
  /// block; 0 if it has none.
  [[nodiscard]] double largest_diagonal(const DofBlock& block, const Vector& values) const;
  /// Adds `factor` times the mass matrix; its couplings are the model's or none.
  void add_mass(const Mass& mass, double factor, Vector& values) const;
  /// Adds the stiffness across the edges that a tension [N], one for each plain stretch element,
  /// gives them.
  void add_tension_stiffness(const Configuration& here, const Vector& tension,
                             Vector& values) const;
  /// Adds `factor` [1/s] times the matrix C [N s/m] of the internal damping, by which the
  /// velocities give the viscous forces (model/internal_damping.hpp).
  void add_internal_damping(const Configuration& here, double factor, Vector& values) const;
  /// Adds `diagonal` (all degrees of freedom) times `factor` to the matrix diagonal.
  void add_diagonal(const Vector& diagonal, double factor, Vector& values) const;

 private:
  template <int Dim>
  void add_tension_stiffness(const Configuration& here, const Vector& tension,
                             Vector& values) const;

  struct ScatterMaps;

  const Model& model_;
  Index num_values_ = 0;
  std::shared_ptr<const ScatterMaps> maps_;
};

}  // namespace der
