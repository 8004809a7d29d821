#include <utility>

#include "scenario/scene_text.hpp"
#include "scenario/table.hpp"

namespace der::scenario {
namespace {

constexpr auto assign_analysis = [](Analysis& analysis, auto&& what) {
  analysis = std::forward<decltype(what)>(what);
};

Format<StaticAnalysis> static_format() {
  return mapping(
      Table<StaticAnalysis>("static analysis", "The equilibrium under the loads.")
          .optional("stability", &StaticAnalysis::leave_saddles,
                    choice<bool>(
                        {{{"stable", "an unstable equilibrium is left for a stable one"}, true},
                         {{"any", "the equilibrium nearest to the start, stable or not"}, false}}),
                    "Which equilibrium is the answer."));
}

/// The analyses with settings of their own.
Format<Analysis> table_format() {
  return mapping(
      Table<Analysis>("analysis", "Exactly one of these keys, with the settings of that analysis.")
          .kind("static", static_format(), assign_analysis, "The equilibrium under the loads."));
}

/// The analyses as words, with their default settings.
Format<Analysis> word_format() {
  const std::vector<std::pair<Word, Analysis>> options{
      {{"static", "the equilibrium under the loads"}, StaticAnalysis{}}};
  Shape shape{Shape::Kind::Choice};
  for (const auto& [word, analysis] : options) shape.words.push_back(word);
  return {std::move(shape),
          [options](const Shape& self, const Place& place, Complaints& complaints, Analysis& out) {
            const int chosen = read_word(self, expected(self), place, complaints);
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
                                          Complaints& complaints, Analysis& out) {
            return (place.value->mapping() ? table : word).read(place, complaints, out);
          }};
}

}  // namespace der::scenario
