#pragma once

#include <variant>
#include <vector>

#include "der/core/types.hpp"
#include "der/energies/edge_moments.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// The moments that act on a rod at single places, of loads and of springs against turning: where
/// they stand, what they are, and the one or two edges over which the chain spreads them. In a
/// plane they are along z.
class SpreadMoments {
 public:
  struct Moment {
    double arc_length = 0.0;      ///< [m]
    Index first_edge = 0;         ///< number in the rod
    std::vector<double> weights;  ///< of the edges from there on: those of moments that bend
  };

  SpreadMoments(const RodMesh& rod, const Model& model);

  [[nodiscard]] std::size_t size() const { return moments_.size(); }
  [[nodiscard]] const Moment& operator[](std::size_t i) const { return moments_[i]; }
  /// Moment number `i` [N m].
  [[nodiscard]] EdgeMoments value(std::size_t i, const Model& model, const State& state) const;

 private:
  // The source of a moment: all moments at a place of a planar rod, or in space one load or one
  // spring. The number is that in RodMesh::moment_places, in ElementLists::circulatory, or of the
  // spring's element.
  struct PlanarPlace {
    std::size_t number = 0;
  };
  struct SpatialLoad {
    std::size_t number = 0;
  };
  template <int Edges>
  struct SpatialSpring {
    std::size_t number = 0;
  };
  using Source = std::variant<PlanarPlace, SpatialLoad, SpatialSpring<1>, SpatialSpring<2>>;

  [[nodiscard]] EdgeMoments value_of(PlanarPlace place, const Model& model,
                                     const State& state) const;
  [[nodiscard]] static EdgeMoments value_of(SpatialLoad load, const Model& model,
                                            const State& state);
  [[nodiscard]] static EdgeMoments value_of(SpatialSpring<1> spring, const Model& model,
                                            const State& state);
  [[nodiscard]] static EdgeMoments value_of(SpatialSpring<2> spring, const Model& model,
                                            const State& state);

  RodMesh rod_;
  std::vector<Moment> moments_;
  std::vector<Source> sources_;  // of each
};

}  // namespace der
