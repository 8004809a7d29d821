// The curves of rods that are drawn by segments, against closed forms.

#include <doctest/doctest.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "der/core/constants.hpp"
#include "der/scenario/reader.hpp"
#include "der/scenario/scenario.hpp"

namespace der {
namespace {

using scenario::Components;
using scenario::Rod;

constexpr double kRounding = 4e-15;

Scenario scenario_of(const std::string& rod, const std::string& more = "") {
  return Scenario::parse(
      "rods: [{name: rod, cross_section: {stiffness: {EA: 1, EI: 1, GJ: 1, "
      "mass_per_length: 1}}, " +
      rod + "}]\nanalysis: static\n" + more);
}
Rod rod_of(const std::string& rod) { return scenario_of(rod).scene().rods.front(); }

/// From the origin, in the plane.
Rod planar_rod(int nodes, const std::string& shape) {
  return rod_of(fmt::format("nodes: {}, from: [0, 0], shape: {}", nodes, shape));
}

double apart(const Components& a, const Components& b) {
  double sum = 0.0;
  for (std::size_t c = 0; c < a.size(); ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return std::sqrt(sum);
}

TEST_CASE("segments: an arc is the one that its keys say, with nodes evenly on it") {
  const double s = std::sqrt(0.5);
  struct Given {
    std::string keys;
    Components centre;
    double angle;  // from the start to the end, about the centre [rad]
  };
  const double quarter = 0.5 * kPi;
  const std::vector<Given> all{
      {fmt::format("through: [{}, {}]", s, 1.0 - s), {0.0, 1.0}, quarter},
      {"centre: [0, 1]", {0.0, 1.0}, quarter},
      {"centre: [1, 0]", {1.0, 0.0}, -quarter},
      {"centre: [0, 1], longer: true", {0.0, 1.0}, quarter - 2.0 * kPi},
      {"radius: 1", {0.0, 1.0}, quarter},
      {"radius: -1", {1.0, 0.0}, -quarter},
      {"radius: 1, longer: true", {1.0, 0.0}, 2.0 * kPi - quarter},
      {"radius: -1, longer: true", {0.0, 1.0}, quarter - 2.0 * kPi},
      {fmt::format("radius: {}", s), {0.5, 0.5}, kPi},
  };
  constexpr int cells = 7;
  for (const Given& given : all) {
    CAPTURE(given.keys);
    const Rod rod = planar_rod(cells + 1, "[{arc: {to: [1, 1], " + given.keys + "}}]");
    REQUIRE(rod.points.size() == cells + 1);
    for (int k = 0; k <= cells; ++k) {
      const double turn = given.angle * k / cells;
      const double x = -given.centre[0];
      const double y = -given.centre[1];
      const Components on_circle{
          given.centre[0] + x * std::cos(turn) - y * std::sin(turn),
          given.centre[1] + x * std::sin(turn) + y * std::cos(turn),
      };
      CHECK(apart(rod.points[static_cast<std::size_t>(k)], on_circle) < kRounding);
    }
    CHECK(rod.points.back() == Components{1.0, 1.0});
    CHECK(rod.borders->corners.empty());
    CHECK(rod.borders->jumps.empty());
  }
}

TEST_CASE("segments: a flat arc keeps its digits") {
  constexpr double radius = 1e7;
  const Rod rod = planar_rod(3, fmt::format("[{{arc: {{to: [1, 0], radius: {}}}}}]", radius));
  CHECK(rod.points[1][0] == doctest::Approx(0.5).epsilon(1e-8));
  CHECK(rod.points[1][1] == doctest::Approx(-1.0 / (8.0 * radius)).epsilon(1e-6));
}

TEST_CASE("segments: an arc in space lies in the plane of its three points") {
  const Rod rod =
      rod_of("nodes: 3, from: [0, 0, 1], shape: [{arc: {to: [0, 3, -2], through: [0, 3, 1]}}]");
  CHECK(apart(rod.points[1], {0.0, 3.0, 1.0}) < 4.0 * kRounding);
}

TEST_CASE("segments: a helix turns by the right-hand rule about its axis") {
  for (const double pitch : {0.3, -0.3}) {
    const std::string shape =
        fmt::format("[{{helix: {{axis: [0, 0, 2], radius: 0.5, pitch: {}, turns: 1.25}}}}]", pitch);
    const Rod rod = rod_of("nodes: 11, from: [0.5, 0, 0], shape: " + shape);
    for (int k = 0; k <= 10; ++k) {
      const double turns = 0.125 * k;
      const double angle = 2.0 * kPi * turns;
      const Components on_helix{0.5 * std::cos(angle), 0.5 * std::sin(angle), pitch * turns};
      CHECK(apart(rod.points[static_cast<std::size_t>(k)], on_helix) < kRounding);
    }
  }
  const Rod rod = rod_of(
      "nodes: 3, from: [0.3, 0.4, 0], "
      "shape: [{helix: {axis: [0, 0, 1], centre: [0, 0, 7], pitch: 0.2, turns: 1}}]");
  CHECK(apart(rod.points[1], {-0.3, -0.4, 0.1}) < kRounding);
  const Rod along_x = rod_of(
      "nodes: 3, from: [0, 0, 0], "
      "shape: [{helix: {axis: [1, 0, 0], radius: 1, pitch: 0, turns: 0.5}}]");
  CHECK(apart(along_x.points.back(), {0.0, -2.0, 0.0}) < kRounding);
}

TEST_CASE("segments: corners and jumps of the curvature are known, and have nodes") {
  const double turn = 10.0 * kPi / 180.0;
  const Rod bent = planar_rod(6, fmt::format("[{{line: [1, 0]}}, {{line: [{}, {}]}}]",
                                             1.0 + 1.5 * std::cos(turn), 1.5 * std::sin(turn)));
  REQUIRE(bent.borders->corners == std::vector<int>{2});
  CHECK(bent.points[2] == Components{1.0, 0.0});
  CHECK(bent.borders->jumps.empty());

  // A line, a quarter circle, one back to the other side, and a line.
  const Rod wave = planar_rod(5,
                              "[{line: [1, 0]}, {arc: {to: [1.5, 0.5], radius: 0.5}}, "
                              "{arc: {to: [2, 1], radius: -0.5}}, {line: [3, 1]}]");
  CHECK(wave.borders->corners.empty());
  REQUIRE(wave.borders->jumps.size() == 3);
  const std::vector<double> jumps{2.0, -4.0, 2.0};
  for (std::size_t i = 0; i < jumps.size(); ++i) {
    CHECK(wave.borders->jumps[i].node == static_cast<int>(i) + 1);
    const std::array<double, 3>& turn_jump = wave.borders->jumps[i].turn;
    CHECK(std::abs(turn_jump[0]) + std::abs(turn_jump[1]) == 0.0);
    CHECK(turn_jump[2] == doctest::Approx(jumps[i]).epsilon(kRounding));
  }
}

TEST_CASE("segments: two arcs of one circle are one, also with rounded coordinates") {
  const Rod cut = planar_rod(8,
                             "[{arc: {to: [0.5, 0.13397], centre: [0, 1]}}, "
                             "{arc: {to: [1, 1], centre: [0, 1]}}]");
  const Rod whole = planar_rod(8, "[{arc: {to: [1, 1], centre: [0, 1]}}]");
  CHECK(cut.borders->corners.empty());
  CHECK(cut.borders->jumps.empty());
  for (std::size_t k = 0; k < whole.points.size(); ++k) {
    CHECK(apart(cut.points[k], whole.points[k]) < 1e-5);
  }
}

TEST_CASE("segments: a line is the rod from one point to another, to the bit") {
  const Rod drawn = rod_of("nodes: 12, from: [0.1, 0.7, 0.3], shape: [{line: [1, 0.3, -0.9]}]");
  const Rod straight = rod_of("nodes: 12, from: [0.1, 0.7, 0.3], to: [1, 0.3, -0.9]");
  CHECK(drawn.points == straight.points);
}

TEST_CASE("segments: a ring knows whether it is smooth where it begins") {
  const std::string ring = "closed: true, nodes: 8, from: [0, 0], shape: ";
  const Rod circle = rod_of(ring +
                            "[{arc: {to: [2, 0], through: [1, -1]}}, "
                            "{arc: {to: [0, 0], through: [1, 1]}}]");
  CHECK(circle.borders->corners.empty());
  CHECK(circle.borders->jumps.empty());
  CHECK(apart(circle.points[4], {2.0, 0.0}) < kRounding);
  CHECK(circle.points.size() == 8);
  const Rod moon = rod_of(ring + "[{arc: {to: [2, 0], through: [1, -1]}}, {line: [0, 0]}]");
  CHECK(moon.borders->corners == std::vector<int>{0, 5});
  const Rod spline = rod_of(ring + "[{spline: [[1, -1], [2, 0], [1, 1], [0, 0]]}]");
  CHECK(spline.borders->corners.empty());
  CHECK(apart(spline.points[2], {1.0, -1.0}) < 1e-12);
}

TEST_CASE("segments: a spline of three points is a parabola with nodes at even arc lengths") {
  const Rod rod = rod_of("nodes: 5, from: [-1, 1], shape: [{spline: [[0, 0], [1, 1]]}]");
  const auto length = [](double x) {  // of y = x^2 from 0 on
    const double root = std::sqrt(1.0 + 4.0 * x * x);
    return 0.5 * x * root + 0.25 * std::asinh(2.0 * x);
  };
  for (const Components& point : rod.points) {
    CHECK(std::abs(point[1] - point[0] * point[0]) < kRounding);
  }
  CHECK(length(rod.points[3][0]) == doctest::Approx(0.5 * length(1.0)).epsilon(1e-13));
}

TEST_CASE("segments: a spline has order 4") {
  double before = 0.0;
  for (const int count : {20, 40}) {
    std::string points;
    for (int i = 1; i <= count; ++i) {
      const double angle = i * kPi / count;
      points += fmt::format("[{}, {}],", std::sin(angle), 1.0 - std::cos(angle));
    }
    const Rod rod = planar_rod(51, "[{spline: [" + points + "]}]");
    double error = 0.0;
    for (const Components& point : rod.points) {
      error = std::max(error, std::abs(std::hypot(point[0], point[1] - 1.0) - 1.0));
    }
    if (before > 0.0) CHECK(before / error > 12.0);
    before = error;
  }
}

TEST_CASE("segments: places count along the curve") {
  // A node at a third of a half circle, given by its arc length.
  const Scenario scenario =
      scenario_of("nodes: 7, from: [0, 0], shape: [{arc: {to: [0, 2], radius: 1}}]",
                  fmt::format("supports: [{{rod: rod, at: {}, fix: [x, y]}}]\n", kPi / 3.0));
  const Rod& rod = scenario.scene().rods.front();
  const double edge = apart(rod.points[0], rod.points[1]);
  CHECK(scenario.scene().supports[0].at.arc_length == doctest::Approx(2.0 * edge).epsilon(1e-14));
}

}  // namespace
}  // namespace der
