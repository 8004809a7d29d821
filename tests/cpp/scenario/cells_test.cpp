// Warnings of springs against turning, bearings, moments and loads that follow, which act in the
// cell of one node but not at one place: between the same middles of edges.

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "der/scenario/scenario.hpp"
#include "scene_texts.hpp"

namespace der {
namespace {

using test::contains;
using Warnings = std::vector<std::string>;

/// The warnings of the beam with these supports and loads. Its edges of 0.1 m have their middles at
/// 0.05 m, 0.15 m, ...
Warnings warnings_of(const std::string& supports, const std::string& loads) {
  return test::beam({{"supports", "[" + supports + "]"}, {"loads", "[" + loads + "]"}})
      .scene()
      .warnings;
}

std::string spring(const std::string& at) {
  return "{rod: beam, at: " + at + ", spring: {rotational_stiffness: 3}}";
}
std::string moment(const std::string& at, const std::string& value = "1") {
  return "{moment: {rod: beam, at: " + at + ", moment: " + value + "}}";
}
std::string follower(const std::string& at) {
  return "{point_force: {rod: beam, at: " + at + ", force: [0, 1], follower: true}}";
}
std::string following_moment(const std::string& at) {
  return "{moment: {rod: beam, at: " + at + ", moment: [0, 0, 1], follower: true}}";
}

TEST_CASE("cells: a moment near a spring is warned of, with what to do") {
  const Warnings warnings = warnings_of(spring("start"), moment("0.04"));
  REQUIRE(warnings.size() == 1);
  CHECK(
      contains(warnings[0], "supports.0.spring and loads.0.moment act on rod 'beam' within 0.04"));
  CHECK(contains(warnings[0],
                 "Put both at one place, write 'joints: [{name: here, of: [{rod: beam, at: 0}]}]', "
                 "or give the rod about 26 nodes"));
}

TEST_CASE("cells: at one place, in the middle of an edge and in other cells nothing is warned of") {
  for (const char* at : {"start", "0.15", "0.2"}) {
    CAPTURE(at);
    CHECK(warnings_of(spring("start"), moment(at)).empty());
  }
  CHECK(warnings_of(spring("0.46"), moment("0.55")).empty());
  CHECK(warnings_of(spring("0.46"), moment("0.54")).size() == 1);
  CHECK(warnings_of(spring("0.46"), moment("0.56")).empty());
  CHECK(warnings_of(spring("0.96"), moment("end")).size() == 1);
}

TEST_CASE("cells: beside a free end what acts in the next cell is warned of, too") {
  for (const char* at : {"0.05", "0.06", "0.1", "0.149"}) {
    CAPTURE(at);
    CHECK(warnings_of(spring("start"), moment(at)).size() == 1);
    CHECK(warnings_of(spring("0.03"), moment(at)).size() == 1);
  }
  const Warnings warnings = warnings_of(spring("0.92"), moment("end"));
  REQUIRE(warnings.size() == 1);
  CHECK(contains(warnings[0], "both act within an edge and a half of its free end"));
  CHECK(contains(warnings[0], "or give the rod about 20 nodes"));
  CHECK(warnings_of(spring("0.85"), moment("end")).empty());
  const std::string clamp = "{rod: beam, at: start, clamp: true}, ";
  CHECK(warnings_of(clamp + spring("0.03"), moment("0.08")).empty());
}

TEST_CASE("cells: the nearest pair is told, and no count of nodes where none would do") {
  const Warnings warnings =
      warnings_of(spring("0.3") + ", " + spring("0.30001"), moment("0.32") + ", " + moment("0.9"));
  REQUIRE(warnings.size() == 1);
  CHECK(contains(warnings[0], "supports.0.spring and supports.1.spring"));
  CHECK_FALSE(contains(warnings[0], "about"));
}

TEST_CASE("cells: springs that do not resist turning, and loads of clamps, do not matter") {
  const std::string pull = "{rod: beam, at: start, spring: {stiffness: [3, 3]}}";
  CHECK(warnings_of(pull, moment("0.04")).empty());
  const std::string wall = "{rod: beam, at: start, clamp: true}";
  CHECK(warnings_of(wall, moment("0.04")).empty());
  const Warnings held = warnings_of(wall + ", " + spring("0.04"), follower("start"));
  REQUIRE(held.size() == 1);
  CHECK(contains(held[0], "the support takes it up"));
}

TEST_CASE("cells: loads that follow feel moments and springs, and not one another") {
  const std::string pin = "{rod: beam, at: end, clamp: true}";
  CHECK(warnings_of(pin, follower("start") + ", " + moment("0.04")).size() == 1);
  CHECK(warnings_of(pin, follower("start") + ", " + follower("0.04")).empty());
  CHECK(warnings_of(pin + ", " + spring("0.04"), follower("start")).size() == 1);
}

/// The same for the beam in space with a rectangular section.
Warnings in_space(const std::string& supports, const std::string& loads) {
  return test::beam({{"rods.beam.from", "[0, 0, 0]"},
                     {"rods.beam.to", "[1, 0, 0]"},
                     {"rods.beam.cross_section",
                      "{rectangle: {width: 0.02, height: 0.01}, director: [0, 1, 1]}"},
                     {"rods.beam.material.poissons_ratio", "0.3"},
                     {"supports", "[" + supports + "]"},
                     {"loads", "[" + loads + "]"}})
      .scene()
      .warnings;
}

TEST_CASE("cells: bearings in space are springs, clamps at ends are not") {
  const std::string near = moment("0.53", "[0, 0, 1]");
  CHECK(in_space("{rod: beam, at: middle, clamp: tangent}", near).size() == 1);
  CHECK(in_space("{rod: beam, at: middle, clamp: true}", near).empty());
  CHECK(in_space("{rod: beam, at: end, clamp: tangent}", moment("0.98", "[0, 0, 1]")).empty());
  const std::string at_bearing = moment("middle", "[1, 0, 0]");
  CHECK(in_space("{rod: beam, at: middle, clamp: tangent}", at_bearing).empty());
}

TEST_CASE("cells: moments that follow in space feel one another") {
  const std::string wall = "{rod: beam, at: start, clamp: true}";
  const std::string fixed = moment("0.5", "[0, 0, 1]");
  CHECK(in_space(wall, fixed + ", " + following_moment("0.52")).size() == 1);
  CHECK(in_space(wall, following_moment("0.5") + ", " + following_moment("0.52")).size() == 1);
}

TEST_CASE("cells: the cell of the start of a ring reaches to both sides") {
  const auto ring = [](const std::string& at) {
    return test::beam({{"rods.beam.nodes", ""},
                       {"rods.beam.from", ""},
                       {"rods.beam.to", ""},
                       {"rods.beam.points", "[[0, 0], [1, 0], [1, 1], [0, 1]]"},
                       {"rods.beam.closed", "true"},
                       {"supports", "[{rod: beam, at: 2, fix: [x, y]}, " + spring(at) + "]"},
                       {"loads", "[" + moment("0.3") + "]"}})
        .scene()
        .warnings;
  };
  CHECK(ring("3.9").size() == 1);
  CHECK(ring("0.4").size() == 1);
  CHECK(ring("3.4").empty());
}

}  // namespace
}  // namespace der
