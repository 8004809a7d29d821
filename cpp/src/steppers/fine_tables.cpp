#include "der/steppers/fine_tables.hpp"

#include <fmt/format.h>

#include <variant>

namespace der {
namespace {

using scenario::Component;

struct Table {
  std::string path;  ///< as in `--set`
  const std::vector<double>& times;
};

std::vector<Table> tables(const scenario::Scene& scene) {
  std::vector<Table> found;
  for (std::size_t i = 0; i < scene.supports.size(); ++i) {
    const scenario::Support& support = scene.supports[i];
    const std::string path = fmt::format("supports.{}.prescribe.", i);
    for (const scenario::Prescribed& motion : support.prescribe) {
      found.push_back(
          {path + (motion.component == Component::X ? "x" : "y"), motion.displacement.times});
    }
    if (support.rotation) found.push_back({path + "angle", support.rotation->times});
  }
  for (std::size_t i = 0; i < scene.loads.size(); ++i) {
    const auto& what = scene.loads[i].what;
    const std::string path = fmt::format("loads.{}.", i);
    if (const auto* point = std::get_if<scenario::PointForce>(&what)) {
      found.push_back({path + "point_force.force", point->force.times});
    } else if (const auto* moment = std::get_if<scenario::Moment>(&what)) {
      found.push_back({path + "moment.moment", moment->moment.times});
    } else if (const auto* distributed = std::get_if<scenario::DistributedForce>(&what)) {
      found.push_back({path + "distributed_force.force", distributed->force.times});
    }
  }
  return found;
}

}  // namespace

std::vector<std::string> fine_table_warnings(const scenario::Scene& scene, double step) {
  std::vector<std::string> warnings;
  for (const auto& [path, times] : tables(scene)) {
    std::size_t closest = 0;
    for (std::size_t i = 1; i < times.size(); ++i) {
      if (times[i] <= 0.0 || times[i - 1] >= scene.time.duration) continue;
      const double gap = times[i] - times[i - 1];
      if (closest == 0 || gap < times[closest] - times[closest - 1]) closest = i;
    }
    // As long as a step but for rounding is not closer.
    if (closest == 0 || times[closest] - times[closest - 1] >= step * (1.0 - 1e-9)) continue;
    warnings.push_back(fmt::format(
        "the table {} has entries at {} and {} s, closer together than the step of {:g} s: equal "
        "steps do not stop at entries, so the answer hangs on where they fall. Take smaller steps, "
        "or a time.tolerance, with which steps end at every entry",
        path, times[closest - 1], times[closest], step));
  }
  return warnings;
}

}  // namespace der
