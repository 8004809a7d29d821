#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "der/catalog/quantities.hpp"
#include "der/catalog/steppers.hpp"
#include "scene_texts.hpp"

namespace der {
namespace {

using Json = nlohmann::json;

void collect_references(const Json& node, std::set<std::string>& found) {
  if (node.is_object() && node.contains("$ref")) found.insert(node["$ref"].get<std::string>());
  for (const Json& child : node) {
    if (child.is_structured()) collect_references(child, found);
  }
}

TEST_CASE("schema: has the keys of the contract and no others") {
  const Json schema = Json::parse(json_schema());
  CHECK(schema["$schema"] == "https://json-schema.org/draft/2020-12/schema");
  CHECK(schema["additionalProperties"] == false);
  CHECK(schema["required"] == Json::array({"rods"}));
  const std::set<std::string> keys{"title",      "model",  "rods",  "joints",    "springs",
                                   "supports",   "loads",  "time",  "actuation", "analysis",
                                   "start_from", "solver", "output"};
  std::set<std::string> found;
  for (const auto& [key, value] : schema["properties"].items()) found.insert(key);
  CHECK(found == keys);
  const Json& rod = schema["$defs"]["rod"];
  CHECK(rod["properties"]["nodes"]["minimum"] == 2);
  CHECK(rod["properties"]["curvature"]["default"] == "angle");
  CHECK(rod["allOf"][0]["oneOf"][0]["required"] == Json::array({"nodes", "from", "to"}));
  CHECK(rod["allOf"][0]["oneOf"][1]["required"] == Json::array({"nodes", "from", "shape"}));
  CHECK(rod["allOf"][0]["oneOf"][1]["properties"] == Json{{"to", false}, {"points", false}});
  CHECK(rod["allOf"][0]["oneOf"][2]["properties"]["nodes"] == false);
  CHECK(schema["$defs"]["tube"]["properties"]["outer_radius"]["exclusiveMinimum"] == 0);
  const Json& load = schema["$defs"]["load"];  // one of the kinds beside a name
  CHECK(load["oneOf"].size() + 1 == load["properties"].size());
  CHECK(load["oneOf"][0] == Json{{"required", {"gravity"}}});
  const Json& section = schema["$defs"]["cross-section"];  // one of the kinds beside a director
  CHECK(section["oneOf"].size() == 5);
  CHECK(section["oneOf"][0] == Json{{"required", {"circle"}}});
  CHECK(section["properties"]["director"]["minItems"] == 2);
  CHECK(section["properties"]["director"]["maxItems"] == 3);
  CHECK(schema["$defs"]["rotation"]["properties"]["axis"]["minItems"] == 3);
  CHECK(schema["$defs"]["solver"]["properties"]["max_iterations"]["default"] == 50);
}

TEST_CASE("schema: every reference leads somewhere and every definition is used") {
  const Json schema = Json::parse(json_schema());
  std::set<std::string> references;
  collect_references(schema, references);
  std::set<std::string> definitions;
  for (const auto& [name, definition] : schema["$defs"].items()) {
    definitions.insert("#/$defs/" + name);
    CHECK(definition["description"].is_string());
  }
  CHECK(references == definitions);
}

TEST_CASE("schema: names come from the registries") {
  const Json schema = Json::parse(json_schema());
  CHECK(schema["$defs"]["time"]["properties"]["integrator"]["enum"] == Json(integrator_names()));
  CHECK(schema["$defs"]["probe"]["properties"]["quantity"]["enum"].size() == quantities().size());
}

TEST_CASE("reference: tells of every key of the schema, with its unit") {
  const Json schema = Json::parse(json_schema());
  const std::string reference = scene_reference();
  for (const auto& definition : schema["$defs"].items()) {
    const std::string& name = definition.key();
    CAPTURE(name);
    for (const auto& property : definition.value()["properties"].items()) {
      const std::string& key = property.key();
      CAPTURE(key);
      CHECK(test::contains(reference, "| `" + key + "` |"));
      CHECK(property.value()["description"].is_string());
    }
  }
  CHECK(test::contains(reference,
                       "| `youngs_modulus` | number greater than 0 | Pa | **required** |"));
  CHECK(test::contains(reference, "`turning_angle`: angle from the edge before a node"));
}

}  // namespace
}  // namespace der
