#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "der/scenario/reader.hpp"
#include "scenario/number.hpp"
#include "scenario/scene_text.hpp"

namespace der {
namespace {

using Json = nlohmann::ordered_json;
using scenario::Alternatives;
using scenario::FieldInfo;
using scenario::Range;
using scenario::Shape;
using scenario::TableInfo;

/// Turns shapes into schemas and collects the tables that they refer to.
class SchemaBuilder {
 public:
  Json schema(const Shape& shape) {
    switch (shape.kind) {
      case Shape::Kind::Number:
        return bounded(number_in(shape.unit), shape.range);
      case Shape::Kind::Integer:
        return bounded({{"type", "integer"}}, shape.range);
      case Shape::Kind::Boolean:
        return {{"type", "boolean"}};
      case Shape::Kind::Text:
        return {{"type", "string"}};
      case Shape::Kind::Name:
        return {{"type", "string"}, {"pattern", scenario::kNamePattern}};
      case Shape::Kind::Choice:
        return {{"enum", names_of(shape.words)}};
      case Shape::Kind::Vector:
        return numbers(shape.unit, shape.min_items, 3);
      case Shape::Kind::Pair:
        return numbers(shape.unit, 2, 2);
      case Shape::Kind::Triple:
        return numbers(shape.unit, 3, 3);
      case Shape::Kind::List:
        return list(shape);
      case Shape::Kind::Table:
        return reference(*shape.table);
      case Shape::Kind::NamedTables:
        return {{"type", "object"},
                {"propertyNames", {{"pattern", scenario::kNamePattern}}},
                {"additionalProperties", reference(*shape.table)}};
      case Shape::Kind::AnyOf:
        return any_of(shape);
    }
    return {};
  }

  Json table(const TableInfo& info) {
    Json properties = Json::object();
    Json required = Json::array();
    for (const FieldInfo& field : info.fields) {
      properties[field.key] = property(field, info.unit_of(field));
      if (field.required) required.push_back(field.key);
    }
    Json result{{"type", "object"}, {"description", info.doc}};
    result["properties"] = std::move(properties);
    result["additionalProperties"] = false;
    if (!required.empty()) result["required"] = std::move(required);
    if (info.one_key) require_kind(info, result);
    for (const Alternatives& alternatives : info.alternatives) {
      result["allOf"].push_back({{"oneOf", branches(alternatives)}});
    }
    return result;
  }

  [[nodiscard]] const Json& definitions() const { return definitions_; }

 private:
  static Json bounded(Json schema, const Range& range) {
    if (std::isfinite(range.min)) {
      schema[range.min_open ? "exclusiveMinimum" : "minimum"] = number(range.min);
    }
    if (std::isfinite(range.max)) {
      schema[range.max_open ? "exclusiveMaximum" : "maximum"] = number(range.max);
    }
    return schema;
  }

  /// A number, or a text of one with a unit behind it; the reader knows which units those are.
  static Json number_in(const std::string& unit) {
    if (unit.empty()) return {{"type", "number"}};
    return {{"type", {"number", "string"}}, {"pattern", scenario::kNumberWithUnitPattern}};
  }

  static Json numbers(const std::string& unit, int fewest, int most) {
    return {
        {"type", "array"}, {"items", number_in(unit)}, {"minItems", fewest}, {"maxItems", most}};
  }

  /// One of the keys that say which kind it is, and no other of them.
  static void require_kind(const TableInfo& info, Json& schema) {
    if (info.kinds().size() == info.fields.size()) {
      schema["minProperties"] = 1;
      schema["maxProperties"] = 1;
      return;
    }
    for (const std::string& kind : info.kinds()) {
      schema["oneOf"].push_back({{"required", Json::array({kind})}});
    }
  }

  /// Whole bounds without a decimal point.
  static Json number(double value) {
    if (value == std::floor(value)) return static_cast<std::int64_t>(value);
    return value;
  }

  Json list(const Shape& shape) {
    Json result{{"type", "array"}, {"items", schema(shape.parts.front())}};
    if (shape.min_items > 0) result["minItems"] = shape.min_items;
    return result;
  }

  Json any_of(const Shape& shape) {
    Json parts = Json::array();
    for (const Shape& part : shape.parts) parts.push_back(schema(part));
    return {{"anyOf", std::move(parts)}};
  }

  Json reference(const TableInfo& info) {
    std::string id = info.name;
    std::replace(id.begin(), id.end(), ' ', '_');
    if (!definitions_.contains(id)) {
      definitions_[id] = Json();  // holds the place: what is inside comes behind it
      definitions_[id] = table(info);
    }
    return {{"$ref", "#/$defs/" + id}};
  }

  Json property(const FieldInfo& field, const std::string& unit) {
    Json result = schema(field.shape);
    std::string doc = field.doc;
    if (!unit.empty()) doc += " [" + unit + "]";
    if (!field.default_text.empty() && !field.default_is_literal) {
      doc += " Default: " + field.default_text + ".";
    }
    result["description"] = doc;
    if (field.default_is_literal) result["default"] = literal(field);
    return result;
  }

  static Json literal(const FieldInfo& field) {
    if (field.shape.kind == Shape::Kind::Choice) return field.default_text;
    return Json::parse(field.default_text);
  }

  /// One branch with all its keys and none of the others', for each branch; or none of them all.
  static Json branches(const Alternatives& alternatives) {
    Json result = Json::array();
    for (const auto& branch : alternatives.branches) {
      Json one{{"required", branch}};
      for (const auto& other : alternatives.branches) {
        if (&other == &branch) continue;
        for (const std::string& key : other) {
          const bool shared = std::find(branch.begin(), branch.end(), key) != branch.end();
          if (!shared) one["properties"][key] = false;
        }
      }
      result.push_back(std::move(one));
    }
    if (!alternatives.required) {
      Json none;
      for (const auto& branch : alternatives.branches) {
        for (const std::string& key : branch) none["properties"][key] = false;
      }
      result.push_back(std::move(none));
    }
    return result;
  }

  Json definitions_ = Json::object();
};

}  // namespace

std::string json_schema() {
  SchemaBuilder builder;
  Json root = builder.table(*scenario::scene_format().shape.table);
  Json result{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "der scene"}};
  result.update(root);
  result["$defs"] = builder.definitions();
  return result.dump(2) + '\n';
}

}  // namespace der
