#include "der/output/datasets.hpp"

#include <fmt/format.h>

#include <utility>

#include "der/output/run_arrays.hpp"
#include "der/scenario/scenario.hpp"

namespace der {
namespace {

/// Displacements of the nodes one behind the other: number x nodes x dimension.
template <class M>
Dataset shapes(const std::string& name, const Model& model, const std::vector<M>& modes) {
  Dataset result{name,
                 unit_of_array(name),
                 {modes.size(), static_cast<std::size_t>(model.num_nodes),
                  static_cast<std::size_t>(model.dimension)},
                 {}};
  for (const M& mode : modes) {
    result.values.insert(result.values.end(), mode.shape.data(),
                         mode.shape.data() + model.dofs.num_positions());
  }
  return result;
}

template <class T, class F>
Dataset column(const std::string& name, const std::vector<T>& items, F&& value) {
  Dataset result{name, unit_of_array(name), {items.size()}, {}};
  for (const T& item : items) result.values.push_back(static_cast<double>(value(item)));
  return result;
}

using PlacedPoint = std::pair<std::size_t, const PathPoint*>;  // number of the branch

std::vector<PlacedPoint> points_of(const RunOutcome& outcome) {
  std::vector<PlacedPoint> points;
  for (std::size_t branch = 0; branch < outcome.path.size(); ++branch) {
    for (const PathPoint& point : outcome.path[branch].points) points.emplace_back(branch, &point);
  }
  return points;
}

}  // namespace

const char* event_name(PathEvent event) {
  switch (event) {
    case PathEvent::Fold:
      return "fold";
    case PathEvent::Bifurcation:
      return "bifurcation";
    case PathEvent::OutOfPlane:
      return "out_of_plane";
    default:
      return "";
  }
}

std::vector<Dataset> datasets(const Simulation& simulation, const RunOutcome& outcome) {
  const Model& model = simulation.model();
  std::vector<Dataset> result;
  if (!outcome.modes.empty()) {
    const auto& modes = outcome.modes;
    result.push_back(
        column("modes/frequencies", modes, [](const Mode& mode) { return mode.frequency; }));
    result.push_back(
        column("modes/growth_rates", modes, [](const Mode& mode) { return mode.growth_rate; }));
    result.push_back(shapes("modes/shapes", model, modes));
  }
  if (!outcome.buckling.modes.empty()) {
    const LinearBuckling& buckling = outcome.buckling;
    const auto add = [&](const char* name, double times) {
      result.push_back(column(name, buckling.modes, [times](const BucklingMode& mode) {
        return times * mode.load_factor;
      }));
    };
    add("buckling/load_factors", 1.0);
    add("buckling/rotations", buckling.rotation);
    add("buckling/strains", buckling.strain);
    result.push_back(shapes("buckling/shapes", model, buckling.modes));
  }
  if (!outcome.path.empty()) {
    const auto points = points_of(outcome);
    const auto add = [&](const std::string& name, auto&& value) {
      result.push_back(column("path/" + name, points, value));
    };
    add("branch", [](const PlacedPoint& p) { return p.first; });
    add("factor", [](const PlacedPoint& p) { return p.second->factor; });
    add("arc", [](const PlacedPoint& p) { return p.second->arc; });
    add("unstable_directions",
        [](const PlacedPoint& p) { return p.second->stability.unstable_directions; });
    if (model.dimension == 2 && simulation.not_tested_out_of_plane().empty()) {
      add("unstable_out_of_plane",
          [](const PlacedPoint& p) { return p.second->out_of_plane.unstable_directions; });
    }
    add("event", [](const PlacedPoint& p) { return static_cast<int>(p.second->event); });
  }
  return result;
}

std::string path_csv(const Simulation& simulation, const RunOutcome& outcome) {
  std::string text = "branch,factor,arc,stability,unstable_directions,event";
  for (const auto& probe : simulation.scenario().scene().output.probes) text += "," + probe.name;
  text += '\n';
  std::size_t row = 0;
  for (const auto& [branch, point] : points_of(outcome)) {
    text += fmt::format("{},{:.17g},{:.9g},{},{},{}", branch, point->factor, point->arc,
                        point->stability.name(), point->stability.unstable_directions,
                        event_name(point->event));
    for (const double value : outcome.path_probes[row++]) text += fmt::format(",{:.17g}", value);
    text += '\n';
  }
  return text;
}

}  // namespace der
