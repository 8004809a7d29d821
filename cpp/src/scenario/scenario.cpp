#include <memory>
#include <unordered_map>
#include <utility>

#include "der/scenario/document.hpp"
#include "der/scenario/reader.hpp"
#include "scenario/overrides.hpp"
#include "scenario/scene_text.hpp"

namespace der {
namespace {

using scenario::Document;

scenario::Scene read_scene(const Document& document, scenario::Diagnostics& diagnostics) {
  scenario::SceneText text;
  if (document.root().mapping()) {
    scenario::scene_format().read({&document.root()}, diagnostics, text);
    scenario::check_scene(text, diagnostics);
  } else {
    diagnostics.add(scenario::Place{&document.root()},
                    document.root().is_null()
                        ? "the scene is empty: it needs at least 'rods' and 'time' or 'analysis'"
                        : "a scene is a mapping of keys such as 'rods' and 'time'");
  }
  diagnostics.throw_if_any();
  return static_cast<scenario::Scene&&>(text);
}

using Numbers = std::unordered_map<const scenario::Value*, double>;

/// The same value with numbers in place of what has a unit.
scenario::Value in_si_units(const scenario::Value& value, const Numbers& numbers) {
  if (const auto number = numbers.find(&value); number != numbers.end()) {
    return {number->second, value.mark};
  }
  if (const scenario::Sequence* items = value.sequence()) {
    scenario::Sequence converted;
    for (const scenario::Value& item : *items) converted.push_back(in_si_units(item, numbers));
    return {std::move(converted), value.mark};
  }
  if (const scenario::Mapping* entries = value.mapping()) {
    scenario::Mapping converted;
    for (const scenario::Entry& entry : *entries) {
      converted.push_back({entry.key, in_si_units(entry.value, numbers), entry.mark});
    }
    return {std::move(converted), value.mark};
  }
  return value;
}

Document varied(Document document, const std::vector<Override>& overrides) {
  return overrides.empty() ? std::move(document) : with_overrides(document, overrides);
}

}  // namespace

Scenario::Scenario(std::shared_ptr<const Document> document,
                   std::shared_ptr<const scenario::Scene> scene)
    : document_(std::move(document)), scene_(std::move(scene)) {}

Scenario Scenario::load(const std::filesystem::path& file, const std::vector<Override>& overrides) {
  return from_document(std::make_shared<const Document>(varied(Document::load(file), overrides)));
}

Scenario Scenario::parse(std::string_view text, const std::string& source,
                         const std::vector<Override>& overrides) {
  return from_document(
      std::make_shared<const Document>(varied(Document::parse(text, source), overrides)));
}

Scenario Scenario::from_document(std::shared_ptr<const Document> document) {
  scenario::Diagnostics diagnostics(*document);
  auto scene = std::make_shared<const scenario::Scene>(read_scene(*document, diagnostics));
  if (const Numbers& numbers = diagnostics.numbers(); !numbers.empty()) {
    document = std::make_shared<const Document>(in_si_units(document->root(), numbers),
                                                document->source());
  }
  return {std::move(document), std::move(scene)};
}

Scenario Scenario::with(const std::vector<Override>& overrides) const {
  return from_document(
      std::make_shared<const Document>(scenario::with_overrides(*document_, overrides)));
}

const std::string& Scenario::source() const noexcept { return document_->source(); }

std::string Scenario::to_yaml() const { return document_->to_yaml(); }

}  // namespace der
