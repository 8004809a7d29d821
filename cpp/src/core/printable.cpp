#include "der/core/printable.hpp"

#include <fmt/format.h>

namespace der {
namespace {

/// One character of a text in UTF-8.
struct Character {
  unsigned code = 0;
  std::size_t length = 0;  // [bytes]; 0 where the text is not UTF-8
};

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xc0U) == 0x80U; }

/// The character that a text begins with. By the Unicode Standard, table 3-7: overlong forms,
/// surrogates and numbers beyond U+10FFFF are none.
Character first_of(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text.front());
  if (lead < 0x80) return {lead, 1};
  const std::size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < length) return {};
  unsigned code = lead & (0x7fU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if (!continues(text[i])) return {};
    code = (code << 6U) | (static_cast<unsigned char>(text[i]) & 0x3fU);
  }
  const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  if (overlong || surrogate || code > 0x10ffff) return {};
  return {code, length};
}

bool is_control(unsigned code) { return code < 0x20 || (code >= 0x7f && code < 0xa0); }

}  // namespace

std::string printable(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const Character next = first_of(text);
    const std::size_t length = next.length == 0 ? 1 : next.length;
    if (next.length > 0 && !is_control(next.code)) {
      result += text.substr(0, length);
    } else if (next.code == '\n' || next.code == '\t') {
      result += next.code == '\n' ? "\\n" : "\\t";
    } else {
      const unsigned code = next.length > 0 ? next.code : static_cast<unsigned char>(text.front());
      result += fmt::format("\\x{:02x}", code);
    }
    text.remove_prefix(length);
  }
  return result;
}

std::string shortened(std::string_view text, std::size_t limit) {
  if (text.size() <= limit) return std::string(text);
  while (limit > 0 && continues(text[limit])) --limit;
  return std::string(text.substr(0, limit)) + "...";
}

std::optional<unsigned> control_character(std::string_view text) {
  while (!text.empty()) {
    const Character next = first_of(text);
    const bool blank = next.code == '\n' || next.code == '\t';
    if (next.length > 0 && is_control(next.code) && !blank) return next.code;
    text.remove_prefix(next.length == 0 ? 1 : next.length);
  }
  return std::nullopt;
}

}  // namespace der
