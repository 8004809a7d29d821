#include "der/core/error.hpp"

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
    text += line_of(source, complaint);
  }
  return text;
}

}  // namespace

SceneError::SceneError(const std::string& source, std::vector<Diagnostic> diagnostics)
    : Error("invalid_scene", text_of(source, diagnostics)), diagnostics_(std::move(diagnostics)) {}

}  // namespace der
