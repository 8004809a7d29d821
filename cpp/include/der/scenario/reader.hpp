#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace der {

namespace scenario {
class Document;  // the ordered tree of marked values that texts and dictionaries are read into
struct Scene;    // what a document means
}  // namespace scenario

/// One override, as in `--set rods.beam.nodes=101`: the key path and the new value as YAML text.
using Override = std::pair<std::string, std::string>;

/// A validated scene together with the document that it was read from, so that it can be varied
/// (`with`), saved (`to_yaml`) and named in messages (`source`). Immutable; copies are cheap.
class Scenario {
 public:
  /// Reads and validates a file. Throws SceneError with every diagnostic found.
  static Scenario load(const std::filesystem::path& file,
                       const std::vector<Override>& overrides = {});
  /// Reads and validates a text; `source` names it in messages.
  static Scenario parse(std::string_view text, const std::string& source = "scene",
                        const std::vector<Override>& overrides = {});
  /// Validates a document built by hand (the Python bindings turn a dict into one).
  static Scenario from_document(std::shared_ptr<const scenario::Document> document);

  /// The same scene with some values replaced (or added), validated again. A path names mappings by
  /// key and list items by `name` or by number: `rods.beam.nodes`, `loads.0.gravity`. An empty
  /// value removes what its path names (`time=` makes way for `analysis=static`).
  [[nodiscard]] Scenario with(const std::vector<Override>& overrides) const;

  [[nodiscard]] const scenario::Scene& scene() const noexcept { return *scene_; }
  [[nodiscard]] const std::string& source() const noexcept;
  [[nodiscard]] const scenario::Document& document() const noexcept { return *document_; }
  /// The scene as YAML text that reads back to the same scene, overrides applied.
  [[nodiscard]] std::string to_yaml() const;

 private:
  Scenario(std::shared_ptr<const scenario::Document> document,
           std::shared_ptr<const scenario::Scene> scene);
  std::shared_ptr<const scenario::Document> document_;
  std::shared_ptr<const scenario::Scene> scene_;
};

/// The JSON Schema (draft 2020-12) of a scene file, generated from the reader's own tables.
std::string json_schema();
/// The scene reference in Markdown, generated from the same tables.
std::string scene_reference();

}  // namespace der
