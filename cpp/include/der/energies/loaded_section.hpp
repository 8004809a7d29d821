#pragma once

#include <vector>

#include "der/core/index.hpp"
#include "der/core/types.hpp"
#include "der/energies/framed_edge.hpp"
#include "der/energies/load_amount.hpp"
#include "der/energies/section_spring.hpp"
#include "der/kinematics/configuration.hpp"

namespace der {

/// A moment on a section, by what it is made of.
struct MomentOnSection {
  LoadAmount amount;
  bool follower = false;
};

/// The section at a place where the edges beside it do not tell how it lies, because springs
/// against turning hold it, moments make the curvature jump, the rod has a corner, or a clamp is
/// nearer than an edge. It turns against the edges as the rod on the way to them bends and twists
/// (HeldSection), with stiffness 0 of the springs if there are none.
///
/// Loads see each other through it: those of one place are in an order, and each of them is what it
/// adds to the moments before it.
template <int Edges>
struct LoadedSection {
  using Kernel = SectionSpring<Edges>;
  std::vector<FramedEdge> edges;
  typename Kernel::Constants section;
  std::vector<MomentOnSection> moments;  ///< on the section before the load

  /// The section without any moment.
  [[nodiscard]] typename Kernel::Response response(const Configuration& here) const {
    Eigen::Matrix<double, Kernel::kDofs, 1> x;
    for (std::size_t i = 0; i < Edges; ++i) {
      const SpatialEdge& edge = edges[i].edge;
      const auto first = 3 * static_cast<Index>(i);
      x.template segment<3>(first) = here.coordinates.segment<3>(edge.start);
      x.template segment<3>(first + 3) = here.coordinates.segment<3>(edge.end);
      x[3 * Kernel::kNodes + static_cast<Index>(i)] = here.coordinates[edge.theta];
    }
    return {section, here, x};
  }
  /// Components of a vector in the initial shape along the directors and the tangent there.
  [[nodiscard]] Vec3 reference_components(const Vec3& vector) const {
    const SectionFrame& drawn = section.spring.drawn;
    return {drawn.first.dot(vector), drawn.second.dot(vector), drawn.tangent.dot(vector)};
  }
  void add(const Vec3& amount, bool follower, SectionLoad& load) const {
    if (follower) {
      load.turning += reference_components(amount);
    } else {
      load.fixed += amount;
    }
  }
  /// The moments before the load.
  [[nodiscard]] SectionLoad load_before(const Vector& controls) const {
    SectionLoad load;
    for (const MomentOnSection& moment : moments) {
      add(moment.amount.at(controls), moment.follower, load);
    }
    return load;
  }
};

}  // namespace der
