#include "der/output/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "der/core/constants.hpp"
#include "der/core/loops.hpp"
#include "der/output/datasets.hpp"
#include "der/output/hints.hpp"
#include "der/output/out_of_plane_verdict.hpp"
#include "der/scenario/scenario.hpp"
#include "der/scenario/unit_problem.hpp"
#include "der/steppers/fine_tables.hpp"
#include "der/version.hpp"

namespace der {
namespace {

using Json = nlohmann::ordered_json;

/// Rotation [rad] or strain up to which a structure is much like its shape without loads. (Pinned
/// arches under a point load: linear buckling is 67 % high where it is 0.06, 9 % where it is
/// 0.035.)
constexpr double kLittleChange = 0.02;

Json probes_json(const Recorder& recorder) {
  Json probes = Json::object();
  if (!recorder.has_data()) return probes;
  for (std::size_t i = 0; i < recorder.probes().size(); ++i) {
    const Probe& probe = recorder.probes()[i];
    const ProbeSummary& s = recorder.summaries()[i];
    probes[probe.name()] = {{"final", s.final}, {"min", s.min},     {"max", s.max},
                            {"t_min", s.t_min}, {"t_max", s.t_max}, {"unit", probe.unit()}};
  }
  return probes;
}

Json energies_json(const Energies& e) {
  Json energies = Json::object();
  for (const EnergyTermInfo& row : kEnergyTerms) energies[row.name] = e[row.term];
  return energies;
}

Json work_json(const Work& work, const Energies& now) {
  Json json;
  for (const LedgerEntry& row : kLedger) json[row.name] = row.value(work, now);
  return json;
}

Json path_json(const RunOutcome& outcome, const Recorder& recorder) {
  Json path;
  path["points"] = outcome.path_probes.size();
  path["branches"] = Json::array();
  path["events"] = Json::array();
  std::size_t row = 0;
  for (std::size_t number = 0; number < outcome.path.size(); ++number) {
    const PathBranch& branch = outcome.path[number];
    path["branches"].push_back({{"parent", branch.parent},
                                {"side", branch.side},
                                {"points", branch.points.size()},
                                {"ending", branch.ending}});
    for (const PathPoint& point : branch.points) {
      const std::vector<double>& values = outcome.path_probes[row++];
      if (point.event == PathEvent::None) continue;
      Json probes = Json::object();
      for (std::size_t i = 0; i < values.size(); ++i) {
        probes[recorder.probes()[i].name()] = values[i];
      }
      path["events"].push_back({{"kind", event_name(point.event)},
                                {"branch", number},
                                {"load_factor", point.factor},
                                {"unstable_directions", point.stability.unstable_directions},
                                {"unstable_out_of_plane", point.out_of_plane.unstable_directions},
                                {"probes", std::move(probes)}});
    }
  }
  return path;
}

/// A list without an entry tells that there is no factor.
void add_buckling(const LinearBuckling& buckling, Json& summary) {
  for (const char* name : {"load_factors", "prebuckling_rotations", "prebuckling_strains"}) {
    summary[name] = Json::array();
  }
  for (const BucklingMode& mode : buckling.modes) {
    summary["load_factors"].push_back(mode.load_factor);
    summary["prebuckling_rotations"].push_back(mode.load_factor * buckling.rotation);
    summary["prebuckling_strains"].push_back(mode.load_factor * buckling.strain);
  }
}

Json out_of_plane_json(const OutOfPlaneVerdict& verdict) {
  Json json;
  if (!verdict.not_tested.empty()) {
    json["stability"] = "not_tested";
    json["not_tested"] = verdict.not_tested;
    return json;
  }
  if (verdict.stability) {
    json["stability"] = verdict.stability->name();
    json["unstable_directions"] = verdict.stability->unstable_directions;
    json["neutral_directions"] = verdict.stability->neutral_directions;
    json["unknown_directions"] = verdict.stability->unknown_directions;
  } else {
    json["load_factor"] = verdict.load_factor ? Json(*verdict.load_factor) : Json();
  }
  if (verdict.growth_rate > 0.0) json["growth_rate"] = verdict.growth_rate;
  if (!verdict.warning.empty()) json["warning"] = verdict.warning;
  return json;
}

/// When something was seen, in words.
template <class Seen>
std::string place_in_run(const Simulation& simulation, const Seen& seen) {
  const scenario::Scene& scene = simulation.scenario().scene();
  if (scene.is_dynamic()) return fmt::format("at t = {:.4g} s", seen.time);
  if (std::holds_alternative<scenario::ContinuationAnalysis>(scene.analysis)) {
    return fmt::format("at load factor {:.4g}", seen.load_factor);
  }
  return "in the equilibrium";
}

/// That a rod passes through itself or another, where and when; else empty.
std::string crossing_warning(const Simulation& simulation, const RunOutcome& outcome) {
  if (!outcome.crossing) return {};
  return describe(*outcome.crossing, place_in_run(simulation, *outcome.crossing));
}

/// That a rod is strained beyond what a linear law holds for, unless the scene has been told
/// already that a unit is wrong.
std::string strain_warning(const Simulation& simulation, const RunOutcome& outcome) {
  if (!outcome.strained || outcome.failed()) return {};
  if (!scenario::unit_problem(simulation.scenario().scene()).empty()) return {};
  return describe(*outcome.strained, place_in_run(simulation, *outcome.strained));
}

/// That a rod has lost a turn: a node alone turns by less than half a turn.
std::string lost_turn_warning(const RunOutcome& outcome) {
  if (!outcome.equilibrium || !(outcome.equilibrium->largest_turning_angle > kPi)) return {};
  return fmt::format(
      "a rod turns by {:.2g} rad less or more than the clamps and springs that hold it: its mesh "
      "is "
      "too coarse beside them and has lost a turn. Give it more nodes",
      outcome.equilibrium->largest_turning_angle);
}

bool sought_buckling(const Simulation& simulation) {
  return std::holds_alternative<scenario::BucklingAnalysis>(simulation.scenario().scene().analysis);
}

void add_analysis(const Simulation& simulation, const RunOutcome& outcome, const Recorder& recorder,
                  Json& summary) {
  for (const Mode& mode : outcome.modes) {
    summary["frequencies_hz"].push_back(mode.frequency);
    summary["growth_rates"].push_back(mode.growth_rate);
  }
  if (sought_buckling(simulation) && outcome.ok()) add_buckling(outcome.buckling, summary);
  if (!outcome.path.empty()) summary["path"] = path_json(outcome, recorder);
}

std::vector<std::string> warnings_of_loads(const LinearBuckling& buckling) {
  if (buckling.modes.empty() && buckling.reversed) {
    return {
        "no positive load factor is critical: the loads cause tension where buckling needs "
        "compression; with reversed signs they make the structure buckle. If they are meant to "
        "compress it, reverse their signs"};
  }
  if (buckling.modes.empty() && buckling.rotation <= buckling.strain) {
    return {
        "no load factor is critical: the loads compress no part of the structure, nor would they "
        "with reversed signs. Linear buckling needs a load along a rod"};
  }
  if (buckling.modes.empty()) {
    return {
        "the loads bend the structure, but compress no part of it to first order, and linear "
        "buckling considers nothing else. To see whether the bent structure snaps through, use "
        "'analysis: continuation'"};
  }
  const double factor = buckling.modes.front().load_factor;
  const double rotation = factor * buckling.rotation;
  const double strain = factor * buckling.strain;
  if (std::max(rotation, strain) <= kLittleChange) return {};
  return {fmt::format(
      "the structure deforms before it buckles: by linear theory edges turn by up to {:.2g} rad "
      "and strain by up to {:.2g} at the first load factor. Linear buckling leaves that out and "
      "may be far off, mostly too high; analysis: continuation follows the deformed shape",
      rotation, strain)};
}

std::vector<std::string> buckling_warnings(const LinearBuckling& buckling,
                                           const scenario::Scene& scene) {
  std::vector<std::string> warnings = warnings_of_loads(buckling);
  if (warnings.empty() || scene.actuations.empty()) return warnings;
  warnings.front() +=
      ". Linear buckling scales the loads alone: where the structure buckles as its actuations "
      "grow "
      "is found by 'analysis: {continuation: {vary: actuation}}'";
  return warnings;
}

}  // namespace

UsedSolver used_solver(const Simulation& simulation) {
  const bool is_static = !simulation.scenario().scene().is_dynamic();
  const StepperInfo& integrator = simulation.integrator();
  if (is_static || integrator.implicit) {
    return {std::string(simulation.linear_solver()), simulation.linear_solver_reason()};
  }
  return {"none", std::string(integrator.name) + " is explicit: it solves no equations"};
}

std::string created_energy_warning(const Simulation& simulation) {
  const EnergyAudit& audit = simulation.state().audit;
  if (audit.unreliable_from < 0.0) return {};
  const std::string advice = audit.folded_from >= 0.0
                                 ? "give the rod more nodes, damping or a smoother load"
                                 : simulation.advice_on_steps();
  return fmt::format("result unreliable from t = {:.4g} s on: {}. To get a right one {}",
                     audit.unreliable_from, describe(simulation.model(), audit), advice);
}

std::vector<std::string> doubts(const Simulation& simulation, const RunOutcome& outcome) {
  std::vector<std::string> found{crossing_warning(simulation, outcome),
                                 strain_warning(simulation, outcome), lost_turn_warning(outcome),
                                 created_energy_warning(simulation)};
  found.erase(std::remove(found.begin(), found.end(), std::string()), found.end());
  return found;
}

std::vector<std::string> warnings(const Simulation& simulation, const RunOutcome& outcome) {
  std::vector<std::string> found = simulation.scenario().scene().warnings;
  const std::vector<std::string> of_run = warnings_of_run(simulation, outcome);
  found.insert(found.end(), of_run.begin(), of_run.end());
  return found;
}

std::vector<std::string> warnings_of_run(const Simulation& simulation, const RunOutcome& outcome) {
  const scenario::Scene& scene = simulation.scenario().scene();
  std::vector<std::string> found;
  const auto add = [&](const std::vector<std::string>& more) {
    found.insert(found.end(), more.begin(), more.end());
  };
  if (const auto plane = out_of_plane_verdict(simulation, outcome);
      plane && !plane->warning.empty()) {
    found.push_back(plane->warning);
  }
  if (sought_buckling(simulation) && outcome.ok()) {
    add(buckling_warnings(outcome.buckling, scene));
    return found;
  }
  if (simulation.plan().step > 0.0) add(fine_table_warnings(scene, simulation.plan().step));
  add(doubts(simulation, outcome));
  return found;
}

Json summary(const Simulation& simulation, const Recorder& recorder, const RunOutcome& outcome) {
  const scenario::Scene& scene = simulation.scenario().scene();
  const Model& model = simulation.model();
  const bool is_static = !scene.is_dynamic();

  Json summary;
  summary["title"] = scene.title;
  summary["status"] = outcome.status;
  if (outcome.failed()) {
    summary["failure"] = {{"message", outcome.message}, {"time", outcome.time}};
  }
  summary["analysis"] = scene.analysis_name();
  summary["model"] = model.name;
  summary["model_reason"] = model.reason;
  summary["integrator"] = is_static ? "none" : simulation.integrator().name;
  if (!is_static && !simulation.adaptive()) summary["step"] = simulation.plan().step;
  if (scene.time.stepping == scenario::Stepping::Automatic) {
    summary["shortest_step"] =
        simulation.plan().step / static_cast<double>(outcome.counters.most_pieces);
  }
  if (simulation.adaptive()) summary["tolerance"] = scene.time.tolerance;
  const UsedSolver solver = used_solver(simulation);
  summary["linear_solver"] = solver.name;
  summary["linear_solver_reason"] = solver.reason;
  summary["loops"] = name_of(loops());
  summary["nodes"] = model.num_nodes;
  summary["dofs"] = model.num_dofs();
  summary["free_dofs"] = model.num_free();
  summary["time"] = outcome.time;
  summary["steps"] = outcome.counters.steps;
  summary["newton_iterations"] = outcome.counters.newton_iterations;
  summary["retried_steps"] = outcome.counters.retried_steps;
  summary["rejected_steps"] = outcome.counters.rejected_steps;
  summary["wall_seconds"] = outcome.wall_seconds;
  if (outcome.equilibrium) {
    summary["residual"] = outcome.equilibrium->residual;
    summary["stability"] = outcome.equilibrium->stability.name();
    summary["unstable_directions"] = outcome.equilibrium->stability.unstable_directions;
    summary["neutral_directions"] = outcome.equilibrium->stability.neutral_directions;
    summary["unknown_directions"] = outcome.equilibrium->stability.unknown_directions;
    summary["saddles_left"] = outcome.equilibrium->saddles_left;
    summary["largest_turning_angle"] = outcome.equilibrium->largest_turning_angle;
  }
  if (const auto plane = out_of_plane_verdict(simulation, outcome)) {
    summary["out_of_plane"] = out_of_plane_json(*plane);
  }
  add_analysis(simulation, outcome, recorder, summary);
  if (recorder.energies()) summary["energies"] = energies_json(*recorder.energies());
  if (recorder.energies() && !is_static) {
    summary["work"] = work_json(simulation.state().work, *recorder.energies());
  }
  if (simulation.state().audit.unreliable_from >= 0.0) {
    summary["unreliable_from"] = simulation.state().audit.unreliable_from;
  }
  summary["warnings"] = warnings(simulation, outcome);
  summary["hints"] = hints(simulation, outcome.counters);
  summary["probes"] = probes_json(recorder);
  summary["scene"] = simulation.scenario().source();
  summary["der_version"] = version;
  return summary;
}

std::string summary_json(const Simulation& simulation, const Recorder& recorder,
                         const RunOutcome& outcome) {
  // A title that is not UTF-8 must not cost the results.
  return summary(simulation, recorder, outcome)
             .dump(2, ' ', false, Json::error_handler_t::replace) +
         "\n";
}

}  // namespace der
