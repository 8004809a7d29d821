#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "der/scenario/document.hpp"
#include "scenario/number.hpp"

namespace der::scenario {
namespace {

/// A value that fits into the rest of the line is written in one line.
constexpr std::size_t kLineWidth = 100;

bool is_letter_or_digit(char c) {
  const auto code = static_cast<unsigned char>(c);
  return code < 0x80 && std::isalnum(code) != 0;
}

/// Whether a text can stand without quotes in any place, brackets included.
bool safe_unquoted(std::string_view text) {
  if (text.empty() || text.back() == ' ') return false;
  if (!is_letter_or_digit(text.front()) && text.front() != '_') return false;
  return std::all_of(text.begin(), text.end(), [](char c) {
    return is_letter_or_digit(c) || std::string_view(" _-+./()").find(c) != std::string_view::npos;
  });
}

/// Words that YAML readers take for something other than a text.
bool is_reserved_word(std::string_view text) {
  static constexpr std::array<std::string_view, 9> words{"true", "false", "null", "yes", "no",
                                                         "on",   "off",   "y",    "n"};
  const auto same = [&](std::string_view word) {
    return std::equal(word.begin(), word.end(), text.begin(), text.end(), [](char a, char b) {
      return a == static_cast<char>(std::tolower(static_cast<unsigned char>(b)));
    });
  };
  return std::any_of(words.begin(), words.end(), same);
}

std::string in_quotes(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (c == '\n') {
      result += "\\n";
    } else if (c == '\t') {
      result += "\\t";
    } else if (code < 0x20 || code == 0x7f) {
      result += fmt::format("\\x{:02x}", code);
    } else {
      result += c;
    }
  }
  return result + '"';
}

std::string text_scalar(const std::string& text) {
  const bool plain = safe_unquoted(text) && !is_reserved_word(text) && !looks_like_number(text);
  return plain ? text : in_quotes(text);
}

/// A key is never taken for a number or a truth value, so `y` needs no quotes there.
std::string key_text(const std::string& key) { return safe_unquoted(key) ? key : in_quotes(key); }

struct FlowWriter {
  std::string operator()(std::monostate) const { return "null"; }
  std::string operator()(const Plain& plain) const {
    // A value that is neither a number nor a safe word can only be a text, which quotes do not
    // change.
    const bool bare = safe_unquoted(plain.text) || looks_like_number(plain.text);
    return bare ? plain.text : in_quotes(plain.text);
  }
  std::string operator()(const std::string& text) const { return text_scalar(text); }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(double value) const { return shortest(value); }
  std::string operator()(const Sequence& items) const {
    std::string text;
    for (const Value& item : items) {
      if (!text.empty()) text += ", ";
      text += to_flow_yaml(item);
    }
    return "[" + text + "]";
  }
  std::string operator()(const Mapping& entries) const {
    std::string text;
    for (const Entry& entry : entries) {
      if (!text.empty()) text += ", ";
      text += key_text(entry.key) + ": " + to_flow_yaml(entry.value);
    }
    return "{" + text + "}";
  }
};

/// Whether a list is better written with one item per line even where it is short.
bool is_list_of_mappings(const Value& value) {
  const Sequence* items = value.sequence();
  return items && !items->empty() && items->front().mapping();
}

/// The value in one line, if it is to stand behind `column` characters; else "".
std::string in_line(const Value& value, std::size_t column) {
  const bool scalar = !value.sequence() && !value.mapping();
  if (!scalar && is_list_of_mappings(value)) return {};
  std::string line = to_flow_yaml(value);
  return scalar || column + 1 + line.size() <= kLineWidth ? line : std::string();
}

void write_block(const Value& value, std::size_t indent, std::string& out) {
  const std::string margin(indent, ' ');
  if (const Mapping* entries = value.mapping()) {
    for (const Entry& entry : *entries) {
      const std::string key = margin + key_text(entry.key) + ":";
      const std::string line = in_line(entry.value, key.size());
      out += key + (line.empty() ? "\n" : ' ' + line + '\n');
      if (line.empty()) write_block(entry.value, indent + 2, out);
    }
  } else if (const Sequence* items = value.sequence()) {
    for (const Value& item : *items) {
      std::string body = in_line(item, indent + 1) + '\n';
      if (body.size() == 1) {
        body.clear();
        write_block(item, indent + 2, body);
        body.erase(0, indent + 2);
      }
      out += margin + "- " + body;
    }
  }
}

}  // namespace

std::string to_flow_yaml(const Value& value) { return std::visit(FlowWriter{}, value.content); }

std::string Document::to_yaml() const {
  const Mapping* entries = root_.mapping();
  if (!entries || entries->empty()) return to_flow_yaml(root_) + '\n';
  std::string text;
  write_block(root_, 0, text);
  return text;
}

}  // namespace der::scenario
