// Every kind of load in `scenario::AnyLoad`, on the sample of it in tests/load_samples.yaml: what
// the engine does with loads of all kinds has to reach a new one too.
#include "der/loads/loads.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "der/building/builder.hpp"
#include "der/core/error.hpp"
#include "der/energies/circulatory_load.hpp"
#include "der/loads/external_force.hpp"
#include "der/model/state.hpp"
#include "der/scenario/reader.hpp"
#include "der/scenario/scenario.hpp"
#include "der/steppers/fine_tables.hpp"

namespace der::test {
namespace {

using Json = nlohmann::json;

Scenario samples(const std::vector<Override>& overrides = {}) {
  return Scenario::load(DER_SOURCE_DIR "/tests/load_samples.yaml", overrides);
}

std::string_view kind_of(const scenario::Load& load) {
  return std::visit([](const auto& what) -> std::string_view { return what.kKey; }, load.what);
}

/// The scene with none but one of its loads.
scenario::Scene with_only(std::size_t number) {
  scenario::Scene scene = samples().scene();
  scene.loads = {scene.loads[number]};
  return scene;
}

/// The paths of a kind of load whose value may be a table over time, as the schema has them.
std::vector<std::string> paths_of_tables(std::string_view kind) {
  static const Json schema = Json::parse(json_schema());
  const Json& definitions = schema["$defs"];
  const std::string name(kind);
  const auto may_be_table = [](const Json& property) {
    return property.dump().find("#/$defs/table") != std::string::npos;
  };
  std::vector<std::string> paths;
  if (!definitions.contains(kind)) {  // a load without keys of its own
    if (may_be_table(definitions["load"]["properties"][name])) paths.push_back(name);
    return paths;
  }
  for (const auto& [key, property] : definitions[name]["properties"].items()) {
    if (may_be_table(property)) paths.push_back(name + "." + key);
  }
  return paths;
}

/// External forces [N] of a model at rest at a time [s].
Vector force_at(double t, const Model& model) {
  State state = initial_state(model);
  Vector force;
  Configuration here = configuration_of(model, state);
  evaluate_controls(model, state, t, here.controls);
  external_force(model, here, state.extra_force, force);
  return force;
}

/// Largest force [N] of the model's loads at rest, or moment [N m] of an element, over time.
double largest_force(const Model& model) {
  double largest = 0.0;
  Configuration here;
  Vector force;
  for (const double t : {0.0, 0.1, 0.2}) {
    model.tables.evaluate(t, here.controls);
    external_force(model, here, Vector::Zero(model.num_dofs()), force);
    largest = std::max(largest, force.lpNorm<Eigen::Infinity>());
    if (here.controls.size() > 0) {
      largest = std::max(largest, here.controls.lpNorm<Eigen::Infinity>());
    }
  }
  return largest;
}

}  // namespace

TEST_CASE("loads: every kind has a key in the scene and a sample") {
  std::vector<std::string> kinds;
  for (const std::string_view kind : scenario::load_kinds()) kinds.emplace_back(kind);
  const Json schema = Json::parse(json_schema());
  std::vector<std::string> keys;
  for (const auto& [key, property] : schema["$defs"]["load"]["properties"].items()) {
    if (key != "name") keys.push_back(key);
  }
  std::vector<std::string> sampled;
  const Scenario scenario = samples();
  for (const auto& load : scenario.scene().loads) sampled.emplace_back(kind_of(load));
  for (auto* names : {&kinds, &keys, &sampled}) std::sort(names->begin(), names->end());
  CHECK(fmt::format("{}", fmt::join(keys, " ")) == fmt::format("{}", fmt::join(kinds, " ")));
  CHECK(fmt::format("{}", fmt::join(sampled, " ")) == fmt::format("{}", fmt::join(kinds, " ")));
}

TEST_CASE("loads: the warning of fine tables looks at every table of every kind") {
  const Scenario scenario = samples();
  const std::vector<std::string> warnings = fine_table_warnings(scenario.scene(), 0.005);
  const auto warned = [&](const std::string& path) {
    return std::any_of(warnings.begin(), warnings.end(), [&](const std::string& warning) {
      return warning.find(path + " has entries at 0 and 0.001 s") != std::string::npos;
    });
  };
  std::size_t tables = 0;
  const auto& loads = scenario.scene().loads;
  for (std::size_t i = 0; i < loads.size(); ++i) {
    for (const std::string& end : paths_of_tables(kind_of(loads[i]))) {
      const std::string path = fmt::format("loads.{}.{}", i, end);
      CAPTURE(path);
      CHECK(warned(path));
      ++tables;
    }
  }
  CHECK(tables >= 3);
  CHECK(warnings.size() == tables);
}

TEST_CASE("loads: a static analysis refuses the tables of every kind") {
  const Scenario scenario = samples();
  std::string message;
  try {
    samples({{"time", ""}, {"analysis", "static"}});
  } catch (const SceneError& error) {
    message = error.what();
  }
  const auto& loads = scenario.scene().loads;
  for (std::size_t i = 0; i < loads.size(); ++i) {
    for (const std::string& end : paths_of_tables(kind_of(loads[i]))) {
      const std::string path = fmt::format("loads.{}.{}", i, end);
      CAPTURE(message);
      CHECK(message.find(path) != std::string::npos);
    }
  }
}

TEST_CASE("loads: set to zero, each kind leaves no force behind and keeps its tables") {
  const std::size_t count = samples().scene().loads.size();
  for (std::size_t i = 0; i < count; ++i) {
    scenario::Scene scene = with_only(i);
    CAPTURE(kind_of(scene.loads[0]));
    const Model loaded = build_model(scene);
    set_to_zero(scene.loads[0]);
    const Model unloaded = build_model(scene);
    CHECK(largest_force(unloaded) == 0.0);
    CHECK(unloaded.tables.size() == loaded.tables.size());
    CHECK(unloaded.damped == loaded.damped);
  }
}

TEST_CASE("loads: a force that follows the rod, set to zero, leaves no force behind") {
  scenario::Scene scene = samples({{"loads.3.point_force.follower", "true"}}).scene();
  scene.loads = {scene.loads[3]};
  const Model loaded = build_model(scene);
  REQUIRE(circulatory_loads(*loaded.elements).size() == 1);
  set_to_zero(scene.loads[0]);
  const Model unloaded = build_model(scene);
  CHECK(largest_force(loaded) > 0.0);
  CHECK(largest_force(unloaded) == 0.0);
  CHECK(unloaded.tables.size() == loaded.tables.size());
}

// The sanitizers see here, too, whether a vector of two components is read as one of three.
TEST_CASE("loads: every kind has the forces and the drag in space that it has in the plane") {
  const scenario::Scene in_space =
      samples({{"model", "spatial"}, {"rods.rod.cross_section.stiffness.GJ", "0.4"}}).scene();
  for (std::size_t i = 0; i < in_space.loads.size(); ++i) {
    CAPTURE(kind_of(in_space.loads[i]));
    scenario::Scene scene = in_space;
    scene.loads = {scene.loads[i]};
    const Model spatial = build_model(scene);
    const Model planar = build_model(with_only(i));
    REQUIRE(spatial.dimension == 3);
    for (const double t : {0.0, 0.1}) {
      const Vector expected = force_at(t, planar);
      const Vector found = force_at(t, spatial);
      for (Index node = 0; node < planar.num_nodes; ++node) {
        const Index first = spatial.dof(node, 0);
        CHECK(found.segment<2>(first) == expected.segment<2>(planar.dof(node, 0)));
        CHECK(found[first + 2] == 0.0);
        CHECK(spatial.damping.segment<2>(first) == planar.damping.segment<2>(planar.dof(node, 0)));
      }
    }
  }
}

TEST_CASE("loads: a wrong rod, place or part of a rod is refused for every kind") {
  const Json schema = Json::parse(json_schema());
  const auto message_of = [](const std::vector<Override>& overrides) -> std::string {
    try {
      samples(overrides);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::vector<std::pair<const char*, const char*>> mistakes{
      {"rod", "nobody"}, {"at", "7.5"}, {"from", "7.5"}, {"to", "7.5"}};
  const Scenario scenario = samples();
  for (std::size_t i = 0; i < scenario.scene().loads.size(); ++i) {
    const std::string kind(kind_of(scenario.scene().loads[i]));
    if (!schema["$defs"].contains(kind)) continue;
    for (const auto& [key, value] : mistakes) {
      if (!schema["$defs"][kind]["properties"].contains(key)) continue;
      const std::string path = fmt::format("loads.{}.{}.{}", i, kind, key);
      CAPTURE(path);
      std::vector<Override> overrides{{path, value}};
      // A part that begins beyond its end is another mistake.
      if (std::string_view(key) == "from") {
        overrides.emplace_back(fmt::format("loads.{}.{}.to", i, kind), "");
      }
      CHECK(message_of(overrides).find(path) != std::string::npos);
    }
  }
}

}  // namespace der::test
