#include "der/scenario/find_support.hpp"

#include "der/scenario/scenario.hpp"

namespace der::scenario {

std::optional<std::size_t> find_support(const Scene& scene, const std::string& word) {
  for (std::size_t i = 0; i < scene.supports.size(); ++i) {
    const std::string& name = scene.supports[i].name;
    if (word == std::to_string(i) || (!name.empty() && word == name)) return i;
  }
  return std::nullopt;
}

}  // namespace der::scenario
