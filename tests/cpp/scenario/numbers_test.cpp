#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "der/core/constants.hpp"
#include "der/scenario/document.hpp"
#include "der/scenario/load.hpp"
#include "der/scenario/number_with_unit.hpp"
#include "der/scenario/scenario.hpp"
#include "scene_texts.hpp"

namespace der {
namespace {

using test::beam;
using test::contains;
using test::diagnostics;

/// The value that a number in the text is read as.
double read(const std::string& text) {
  const Scenario scene = beam({{"rods.beam.initial_velocity", "[" + text + ", 0]"}});
  return scene.scene().rods[0].initial_velocity.back()[0];
}

TEST_CASE("numbers: decimal notations") {
  const std::vector<std::pair<std::string, double>> notations{
      {"1e-3", 1e-3}, {".5", 0.5},        {"5.", 5.0},     {"+3", 3.0},
      {"-2", -2.0},   {"70e9", 70e9},     {"1E+2", 100.0}, {"0.1", 0.1},
      {"-.5e1", -5},  {"5e-150", 5e-150}, {"1e00", 1.0},
  };
  for (const auto& notation : notations) {
    const std::string& text = notation.first;
    CAPTURE(text);
    CHECK(read(text) == notation.second);
  }
}

TEST_CASE("numbers: what other readers would take differently is refused with a hint") {
  const std::vector<std::pair<std::string, std::string>> refused{
      {"010", "write 10 or 8"},
      {"-017", "write -17 or -15"},
      {"09", "write 9"},
      {"00.5", "write 0.5"},
      {"1_000", "write 1000"},
      {"0x1F", "write 31"},
      {"0b11", "write 3"},
      {"0o17", "write 15"},
      {"1d-3", "write 1e-3"},
      {".inf", "out of range"},
      {"-.INF", "out of range"},
      {"nan", "out of range"},
      {".NaN", "out of range"},
      {"infinity", "out of range"},
      {"1e999", "out of the range"},
      {"-1e999", "out of the range"},
      {"1e-999", "out of the range"},
      {"2 inch", "'inch' is not a unit of this kind: write the number in m"},
      {"2 kg", "'kg' is not a unit of this kind: write the number in m"},
      {"2 m^2", "'m^2' is not a unit of this kind"},
      {"2 m/s m", "'m/s m' is not a unit of this kind"},
      {"2 %", "'%' is not a unit of this kind"},
      {"010 mm", "write 10 or 8"},
      {"1e308 km", "out of the range"},
      {"1/2", "arithmetic is not evaluated"},
      {"2*3", "arithmetic is not evaluated"},
      {"2^3", "arithmetic is not evaluated"},
      {"1 2", "is a comma or a bracket missing?"},
      {"'0,5'", "a decimal has a point, not a comma: write 0.5"},
      {"'-1,5e-3'", "write -1.5e-3"},
      {"'1,234'", "write 1.234, or 1234 if the comma parts thousands"},
      {"'0,234'", "write 0.234"},
      {"'1,234,567'", "thousands have no separator: write 1234567"},
      {"1.234.567", "thousands have no separator: write 1234567"},
      {"'-1.234,5'", "thousands have no separator: write -1234.5"},
      {"'1,234.5e3'", "thousands have no separator: write 1234.5e3"},
      {"'1.234.567,5'", "thousands have no separator: write 1234567.5"},
      {"1 234", "thousands have no separator: write 1234"},
      {"1 234 567.5", "thousands have no separator: write 1234567.5"},
      {"'1 234,5'", "thousands have no separator: write 1234.5"},
      {"1\u00a0234", "write 1234"},
      {"1\u202f234", "write 1234"},
      {"1'234", "write 1234"},
      {"[1,234,567]", "got a list of 3 items"},
      {"'12,34,567'", "thousands no separator"},
      {"'1234,567'", "a decimal has a point, not a comma: write 1234.567"},
      {"0 234", "is a comma or a bracket missing?"},
      {"'1'", "remove the quotes"},
      {"1:30", "expected a number in m, got '1:30'"},
      {"1.2.3", "expected a number in m, got '1.2.3'"},
      {"1e", "expected a number in m, got '1e'"},
      {"e5", "expected a number in m, got 'e5'"},
      {"-", "expected a number in m, got '-'"},
      {".", "expected a number in m, got '.'"},
      {"''", "expected a number in m"},
      {"true", "expected a number in m, got 'true'"},
      {"~", "expected a number in m, got nothing"},
  };
  for (const auto& notation : refused) {
    const std::string& text = notation.first;
    CAPTURE(text);
    const std::string said = diagnostics({{"rods.beam.to", "[" + text + ", 0]"}});
    CAPTURE(said);
    CHECK(contains(said, "rods.beam.to.0: "));
    CHECK(contains(said, notation.second));
  }
}

double angle(const std::string& text) {
  const Scenario scene = beam({{"supports",
                                "[{rod: beam, at: start, clamp: true, prescribe: {angle: "
                                "{times: [0, 20 ms], values: [0, " +
                                    text + "]}}}]"}});
  return scene.scene().supports[0].rotation->values.back();
}

double stiffness(const std::string& text) {
  const Scenario scene = beam(
      {{"rods.beam.cross_section.circle", ""},
       {"rods.beam.material", ""},
       {"rods.beam.cross_section.stiffness", "{EA: 1, EI: " + text + ", mass_per_length: 1}"}});
  return *std::get<scenario::Stiffness>(scene.scene().rods[0].cross_section).EI;
}

double density(const std::string& text) {
  return beam({{"rods.beam.material.density", text}}).scene().rods[0].material->density;
}

double duration(const std::string& text) {
  return beam({{"time.duration", text}}).scene().time.duration;
}

TEST_CASE("numbers: a unit of the kind of the key may stand behind a number") {
  // The same bits as of the number in SI units.
  CHECK(read("5 m/s") == 5.0);
  CHECK(read("-12.3 mm/s") == -12.3e-3);
  CHECK(read(".7e2 cm/s") == 0.7);
  CHECK(read("1.1 µm/s") == 1.1e-6);
  CHECK(read("36 m/h") == 0.01);
  CHECK(read("6 km/min") == 100.0);
  CHECK(read("5\u00a0mm/s") == 5e-3);
  CHECK(read("'5 mm/s'") == 5e-3);
  CHECK(duration("20 ms") == 0.02);
  CHECK(duration("2 min") == 120.0);
  CHECK(density("1.19 g/cm^3") == 1190.0);
  CHECK(density("1190 kg/m3") == 1190.0);
  CHECK(density("1190 kg/m³") == 1190.0);
  CHECK(density("1.19 kg m^-3") == 1.19);
  for (const char* same : {"2.5 kN m^2", "2.5 kNm^2", "2.5 kN*m^2", "2.5 kN·m²", "2.5e3 Pa m^4"}) {
    CAPTURE(same);
    CHECK(stiffness(same) == 2500.0);
  }
  CHECK(angle("180 deg") == kPi);
  CHECK(angle("90°") == kPi / 2.0);
  CHECK(angle("-2.5 turn") == -5.0 * kPi);
  CHECK(angle("3 mrad") == 3e-3);
  CHECK(angle("45deg") == kPi / 4.0);
}

TEST_CASE("numbers: a frequency is no angular one, and a curvature no twist") {
  const std::string sine =
      diagnostics({{"loads", "[{gravity: {sine: {amplitude: [0, 1], frequency: 2 rad/s}}}]"}});
  CHECK(contains(sine, "'rad/s' is not a unit of this kind: write the number in Hz"));
  CHECK(contains(diagnostics({{"rods.beam.natural_curvature", "2 rad/m"}}), "'rad/m' is not"));
  CHECK(contains(diagnostics({{"rods.beam.initial_twist", "2/m"}}), "'/m' is not"));
  CHECK(beam({{"rods.beam.natural_curvature", "2/m"}}).to_yaml() ==
        beam({{"rods.beam.natural_curvature", "2.0"}}).to_yaml());
  CHECK(contains(diagnostics({{"rods.beam.material.poissons_ratio", "30 %"}}), "alone"));
  CHECK(contains(diagnostics({{"rods.beam.material.poissons_ratio", "0.3 rad"}}), "alone"));
}

TEST_CASE("numbers: a scene keeps them in SI units, and texts as they are") {
  const Scenario scene = beam({{"title", "5 mm"},
                               {"rods.beam.cross_section.circle.radius", "5 mm"},
                               {"loads", "[{gravity: [0, -981 cm/s^2]}]"}});
  CHECK(scene.scene().title == "5 mm");
  const std::string text = scene.to_yaml();
  CAPTURE(text);
  CHECK(contains(text, "title: 5 mm"));
  CHECK(contains(text, "radius: 0.005"));
  CHECK(contains(text, "gravity: [0, -9.81]"));
  CHECK(Scenario::parse(text).to_yaml() == text);
}

TEST_CASE("numbers: whole numbers") {
  CHECK(beam({{"rods.beam.nodes", "+3"}}).scene().rods[0].points.size() == 3);
  const std::vector<std::pair<std::string, std::string>> refused{
      {"11.0", "write 11"},           {"1e1", "write 10"},
      {"2.5", "got '2.5'"},           {"'3'", "remove"},
      {"4294967299", "is too large"}, {"99999999999999999999", "too large"},
      {"3 nodes", "alone"},           {"-3", "must be between"},
  };
  for (const auto& notation : refused) {
    const std::string& text = notation.first;
    CAPTURE(text);
    const std::string said = diagnostics({{"rods.beam.nodes", text}});
    CAPTURE(said);
    CHECK(contains(said, notation.second));
  }
}

TEST_CASE("numbers: typed values of a dictionary obey the same rules") {
  using scenario::make_scalar;
  const auto read_value = [](scenario::Value step) {
    scenario::Value scene = beam().document().root();
    for (auto& entry : std::get<scenario::Mapping>(scene.content)) {
      if (entry.key != "time") continue;
      std::get<scenario::Mapping>(entry.value.content)[1].value = std::move(step);
    }
    return Scenario::from_document(
               std::make_shared<const scenario::Document>(scenario::Document(std::move(scene))))
        .scene()
        .time.step;
  };
  CHECK(read_value(make_scalar(0.125)) == 0.125);
  CHECK(read_value(make_scalar(1)) == 1.0);
  CHECK_THROWS_AS(read_value(make_scalar(true)), SceneError);
  CHECK_THROWS_AS(read_value(make_scalar("0.1")), SceneError);
  CHECK_THROWS_AS(read_value(make_scalar(std::numeric_limits<double>::infinity())), SceneError);
  CHECK_THROWS_AS(read_value(make_scalar(std::nan(""))), SceneError);
  CHECK_THROWS_AS(read_value(scenario::make_null()), SceneError);
}

TEST_CASE("numbers: doubles survive a round trip bit for bit") {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> mantissa(0.1, 1.0);
  std::uniform_int_distribution<int> exponent(-300, 150);
  for (int i = 0; i < 200; ++i) {
    const double value = mantissa(random) * std::pow(10.0, exponent(random));
    CHECK(read(scenario::to_flow_yaml(scenario::make_scalar(value))) == value);
  }
  CHECK(scenario::to_flow_yaml(scenario::make_scalar(0.1)) == "0.1");
  CHECK(scenario::to_flow_yaml(scenario::make_scalar(3.0)) == "3.0");
  CHECK(scenario::to_flow_yaml(scenario::make_scalar(1e300)) == "1e+300");
}

}  // namespace
}  // namespace der
