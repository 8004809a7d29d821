#include "scenario/utf8.hpp"

namespace der::scenario {
namespace {

/// Length of the character at the front of a text and the range of its second byte.
struct Character {
  std::size_t length = 0;  // 0: none can begin so
  unsigned char lowest = 0x80;
  unsigned char highest = 0xbf;
};

Character character_of(unsigned char first) {
  if (first < 0x80) return {1};
  if (first < 0xc2) return {};
  if (first < 0xe0) return {2};
  if (first == 0xe0) return {3, 0xa0, 0xbf};  // shorter forms are there below
  if (first == 0xed) return {3, 0x80, 0x9f};  // surrogates are above
  if (first < 0xf0) return {3};
  if (first == 0xf0) return {4, 0x90, 0xbf};
  if (first < 0xf4) return {4};
  if (first == 0xf4) return {4, 0x80, 0x8f};
  return {};
}

bool begins_with(std::string_view text, const Character& character) {
  if (character.length == 0 || text.size() < character.length) return false;
  for (std::size_t i = 1; i < character.length; ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const unsigned char lowest = i == 1 ? character.lowest : 0x80;
    const unsigned char highest = i == 1 ? character.highest : 0xbf;
    if (byte < lowest || byte > highest) return false;
  }
  return true;
}

}  // namespace

std::size_t first_not_utf8(std::string_view text) {
  std::size_t place = 0;
  while (place < text.size()) {
    const Character character = character_of(static_cast<unsigned char>(text[place]));
    if (!begins_with(text.substr(place), character)) return place;
    place += character.length;
  }
  return place;
}

}  // namespace der::scenario
