#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace der::scenario {

/// "; did you mean 'nodes'?" for the known words nearest to `word`, or those of which one starts
/// the other; "" when there is none.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known);

/// The same for the known words that have a part in common with `word`, as `bending_moment` has
/// with `moment_1`.
std::string did_you_mean_part_of(std::string_view word, const std::vector<std::string>& known);

/// "a rod", "an output"
std::string with_article(std::string_view noun);

/// "'a', 'b' and 'c'"
std::string listed(const std::vector<std::string>& words, std::string_view last_vertex = " and ");

}  // namespace der::scenario
