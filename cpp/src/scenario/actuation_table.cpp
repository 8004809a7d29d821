#include "scenario/scene_text.hpp"
#include "scenario/table.hpp"

namespace der::scenario {
namespace {

struct ActuationText : Actuation {
  std::vector<Series> curvature;
  Series twist;
  Series stretch;
};

/// One table, or two toward the directors of the section.
Format<std::vector<Series>> actuated_curvature_format() {
  const Format<Series> one = series("1/m");
  const Format<std::vector<Series>> two = list_of(one, 2);
  Shape shape{Shape::Kind::AnyOf};
  shape.unit = one.shape.unit;
  shape.parts = one.shape.parts;
  shape.parts.push_back(two.shape);
  return {std::move(shape), [one, two](const Shape& /*self*/, const Place& place,
                                       Diagnostics& diagnostics, std::vector<Series>& out) {
            const Sequence* items = place.value->sequence();
            if (!items) return one.read(place, diagnostics, out.emplace_back());
            if (items->size() != 2) {
              diagnostics.add(place, fmt::format("a natural curvature is one number or table, or "
                                                 "a pair [k1, k2] of them, toward the director "
                                                 "and across it, but this is a list of {}",
                                                 items->size()));
              return false;
            }
            return two.read(place, diagnostics, out);
          }};
}

Format<Profile> profile_format() {
  return choice<Profile>(
      {{{"constant", "the value on the whole stretch"}, Profile::Constant},
       {{"linear", "from 0 at `from` to the value at `to`"}, Profile::Linear},
       {{"smooth",
         "sin^2: 0 with slope 0 at both ends, the value in the middle; half of it on average"},
        Profile::Smooth}});
}

void check_actuation(ActuationText& actuation, const Place& place, Diagnostics& diagnostics) {
  if (actuation.from < actuation.to) return;
  diagnostics.add(
      place.at(*find_entry(*place.value->mapping(), "to")),
      fmt::format("must be greater than 'from' ({} m), got {} m", actuation.from, actuation.to));
}

Actuation completed(ActuationText text, const Mapping* entries) {
  const auto given = [&](const char* key) { return entries && find_entry(*entries, key); };
  if (given("elongation")) {
    text.what = Actuated::Length;
    text.values = {std::move(text.stretch)};
  } else if (given("natural_twist")) {
    text.what = Actuated::Twist;
    text.values = {std::move(text.twist)};
  } else {
    text.values = std::move(text.curvature);
  }
  return static_cast<Actuation&&>(text);
}

}  // namespace

const char* key_of(Actuated what) {
  switch (what) {
    case Actuated::Curvature:
      return "natural_curvature";
    case Actuated::Twist:
      return "natural_twist";
    case Actuated::Length:
      break;
  }
  return "elongation";
}

Format<Actuation> actuation_format() {
  Format<ActuationText> as_written = mapping(
      Table<ActuationText>("actuation",
                           "A change of a rod's rest shape, added to what the rod has by itself. "
                           "Several on one stretch add up.")
          .required("name", &Actuation::name, name(),
                    "Names it for programs that drive it and for override paths.")
          .required("rod", &Actuation::rod, name(), "Name of the rod.")
          .optional("from", &Actuation::from, number("m", not_negative()),
                    "Arc length where the stretch starts.")
          .optional("to", &Actuation::to, number("m", positive()),
                    "Arc length where the stretch ends.", "the rod's length")
          .optional("profile", &Actuation::profile, profile_format(),
                    "How the value is spread over the stretch.")
          .optional("natural_curvature", &ActuationText::curvature, actuated_curvature_format(),
                    "Curvature per rest length: a number or a table, positive counter-clockwise; "
                    "in a scene of three components also a pair of such, toward the director and "
                    "across it.")
          .optional("natural_twist", &ActuationText::twist, series("rad/m"),
                    "Twist per rest length, right-handed.")
          .optional("elongation", &ActuationText::stretch, series(""),
                    "Change of length over rest length, as a thermal strain; greater than -1.")
          .either({{"natural_curvature"}, {"natural_twist"}, {"elongation"}})
          .check(check_actuation));
  Shape shape = as_written.shape;
  return {std::move(shape),
          [as_written = std::move(as_written)](const Shape& /*self*/, const Place& place,
                                               Diagnostics& diagnostics, Actuation& out) {
            ActuationText text;
            const bool fine = as_written.read(place, diagnostics, text);
            out = completed(std::move(text), place.value->mapping());
            return fine;
          }};
}

}  // namespace der::scenario
