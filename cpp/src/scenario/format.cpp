#include "scenario/format.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenario/number.hpp"
#include "scenario/suggestion.hpp"
#include "scenario/table.hpp"

namespace der::scenario {
namespace {

std::string shortened(const std::string& text) {
  constexpr std::size_t limit = 60;
  return text.size() <= limit ? text : text.substr(0, limit) + "...";
}

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

bool check_range(const Shape& shape, double value, const Place& place, Complaints& complaints) {
  if (shape.range.holds(value)) return true;
  complaints.add(place, fmt::format("must be {}, got {}", bounds(shape.range),
                                    std::visit(Describe{}, place.value->content)));
  return false;
}

/// The number in a scalar, whatever type it came with.
struct RealOf {
  const std::string& unit;

  Reading<double> operator()(const Plain& plain) const { return read_real(plain.text, unit); }
  Reading<double> operator()(const std::string& text) const {
    if (read_real(text, unit).value) return {std::nullopt, "remove the quotes"};
    return {std::nullopt, read_real(text, unit).problem};
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

bool read_number(const Shape& shape, const Place& place, Complaints& complaints, double& out) {
  const Reading<double> reading = std::visit(RealOf{shape.unit}, place.value->content);
  if (!reading.value) {
    complain_expected(expected(shape), place, complaints, reading.problem);
    return false;
  }
  out = *reading.value;
  return check_range(shape, out, place, complaints);
}

bool read_integer(const Shape& shape, const Place& place, Complaints& complaints, int& out) {
  const Reading<std::int64_t> reading = std::visit(WholeOf{}, place.value->content);
  if (!reading.value) {
    complain_expected(expected(shape), place, complaints, reading.problem);
    return false;
  }
  constexpr std::int64_t limit = std::numeric_limits<int>::max();
  if (*reading.value > limit || *reading.value < -limit) {
    complain_expected(expected(shape), place, complaints, "it is too large");
    return false;
  }
  out = static_cast<int>(*reading.value);
  return check_range(shape, out, place, complaints);
}

bool read_boolean(const Shape& shape, const Place& place, Complaints& complaints, bool& out) {
  if (const auto* typed = std::get_if<bool>(&place.value->content)) {
    out = *typed;
    return true;
  }
  const auto* plain = std::get_if<Plain>(&place.value->content);
  if (!plain || (plain->text != "true" && plain->text != "false")) {
    complain_expected(expected(shape), place, complaints);
    return false;
  }
  out = plain->text == "true";
  return true;
}

bool read_text(const Shape& shape, const Place& place, Complaints& complaints, std::string& out) {
  const std::string* written = text_of(*place.value);
  const bool plain = std::holds_alternative<Plain>(place.value->content);
  if (!written ||
      (plain && (looks_like_number(*written) || *written == "true" || *written == "false"))) {
    complain_expected(expected(shape), place, complaints, written ? "put it in quotes" : "");
    return false;
  }
  out = *written;
  return true;
}

bool read_name(const Shape& shape, const Place& place, Complaints& complaints, std::string& out) {
  const std::string* written = text_of(*place.value);
  if (!written || !is_name(*written)) {
    complain_expected(expected(shape), place, complaints,
                      written ? "names are made of letters, digits, '_' and '-' and do not start "
                                "with a digit or '-'"
                              : "");
    return false;
  }
  out = *written;
  return true;
}

bool read_vector(const Shape& shape, const Place& place, Complaints& complaints, Components& out) {
  const Sequence* items = place.value->sequence();
  if (!items) {
    const std::string* written = text_of(*place.value);
    const bool unbracketed = written && written->find(',') != std::string::npos;
    complain_expected(expected(shape), place, complaints,
                      unbracketed ? fmt::format("write it in brackets: [{}]", *written) : "");
    return false;
  }
  if (items->size() == 3) {
    complaints.add(place, kNoSpatialRods);
    return false;
  }
  if (items->size() != 2) {
    complain_expected(expected(shape), place, complaints,
                      items->size() == 1 ? "is a comma missing?" : "");
    return false;
  }
  Shape component{Shape::Kind::Number};
  component.unit = shape.unit;
  out.resize(2);
  bool fine = true;
  for (std::size_t i = 0; i < 2; ++i) {
    fine = read_number(component, place.at(static_cast<int>(i), (*items)[i]), complaints, out[i]) &&
           fine;
  }
  return fine;
}

/// Times that increase, and a value for each.
template <class Table>
void check_table(const Table& table, const Place& place, Complaints& complaints) {
  const Mapping& entries = *place.value->mapping();
  const Place times = place.at(*find_entry(entries, "times"));
  for (std::size_t i = 1; i < table.times.size(); ++i) {
    if (table.times[i] > table.times[i - 1]) continue;
    complaints.add(times.at(static_cast<int>(i), (*times.value->sequence())[i]),
                   fmt::format("times must increase, but {} s follows {} s", table.times[i],
                               table.times[i - 1]));
    return;
  }
  if (table.times.size() != table.values.size()) {
    complaints.add(place.at(*find_entry(entries, "values")),
                   fmt::format("a table needs one value for each of its {} times, got {}",
                               table.times.size(), table.values.size()));
  }
}

/// A constant or a table: `Constant` is the type of one value, `Result` that of the series.
template <class Result, class Constant>
Format<Result> constant_or_table(const Format<Constant>& constant, const std::string& name) {
  const Format<Result> table = mapping(
      Table<Result>(name,
                    "A value over time: linear between the times of the list, constant "
                    "before the first and after the last.")
          .required("times", &Result::times, list_of(number("s"), 1), "Increasing times.")
          .required("values", &Result::values, list_of(constant, 1), "One value for each time.")
          .in_unit_of_the_key()
          .check(check_table<Result>));
  Shape shape{Shape::Kind::AnyOf};
  shape.unit = constant.shape.unit;
  shape.parts = {constant.shape, table.shape};
  return {std::move(shape), [constant, table](const Shape& self, const Place& place,
                                              Complaints& complaints, Result& out) {
            if (place.value->mapping()) return table.read(place, complaints, out);
            if (place.value->sequence() && constant.shape.kind == Shape::Kind::Number) {
              complain_expected(expected(self), place, complaints);
              return false;
            }
            Constant value{};
            if (!constant.read(place, complaints, value)) return false;
            out.times = {0.0};
            out.values = {std::move(value)};
            return true;
          }};
}

Format<Location> location_of(const std::vector<std::pair<Word, Location::Kind>>& places,
                             std::vector<ReservedWord> reserved) {
  const Format<Location::Kind> word = choice(places, std::move(reserved));
  std::vector<Location::Kind> kinds;
  for (const auto& [name, kind] : places) kinds.push_back(kind);
  const Format<double> arc_length = number("m", not_negative());
  const Format<Location> node = mapping(Table<Location>("node", "A node by its number.")
                                            .required("node", &Location::node, integer({}),
                                                      "Counted from 0 at the start; -1 is the "
                                                      "last, -2 the one before."));
  Shape shape{Shape::Kind::AnyOf};
  shape.unit = "m";
  shape.parts = {word.shape, arc_length.shape, node.shape};
  return {std::move(shape), [word, kinds, arc_length, node](const Shape& self, const Place& place,
                                                            Complaints& complaints, Location& out) {
            out.mark = place.value->mark;
            if (place.value->mapping()) {
              out.kind = Location::Kind::Node;
              return node.read(place, complaints, out);
            }
            const std::string* written = text_of(*place.value);
            const bool is_word = written && !written->empty() &&
                                 std::isalpha(static_cast<unsigned char>(written->front())) != 0;
            if (is_word) {
              const int chosen = read_word(word.shape, expected(self), place, complaints);
              if (chosen >= 0) out.kind = kinds[static_cast<std::size_t>(chosen)];
              return chosen >= 0;
            }
            if (place.value->sequence()) {
              complain_expected(expected(self), place, complaints);
              return false;
            }
            out.kind = Location::Kind::ArcLength;
            return arc_length.read(place, complaints, out.arc_length);
          }};
}

std::vector<std::pair<Word, Location::Kind>> single_places() {
  return {{{"start", "first node"}, Location::Kind::Start},
          {{"middle", "half the rod's length"}, Location::Kind::Middle},
          {{"end", "last node"}, Location::Kind::End}};
}

}  // namespace

void complain_expected(const std::string& what, const Place& place, Complaints& complaints,
                       const std::string& hint) {
  complaints.add(place, fmt::format("expected {}, got {}{}{}", what,
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
  return {std::move(shape), read_vector};
}

int read_word(const Shape& shape, const std::string& what, const Place& place,
              Complaints& complaints) {
  const std::string* written = text_of(*place.value);
  const std::vector<std::string> names = names_of(shape.words);
  if (written) {
    const auto known = std::find(names.begin(), names.end(), *written);
    if (known != names.end()) return static_cast<int>(known - names.begin());
    for (const ReservedWord& word : shape.reserved) {
      if (word.name != *written) continue;
      complaints.add(place, word.message);
      return -1;
    }
  }
  complain_expected(what, place, complaints, written ? did_you_mean(*written, names) : "");
  return -1;
}

bool is_list(const Shape& shape, const Place& place, Complaints& complaints) {
  const Sequence* items = place.value->sequence();
  if (!items) {
    const bool one_item = place.value->mapping() != nullptr;
    complain_expected(expected(shape), place, complaints,
                      one_item ? "start each item with '- '" : "");
    return false;
  }
  if (items->size() < static_cast<std::size_t>(shape.min_items)) {
    complaints.add(place, fmt::format("needs at least {} item{}, got {}", shape.min_items,
                                      shape.min_items == 1 ? "" : "s", items->size()));
    return false;
  }
  return true;
}

Format<Series> series(const std::string& unit) {
  return constant_or_table<Series>(number(unit), "table");
}

Format<VectorSeries> vector_series(const std::string& unit) {
  return constant_or_table<VectorSeries>(vector(unit), "table of vectors");
}

Format<Location> location() {
  auto places = single_places();
  places.push_back({{"all", "every node"}, Location::Kind::All});
  return location_of(places, {});
}

Format<Location> single_location(const std::string& why_not_all) {
  return location_of(single_places(), {{"all", why_not_all}});
}

}  // namespace der::scenario
