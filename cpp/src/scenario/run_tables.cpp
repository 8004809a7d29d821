#include <string_view>
#include <unordered_set>

#include "der/catalog/linear_solvers.hpp"
#include "der/catalog/quantities.hpp"
#include "der/catalog/steppers.hpp"
#include "der/core/printable.hpp"
#include "der/scenario/load.hpp"
#include "scenario/scene_text.hpp"
#include "scenario/table.hpp"

namespace der::scenario {
namespace {

std::vector<Word> words(const std::vector<std::string>& names) {
  std::vector<Word> result;
  result.reserve(names.size());
  for (const std::string& word : names) result.push_back({word, ""});
  return result;
}

Format<std::string> quantity_format() {
  std::vector<Word> names;
  for (const Quantity& quantity : quantities()) {
    const std::string unit = quantity.unit.empty() ? "" : " [" + quantity.unit + "]";
    names.push_back({quantity.name, quantity.meaning + unit});
  }
  return one_of(names);
}

/// `over: rod`: the only span there is.
Format<bool> over_format() { return choice<bool>({{{"rod", "the whole rod"}, true}}); }

/// A support by its number, or by a name.
Format<std::string> named_support_format() {
  const Format<int> number = integer(at_least(0));
  const Format<std::string> word = name();
  Shape shape{Shape::Kind::AnyOf};
  shape.parts = {number.shape, word.shape};
  return {std::move(shape), [number, word](const Shape& /*self*/, const Place& place,
                                           Diagnostics& diagnostics, std::string& out) {
            const std::string* text = text_of(*place.value);
            if (text != nullptr && is_name(*text)) return word.read(place, diagnostics, out);
            int which = 0;
            if (!number.read(place, diagnostics, which)) return false;
            out = std::to_string(which);
            return true;
          }};
}

struct ProbeText : Probe {
  bool over_rod = false;
};

Table<ProbeText> probe_table() {
  return Table<ProbeText>("probe", "A number recorded at every step.")
      .required("quantity", &Probe::quantity, quantity_format(), "Recorded quantity.")
      .optional("rod", &Probe::rod, name(),
                "Name of the rod; energies of the whole model go "
                "without it.")
      .optional("at", &Probe::at,
                single_location("'all' is not a single place: for the extreme along the rod write "
                                "'over: rod' and 'reduce: min' or 'max'"),
                "Where along the rod.")
      .optional("over", &ProbeText::over_rod, over_format(),
                "In place of `at`: the extreme along the rod.")
      .optional("support", &Probe::support, named_support_format(),
                "In place of `rod`, for reactions: the number of the support, counted from 0.")
      .optional("joint", &Probe::joint, name(),
                "In place of `rod` and `at`: a joint, for its position, velocity and rotation.")
      .optional("leg", &Probe::leg, name(),
                "With `joint`, for forces and moments: the rod that exerts them on the joint.")
      .optional("spring", &Probe::spring, name(),
                "In place of `rod`: a spring between joints, for its length and force.")
      .optional("actuation", &Probe::actuation, name(),
                "In place of `rod`, for what an actuation exerts: its name.")
      .optional("reduce", &Probe::over,
                choice<Reduce>({{{"min", "the least value"}, Reduce::Min},
                                {{"max", "the greatest value"}, Reduce::Max}}),
                "Which extreme; with `over`.")
      .optional("side", &Probe::side,
                choice<Side>({{{"before", "toward the start of the rod"}, Side::Before},
                              {{"after", "toward its end"}, Side::After}}),
                "With `at`: on which side of a place where the quantity jumps: curvatures, twist, "
                "moments and torque at an interior clamp, moment or spring against turning, strain "
                "and tension at a force, support or sphere, all of these, slope and tangent at a "
                "corner; without it, after the place.")
      .at_most_one({{"at"}, {"over", "reduce"}})
      .at_most_one({{"rod"}, {"support"}, {"actuation"}, {"joint"}, {"spring"}});
}

/// A mapping from free names to probes.
Format<std::vector<Probe>> probes_format() {
  const auto table = std::make_shared<const Table<ProbeText>>(probe_table());
  Shape shape{Shape::Kind::NamedTables};
  shape.table = std::shared_ptr<const TableInfo>(table, &table->info());
  return {std::move(shape), [table](const Shape& self, const Place& place, Diagnostics& diagnostics,
                                    std::vector<Probe>& out) {
            const Mapping* entries = place.value->mapping();
            if (!entries) {
              report_expected(expected(self), place, diagnostics);
              return false;
            }
            const std::size_t before = diagnostics.size();
            std::unordered_set<std::string_view> names;
            for (const Entry& entry : *entries) {
              if (!names.insert(entry.key).second) {
                diagnostics.add_key(place, entry.key, entry.mark,
                                    fmt::format("duplicate probe '{}'", shortened(entry.key)));
              } else if (!is_name(entry.key)) {
                diagnostics.add_key(place, entry.key, entry.mark,
                                    "names are made of letters, digits, '_' and '-' and do not "
                                    "start with a digit or '-'");
              }
              ProbeText probe;
              table->read(place.at(entry), diagnostics, probe);
              probe.name = entry.key;
              out.push_back(static_cast<Probe&&>(probe));
            }
            return diagnostics.size() == before;
          }};
}

/// A number, or the word `auto`.
Format<std::variant<double, AutomaticStep>> step_format() {
  const Format<double> fixed = number("s", positive());
  const Format<bool> automatic =
      choice<bool>({{{"auto", "the largest stable step of an explicit integrator"}, true}});
  Shape shape{Shape::Kind::AnyOf};
  shape.unit = fixed.shape.unit;
  shape.parts = {fixed.shape, automatic.shape};
  return {std::move(shape),
          [fixed](const Shape& /*self*/, const Place& place, Diagnostics& diagnostics,
                  std::variant<double, AutomaticStep>& out) {
            const std::string* word = text_of(*place.value);
            if (word && *word == "auto") {
              out = AutomaticStep{};
              return true;
            }
            return fixed.read(place, diagnostics, out.emplace<double>());
          }};
}

}  // namespace

Format<TimeText> time_format() {
  return mapping(
      Table<TimeText>("time", "A run over time.")
          .required("duration", &Time::duration, number("s", positive()), "End of the run.")
          .optional("step", &TimeText::given_step, step_format(),
                    "Time step; `auto`: the largest stable one of an explicit integrator, with a "
                    "margin.")
          .optional("tolerance", &TimeText::given_tolerance, number("", between(0, 1)),
                    "In place of `step`: the error of positions that may come from the time steps, "
                    "as a fraction of the structure's size. The steps adapt to it.")
          .either({{"step"}, {"tolerance"}})
          .optional("integrator", &Time::integrator, one_of(words(integrator_names())),
                    "Time-stepping scheme.")
          .optional(
              "spectral_radius", &TimeText::given_spectral_radius,
              number("", Range{0.0, false, 1.0, false}),
              "For `generalized_alpha`: spectral radius at infinite frequency (0: full damping, "
              "1: none).",
              "0.9")
          .optional("allow_unstable", &Time::allow_unstable, boolean(),
                    "Whether a run may go on where the integrator creates as much as half of the "
                    "energy that the run exchanges, and an explicit integrator with a step that is "
                    "too large for it.")
          .optional("minimum_step", &TimeText::given_minimum_step, number("s", positive()),
                    "A step that fails is retried in smaller ones, down to this.",
                    "step / 1024; with `step: auto` 1e-5 of the step; with `tolerance` about 1e-12 "
                    "of the duration"));
}

Format<Solver> solver_format() {
  return mapping(
      Table<Solver>("solver", "How the equations of a step are solved.")
          .optional("linear", &Solver::linear, one_of(words(linear_solver_names())),
                    "Solver for the linear equations; `auto` picks the fastest that fits.")
          .optional("residual_tolerance", &Solver::residual_tolerance, number("", between(0, 1)),
                    "Newton's method ends when the residual is below this fraction of the acting "
                    "forces ...")
          .optional("step_tolerance", &Solver::step_tolerance, number("", between(0, 1)),
                    "... and its step below this fraction of the structure's size.")
          .optional("max_iterations", &Solver::max_iterations, integer(at_least(1)),
                    "Iterations before a step counts as failed."));
}

Format<OutputText> output_format() {
  return mapping(
      Table<OutputText>("output", "Saved frames and probes.")
          .optional("every", &OutputText::given_every, number("s", positive()),
                    "Time between saved frames; with a fixed step a whole multiple of it.",
                    "a thousandth of the duration, or the step if that is longer")
          .optional("probes", &Output::probes, probes_format(),
                    "Numbers to record, under names of your own."));
}

const Format<SceneText>& scene_format() {
  static const Format<SceneText> format = mapping(
      Table<SceneText>("scene",
                       "A scene is one YAML mapping with these keys. Values are in SI "
                       "units, or have a unit behind them.")
          .optional("title", &Scene::title, text(), "One line that says what the scene shows.")
          .optional(
              "model", &Scene::model,
              choice<ModelChoice>(
                  {{{"auto", "the smallest model that can represent the scene"}, ModelChoice::Auto},
                   {{"planar", "positions and bending in the x-y plane"}, ModelChoice::Planar},
                   {{"spatial_bend", "positions and bending in space, of rods that do not twist"},
                    ModelChoice::SpatialBend},
                   {{"spatial", "positions, bending and twist in space"}, ModelChoice::Spatial}}),
              "Mechanical model.")
          .required("rods", &SceneText::given_rods, list_of(rod_format(), 1), "The rods.")
          .optional("joints", &Scene::joints, list_of(joint_format(), 0),
                    "Joints between rods. Nothing else joins rods that touch.")
          .optional("springs", &Scene::springs, list_of(axial_spring_format(), 0),
                    "Springs between joints.")
          .optional("supports", &Scene::supports, list_of(support_format(), 0),
                    "Supports that hold or move the rods.")
          .optional("loads", &Scene::loads, list_of(load_format(), 0), "Loads on the rods.")
          .optional("actuation", &Scene::actuations, list_of(actuation_format(), 0),
                    "Changes of the rods' rest shapes.")
          .optional("time", &SceneText::given_time, time_format(), "A run over time.")
          .optional("analysis", &Scene::analysis, analysis_format(),
                    "In place of `time`: an analysis without it.")
          .either({{"time"}, {"analysis"}})
          .optional(
              "start_from", &Scene::start_from, text(),
              "Where to start: `equilibrium` (that under the loads at time 0), or the folder of "
              "a run of the same rods, whose last frame it is.",
              "the shape as drawn")
          .optional("solver", &Scene::solver, solver_format(), "Numerical settings.")
          .optional("output", &SceneText::given_output, output_format(),
                    "Saved frames and probes."));
  return format;
}

}  // namespace der::scenario
