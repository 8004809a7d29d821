#include <cctype>

#include "scenario/table.hpp"

namespace der::scenario {
namespace {

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
  return {std::move(shape),
          [word, kinds, arc_length, node](const Shape& self, const Place& place,
                                          Diagnostics& diagnostics, Location& out) {
            out.mark = place.value->mark;
            if (place.value->mapping()) {
              out.kind = Location::Kind::Node;
              return node.read(place, diagnostics, out);
            }
            const std::string* written = text_of(*place.value);
            const bool is_word = written && !written->empty() &&
                                 std::isalpha(static_cast<unsigned char>(written->front())) != 0;
            if (is_word) {
              const int chosen = read_word(word.shape, self, place, diagnostics);
              if (chosen >= 0) out.kind = kinds[static_cast<std::size_t>(chosen)];
              return chosen >= 0;
            }
            if (place.value->sequence()) {
              report_expected(expected(self), place, diagnostics);
              return false;
            }
            out.kind = Location::Kind::ArcLength;
            return arc_length.read(place, diagnostics, out.arc_length);
          }};
}

std::vector<std::pair<Word, Location::Kind>> single_places() {
  return {{{"start", "first node"}, Location::Kind::Start},
          {{"middle", "half the rod's length"}, Location::Kind::Middle},
          {{"end", "last node"}, Location::Kind::End}};
}

}  // namespace

Format<Location> location() {
  auto places = single_places();
  places.push_back({{"all", "every node"}, Location::Kind::All});
  return location_of(places, {});
}

Format<Location> single_location(const std::string& why_not_all) {
  return location_of(single_places(), {{"all", why_not_all}});
}

}  // namespace der::scenario
