#include "der/scenario/out_of_plane.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <type_traits>
#include <variant>

#include "der/scenario/load.hpp"
#include "scenario/directions.hpp"

namespace der::scenario {
namespace {

bool is_zero_over_time(const VectorSeries& series) {
  for (const Components& value : series.values) {
    if (!is_zero(value)) return false;
  }
  return true;
}

std::string unknown_twisting(const Rod& rod) {
  if (is_cable(rod) || has_torsional_stiffness(rod)) return {};
  const char* advice = "give its material a 'poissons_ratio' or a 'shear_modulus'";
  if (const auto* direct = std::get_if<Stiffness>(&rod.cross_section)) {
    advice = direct->EI ? "give 'GJ' beside 'EI', or 'EI1', 'EI2' and 'GJ' where bending out of "
                          "the plane has another stiffness"
                        : "give 'GJ' beside 'EI1' and 'EI2'";
  }
  return fmt::format("the stiffness of rod '{}' against twisting is not known: {}", rod.name,
                     advice);
}

struct WithoutPotential {
  std::size_t number;
  bool is_set;  ///< by a program, to any value

  std::string operator()(const Moment& load) const {
    if (!is_set && is_zero(load.moment)) return {};
    return fmt::format("loads.{}.moment has no potential in space", number);
  }
  std::string operator()(const PointForce& load) const {
    if (!load.follower || (!is_set && is_zero_over_time(load.force))) return {};
    return fmt::format("loads.{}.point_force turns with the rod and has no potential", number);
  }
  template <class Kind>
  std::string operator()(const Kind& /*load*/) const {
    return {};
  }
};

}  // namespace

std::string why_not_tested_out_of_plane(const Scene& scene) {
  if (!scene.joints.empty()) return "this version tests no joints there";
  for (std::size_t i = 0; i < scene.loads.size(); ++i) {
    std::string clause =
        std::visit(WithoutPotential{i, !scene.loads[i].name.empty()}, scene.loads[i].what);
    if (!clause.empty()) return clause;
  }
  for (std::size_t i = 0; i < scene.supports.size(); ++i) {
    const auto& spring = scene.supports[i].spring;
    if (!spring || spring->rotational_stiffness.empty()) continue;
    return fmt::format("the spring of supports.{} against rotation is one about z alone", i);
  }
  for (const Rod& rod : scene.rods) {
    std::string clause = unknown_twisting(rod);
    if (!clause.empty()) return clause;
  }
  return {};
}

}  // namespace der::scenario
