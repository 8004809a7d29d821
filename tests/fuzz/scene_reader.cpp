// The fuzz target of the scene reader: a text of any bytes, with overrides in lines
// "#set PATH=VALUE", is refused as a SceneError or is a scene, which is written, read again and,
// where it is small, built into a model.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "der/building/builder.hpp"
#include "der/core/error.hpp"
#include "der/scenario/reader.hpp"
#include "der/scenario/scenario.hpp"

namespace {

using der::Override;

/// Larger models only take longer.
constexpr std::size_t kMostNodes = 2000;

std::vector<Override> overrides_in(std::string_view text) {
  constexpr std::string_view mark = "#set ";
  std::vector<Override> overrides;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    const std::size_t equals = line.find('=');
    if (line.substr(0, mark.size()) != mark || equals == std::string_view::npos) continue;
    const std::string_view path = line.substr(mark.size(), equals - mark.size());
    overrides.emplace_back(path, line.substr(equals + 1));
  }
  return overrides;
}

std::size_t nodes_of(const der::scenario::Scene& scene) {
  std::size_t nodes = 0;
  for (const auto& rod : scene.rods) nodes += rod.points.size();
  return nodes;
}

/// A scene that was accepted is written as a text that is the same scene.
void write_and_read(const der::Scenario& scenario) {
  const std::string text = scenario.to_yaml();
  std::string again;
  try {
    again = der::Scenario::parse(text).to_yaml();
  } catch (const der::SceneError& error) {
    again = error.what();
  }
  if (again == text) return;
  std::cerr << "A scene that is written does not read back:\n" << text << "\n\n" << again << '\n';
  std::abort();
}

void build(const der::Scenario& scenario) {
  if (nodes_of(scenario.scene()) > kMostNodes) return;
  try {
    der::build_model(scenario.scene());
  } catch (const der::Error&) {  // NOLINT(bugprone-empty-catch): refused by name
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const auto scenario = der::Scenario::parse(text, "scene", overrides_in(text));
    write_and_read(scenario);
    build(scenario);
  } catch (const der::SceneError&) {  // NOLINT(bugprone-empty-catch): refused by name
  }
  return 0;
}
