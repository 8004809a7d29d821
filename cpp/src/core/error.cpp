#include "der/core/error.hpp"

#include "der/core/printable.hpp"

namespace der {
namespace {

std::string line_of(const std::string& source, const Diagnostic& complaint) {
  std::string line = source;
  if (complaint.line > 0) {
    if (!line.empty()) line += ':';
    line += std::to_string(complaint.line) + ':' + std::to_string(complaint.column);
  }
  if (!line.empty()) line += ": ";
  if (!complaint.path.empty()) line += complaint.path + ": ";
  return line + complaint.message;
}

std::string text_of(const std::string& source, const std::vector<Diagnostic>& complaints) {
  std::string text;
  for (const Diagnostic& complaint : complaints) {
    if (!text.empty()) text += '\n';
    text += printable(line_of(source, complaint));
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
