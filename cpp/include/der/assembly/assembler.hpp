#pragma once

#include <array>
#include <tuple>
#include <vector>

#include "der/assembly/pattern.hpp"
#include "der/assembly/planar_chain.hpp"
#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/model/model.hpp"

namespace der {

/// Sums the elements of a model into a gradient over all degrees of freedom and a Hessian over the
/// free ones, straight into the solver's array of values: chains as a whole, the other elements one
/// by one. The scatter maps are built once; assembling allocates nothing. Entries of held degrees
/// of freedom go to one spare slot at the end of the values.
class Assembler {
 public:
  Assembler(const Model& model, const MatrixLayout& layout);

  /// Length of the array of values that `hessian` fills, spare slot included.
  [[nodiscard]] Index num_values() const { return num_values_; }

  /// Sets `gradient` (all degrees of freedom) [N] of the potential energy of all elements.
  void gradient(const Vector& positions, const Vector& controls, Vector& gradient) const;
  /// As above, and sets `values` to the Hessian [N/m].
  void gradient_and_hessian(const Vector& positions, const Vector& controls, Vector& gradient,
                            Vector& values) const;
  /// Adds `factor` times the mass matrix; its couplings are the model's or none.
  void add_mass(const Mass& mass, double factor, Vector& values) const;
  /// Adds the stiffness across the edges that a tension [N], one for each plain stretch element,
  /// gives them.
  void add_tension_stiffness(const Vector& positions, const Vector& tension, Vector& values) const;
  /// Adds `diagonal` (all degrees of freedom) times `factor` to the matrix diagonal.
  void add_diagonal(const Vector& diagonal, double factor, Vector& values) const;
  /// Adds `shift` to every diagonal entry of the matrix.
  void shift_diagonal(double shift, Vector& values) const;

 private:
  template <Derivatives D>
  void assemble(const Vector& positions, const Vector& controls, Vector& gradient,
                Vector* values) const;

  struct CouplingSlots {
    Index a;  // diagonal entries
    Index b;
    Index ab;  // the entry between them
  };

  const Model& model_;
  Index num_values_ = 0;
  std::vector<PlanarChain> chains_;
  std::vector<Index> diagonal_slots_;          // of each free degree of freedom
  std::vector<CouplingSlots> coupling_slots_;  // of each of the model's mass couplings

  template <class List>
  struct ScatterMap;
  template <class Kernel>
  struct ScatterMap<ElementList<Kernel>> {
    static constexpr std::size_t kSlots = Kernel::kDofs * (Kernel::kDofs + 1) / 2;
    std::vector<std::size_t> elements;             // those that no chain assembles
    std::vector<std::array<Index, kSlots>> slots;  // their lower triangles, column by column
  };
  template <class Lists>
  struct ScatterMaps;
  template <class... Lists>
  struct ScatterMaps<std::tuple<Lists...>> {
    using type = std::tuple<ScatterMap<Lists>...>;
  };
  ScatterMaps<ElementLists>::type scatter_;
  std::vector<std::array<Index, 10>> edge_slots_;  // of every plain stretch element
};

}  // namespace der
