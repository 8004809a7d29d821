// Warnings of numbers that are probably in another unit than the SI's.

#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

#include "der/scenario/scenario.hpp"
#include "scene_texts.hpp"

namespace der {
namespace {

using test::contains;
using Warnings = std::vector<std::string>;
using Materials = std::vector<std::pair<std::string, std::string>>;

Warnings warnings_of(const std::vector<Override>& overrides) {
  return test::beam(overrides).scene().warnings;
}
Warnings with_material(const std::string& modulus, const std::string& density,
                       const std::string& loads = "[]") {
  return warnings_of(
      {{"rods.beam.material", "{youngs_modulus: " + modulus + ", density: " + density + "}"},
       {"loads", loads}});
}

const std::string kGravity = "[{gravity: [0, -9.81]}]";

void check_one(const Warnings& warnings, const std::string& part) {
  REQUIRE(warnings.size() == 1);
  CAPTURE(warnings[0]);
  CHECK(contains(warnings[0], "rod 'beam' is "));
  CHECK(contains(warnings[0], part));
}

TEST_CASE("units: a rod that is thicker than long has its cross-section in mm") {
  const std::string section = "rods.beam.cross_section";
  check_one(warnings_of({{section, "{circle: {radius: 6}}"}}), "'radius' then is 0.006");
  check_one(warnings_of({{section, "{tube: {inner_radius: 5, outer_radius: 6}}"}}),
            "'outer_radius' then is 0.006");
  check_one(warnings_of({{section, "{rectangle: {width: 20, height: 2}}"}}),
            "'height' then is 0.002");
  CHECK(warnings_of({{section, "{circle: {radius: 0.5}}"}}).empty());
  CHECK(warnings_of({{section, "{rectangle: {width: 20, height: 0.002}}"}}).empty());
}

TEST_CASE("units: a modulus below that of any gel is in MPa") {
  check_one(with_material("1", "1100"), "'youngs_modulus' then is 1e+06");
  check_one(with_material("0.5", "1100", kGravity), "'youngs_modulus' then is 500000");
  CHECK(with_material("100", "1000").empty());
}

TEST_CASE("units: a density that only a foam has, with a modulus that no foam has, is in g/cm^3") {
  check_one(with_material("1e6", "1"), "'density' then is 1000");
  check_one(with_material("210e9", "7.85"), "'density' then is 7850");
  check_one(with_material("1e6", "1.1e6"), "'density' then is 1100");
  CHECK(with_material("1e4", "1").empty());       // metal microlattice
  CHECK(with_material("5e6", "15").empty());      // polystyrene foam
  CHECK(with_material("41e6", "24").empty());     // aramid honeycomb
  CHECK(with_material("6e11", "22590").empty());  // osmium
  // Nothing weighs or moves.
  CHECK(warnings_of({{"rods.beam.material", "{youngs_modulus: 1e9, density: 1}"},
                     {"time", ""},
                     {"analysis", "static"},
                     {"supports", "[{rod: beam, at: start, clamp: true}]"}})
            .empty());
}

TEST_CASE("units: loads that strain a rod by far more than it bears doubt its modulus") {
  // rho g L / E = 1000 * 9.81 * 1 / 210
  const Warnings hanging = with_material("210", "1000", kGravity);
  REQUIRE(hanging.size() == 1);
  CAPTURE(hanging[0]);
  CHECK(contains(hanging[0], "strained by 47"));
  CHECK(contains(hanging[0], "Is its modulus in kPa? 'youngs_modulus' then is 210000"));
  // F / EA = 1e5 / (1e7 pi 1e-4)
  const std::string pull = "[{point_force: {rod: beam, at: end, force: [1e5, 0]}}]";
  const Warnings pulled = with_material("1e7", "1000", pull);
  REQUIRE(pulled.size() == 1);
  CHECK(contains(pulled[0], "strained by 32"));
  CHECK(with_material("1e9", "1000", pull).empty());
  // A gel of 1 kPa that would hang by its own weight.
  CHECK(with_material("1000", "1000", kGravity).empty());
}

TEST_CASE("units: a metal or a stone that is as soft as a gel has its modulus in MPa or GPa") {
  // Steel, aluminium, copper, lead, glass, granite.
  check_one(with_material("210000", "7850"), "Is it in MPa? 'youngs_modulus' then is 2.1e+11");
  check_one(with_material("70000", "2700", kGravity), "'youngs_modulus' then is 7e+10");
  check_one(with_material("120e3", "8960"), "'youngs_modulus' then is 1.2e+11");
  check_one(with_material("16000", "11340"), "'youngs_modulus' then is 1.6e+10");
  check_one(with_material("70000", "2500"), "'youngs_modulus' then is 7e+10");
  check_one(with_material("210", "7850"), "Is it in GPa? 'youngs_modulus' then is 2.1e+11");
  check_one(with_material("16", "11340"), "Is it in GPa? 'youngs_modulus' then is 1.6e+10");
  // Nothing needs to move or to weigh.
  check_one(warnings_of({{"rods.beam.material", "{youngs_modulus: 210000, density: 7850}"},
                         {"time", ""},
                         {"analysis", "static"},
                         {"supports", "[{rod: beam, at: start, clamp: true}]"}}),
            "Is it in MPa?");
  // Gels, silicone, silicone with magnetic powder, lead.
  for (const auto& material : Materials{
           {"1e3", "1000"}, {"1e5", "1000"}, {"6e4", "1070"}, {"2e5", "3000"}, {"16e9", "11340"}}) {
    CAPTURE(material.first);
    CHECK(with_material(material.first, material.second).empty());
  }
}

TEST_CASE("units: a scene gets one warning, whatever else is wrong") {
  CHECK(warnings_of({{"rods.beam.cross_section", "{circle: {radius: 6}}"},
                     {"rods.beam.material", "{youngs_modulus: 1, density: 1}"},
                     {"loads", kGravity}})
            .size() == 1);
}

}  // namespace
}  // namespace der
