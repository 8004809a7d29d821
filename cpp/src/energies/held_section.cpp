#include "der/energies/held_section.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

#include "der/energies/spatial_bend.hpp"

namespace der {
namespace {

constexpr int kMostSteps = 100;
/// Steps [rad] below which Newton's method is tried, at first and after steps with care.
constexpr double kLongStep = 1.0;
constexpr double kShortStep = 0.1;
/// Most parts in which a moment on the section is raised.
constexpr int kMostParts = 64;
/// After a step [rad] this short the next one is below rounding.
constexpr double kLastStep = 1e-8;

bool holds(const SpringInSeries& spring) { return !spring.stiffness.isZero(0.0); }

}  // namespace

HeldSection::Rotation::Rotation(const VertexKinematics<AngleCurvature>& vertex)
    : kinematics(vertex),
      strain(vertex.strain().kappa_1, vertex.strain().kappa_2, vertex.strain().twist) {
  const auto [g1, g2, gt] = vertex.gradients();
  slopes << g1, g2, gt;
}

Mat3 HeldSection::Rotation::curving(const Vec3& load) const {
  VertexResponse response;
  kinematics.respond<true>(LoadedVertex{{}, {load[0], load[1], load[2]}}, response);
  return response.stiffness;
}

HeldSection::HeldSection(const SpringInSeries& spring, const CarriedSections& carried,
                         std::size_t count)
    : spring_(spring),
      carried_(carried),
      count_(count),
      reference_(holds(spring) ? spring.drawn : carried[0].frame),
      reference_twist_(holds(spring) ? 0.0 : carried[0].twist),
      place_(place_at(carried[0].frame, carried[0].twist - reference_twist_)) {
  settle();
}

HeldSection HeldSection::under(const SectionLoad& load) const {
  HeldSection result = *this;
  result.load_ = load;
  if (settled_ && !load.is_zero()) result.raise_load();
  return result;
}

/// `near`: the twist from the reference [rad], known up to less than half a turn.
HeldSection::Place HeldSection::place_at(const SectionFrame& section, double near) const {
  const double twist = nearest_turn(twist_between(reference_, section), near);
  const auto rotation_to = [&](std::size_t i) {
    const CarriedSection& known = carried_[i];
    const double between =
        nearest_turn(twist_between(section, known.frame), known.twist - reference_twist_ - twist);
    return Rotation(VertexKinematics<AngleCurvature>::read_before(section, known.frame, between));
  };
  Place place{section,
              Rotation({reference_, section, twist}),
              {rotation_to(0), rotation_to(count_ - 1)},
              Mat3::Zero(),
              Mat3::Zero(),
              Vec3::Zero()};
  for (std::size_t i = 0; i < count_; ++i) {
    const Rotation& rotation = place.to_carried[i];
    place.way += carried_[i].weights * rotation.strain;
    place.slopes += rotation.slopes * carried_[i].weights.transpose();
  }
  place.per_rotation = place.from_reference.slopes.transpose().inverse();
  place.slopes = place.per_rotation.transpose() * place.slopes;
  return place;
}

/// The place at which z has changed.
HeldSection::Place HeldSection::turned(const Place& place, const Vec3& change) const {
  const Vec3 rotation = place.per_rotation * change;
  const double angle = rotation.norm();
  if (!(angle > 0.0)) return place;
  const Mat3 turn = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  const SectionFrame section =
      SectionFrame::of((turn * place.section.tangent).normalized(), turn * place.section.first);
  return place_at(section, place.from_reference.strain.z() + change.z());
}

/// The place at which psi = C p, from one nearby.
HeldSection::Place HeldSection::on_the_way(Place place, const Vec3& moment) const {
  for (int i = 0; i < kMostSteps; ++i) {
    const Vec3 missing = place.way - spring_.compliance * moment;
    const Vec3 step = place.slopes.transpose().inverse() * missing;
    place = turned(place, step);
    if (!(step.norm() > kLastStep)) break;
  }
  return place;
}

/// The part of the second derivative by z of z . K z/2 + p . psi that is due to the second
/// derivatives of the rotations, without the change of p.
Mat3 HeldSection::curving(const Vec3& moment) const {
  Mat3 own = place_.from_reference.curving(place_.slopes * moment);
  for (std::size_t i = 0; i < count_; ++i) own += carried_curving(i, moment);
  return place_.per_rotation.transpose() * own * place_.per_rotation;
}

Mat3 HeldSection::carried_curving(std::size_t i, const Vec3& moment) const {
  return place_.to_carried[i].curving(carried_[i].weights.transpose() * moment);
}

/// M_i under the moment p.
Vec3 HeldSection::carried_moment(std::size_t i, const Vec3& moment) const {
  return place_.to_carried[i].slopes * (carried_[i].weights.transpose() * moment);
}

/// The work of the moment m by z: m . omega for the rotation omega of the section.
Vec3 HeldSection::load_along_z() const { return place_.per_rotation.transpose() * load(); }

/// The derivative of -load_along_z() by z. Turning the section by omega changes the moment Z q of a
/// constant load q on z by (S - 1/2 [Z q]x) omega, and the part of m that turns by omega x m.
Mat3 HeldSection::load_curving() const {
  const Vec3 aside = 0.5 * (load_.turned(place_.section) - load_.fixed);
  const Mat3 own = place_.from_reference.curving(load_along_z()) + cross_matrix(aside);
  return place_.per_rotation.transpose() * own * place_.per_rotation;
}

/// The derivative of K z - G p - load_along_z() and psi - C p by z and p, with G the slopes of the
/// place. Symmetric but for the load, and regular for all stiffnesses of springs and of the rod,
/// the least and the largest.
HeldSection::Mat6 HeldSection::equations() const {
  Mat3 own = curving(moment_);
  if (!load_.is_zero()) own += load_curving();
  own.diagonal() += spring_.stiffness;
  Mat6 matrix;
  matrix << own, -place_.slopes, -place_.slopes.transpose(), -spring_.compliance;
  return matrix;
}

HeldSection::Vec6 HeldSection::newton_step() const {
  Vec6 missing;
  missing << place_.slopes * moment_ + load_along_z() -
                 spring_.stiffness.cwiseProduct(place_.from_reference.strain),
      spring_.compliance * moment_ - place_.way;
  return equations().partialPivLu().solve(missing);
}

/// A step from the place, by which z alone changes and p = C^-1 psi, that lowers E: Newton's, with
/// a share `shift` of the matrix without second derivatives of rotations that grows until E falls
/// (Levenberg). False if there is none.
bool HeldSection::descend(const Mat3& per_compliance, double& shift) {
  constexpr double kMostShift = 1e6;
  const auto potential = [&](const Place& place) {
    const Vec3& z = place.from_reference.strain;
    return 0.5 *
           (z.dot(spring_.stiffness.cwiseProduct(z)) + place.way.dot(per_compliance * place.way));
  };
  const Vec3 slope =
      spring_.stiffness.cwiseProduct(place_.from_reference.strain) - place_.slopes * moment_;
  Mat3 convex = place_.slopes * per_compliance * place_.slopes.transpose();
  convex.diagonal() += spring_.stiffness;
  const Mat3 matrix = convex + curving(moment_);
  const double start = potential(place_);
  for (; shift < kMostShift; shift *= 10.0) {
    const Vec3 step = -(matrix + shift * convex).ldlt().solve(slope);
    const double falls = slope.dot(step);
    if (!(falls < 0.0) || step.norm() > kLongStep) continue;
    const Place place = turned(place_, step);
    if (!(potential(place) < start + 1e-4 * falls)) continue;
    place_ = place;
    moment_ = per_compliance * place.way;
    shift = std::max(1e-3, 0.1 * shift);
    return true;
  }
  return false;
}

/// Newton's method from here on, as long as its steps become shorter than `longest` [rad]; else all
/// is as before. The last step is one beyond that after which z and p are exact: its equations have
/// the curving under the final moment.
bool HeldSection::converge(double longest) {
  const Place place = place_;
  const Vec3 moment = moment_;
  for (double before = longest;;) {
    const Vec6 step = newton_step();
    const double length = step.head<3>().norm();
    const bool last = before < kLastStep;
    if (!last && !(length < before)) {
      place_ = place;
      moment_ = moment;
      return false;
    }
    place_ = turned(place_, step.head<3>());
    moment_ += step.tail<3>();
    if (last) return true;
    before = length;
  }
}

/// Solves for z and p, first from where they would be if spring and way had the same axes, then
/// downhill from where the rod on the way does not bend. Bent or twisted so far that it would
/// buckle, it may have no place nearby where E is least: the search ends before. Without springs
/// the rod on the way does not bend.
void HeldSection::settle() {
  const Place start = on_the_way(place_, Vec3::Zero());
  if (!holds(spring_)) {
    place_ = start;
    settled_ = start.way.norm() < kLastStep;
    return;
  }
  const Mat3 springs = spring_.stiffness.asDiagonal();
  const Mat3 in_series = (Mat3::Identity() + springs * spring_.compliance).inverse() * springs;
  moment_ = in_series * start.from_reference.strain;
  place_ = turned(start, -(spring_.compliance * moment_));
  settled_ = converge(kLongStep);
  if (settled_) return;
  const Mat3 per_compliance = spring_.compliance.inverse();
  moment_.setZero();
  place_ = start;
  if (!per_compliance.allFinite()) return;
  double shift = 1.0;
  for (int i = 0; i < kMostSteps && !settled_ && descend(per_compliance, shift); ++i) {
    settled_ = converge(kShortStep);
  }
}

/// From the place without a moment m on the section, in as few parts as Newton's method needs.
void HeldSection::raise_load() {
  const Place start = place_;
  const Vec3 moment = moment_;
  const SectionLoad whole = load_;
  settled_ = false;
  for (int parts = 1; parts <= kMostParts && !settled_; parts *= 2) {
    place_ = start;
    moment_ = moment;
    settled_ = true;
    for (int part = 1; part <= parts && settled_; ++part) {
      load_ = whole.times(double(part) / parts);
      settled_ = converge(kLongStep);
    }
  }
  load_ = whole;
}

double HeldSection::energy_in_springs() const {
  const Vec3& z = place_.from_reference.strain;
  // The moment of stiff springs is known in equilibrium, while K z has lost its digits.
  if (settled_) return 0.5 * z.dot(place_.slopes * moment_ + load_along_z());
  return 0.5 * z.dot(spring_.stiffness.cwiseProduct(z));
}

double HeldSection::energy_on_the_way() const {
  return 0.5 * moment_.dot(spring_.compliance * moment_);
}

Vec3 HeldSection::moment(std::size_t i) const { return carried_moment(i, moment_); }

HeldSection::Slopes HeldSection::slopes_of_moments() const {
  Slopes slopes;
  for (std::size_t i = 0; i < count_; ++i) {
    slopes[i] << -(carried_curving(i, moment_) + 0.5 * cross_matrix(moment(i))) *
                     place_.per_rotation,
        place_.to_carried[i].slopes * carried_[i].weights.transpose();
  }
  return slopes;
}

HeldSection::Following HeldSection::following(const Slopes& slopes) const {
  const auto matrix = equations().partialPivLu();
  Following result;
  for (std::size_t i = 0; i < count_; ++i) result[i] = -matrix.solve(slopes[i].transpose());
  return result;
}

std::array<Mat3, HeldSection::kMost> HeldSection::turning() const {
  const Following change = following(slopes_of_moments());
  std::array<Mat3, kMost> result{Mat3::Zero(), Mat3::Zero()};
  for (std::size_t i = 0; i < count_; ++i) result[i] = place_.per_rotation * change[i].topRows<3>();
  return result;
}

HeldSection::Stiffness HeldSection::stiffness() const {
  const Slopes slopes = slopes_of_moments();
  const Following change = following(slopes);
  Stiffness result;
  for (std::size_t i = 0; i < count_; ++i) {
    for (std::size_t j = 0; j < count_; ++j) result[i][j] = slopes[i] * change[j];
    result[i][i] += carried_curving(i, moment_);
  }
  return result;
}

HeldSection::Stress HeldSection::stress(const std::array<Vec3, kMost>& rotations) const {
  const Following change = following(slopes_of_moments());
  Vec3 moment = Vec3::Zero();
  for (std::size_t i = 0; i < count_; ++i) moment += change[i].bottomRows<3>() * rotations[i];

  // The section follows the known ones as it does without the stress, which the second derivative
  // of the whole energy is taken along.
  const Mat3 own = curving(moment);
  std::array<Mat3, kMost> to_section;  // of M_i by z
  Stress result;
  for (std::size_t i = 0; i < count_; ++i) {
    result.moments[i] = carried_moment(i, moment);
    to_section[i] =
        -(carried_curving(i, moment) + 0.5 * cross_matrix(result.moments[i])) * place_.per_rotation;
  }
  for (std::size_t i = 0; i < count_; ++i) {
    const Mat3 moved_i = change[i].topRows<3>();
    for (std::size_t j = 0; j < count_; ++j) {
      const Mat3 moved_j = change[j].topRows<3>();
      result.stiffness[i][j] = to_section[i] * moved_j +
                               moved_i.transpose() * to_section[j].transpose() +
                               moved_i.transpose() * own * moved_j;
    }
    result.stiffness[i][i] += carried_curving(i, moment);
  }
  const Mat6 inverse = equations().inverse();
  const auto unbalanced = [&](std::size_t i) -> Mat3 {
    return own * change[i].topRows<3>() + to_section[i].transpose();
  };
  for (std::size_t i = 0; i < count_; ++i) {
    for (std::size_t j = 0; j < count_; ++j) {
      result.by_following[i][j] =
          -unbalanced(i).transpose() * inverse.topLeftCorner<3, 3>() * unbalanced(j);
    }
  }
  return result;
}

}  // namespace der
