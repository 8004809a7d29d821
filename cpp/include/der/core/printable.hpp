#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace der {

/// A text from outside as one line that a terminal can be given: control characters (with which a
/// text could move the cursor, or change the window's title) and bytes that are not UTF-8 are
/// written as escapes, such as `\x1b`.
std::string printable(std::string_view text);

/// At most `limit` bytes of a text, and "..." where that is not all of it; no character is cut.
std::string shortened(std::string_view text, std::size_t limit = 60);

/// The first control character of a text other than a tab or a line break.
std::optional<unsigned> control_character(std::string_view text);

}  // namespace der
