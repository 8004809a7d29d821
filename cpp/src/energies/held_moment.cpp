#include "der/energies/held_moment.hpp"

namespace der {

template <int Edges>
HeldMoment<Edges>::Change::Change(const HeldMoment& moment, const Configuration& here,
                                  const Vec3& amount)
    : free(moment.response(here)),
      before(free.held.under(moment.load_before(here.controls))),
      after(free.held.under(moment.load_with(here.controls, amount))) {
  const auto& clamp = moment.section.clamp;
  if (clamp && !clamp->holds_section) spins_about = clamp->held.untwisted(here.controls).tangent;
}

template <int Edges>
SectionLoad HeldMoment<Edges>::load_with(const Vector& controls, const Vec3& amount) const {
  SectionLoad load = this->load_before(controls);
  this->add(amount, follower, load);
  return load;
}

template <int Edges>
Vec3 HeldMoment<Edges>::Change::on_rod() const {
  Vec3 whole = Vec3::Zero();
  for (std::size_t i = 0; i < free.count; ++i) whole -= on_carried(i);
  return whole;
}

template <int Edges>
EdgeMoments HeldMoment<Edges>::moments_at(const Configuration& here, const Vec3& amount) const {
  const Change change(*this, here, amount);
  EdgeMoments result;
  result.whole = change.on_rod();
  for (std::size_t i = 0; i < Edges; ++i) result.on_edge[i] = -change.on_edge(i);
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
  // The torque that a clamp passes on turns with the tangent of the edge.
  const auto passed_on = [&](std::size_t j) -> Mat3 {
    if (!change.spins_about) return Mat3::Zero();
    const Vec3& tangent = frames[0].frame.tangent;
    const Mat3 changed = after[kClamp][j] - before[kClamp][j];
    return tangent * change.spins_about->transpose() * changed -
           0.5 * change.passed_on() * cross_matrix(tangent);
  };
  for (std::size_t i = 0; i < Edges; ++i) {
    const Index own = 4 * static_cast<Index>(i);
    const Eigen::Matrix<double, 3, 4> turning = frames[i].rotation();
    out.force.template segment<4>(own) = -turning.transpose() * change.on_edge(i);
    for (std::size_t j = 0; j < Edges; ++j) {
      out.tangent.template block<4, 4>(own, 4 * static_cast<Index>(j)) =
          turning.transpose() * (after[i][j] - before[i][j] + passed_on(j)) * frames[j].rotation();
    }
    out.tangent.template block<4, 4>(own, own) += frames[i].geometric_stiffness(change.on_edge(i));
  }
}

template struct HeldMoment<1>;
template struct HeldMoment<2>;

}  // namespace der
