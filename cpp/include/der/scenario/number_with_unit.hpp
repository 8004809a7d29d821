#pragma once

#include <optional>
#include <string_view>

namespace der::scenario {

/// The number in SI units of a text such as `5 mm`, of whichever kind its unit is; nothing for
/// every other text.
std::optional<double> number_with_unit(std::string_view text);

}  // namespace der::scenario
