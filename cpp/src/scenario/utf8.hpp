#pragma once

#include <cstddef>
#include <string_view>

namespace der::scenario {

/// Place of the first byte that is no part of UTF-8 (RFC 3629: no overlong forms, no surrogates,
/// nothing above U+10FFFF); the size of the text if there is none.
std::size_t first_not_utf8(std::string_view text);

}  // namespace der::scenario
