#pragma once

#include <array>
#include <cstddef>

#include "der/core/types.hpp"
#include "der/energies/vertex_response.hpp"
#include "der/kinematics/section_frame.hpp"

namespace der {

/// Springs against turning and the rod on the way to them, in series.
struct SpringInSeries {
  Vec3 stiffness = Vec3::Zero();  ///< of the springs, towards the directors, about the tangent
                                  ///< [N m/rad]
  /// Compliance C [rad/(N m)] of the rod between the springs and what the edges tell, symmetric,
  /// in the axes of the section that the springs hold.
  Mat3 compliance = Mat3::Zero();
  SectionFrame drawn;  ///< where the springs exert no moment
};

/// A section that an edge or a clamp carries along rigidly.
struct CarriedSection {
  SectionFrame frame;
  double twist = 0.0;               ///< from the drawn section [rad], whole turns included
  Mat3 weights = Mat3::Identity();  ///< W [-]
};

/// The moments that act on the held section itself.
struct SectionLoad {
  Vec3 fixed = Vec3::Zero();    ///< that keeps its direction [N m]
  Vec3 turning = Vec3::Zero();  ///< along the two directors and the tangent of the section [N m]

  [[nodiscard]] bool is_zero() const { return fixed.isZero(0.0) && turning.isZero(0.0); }
  [[nodiscard]] Vec3 turned(const SectionFrame& section) const {
    return turning[0] * section.first + turning[1] * section.second + turning[2] * section.tangent;
  }
  [[nodiscard]] Vec3 on(const SectionFrame& section) const { return fixed + turned(section); }
  [[nodiscard]] SectionLoad times(double share) const { return {share * fixed, share * turning}; }
};

/// The section of a rod that springs hold, between or beside one or two that are known. It has the
/// rotation z from the drawn section, and to the known ones it has the rotations k_i, all as
/// vertices measure them (VertexKinematics). With the weights W_i of the known ones, which add up
/// to the unit matrix, the section lies where
///   E = 1/2 z . K z + 1/2 psi . C^-1 psi,   psi = sum_i W_i k_i
/// is least: the springs' moment bends and twists the rod on the way, about the axes that the
/// section has then. This holds for springs of any stiffness, and where there is no rod on the way,
/// C = 0: the equations are those of z and of the moment p, with K z = p and psi = C p. A moment m
/// on the section adds to K z what it does along z. It may have no potential: z and p solve the
/// equations all the same, and S is then not symmetric.
class HeldSection {
 public:
  static constexpr std::size_t kMost = 2;
  using CarriedSections = std::array<CarriedSection, kMost>;

  /// The first `count` sections are known.
  HeldSection(const SpringInSeries& spring, const CarriedSections& carried, std::size_t count);
  /// The same section under moments.
  [[nodiscard]] HeldSection under(const SectionLoad& load) const;

  [[nodiscard]] double energy() const { return energy_in_springs() + energy_on_the_way(); }
  [[nodiscard]] double energy_in_springs() const;
  [[nodiscard]] double energy_on_the_way() const;

  [[nodiscard]] const SectionFrame& section() const { return place_.section; }
  /// The derivatives of z by the rotation of the section, one a column: along them act the moments
  /// of the springs, k_i z_i each.
  [[nodiscard]] const Mat3& axes_of_springs() const { return place_.from_reference.slopes; }
  /// The rotation of the section by that of each known one [-], equilibrium being kept.
  [[nodiscard]] std::array<Mat3, kMost> turning() const;

  /// The moment [N m] M_i with dE = sum_i M_i . omega_i, for rotations of the known sections.
  [[nodiscard]] Vec3 moment(std::size_t i) const;
  /// The moment m on the section [N m].
  [[nodiscard]] Vec3 load() const { return load_.on(place_.section); }

  /// S_ij [N m]: M_i changes by sum_j S_ij omega_j - 1/2 M_i x omega_i, the held section moving so
  /// that E stays the least.
  using Stiffness = std::array<std::array<Mat3, kMost>, kMost>;
  [[nodiscard]] Stiffness stiffness() const;

  /// The moments M_i [N m] that small rotations [rad] of the known sections cause, and what they
  /// add to S_ij by turning with the rod, whose material stiffness and directions stay those of
  /// here. Under the stress the section follows the known ones otherwise: times the square of the
  /// load factor, that makes the stiffness `by_following`, which is never positive.
  struct Stress {
    std::array<Vec3, kMost> moments;
    Stiffness stiffness;
    Stiffness by_following;
  };
  [[nodiscard]] Stress stress(const std::array<Vec3, kMost>& rotations) const;

 private:
  using Vec6 = Eigen::Matrix<double, 6, 1>;
  using Mat6 = Eigen::Matrix<double, 6, 6>;
  /// A rotation between two sections, and its derivative by that of the second, one component a
  /// column.
  struct Rotation {
    VertexKinematics<AngleCurvature> kinematics;
    Vec3 strain;
    Mat3 slopes;
    explicit Rotation(const VertexKinematics<AngleCurvature>& vertex);
    /// S of a constant load on the rotation (VertexResponse).
    [[nodiscard]] Mat3 curving(const Vec3& load) const;
  };
  /// The section wherever it is, and its rotations.
  struct Place {
    SectionFrame section;
    Rotation from_reference;  // z
    std::array<Rotation, kMost> to_carried;
    Mat3 per_rotation;  // omega of the section by z
    Mat3 slopes;        // of -psi by z
    Vec3 way;           // psi
  };

  [[nodiscard]] Place place_at(const SectionFrame& section, double near) const;
  [[nodiscard]] Place turned(const Place& place, const Vec3& change) const;
  [[nodiscard]] Place on_the_way(Place place, const Vec3& moment) const;
  [[nodiscard]] Mat3 curving(const Vec3& moment) const;
  [[nodiscard]] Vec3 load_along_z() const;
  [[nodiscard]] Mat3 load_curving() const;
  [[nodiscard]] Mat3 carried_curving(std::size_t i, const Vec3& moment) const;
  [[nodiscard]] Vec3 carried_moment(std::size_t i, const Vec3& moment) const;
  [[nodiscard]] Mat6 equations() const;
  /// Change of z and p by the rotation of each known section.
  using Following = std::array<Eigen::Matrix<double, 6, 3>, kMost>;
  /// Derivatives of M_i by z and p.
  using Slopes = std::array<Eigen::Matrix<double, 3, 6>, kMost>;
  [[nodiscard]] Slopes slopes_of_moments() const;
  [[nodiscard]] Following following(const Slopes& slopes) const;
  [[nodiscard]] Vec6 newton_step() const;
  bool descend(const Mat3& per_compliance, double& shift);
  bool converge(double longest);
  void settle();
  void raise_load();

  const SpringInSeries& spring_;
  const CarriedSections& carried_;
  std::size_t count_;
  // Where z counts from: the drawn section; without springs a known one, from which the section is
  // never far.
  SectionFrame reference_;
  double reference_twist_;  // from the drawn section [rad]
  SectionLoad load_;
  Vec3 moment_ = Vec3::Zero();  // p
  Place place_;
  bool settled_ = false;  // in equilibrium
};

}  // namespace der
