#include "der/core/error.hpp"

#include "der/core/printable.hpp"

namespace der {
namespace {

std::string line_of(const std::string& source, const Diagnostic& diagnostic) {
  std::string line = source;
  if (diagnostic.line > 0) {
    if (!line.empty()) line += ':';
    line += std::to_string(diagnostic.line) + ':' + std::to_string(diagnostic.column);
  }
  if (!line.empty()) line += ": ";
  if (!diagnostic.path.empty()) line += diagnostic.path + ": ";
  return line + diagnostic.message;
}

std::string text_of(const std::string& source, const std::vector<Diagnostic>& diagnostics) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics) {
    if (!text.empty()) text += '\n';
    text += printable(line_of(source, diagnostic));
  }
  return text;
}

/// Messages quote what stands in a scene, which may be anything.
std::vector<Diagnostic> made_printable(std::vector<Diagnostic> diagnostics) {
  for (Diagnostic& diagnostic : diagnostics) {
    diagnostic.path = printable(diagnostic.path);
    diagnostic.message = printable(diagnostic.message);
  }
  return diagnostics;
}

}  // namespace

SceneError::SceneError(const std::string& source, std::vector<Diagnostic> diagnostics)
    : Error("invalid_scene", text_of(source, diagnostics)),
      diagnostics_(made_printable(std::move(diagnostics))) {}

}  // namespace der
