#include "scenario/number.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "der/scenario/number_with_unit.hpp"
#include "scenario/unit.hpp"

namespace der::scenario {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The longest start of a text that has the form of a decimal number.
struct Decimal {
  std::size_t length = 0;  // 0: there is none
  bool whole = true;       // no point and no exponent
  bool leading_zero = false;
};

std::size_t skip_digits(std::string_view text, std::size_t i) {
  while (i < text.size() && is_digit(text[i])) ++i;
  return i;
}

std::size_t skip_sign(std::string_view text, std::size_t i) {
  return i < text.size() && (text[i] == '+' || text[i] == '-') ? i + 1 : i;
}

Decimal scan(std::string_view text) {
  Decimal number;
  const std::size_t start = skip_sign(text, 0);
  std::size_t end = skip_digits(text, start);
  std::size_t digits = end - start;
  number.leading_zero = digits > 1 && text[start] == '0';
  if (end < text.size() && text[end] == '.') {
    const std::size_t fraction = skip_digits(text, end + 1);
    digits += fraction - end - 1;
    if (digits > 0) {
      number.whole = false;
      end = fraction;
    }
  }
  if (digits == 0) return {};
  if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
    const std::size_t exponent = skip_sign(text, end + 1);
    const std::size_t after = skip_digits(text, exponent);
    if (after > exponent) {
      number.whole = false;
      end = after;
    }
  }
  number.length = end;
  return number;
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

bool is_infinite_or_nan(std::string_view text) {
  std::string word = lower(text.substr(skip_sign(text, 0)));
  if (!word.empty() && word.front() == '.') word.erase(0, 1);
  return word == "inf" || word == "infinity" || word == "nan";
}

template <class T>
std::optional<T> convert(std::string_view text) {
  if (text.front() == '+') text.remove_prefix(1);  // from_chars knows no plus sign
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string without(std::string_view text, char unwanted) {
  std::string result(text);
  result.erase(std::remove(result.begin(), result.end(), unwanted), result.end());
  return result;
}

/// With a plain blank for the narrow and for the no-break ones, which part thousands, too.
std::string with_plain_blanks(std::string_view text) {
  std::string result(text);
  for (const std::string_view blank : {"\u00a0", "\u202f", "\u2009"}) {
    for (std::size_t at = 0; (at = result.find(blank, at)) != std::string::npos;) {
      result.replace(at, blank.size(), " ");
    }
  }
  return result;
}

/// `1234567.5` of `1,234,567.5`, `1.234.567,5` and `1 234 567.5`: groups of three digits after the
/// first, all parted alike. Empty where none are.
std::string joined_thousands(std::string_view text) {
  const std::size_t start = skip_sign(text, 0);
  std::size_t i = skip_digits(text, start);
  if (i == start || i > start + 3 || i == text.size() || text[start] == '0') return {};
  const char separator = text[i];
  if (separator != ',' && separator != '.' && separator != ' ') return {};
  std::string joined(text.substr(0, i));
  while (i < text.size() && text[i] == separator && skip_digits(text, i + 1) == i + 4) {
    joined += text.substr(i + 1, 3);
    i += 4;
  }
  if (i < text.size() && separator != text[i] && (text[i] == '.' || text[i] == ',')) {
    joined += '.';
    ++i;
  }
  joined += text.substr(i);
  return scan(joined).length == joined.size() ? joined : std::string();
}

std::string thousands_clause(std::string_view joined) {
  return fmt::format("thousands have no separator: write {}", joined);
}

/// `1.5` of `1,5`; empty where no decimal comma is.
std::string pointed_decimal(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos || comma == 0 || !is_digit(text[comma - 1])) return {};
  std::string pointed(text);
  pointed[comma] = '.';
  const bool is_whole = scan(text.substr(0, comma)).length == comma;
  const bool has_fraction = comma + 1 < text.size() && is_digit(text[comma + 1]);
  if (!is_whole || !has_fraction || scan(pointed).length != text.size()) return {};
  return pointed;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  return text;
}

/// A text that is a number with separators, and the unit behind it; all of it and nothing where no
/// unit is.
std::pair<std::string_view, std::string_view> parted_from_unit(std::string_view text) {
  const std::size_t last = text.find_first_not_of("0123456789.,+- ");
  if (last == std::string_view::npos) return {text, {}};
  std::size_t end = last;
  const bool has_exponent = text[last] == 'e' || text[last] == 'E';
  const std::size_t digits = has_exponent ? skip_sign(text, last + 1) : last;
  const std::size_t exponent = has_exponent ? skip_digits(text, digits) : last;
  if (exponent > digits) end = exponent;
  const std::string_view unit = trimmed(text.substr(end));
  if (unit.empty() || !read_unit(unit)) return {text, {}};
  while (end > 0 && text[end - 1] == ' ') --end;
  return {text.substr(0, end), unit};
}

std::string leading_zero_problem(std::string_view text) {
  const bool negative = text.front() == '-';
  std::string_view digits = text.substr(skip_sign(text, 0));
  const bool octal =
      std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '7'; });
  long octal_value = 0;
  if (octal) std::from_chars(digits.data(), digits.data() + digits.size(), octal_value, 8);
  while (digits.size() > 1 && digits[0] == '0' && is_digit(digits[1])) digits.remove_prefix(1);
  const char* sign = negative ? "-" : "";
  if (!octal) return fmt::format("numbers have no leading zero: write {}{}", sign, digits);
  return fmt::format("a leading zero is ambiguous (octal in YAML 1.1): write {}{} or {}{}", sign,
                     digits, sign, octal_value);
}

std::string other_base_problem(std::string_view text) {
  const std::string word = lower(text.substr(skip_sign(text, 0)));
  if (word.size() < 3 || word[0] != '0') return {};
  int base = 0;
  if (word[1] == 'x') base = 16;
  if (word[1] == 'o') base = 8;
  if (word[1] == 'b') base = 2;
  if (base == 0) return {};
  long value = 0;
  const auto [end, error] =
      std::from_chars(word.data() + 2, word.data() + word.size(), value, base);
  if (error != std::errc{} || end != word.data() + word.size()) return {};
  return fmt::format("only decimal numbers are read: write {}{}", text.front() == '-' ? "-" : "",
                     value);
}

struct InUnit {
  std::string_view number;
  Unit unit;
};

/// The parts of a text that is a number with a unit behind it; nothing for every other text.
std::optional<InUnit> with_unit(std::string_view text, const Decimal& number) {
  if (number.length == 0) return std::nullopt;
  const std::string behind = with_plain_blanks(text.substr(number.length));
  const std::optional<Unit> unit = read_unit(trimmed(behind));
  if (!unit) return std::nullopt;
  return InUnit{text.substr(0, number.length), *unit};
}

/// The number in SI units: the same bits as those of the text with its decimal point shifted.
/// Nothing for one that is out of range.
std::optional<double> in_si(const InUnit& written) {
  const auto& [number, unit] = written;
  const std::size_t e = number.find_first_of("eE");
  long exponent = 0;
  if (e != std::string_view::npos) {
    const std::optional<int> given = convert<int>(number.substr(e + 1));
    if (!given) return std::nullopt;
    exponent = *given;
  }
  const std::optional<double> value =
      convert<double>(fmt::format("{}e{}", number.substr(0, e), exponent + unit.decimals));
  if (!value) return std::nullopt;
  const double scaled = *value / unit.denominator * unit.numerator;
  return std::isfinite(scaled) ? std::optional(scaled) : std::nullopt;
}

constexpr const char* kOutOfRange =
    "it is out of the range of double-precision numbers (1e-308 to 1.8e308)";

/// Tells what to write in place of an unknown unit, or of one of another kind than the key's.
std::string unit_clause(std::string_view written, std::string_view unit) {
  if (unit.empty()) return "write the number alone, without a unit";
  return fmt::format("'{}' is not a unit of this kind: write the number in {}", written, unit);
}

bool is_fortran_exponent(std::string_view text) {
  return (text.front() == 'd' || text.front() == 'D') && text.size() > 1 &&
         skip_digits(text, skip_sign(text, 1)) == text.size();
}

/// Why a text that is no decimal number is none, as far as one can tell. `unit` is that of the key.
std::string diagnose(std::string_view text, const Decimal& start, std::string_view unit) {
  if (is_infinite_or_nan(text)) return "infinities and NaN are out of range";
  if (std::string problem = other_base_problem(text); !problem.empty()) return problem;
  for (const char separator : {'_', '\''}) {
    const std::string joined = without(text, separator);
    if (joined.size() < text.size() && scan(joined).length == joined.size()) {
      return fmt::format("write {}", joined);
    }
  }
  if (start.length == 0) return {};
  const std::string_view rest = trimmed(text.substr(start.length));
  if (std::string problem = separator_problem(text); !problem.empty()) return problem;
  if (rest.front() == ',') {
    return "decimals have a point, thousands no separator, and a list stands in brackets";
  }
  if (rest.front() == '*' || rest.front() == '/' || rest.front() == '^') {
    return "arithmetic is not evaluated: write the result";
  }
  if (is_digit(rest.front()) || rest.front() == '-' || rest.front() == '+') {
    return "is a comma or a bracket missing?";
  }
  if (is_fortran_exponent(rest)) {
    return fmt::format("write {}e{}", text.substr(0, start.length), rest.substr(1));
  }
  const auto first = static_cast<unsigned char>(rest.front());
  const bool may_be_unit = std::isalpha(first) != 0 || first >= 0x80 || first == '%';
  return may_be_unit ? unit_clause(rest, unit) : std::string();
}

}  // namespace

Reading<double> read_real(std::string_view text, std::string_view unit) {
  const Decimal number = scan(text);
  if (number.length == text.size() && !text.empty()) {
    if (number.leading_zero) return {std::nullopt, leading_zero_problem(text)};
    const std::optional<double> value = convert<double>(text);
    return value ? Reading<double>{value, {}} : Reading<double>{std::nullopt, kOutOfRange};
  }
  const std::optional<InUnit> found = with_unit(text, number);
  if (!found) return {std::nullopt, diagnose(text, number, unit)};
  if (number.leading_zero) return {std::nullopt, leading_zero_problem(found->number)};
  if (unit.empty() || !found->unit.same_kind(*read_unit(unit))) {
    return {std::nullopt, unit_clause(trimmed(text.substr(number.length)), unit)};
  }
  const std::optional<double> value = in_si(*found);
  return value ? Reading<double>{value, {}, true} : Reading<double>{std::nullopt, kOutOfRange};
}

std::optional<double> number_with_unit(std::string_view text) {
  const Decimal number = scan(text);
  const std::optional<InUnit> found = with_unit(text, number);
  return found && !number.leading_zero ? in_si(*found) : std::nullopt;
}

Reading<std::int64_t> read_whole(std::string_view text) {
  const Decimal number = scan(text);
  if (text.empty() || number.length != text.size()) {
    const std::string joined = joined_thousands(with_plain_blanks(text));
    if (!joined.empty() && scan(joined).whole) return {std::nullopt, thousands_clause(joined)};
    return {std::nullopt, diagnose(text, number, {})};
  }
  if (number.leading_zero) return {std::nullopt, leading_zero_problem(text)};
  if (number.whole) {
    const std::optional<std::int64_t> value = convert<std::int64_t>(text);
    if (value) return {value, {}};
    return {std::nullopt, "it is too large"};
  }
  const std::optional<double> value = convert<double>(text);
  if (value && std::abs(*value) < 1e15 && *value == std::floor(*value)) {
    return {std::nullopt, fmt::format("write {:.0f}", *value)};
  }
  return {std::nullopt, {}};
}

std::string separator_problem(std::string_view text) {
  const auto [number, unit] = parted_from_unit(text);
  const std::string thousands = joined_thousands(with_plain_blanks(number));
  const std::string pointed = pointed_decimal(number);
  const auto in_unit = [&, behind = unit](const std::string& written) {
    return behind.empty() ? written : fmt::format("{} {}", written, behind);
  };
  if (pointed.empty()) return thousands.empty() ? thousands : thousands_clause(in_unit(thousands));
  const std::string clause = "a decimal has a point, not a comma: write " + in_unit(pointed);
  if (thousands.empty()) return clause;
  return fmt::format("{}, or {} if the comma parts thousands", clause, in_unit(thousands));
}

bool looks_like_number(std::string_view text) {
  return !text.empty() && (scan(text).length == text.size() || is_infinite_or_nan(text) ||
                           !other_base_problem(text).empty());
}

std::string shortest(double value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  std::string text(buffer.data(), result.ptr);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

}  // namespace der::scenario
