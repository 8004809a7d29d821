#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace der::scenario {

struct Scene;

/// The number of the support that a probe names: by its number in the scene, counted from 0.
/// Nothing if there is no such support.
std::optional<std::size_t> find_support(const Scene& scene, const std::string& word);

}  // namespace der::scenario
