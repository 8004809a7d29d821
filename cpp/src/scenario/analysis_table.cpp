#include <string>
#include <utility>
#include <vector>

#include "scenario/scene_text.hpp"
#include "scenario/table.hpp"

namespace der::scenario {
namespace {

constexpr auto assign_analysis = [](Analysis& analysis, auto&& what) {
  analysis = std::forward<decltype(what)>(what);
};

struct ContinuationText : ContinuationAnalysis {
  std::string given_vary = "loads";
};

constexpr auto assign_continuation = [](Analysis& analysis, ContinuationText&& text) {
  analysis = static_cast<ContinuationAnalysis&&>(text);
};

/// Reads `loads`, `supports`, `actuation`, or one of them with its number or its name; false if it
/// is none of these.
bool read_varied(const std::string& text, ContinuationAnalysis& out) {
  const auto dot = text.find('.');
  const std::string kind = text.substr(0, dot);
  if (kind != "loads" && kind != "supports" && kind != "actuation") return false;
  out.vary = kind == "loads"      ? Varied::Loads
             : kind == "supports" ? Varied::Supports
                                  : Varied::Actuations;
  if (dot == std::string::npos) return true;
  const std::string digits = text.substr(dot + 1);
  if (is_name(digits)) {
    out.name = digits;
    return true;
  }
  const bool leading_zero = digits.size() > 1 && digits.front() == '0';
  if (digits.empty() || digits.size() > 6 || leading_zero ||
      digits.find_first_not_of("0123456789") != std::string::npos) {
    return false;
  }
  out.number = std::stoi(digits);
  return true;
}

void check_continuation(ContinuationText& text, const Place& place, Diagnostics& diagnostics) {
  const Mapping& entries = *place.value->mapping();
  if (text.from == text.to) {
    const Entry* to = find_entry(entries, "to");
    diagnostics.add(to ? place.at(*to) : place,
                    fmt::format("must differ from 'from', but both are {}", text.to));
  }
  if (!read_varied(text.given_vary, text)) {
    diagnostics.add(place.at(*find_entry(entries, "vary")),
                    fmt::format("expected 'loads', 'supports', 'actuation', or one by its number "
                                "or its name, as 'loads.0' or 'actuation.bend', got '{}'",
                                text.given_vary));
  }
}

Format<StaticAnalysis> static_format() {
  return mapping(
      Table<StaticAnalysis>("static analysis", "The equilibrium under the loads.")
          .optional("stability", &StaticAnalysis::leave_saddles,
                    choice<bool>(
                        {{{"stable", "an unstable equilibrium is left for a stable one"}, true},
                         {{"any", "the equilibrium nearest to the start, stable or not"}, false}}),
                    "Which equilibrium is the answer."));
}

Format<ModesAnalysis> modes_format() {
  return mapping(Table<ModesAnalysis>("modes analysis",
                                      "Natural frequencies and shapes of free vibrations about the "
                                      "equilibrium under the loads.")
                     .optional("count", &ModesAnalysis::count, integer(at_least(1)),
                               "How many, from the lowest frequency on.", "6"));
}

Format<BucklingAnalysis> buckling_format() {
  return mapping(Table<BucklingAnalysis>(
                     "buckling analysis",
                     "Linear buckling: factors of all loads at which the shape without load, "
                     "or little deformed, becomes unstable.")
                     .optional("count", &BucklingAnalysis::count, integer(at_least(1)),
                               "How many, from the lowest load on.", "3"));
}

Format<ContinuationText> continuation_format() {
  return mapping(
      Table<ContinuationText>("continuation",
                              "The path of equilibria as loads change in proportion to a factor, "
                              "through limit points; its folds and bifurcations.")
          .optional("vary", &ContinuationText::given_vary, text(),
                    "Quantities that the factor scales: `loads` (all of them), `supports` (all "
                    "prescribed motions), `actuation` (all changes of rest shapes), or one by its "
                    "number or its name, as `loads.0` or `actuation.bend`.",
                    "`loads`")
          .optional("from", &ContinuationAnalysis::from, number(""), "First factor.", "0")
          .optional("to", &ContinuationAnalysis::to, number(""),
                    "Last factor. A path also ends at the opposite limit, `2 from - to`.", "1")
          .optional("step", &ContinuationAnalysis::step, number("", positive()),
                    "Largest distance of two points: change of the factor against `to - from`, and "
                    "of the shape in units of like size.",
                    "0.05")
          .optional("points", &ContinuationAnalysis::points, integer(at_least(2)),
                    "Largest number of points of a branch.", "500")
          .optional("branches", &ContinuationAnalysis::branches, integer(not_negative()),
                    "How many bifurcations deep the paths that branch off are followed, to both "
                    "sides; 0: only the first path.",
                    "0")
          .check(check_continuation));
}

/// The analyses with settings of their own.
Format<Analysis> table_format() {
  return mapping(
      Table<Analysis>("analysis", "Exactly one of these keys, with the settings of that analysis.")
          .kind("static", static_format(), assign_analysis, "The equilibrium under the loads.")
          .kind("modes", modes_format(), assign_analysis, "Free vibrations about it.")
          .kind("buckling", buckling_format(), assign_analysis, "Linear buckling loads.")
          .kind("continuation", continuation_format(), assign_continuation,
                "The path of equilibria along a load."));
}

/// The analyses as words, with their default settings.
Format<Analysis> word_format() {
  const std::vector<std::pair<Word, Analysis>> options{
      {{"static", "the equilibrium under the loads"}, StaticAnalysis{}},
      {{"modes", "free vibrations about that equilibrium"}, ModesAnalysis{}},
      {{"buckling", "linear buckling loads"}, BucklingAnalysis{}},
      {{"continuation", "the path of equilibria from no load to the whole"},
       ContinuationAnalysis{}}};
  Shape shape{Shape::Kind::Choice};
  for (const auto& [word, analysis] : options) shape.words.push_back(word);
  return {std::move(shape), [options](const Shape& self, const Place& place,
                                      Diagnostics& diagnostics, Analysis& out) {
            const int chosen = read_word(self, self, place, diagnostics);
            if (chosen >= 0) out = options[static_cast<std::size_t>(chosen)].second;
            return chosen >= 0;
          }};
}

}  // namespace

Format<Analysis> analysis_format() {
  Shape shape{Shape::Kind::AnyOf};
  const Format<Analysis> word = word_format();
  const Format<Analysis> table = table_format();
  shape.parts = {word.shape, table.shape};
  return {std::move(shape), [word, table](const Shape& /*self*/, const Place& place,
                                          Diagnostics& diagnostics, Analysis& out) {
            return (place.value->mapping() ? table : word).read(place, diagnostics, out);
          }};
}

}  // namespace der::scenario
