#pragma once

#include <string>
#include <vector>

#include "der/core/error.hpp"
#include "der/scenario/reader.hpp"

namespace der::test {

inline const std::string kRod = R"(rods:
  - name: beam
    nodes: 11
    from: [0, 0]
    to: [1, 0]
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e9, density: 1000}
)";
inline const std::string kTime = "time: {duration: 1, step: 0.01}\n";

/// A scene of one straight rod of 11 nodes and 1 m, with some values replaced.
inline Scenario beam(const std::vector<Override>& overrides = {}) {
  return Scenario::parse(kRod + kTime, "beam", overrides);
}

/// The diagnostics of a scene; empty for a valid one.
inline std::vector<Diagnostic> diagnostics(const std::string& text) {
  try {
    Scenario::parse(text);
  } catch (const SceneError& error) {
    return error.diagnostics();
  }
  return {};
}

/// The diagnostics of the beam with some values replaced, as one text.
inline std::string diagnostics(const std::vector<Override>& overrides) {
  try {
    beam(overrides);
  } catch (const SceneError& error) {
    return error.what();
  }
  return {};
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace der::test
