#include "der/steppers/fine_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

#include "der/scenario/load.hpp"
#include "der/scenario/scenario.hpp"

namespace der {
namespace {

/// Share of a table's largest velocity from which on a jump of it is a kink.
constexpr double kKink = 0.5;

struct Table {
  std::string path;  ///< as in `--set`
  const std::vector<double>& times;
  const scenario::Course& course;
};

void add_tables(const scenario::Support& support, const std::string& path,
                std::vector<Table>& tables) {
  scenario::for_each_motion(support, [&](const char* key, const scenario::Series& motion) {
    tables.push_back({fmt::format("{}.prescribe.{}", path, key), motion.times, motion.course});
  });
}

template <class Load>
void add_tables(const Load& load, const std::string& path, std::vector<Table>& tables) {
  scenario::for_each_amount(load, [&](const char* key, const auto& amount) {
    const char* dot = *key == '\0' ? "" : ".";
    tables.push_back(
        {fmt::format("{}.{}{}{}", path, Load::kKey, dot, key), amount.times, amount.course});
  });
}

void add_tables(const scenario::Actuation& actuation, std::vector<Table>& tables) {
  for (const scenario::Series& series : actuation.values) {
    tables.push_back({fmt::format("actuation.{}.{}", actuation.name, key_of(actuation.what)),
                      series.times, series.course});
  }
}

std::string path_of_angle(const scenario::Joint& joint) {
  return fmt::format("joints.{}.prescribe.angle", joint.name);
}

/// Before its first entry and after its last one a table is constant.
std::optional<MotionKink> first_kink(const scenario::Series& motion, double until) {
  if (motion.course.kind != scenario::Course::Kind::Linear) return std::nullopt;
  const std::vector<double>& times = motion.times;
  const std::vector<double>& values = motion.values;
  const auto rate_from = [&](std::size_t entry) {
    if (entry + 1 >= times.size()) return 0.0;
    return (values[entry + 1] - values[entry]) / (times[entry + 1] - times[entry]);
  };
  double fastest = 0.0;
  for (std::size_t i = 0; i < times.size(); ++i)
    fastest = std::max(fastest, std::abs(rate_from(i)));
  for (std::size_t i = 0; i < times.size() && times[i] < until; ++i) {
    const double jump = std::abs(rate_from(i) - (i > 0 ? rate_from(i - 1) : 0.0));
    if (times[i] >= 0.0 && jump > kKink * fastest) return MotionKink{{}, times[i]};
  }
  return std::nullopt;
}

std::vector<Table> tables(const scenario::Scene& scene) {
  std::vector<Table> found;
  for (std::size_t i = 0; i < scene.supports.size(); ++i) {
    add_tables(scene.supports[i], fmt::format("supports.{}", i), found);
  }
  for (std::size_t i = 0; i < scene.loads.size(); ++i) {
    std::visit([&](const auto& load) { add_tables(load, fmt::format("loads.{}", i), found); },
               scene.loads[i].what);
  }
  for (const scenario::Actuation& actuation : scene.actuations) add_tables(actuation, found);
  for (const scenario::Joint& joint : scene.joints) {
    if (!joint.prescribe) continue;
    const scenario::Series& angle = joint.prescribe->angle;
    found.push_back({path_of_angle(joint), angle.times, angle.course});
  }
  for (const scenario::AxialSpring& spring : scene.springs) {
    if (!spring.rest_length) continue;
    found.push_back({fmt::format("springs.{}.rest_length", spring.name), spring.rest_length->times,
                     spring.rest_length->course});
  }
  return found;
}

}  // namespace

std::vector<std::string> fine_table_warnings(const scenario::Scene& scene, double step) {
  std::vector<std::string> warnings;
  for (const auto& [path, times, course] : tables(scene)) {
    if (step > longest_resolving_step(course) * (1.0 + 1e-9)) {
      warnings.push_back(
          fmt::format("the sine {} has a period of {:g} s, which steps of {:g} s hardly see: take "
                      "at least four steps in a period, better twenty, or a time.tolerance",
                      path, 1.0 / course.frequency, step));
    }
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
        "steps do not stop at entries, so the answer depends on where they fall. Take smaller "
        "steps, "
        "or a time.tolerance, with which steps end at every entry",
        path, times[closest - 1], times[closest], step));
  }
  return warnings;
}

std::vector<MotionKink> motion_kinks(const scenario::Scene& scene, double until) {
  std::vector<MotionKink> kinks;
  for (std::size_t i = 0; i < scene.supports.size(); ++i) {
    const auto enter = [&](const char* key, const scenario::Series& motion) {
      std::optional<MotionKink> kink = first_kink(motion, until);
      if (!kink) return;
      kink->path = fmt::format("supports.{}.prescribe.{}", i, key);
      kinks.push_back(*kink);
    };
    scenario::for_each_motion(scene.supports[i], enter);
  }
  for (const scenario::Joint& joint : scene.joints) {
    if (!joint.prescribe) continue;
    std::optional<MotionKink> kink = first_kink(joint.prescribe->angle, until);
    if (!kink) continue;
    kink->path = path_of_angle(joint);
    kinks.push_back(*kink);
  }
  return kinks;
}

}  // namespace der
