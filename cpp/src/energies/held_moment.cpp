#include "der/energies/held_moment.hpp"

namespace der {

template <int Edges>
HeldMoment<Edges>::Change::Change(const HeldMoment& moment, const Configuration& here,
                                  const Vec3& amount)
    : free(moment.response(here)),
      before(free.held.under(moment.load_before(here.controls))),
      after(free.held.under(moment.load_with(here.controls, amount))) {}

template <int Edges>
SectionLoad HeldMoment<Edges>::load_with(const Vector& controls, const Vec3& amount) const {
  SectionLoad load = this->load_before(controls);
  this->add(amount, follower, load);
  return load;
}

template <int Edges>
Vec3 HeldMoment<Edges>::Change::on_rod() const {
  Vec3 whole = Vec3::Zero();
  for (std::size_t i = 0; i < free.count; ++i) whole -= moment(i);
  return whole;
}

template <int Edges>
EdgeMoments HeldMoment<Edges>::moments_at(const Configuration& here, const Vec3& amount) const {
  const Change change(*this, here, amount);
  EdgeMoments result;
  result.whole = change.on_rod();
  for (std::size_t i = 0; i < Edges; ++i) result.on_edge[i] = -change.moment(i);
  return result;
}

template <int Edges>
Vec3 HeldMoment<Edges>::taken_by_springs(const Configuration& here, const Vec3& amount) const {
  const Change change(*this, here, amount);
  return change.on_rod() - (change.after.load() - change.before.load());
}

template <int Edges>
Mat3 HeldMoment<Edges>::axes_of_springs(const Configuration& here, const Vec3& amount) const {
  return Change(*this, here, amount).after.axes_of_springs();
}

template <int Edges>
StoredBeside HeldMoment<Edges>::stored(const Configuration& here, const Vec3& amount) const {
  const Change change(*this, here, amount);
  return {change.after.energy_on_the_way() - change.before.energy_on_the_way(),
          change.after.energy_in_springs() - change.before.energy_in_springs()};
}

template <int Edges>
void HeldMoment<Edges>::evaluate(const Configuration& here, const Vec3& amount,
                                 CirculatoryTerm& out) const {
  out.reset(size());
  const Change change(*this, here, amount);
  const HeldSection::Stiffness after = change.after.stiffness();
  const HeldSection::Stiffness before = change.before.stiffness();
  const auto& frames = change.free.edges;
  for (std::size_t i = 0; i < Edges; ++i) {
    const Index own = 4 * static_cast<Index>(i);
    const Eigen::Matrix<double, 3, 4> turning = frames[i].rotation();
    out.force.template segment<4>(own) = -turning.transpose() * change.moment(i);
    for (std::size_t j = 0; j < Edges; ++j) {
      out.tangent.template block<4, 4>(own, 4 * static_cast<Index>(j)) =
          turning.transpose() * (after[i][j] - before[i][j]) * frames[j].rotation();
    }
    out.tangent.template block<4, 4>(own, own) += frames[i].geometric_stiffness(change.moment(i));
  }
}

template struct HeldMoment<1>;
template struct HeldMoment<2>;

}  // namespace der
