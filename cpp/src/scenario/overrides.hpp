#pragma once

#include <vector>

#include "der/core/error.hpp"
#include "der/scenario/document.hpp"
#include "der/scenario/reader.hpp"

namespace der::scenario {

/// Puts the overrides into a copy of the document. Throws SceneError with every override whose path
/// leads nowhere or whose value is not YAML. An empty value removes what the path names.
Document with_overrides(const Document& document, const std::vector<Override>& overrides);

}  // namespace der::scenario
