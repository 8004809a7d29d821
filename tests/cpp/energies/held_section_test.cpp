#include "der/energies/held_section.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "energies/sample_elements.hpp"

namespace der::test {
namespace {

SectionFrame turned(const SectionFrame& section, const Vec3& rotation) {
  const double angle = rotation.norm();
  if (angle == 0.0) return section;
  const Mat3 turn = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  return SectionFrame::of(turn * section.tangent, turn * section.first);
}

Vec3 vector(const MaterialCurvature& strain) {
  return {strain.kappa_1, strain.kappa_2, strain.twist};
}

/// A spring on one edge that has turned by up to half a radian, and what its rod stores.
struct OnOneEdge {
  SpringInSeries spring;
  HeldSection::CarriedSections carried;

  explicit OnOneEdge(Random& random) {
    spring.drawn = sample_frame(direction(random), random);
    spring.stiffness = {uniform(random, 0.1, 3.0), uniform(random, 0.1, 3.0), 0.0};
    spring.compliance.diagonal() << 0.2, 0.7, 0.4;
    carried[0].frame = turned(spring.drawn, uniform(random, 0.0, 0.5) * direction(random));
    carried[0].twist = twist_between(spring.drawn, carried[0].frame);
  }
  [[nodiscard]] HeldSection held() const { return {spring, carried, 1}; }
  [[nodiscard]] Vec3 from_reference(const SectionFrame& section) const {
    using Kinematics = VertexKinematics<AngleCurvature>;
    const double twist = twist_between(spring.drawn, section);
    return vector(Kinematics(spring.drawn, section, twist).strain());
  }
  [[nodiscard]] Vec3 to_edge(const SectionFrame& section) const {
    using Kinematics = VertexKinematics<AngleCurvature>;
    const double twist = twist_between(section, carried[0].frame);
    return vector(Kinematics::read_before(section, carried[0].frame, twist).strain());
  }
  [[nodiscard]] double energy_at(const SectionFrame& section) const {
    const Vec3 z = from_reference(section);
    const Vec3 psi = to_edge(section);
    return 0.5 *
           (z.dot(spring.stiffness.cwiseProduct(z)) + psi.dot(spring.compliance.inverse() * psi));
  }
};

}  // namespace

TEST_CASE("a section on springs lies where the energy of springs and rod is least") {
  Random random(20261124);
  for (int sample = 0; sample < 20; ++sample) {
    const OnOneEdge one(random);
    const double least = one.held().energy();
    double found = one.energy_at(one.carried[0].frame);
    SectionFrame section = one.carried[0].frame;
    for (int trial = 0; trial < 4000; ++trial) {
      const double reach = std::pow(10.0, uniform(random, -5.0, -0.5));
      const SectionFrame other = turned(section, reach * direction(random));
      const double energy = one.energy_at(other);
      CHECK(energy > least - 1e-12);
      if (energy >= found) continue;
      found = energy;
      section = other;
    }
    CHECK(found == doctest::Approx(least).epsilon(1e-6));
  }
}

TEST_CASE("springs without rod on the way turn as the edge does, rigid ones not at all") {
  Random random(5);
  for (int sample = 0; sample < 20; ++sample) {
    OnOneEdge one(random);
    const double free = one.energy_at(one.carried[0].frame);  // nothing on the way
    OnOneEdge rigid = one;
    one.spring.compliance.setZero();
    CHECK(one.held().energy() == doctest::Approx(free).epsilon(1e-12));
    CHECK(one.held().energy_on_the_way() == 0.0);

    const Vec3 psi = rigid.to_edge(rigid.spring.drawn);
    const double way = 0.5 * psi.dot(rigid.spring.compliance.inverse() * psi);
    for (const double stiffness : {1e12, 1e300}) {
      rigid.spring.stiffness.setConstant(stiffness);
      CHECK(rigid.held().energy() == doctest::Approx(way).epsilon(1e-10));
      CHECK(rigid.held().energy_in_springs() < 1e-11);
    }
  }
}

// Turns are differences of numbers of the order of 1: rounded, they are of 1e-16.
TEST_CASE("a section at rest exerts no moment but by rounding") {
  Random random(7);
  OnOneEdge one(random);
  one.carried[0].frame = one.spring.drawn;
  one.carried[0].twist = 0.0;
  CHECK(one.held().energy() < 1e-30);
  CHECK(one.held().moment(0).norm() < 1e-14);
}

}  // namespace der::test
