#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace der::scenario {

/// "; did you mean 'nodes'?" for the known word nearest to `word`, or "" when none is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known);

/// "a rod", "an output"
std::string with_article(std::string_view noun);

/// "'a', 'b' and 'c'"
std::string listed(const std::vector<std::string>& words, std::string_view last_joint = " and ");

}  // namespace der::scenario
