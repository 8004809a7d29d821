#include "der/energies/held_moment.hpp"

#include "der/core/index.hpp"

namespace der {

template <int Edges>
Vec3 HeldMoment<Edges>::Change::on_rod() const {
  Vec3 whole = Vec3::Zero();
  for (std::size_t i = 0; i < free.count; ++i) whole -= moment(i);
  return whole;
}

template <int Edges>
typename HeldMoment<Edges>::Change HeldMoment<Edges>::change_at(const Configuration& here,
                                                                const Vec3& amount) const {
  Eigen::Matrix<double, Kernel::kDofs, 1> x;
  for (std::size_t i = 0; i < Edges; ++i) {
    const SpatialEdge& edge = edges[i].edge;
    const auto first = 3 * static_cast<Index>(i);
    x.template segment<3>(first) = here.coordinates.segment<3>(edge.start);
    x.template segment<3>(first + 3) = here.coordinates.segment<3>(edge.end);
    x[3 * Kernel::kNodes + static_cast<Index>(i)] = here.coordinates[edge.theta];
  }
  const SectionFrame& drawn = section.spring.drawn;
  const SectionLoad load = follower
                               ? SectionLoad{{drawn.first.dot(amount), drawn.second.dot(amount),
                                              drawn.tangent.dot(amount)},
                                             true}
                               : SectionLoad{amount, false};
  return Change(section, here, x, load);
}

template <int Edges>
EdgeMoments HeldMoment<Edges>::moments(const Configuration& here, const Vec3& amount) const {
  const Change change = change_at(here, amount);
  EdgeMoments result;
  result.whole = change.on_rod();
  for (std::size_t i = 0; i < Edges; ++i) result.on_edge[i] = -change.moment(i);
  return result;
}

template <int Edges>
Vec3 HeldMoment<Edges>::taken_by_springs(const Configuration& here, const Vec3& amount) const {
  const Change change = change_at(here, amount);
  return change.on_rod() - change.loaded.load();
}

template <int Edges>
StoredBeside HeldMoment<Edges>::stored(const Configuration& here, const Vec3& amount) const {
  const Change change = change_at(here, amount);
  const HeldSection& loaded = change.loaded;
  const HeldSection& free = change.free.held;
  return {loaded.energy_on_the_way() - free.energy_on_the_way(),
          loaded.energy_in_springs() - free.energy_in_springs()};
}

template <int Edges>
void HeldMoment<Edges>::evaluate(const Configuration& here, const Vec3& amount,
                                 CirculatoryTerm& out) const {
  out.reset(size());
  const Change change = change_at(here, amount);
  const HeldSection::Stiffness loaded = change.loaded.stiffness();
  const HeldSection::Stiffness free = change.free.held.stiffness();
  const auto& frames = change.free.edges;
  for (std::size_t i = 0; i < Edges; ++i) {
    const Index own = 4 * static_cast<Index>(i);
    const Eigen::Matrix<double, 3, 4> turning = frames[i].rotation();
    out.force.template segment<4>(own) = -turning.transpose() * change.moment(i);
    for (std::size_t j = 0; j < Edges; ++j) {
      out.tangent.template block<4, 4>(own, 4 * static_cast<Index>(j)) =
          turning.transpose() * (loaded[i][j] - free[i][j]) * frames[j].rotation();
    }
    out.tangent.template block<4, 4>(own, own) += frames[i].geometric_stiffness(change.moment(i));
  }
}

template struct HeldMoment<1>;
template struct HeldMoment<2>;

}  // namespace der
