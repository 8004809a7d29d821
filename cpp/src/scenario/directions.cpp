#include "scenario/directions.hpp"

#include <algorithm>
#include <cmath>

namespace der::scenario {
namespace {

Vec3 first_edge(const Rod& rod) { return in_space(rod.points[1]) - in_space(rod.points[0]); }

/// The director as a unit vector, whatever length is given.
Vec3 director_of(const Rod& rod) {
  return rod.director ? in_space(*rod.director).stableNormalized() : Vec3::UnitZ();
}

struct IsIsotropic {
  bool operator()(const Circle& /*section*/) const { return true; }
  bool operator()(const Tube& /*section*/) const { return true; }
  bool operator()(const Rectangle& section) const { return section.width == section.height; }
  bool operator()(const Ellipse& section) const { return section.width == section.height; }
  bool operator()(const Stiffness& section) const {
    return section.EI || section.EI1 == section.EI2;
  }
};

}  // namespace

Vec3 in_space(const Components& components) {
  return {components[0], components[1], along_z(components)};
}

double along_z(const Components& components) { return components.size() > 2 ? components[2] : 0.0; }

bool is_isotropic(const CrossSection& section) { return std::visit(IsIsotropic{}, section); }

bool is_cable(const Rod& rod) {
  const auto* direct = std::get_if<Stiffness>(&rod.cross_section);
  return direct && (direct->EI ? direct->EI : direct->EI1) == 0.0;
}

bool has_torsional_stiffness(const Rod& rod) {
  if (const auto* direct = std::get_if<Stiffness>(&rod.cross_section)) {
    return direct->GJ.has_value();
  }
  return rod.material->poissons_ratio || rod.material->shear_modulus;
}

DampingTimes damping_of(const Rod& rod) {
  if (const auto* direct = std::get_if<Stiffness>(&rod.cross_section)) return direct->damping;
  return rod.material ? rod.material->damping : DampingTimes{};
}

bool is_straight(const Rod& rod) {
  const Vec3 start = in_space(rod.points.front());
  const Vec3 chord = in_space(rod.points.back()) - start;
  const double scale = std::max({start.norm(), in_space(rod.points.back()).norm(), chord.norm()});
  double reached = 0.0;
  for (std::size_t i = 1; i < rod.points.size(); ++i) {
    const Vec3 offset = in_space(rod.points[i]) - start;
    const double along = offset.dot(chord) / chord.norm();
    const double beside = offset.cross(chord).norm() / chord.norm();
    if (along <= reached || beside > kRounding * scale) return false;
    reached = along;
  }
  return true;
}

bool is_flat(const Rod& rod) {
  const double z = along_z(rod.points.front());
  return std::all_of(rod.points.begin(), rod.points.end(),
                     [z](const Components& point) { return along_z(point) == z; });
}

bool has_width_direction(const Rod& rod) {
  constexpr double parallel = 1e-9;  // [rad]
  const Vec3 director = director_of(rod);
  const Vec3 edge = first_edge(rod);
  return director.cross(edge).norm() > parallel * edge.norm();
}

FlatDirector flat_director(const Rod& rod) {
  const Vec3 normal = Vec3::UnitZ().cross(first_edge(rod)).normalized();
  const Vec3 director = director_of(rod);
  const FlatDirector along{director.dot(normal), director.z()};
  const double length = std::hypot(along.normal, along.z);
  return {along.normal / length, along.z / length};
}

}  // namespace der::scenario
