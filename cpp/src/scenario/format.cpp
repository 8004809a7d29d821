#include "scenario/format.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "der/core/printable.hpp"
#include "scenario/number.hpp"
#include "scenario/suggestion.hpp"

namespace der::scenario {
namespace {

struct Describe {
  std::string operator()(std::monostate) const { return "nothing"; }
  std::string operator()(const Plain& plain) const { return "'" + shortened(plain.text) + "'"; }
  std::string operator()(const std::string& text) const {
    return "the text '" + shortened(text) + "'";
  }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(double value) const { return shortest(value); }
  std::string operator()(const Sequence& items) const {
    if (items.empty()) return "an empty list";
    return fmt::format("a list of {} item{}", items.size(), items.size() == 1 ? "" : "s");
  }
  std::string operator()(const Mapping& /*entries*/) const { return "a mapping"; }
};

bool check_range(const Shape& shape, double value, const Place& place, Diagnostics& diagnostics) {
  if (shape.range.holds(value)) return true;
  diagnostics.add(place, fmt::format("must be {}, got {}", bounds(shape.range),
                                     std::visit(Describe{}, place.value->content)));
  return false;
}

/// The number in a scalar, whatever type it came with.
struct RealOf {
  const std::string& unit;

  Reading<double> operator()(const Plain& plain) const { return read_real(plain.text, unit); }
  Reading<double> operator()(const std::string& text) const {
    Reading<double> reading = read_real(text, unit);
    if (reading.value && !reading.had_unit) return {std::nullopt, "remove the quotes"};
    return reading;
  }
  Reading<double> operator()(std::int64_t value) const { return {static_cast<double>(value), {}}; }
  Reading<double> operator()(double value) const {
    if (!std::isfinite(value)) return {std::nullopt, "infinities and NaN are out of range"};
    return {value, {}};
  }
  template <class Other>
  Reading<double> operator()(const Other& /*value*/) const {
    return {std::nullopt, {}};
  }
};

struct WholeOf {
  Reading<std::int64_t> operator()(const Plain& plain) const { return read_whole(plain.text); }
  Reading<std::int64_t> operator()(const std::string& text) const {
    if (read_whole(text).value) return {std::nullopt, "remove the quotes"};
    return {std::nullopt, {}};
  }
  Reading<std::int64_t> operator()(std::int64_t value) const { return {value, {}}; }
  Reading<std::int64_t> operator()(double value) const { return read_whole(shortest(value)); }
  template <class Other>
  Reading<std::int64_t> operator()(const Other& /*value*/) const {
    return {std::nullopt, {}};
  }
};

bool read_number(const Shape& shape, const Place& place, Diagnostics& diagnostics, double& out) {
  const Reading<double> reading = std::visit(RealOf{shape.unit}, place.value->content);
  if (!reading.value) {
    report_expected(expected(shape), place, diagnostics, reading.problem);
    return false;
  }
  out = *reading.value;
  if (reading.had_unit) diagnostics.note_number(place, out);
  return check_range(shape, out, place, diagnostics);
}

bool read_integer(const Shape& shape, const Place& place, Diagnostics& diagnostics, int& out) {
  const Reading<std::int64_t> reading = std::visit(WholeOf{}, place.value->content);
  if (!reading.value) {
    report_expected(expected(shape), place, diagnostics, reading.problem);
    return false;
  }
  constexpr std::int64_t limit = std::numeric_limits<int>::max();
  if (*reading.value > limit || *reading.value < -limit) {
    report_expected(expected(shape), place, diagnostics, "it is too large");
    return false;
  }
  out = static_cast<int>(*reading.value);
  return check_range(shape, out, place, diagnostics);
}

/// Those of YAML 1.2, which are Python's, too.
std::optional<bool> truth_of(std::string_view text) {
  if (text == "true" || text == "True" || text == "TRUE") return true;
  if (text == "false" || text == "False" || text == "FALSE") return false;
  return std::nullopt;
}

/// Says what to write in place of a truth value of YAML 1.1, or one in quotes; empty for another
/// value.
std::string truth_problem(const Value& value) {
  const std::string* written = text_of(value);
  if (!written) return {};
  std::string word(*written);
  for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto is_one_of = [&](std::initializer_list<std::string_view> words) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  if (is_one_of({"true", "yes", "on", "y", "1"})) return "write true";
  if (is_one_of({"false", "no", "off", "n", "0"})) return "write false";
  return {};
}

bool read_boolean(const Shape& shape, const Place& place, Diagnostics& diagnostics, bool& out) {
  if (const auto* typed = std::get_if<bool>(&place.value->content)) {
    out = *typed;
    return true;
  }
  const auto* plain = std::get_if<Plain>(&place.value->content);
  const std::optional<bool> value = plain ? truth_of(plain->text) : std::nullopt;
  if (!value) {
    report_expected(expected(shape), place, diagnostics, truth_problem(*place.value));
    return false;
  }
  out = *value;
  return true;
}

bool read_text(const Shape& shape, const Place& place, Diagnostics& diagnostics, std::string& out) {
  const std::string* written = text_of(*place.value);
  const bool plain = std::holds_alternative<Plain>(place.value->content);
  if (!written || (plain && (looks_like_number(*written) || truth_of(*written)))) {
    report_expected(expected(shape), place, diagnostics, written ? "put it in quotes" : "");
    return false;
  }
  if (const std::optional<unsigned> code = control_character(*written)) {
    diagnostics.add(place,
                    fmt::format("the text holds the control character 0x{:02x}: remove it", *code));
    return false;
  }
  out = *written;
  return true;
}

bool read_name(const Shape& shape, const Place& place, Diagnostics& diagnostics, std::string& out) {
  const std::string* written = text_of(*place.value);
  if (!written || !is_name(*written)) {
    report_expected(expected(shape), place, diagnostics,
                    written ? "names are made of letters, digits, '_' and '-' and do not start "
                              "with a digit or '-'"
                            : "");
    return false;
  }
  out = *written;
  return true;
}

/// Reads the numbers of a list that is known to have as many as `out`.
template <class Numbers>
bool read_numbers(const Shape& shape, const Place& place, Diagnostics& diagnostics, Numbers& out) {
  const Sequence& items = *place.value->sequence();
  Shape component{Shape::Kind::Number};
  component.unit = shape.unit;
  bool fine = true;
  for (std::size_t i = 0; i < items.size(); ++i) {
    fine = read_number(component, place.at(static_cast<int>(i), items[i]), diagnostics, out[i]) &&
           fine;
  }
  return fine;
}

bool read_vector(const Shape& shape, const Place& place, Diagnostics& diagnostics,
                 Components& out) {
  const Sequence* items = place.value->sequence();
  if (!items) {
    const std::string* written = text_of(*place.value);
    const bool unbracketed = written && written->find(',') != std::string::npos;
    report_expected(
        expected(shape), place, diagnostics,
        unbracketed ? fmt::format("write it in brackets: [{}]", shortened(*written)) : "");
    return false;
  }
  const std::size_t count = items->size();
  if (count > 3 || count < static_cast<std::size_t>(shape.min_items)) {
    report_expected(expected(shape), place, diagnostics,
                    count == 1 ? "is a comma missing?" : split_number_in(*items));
    return false;
  }
  diagnostics.note_vector(place, split_number_in);
  out.resize(count);
  return read_numbers(shape, place, diagnostics, out);
}

bool read_pair(const Shape& shape, const Place& place, Diagnostics& diagnostics,
               CurvaturePair& out) {
  const Sequence* items = place.value->sequence();
  std::array<double, 2> numbers{};
  if (!items || items->size() != numbers.size()) {
    report_expected(expected(shape), place, diagnostics);
    return false;
  }
  const bool fine = read_numbers(shape, place, diagnostics, numbers);
  out = {numbers[0], numbers[1]};
  return fine;
}

}  // namespace

std::string split_number_in(const Sequence& items) {
  for (std::size_t i = 0; i + 1 < items.size(); ++i) {
    std::string number;
    std::string problem;
    int next = items[i].mark.column;
    for (std::size_t k = i; k < std::min(items.size(), i + kMostParts); ++k) {
      const auto* part = std::get_if<Plain>(&items[k].content);
      if (!part || items[k].mark.line != items[i].mark.line || items[k].mark.column != next) break;
      number += (k == i ? "" : ",") + part->text;
      next = items[k].mark.column + static_cast<int>(part->text.size()) + 1;
      if (k == i) continue;
      if (std::string longer = separator_problem(number); !longer.empty()) {
        problem = std::move(longer);
      }
    }
    if (!problem.empty()) return problem;
  }
  return {};
}

void report_expected(const std::string& what, const Place& place, Diagnostics& diagnostics,
                     const std::string& given_hint) {
  const std::string* text = std::get_if<std::string>(&place.value->content);
  const std::string hint = text && text->empty() && given_hint.empty()
                               ? "to remove the key write nothing, which is None in Python"
                               : given_hint;
  diagnostics.add(place, fmt::format("expected {}, got {}{}{}", what,
                                     std::visit(Describe{}, place.value->content),
                                     hint.empty() || hint.front() == ';' ? "" : ": ", hint));
}

const std::string* text_of(const Value& value) {
  if (const auto* plain = std::get_if<Plain>(&value.content)) return &plain->text;
  return std::get_if<std::string>(&value.content);
}

Format<double> number(std::string unit, Range range) {
  Shape shape{Shape::Kind::Number};
  shape.unit = std::move(unit);
  shape.range = range;
  return {std::move(shape), read_number, [](double value) { return fmt::format("{}", value); }};
}

Format<int> integer(Range range) {
  Shape shape{Shape::Kind::Integer};
  shape.range = range;
  return {std::move(shape), read_integer, [](int value) { return std::to_string(value); }};
}

Format<bool> boolean() {
  return {Shape{Shape::Kind::Boolean}, read_boolean,
          [](bool value) { return std::string(value ? "true" : "false"); }};
}

Format<std::string> text() { return {Shape{Shape::Kind::Text}, read_text}; }

Format<std::string> name() { return {Shape{Shape::Kind::Name}, read_name}; }

Format<std::string> one_of(const std::vector<Word>& words, std::vector<ReservedWord> reserved) {
  std::vector<std::pair<Word, std::string>> options;
  options.reserve(words.size());
  for (const Word& word : words) options.emplace_back(word, word.name);
  return choice(options, std::move(reserved));
}

Format<Components> vector(std::string unit) {
  Shape shape{Shape::Kind::Vector};
  shape.unit = std::move(unit);
  shape.min_items = 2;
  return {std::move(shape), read_vector};
}

Format<Components> space_vector(std::string unit) {
  Format<Components> format = vector(std::move(unit));
  format.shape.min_items = 3;
  return format;
}

Format<Components> section_triple(std::string unit) {
  Format<Components> format = space_vector(std::move(unit));
  format.shape.kind = Shape::Kind::Triple;
  return format;
}

Format<CurvaturePair> pair(std::string unit) {
  Shape shape{Shape::Kind::Pair};
  shape.unit = std::move(unit);
  return {std::move(shape), read_pair};
}

int read_word(const Shape& shape, const Shape& whole, const Place& place,
              Diagnostics& diagnostics) {
  const std::string* written = text_of(*place.value);
  if (written) {
    const auto known = std::find_if(shape.words.begin(), shape.words.end(),
                                    [&](const Word& word) { return word.name == *written; });
    if (known != shape.words.end()) return static_cast<int>(known - shape.words.begin());
    for (const ReservedWord& word : shape.reserved) {
      if (word.name != *written) continue;
      diagnostics.add(place, word.message);
      return -1;
    }
  }
  std::string near = written ? did_you_mean(*written, names_of(shape.words)) : "";
  if (written && near.empty()) near = did_you_mean_part_of(*written, names_of(shape.words));
  constexpr std::size_t many = 6;  // a longer list would hide the name that is meant
  const bool brief = !near.empty() && shape.words.size() > many;
  report_expected(brief ? fmt::format("one of {} words", shape.words.size()) : expected(whole),
                  place, diagnostics, near);
  return -1;
}

bool is_list(const Shape& shape, const Place& place, Diagnostics& diagnostics) {
  const Sequence* items = place.value->sequence();
  if (!items) {
    const bool one_item = place.value->mapping() != nullptr;
    report_expected(expected(shape), place, diagnostics,
                    one_item ? "start each item with '- '" : "");
    return false;
  }
  if (items->size() < static_cast<std::size_t>(shape.min_items)) {
    diagnostics.add(place, fmt::format("needs at least {} item{}, got {}", shape.min_items,
                                       shape.min_items == 1 ? "" : "s", items->size()));
    return false;
  }
  return true;
}

}  // namespace der::scenario
