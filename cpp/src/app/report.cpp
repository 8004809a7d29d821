#include "der/app/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <variant>
#include <vector>

#include "der/app/format.hpp"
#include "der/core/printable.hpp"
#include "der/output/datasets.hpp"
#include "der/output/hints.hpp"
#include "der/output/out_of_plane_verdict.hpp"
#include "der/output/result_size.hpp"
#include "der/output/summary.hpp"
#include "der/scenario/scenario.hpp"

namespace der::app {
namespace {

using Row = std::vector<std::string>;

/// Turning angle at a node [rad] above which a mesh is certainly too coarse for the shape.
constexpr double kSharpTurn = 1.0;

bool is_static(const Simulation& simulation) { return !simulation.scenario().scene().is_dynamic(); }

/// Rows of a table as lines, indented by two: the first and the last column to the left, numbers to
/// the right.
std::string aligned(const std::vector<Row>& rows, const Style& style) {
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const Row& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool left = i == 0 || i + 1 == row.size();
      line += left ? fmt::format("  {:<{}}", row[i], widths[i])
                   : fmt::format("  {:>{}}", row[i], widths[i]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += (&row == &rows.front() ? style.dim(line) : line) + "\n";
  }
  return text;
}

std::string number(double value) { return fmt::format("{:.6g}", value); }

std::string probe_table(const Simulation& simulation, const Recorder& recorder,
                        const Style& style) {
  std::vector<Row> rows;
  if (is_static(simulation)) {
    rows.push_back({"probe", "value", "unit"});
  } else {
    rows.push_back({"probe", "final", "min", "at t [s]", "max", "at t [s]", "unit"});
  }
  for (std::size_t i = 0; i < recorder.probes().size(); ++i) {
    const Probe& probe = recorder.probes()[i];
    const ProbeSummary& s = recorder.summaries()[i];
    if (is_static(simulation)) {
      rows.push_back({probe.name(), number(s.final), probe.unit()});
    } else {
      rows.push_back({probe.name(), number(s.final), number(s.min), number(s.t_min), number(s.max),
                      number(s.t_max), probe.unit()});
    }
  }
  return aligned(rows, style);
}

std::string line(std::string_view label, const std::string& text, const Style& style) {
  return fmt::format("  {} {}\n", style.dim(fmt::format("{:<8}", label)), text);
}

std::string model_lines(const Simulation& simulation, const Style& style) {
  const Model& model = simulation.model();
  const UsedSolver solver = used_solver(simulation);
  return line("model", fmt::format("{}: {}", model.name, model.reason), style) +
         line("",
              fmt::format("{}, {}, {}, {} free",
                          format_count(static_cast<std::int64_t>(model.rods.size()), "rod"),
                          format_count(model.num_nodes, "node"),
                          format_count(model.num_dofs(), "degree") + " of freedom",
                          model.num_free()),
              style) +
         line("solver", fmt::format("{}: {}", solver.name, solver.reason), style);
}

std::string stability_text(const Stability& stability, const Style& style) {
  if (!stability.judged) {
    return "stability not judged: a load that turns with the rod, or a moment in space, has no "
           "potential";
  }
  if (stability.unstable_directions > 0) {
    return style.warning(fmt::format("UNSTABLE in {}: a small disturbance would move it away",
                                     format_count(stability.unstable_directions, "direction")));
  }
  if (stability.unknown_directions > 0) {
    return style.warning(
        fmt::format("stability not known in {}: rounding hides it, the mesh is too fine",
                    format_count(stability.unknown_directions, "direction")));
  }
  if (stability.neutral_directions > 0) {
    return style.warning(
        fmt::format("neutral in {}: nothing holds it there (free to move, or at a critical load)",
                    format_count(stability.neutral_directions, "direction")));
  }
  return "stable";
}

std::string equilibrium_lines(const EquilibriumReport& report, const Style& style) {
  std::string text = line("balance",
                          fmt::format("unbalanced force {:.2g} N, largest acting force {:.4g} N",
                                      report.residual, report.force_scale),
                          style);
  if (report.saddles_left > 0) {
    text += line("",
                 fmt::format("left {} (unstable equilibria) downhill along the softest direction",
                             format_count(report.saddles_left, "saddle")),
                 style);
  }
  if (report.largest_turning_angle > kSharpTurn) {
    text +=
        line("",
             style.warning(fmt::format("the rod turns by {:.2g} rad at a single node: more nodes "
                                       "would resolve the bend",
                                       report.largest_turning_angle)),
             style);
  }
  return text;
}

/// The summary of motion out of the plane that was tested, but for its warnings.
std::string out_of_plane_text(const OutOfPlaneVerdict& verdict, const Style& style) {
  if (verdict.load_factor) {
    return fmt::format("stability out of it lost at the load factor {:.6g}", *verdict.load_factor);
  }
  if (!verdict.stability) return "stable out of it at all load factors";
  const Stability& stability = *verdict.stability;
  const Index doubtful =
      stability.unstable_directions + stability.neutral_directions + stability.unknown_directions;
  if (doubtful == 0) return "stable out of it";
  return style.warning(
      fmt::format("{} out of it in {}", stability.name(), format_count(doubtful, "direction")));
}

std::string plane_line(const OutOfPlaneVerdict& verdict, Detail detail, const Style& style) {
  if (verdict.not_tested.empty()) return line("plane", out_of_plane_text(verdict, style), style);
  if (detail == Detail::Usual) return {};
  return line("plane", "not tested out of it, because " + verdict.not_tested, style);
}

std::string status_line(const Simulation& simulation, const RunOutcome& outcome, Detail detail,
                        const Style& style) {
  std::string status = outcome.status;
  if (outcome.ok()) {
    status = style.good(status);
  } else if (outcome.failed()) {
    status = style.bad(status);
    if (simulation.scenario().scene().is_dynamic()) {
      status += fmt::format(" at t = {:.6g} s", outcome.time);
    }
  } else if (is_static(simulation)) {
    status = style.warning(status) + " before its end: there is no result";
  } else {
    status = style.warning(status) +
             fmt::format(" at t = {:.6g} s of {:.6g} s; go on with --resume", outcome.time,
                         simulation.scenario().scene().time.duration);
  }
  if (outcome.equilibrium) {
    status += ", " + stability_text(outcome.equilibrium->stability, style);
  }
  std::string text = line("status", status, style);
  if (outcome.equilibrium) text += equilibrium_lines(*outcome.equilibrium, style);
  if (const auto plane = out_of_plane_verdict(simulation, outcome)) {
    text += plane_line(*plane, detail, style);
  }
  return text;
}

std::string what_stepped(const Simulation& simulation) {
  const std::string_view name = simulation.integrator().name;
  if (simulation.adaptive()) {
    return fmt::format("{}, adaptive steps for an error of {:g} of the size", name,
                       simulation.scenario().scene().time.tolerance);
  }
  const StepPlan& plan = simulation.plan();
  return fmt::format("{}, {} of {:g} s", name, format_count(plan.total_steps, "step"), plan.step);
}

/// One overload for each kind of analysis.
struct WhatRan {
  const Simulation& simulation;
  std::string operator()(const scenario::DynamicAnalysis&) const {
    return what_stepped(simulation);
  }
  std::string operator()(const scenario::StaticAnalysis&) const { return "static equilibrium"; }
  std::string operator()(const scenario::ModesAnalysis&) const {
    return "vibration modes about the equilibrium";
  }
  std::string operator()(const scenario::BucklingAnalysis&) const {
    return "linear buckling loads";
  }
  std::string operator()(const scenario::ContinuationAnalysis&) const {
    return "continuation of equilibria";
  }
};

std::string what_ran(const Simulation& simulation) {
  return std::visit(WhatRan{simulation}, simulation.scenario().scene().analysis);
}

std::string cost_line(const Simulation& simulation, const RunOutcome& outcome, const Style& style) {
  const Counters& c = outcome.counters;
  std::string text = format_seconds(outcome.wall_seconds);
  if (!is_static(simulation)) {
    const double speed = static_cast<double>(c.steps) / outcome.wall_seconds;
    if (simulation.adaptive()) text += ", " + format_count(c.steps, "step");
    text += fmt::format(" ({} steps/s)", format_count(std::llround(speed)));
  }
  if (c.rejected_steps > 0) text += ", " + format_count(c.rejected_steps, "rejected step");
  if (c.newton_iterations > 0) text += ", " + format_count(c.newton_iterations, "Newton iteration");
  if (c.retried_steps > 0) {
    text += ", " + format_count(c.retried_steps, "step") + " done in smaller pieces";
  }
  return line("cost", text, style);
}

std::string modes_table(const RunOutcome& outcome, const Style& style) {
  std::vector<Row> rows{{"mode", "frequency [Hz]", "growth rate [1/s]", ""}};
  for (std::size_t i = 0; i < outcome.modes.size(); ++i) {
    const Mode& mode = outcome.modes[i];
    const bool rigid = mode.frequency == 0.0 && mode.growth_rate == 0.0;
    rows.push_back({std::to_string(i + 1), number(mode.frequency), number(mode.growth_rate),
                    rigid ? "free to move" : ""});
  }
  return aligned(rows, style);
}

std::string buckling_table(const RunOutcome& outcome, const Style& style) {
  const auto& modes = outcome.buckling.modes;
  if (modes.empty()) return "  no load factor is critical by linear theory\n";
  std::vector<Row> rows{{"mode", "critical load factor", ""}};
  for (std::size_t i = 0; i < modes.size(); ++i) {
    rows.push_back({std::to_string(i + 1), number(modes[i].load_factor), ""});
  }
  return aligned(rows, style);
}

/// Where the path turns and where others cross it.
std::string path_tables(const Recorder& recorder, const RunOutcome& outcome, const Style& style) {
  std::vector<Row> rows{{"event", "branch", "load factor", "unstable directions"}};
  for (const Probe& probe : recorder.probes()) rows.front().push_back(probe.name());
  rows.front().emplace_back();
  std::size_t index = 0;
  for (std::size_t number_of = 0; number_of < outcome.path.size(); ++number_of) {
    const PathBranch& branch = outcome.path[number_of];
    for (const PathPoint& point : branch.points) {
      const auto& probes = outcome.path_probes[index++];
      const bool last = &point == &branch.points.back();
      if (&point != &branch.points.front() && point.event == PathEvent::None && !last) continue;
      Row row{last                             ? "end"
              : point.event == PathEvent::None ? "start"
                                               : event_name(point.event),
              std::to_string(number_of), number(point.factor),
              std::to_string(point.stability.unstable_directions)};
      for (const double value : probes) row.push_back(number(value));
      row.push_back(last ? branch.ending : "");
      rows.push_back(row);
    }
  }
  return aligned(rows, style);
}

std::string warning_lines(const std::vector<std::string>& warnings, const Style& style) {
  std::string text;
  for (const std::string& warning : warnings) {
    text += line("warning", style.warning(warning), style);
  }
  return text;
}

std::string size_text(const Simulation& simulation) {
  const auto& analysis = simulation.scenario().scene().analysis;
  if (std::holds_alternative<scenario::ContinuationAnalysis>(analysis)) {
    return fmt::format("about {}, and {} for each point of the path",
                       format_bytes(expected_bytes(simulation)),
                       format_bytes(bytes_per_frame(simulation)));
  }
  const double frames = expected_frames(simulation);
  return fmt::format("{}, about {}",
                     frames < 1e15 ? format_count(std::llround(frames), "frame")
                                   : fmt::format("{:.3g} frames", frames),
                     format_bytes(expected_bytes(simulation)));
}

}  // namespace

std::string scene_head(const Scenario& scenario, const Style& style) {
  const scenario::Scene& scene = scenario.scene();
  const std::string& title = scene.title.empty() ? scenario.source() : scene.title;
  return style.bold(printable(title)) + "\n" + warning_lines(scene.warnings, style);
}

std::string run_report(const Simulation& simulation, const Recorder& recorder,
                       const RunOutcome& outcome, const RunFolder& folder, Detail detail,
                       const Style& style) {
  std::string text = status_line(simulation, outcome, detail, style);
  text += line("ran", what_ran(simulation), style);
  text += model_lines(simulation, style);
  text += cost_line(simulation, outcome, style);
  text += warning_lines(warnings_of_run(simulation, outcome), style);
  for (const std::string& hint : hints(simulation, outcome.counters))
    text += line("hint", hint, style);
  text += line("results", printable((folder.path() / "").string()), style);
  if (!outcome.path.empty()) return text + "\n" + path_tables(recorder, outcome, style);
  if (!recorder.probes().empty() && recorder.has_data()) {
    text += "\n" + probe_table(simulation, recorder, style);
  }
  const auto& analysis = simulation.scenario().scene().analysis;
  if (!outcome.modes.empty()) text += "\n" + modes_table(outcome, style);
  if (std::holds_alternative<scenario::BucklingAnalysis>(analysis) && outcome.ok()) {
    text += "\n" + buckling_table(outcome, style);
  }
  return text;
}

std::string check_report(const Simulation& simulation, const Style& style) {
  return line("status", style.good("scene is valid"), style) +
         line("runs", what_ran(simulation), style) + model_lines(simulation, style) +
         line("results", size_text(simulation), style);
}

}  // namespace der::app
