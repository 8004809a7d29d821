#include <algorithm>
#include <cmath>

#include "der/output/quantities.hpp"
#include "scenario/checks.hpp"

namespace der::scenario {
namespace {

/// Ten halvings of a step that fails.
constexpr double kMinimumStepShare = 1.0 / 1024.0;
/// More steps than anyone can wait for.
constexpr double kMaxSteps = 1e12;
/// Frames of a run where the scene does not say how often to save.
constexpr double kDefaultFrames = 1000.0;

void check_every(SceneText& scene, Complaints& complaints) {
  const Path path{"output", "every"};
  const double step = scene.time.step;
  if (!scene.given_output.given_every) {
    const double steps = std::round(scene.time.duration / kDefaultFrames / step);
    scene.output.every = step * std::max(1.0, steps);
    return;
  }
  const double every = *scene.given_output.given_every;
  const double steps = every / step;
  constexpr double same = 1e-6;  // of a step
  if (steps < 1.0 - same) {
    complaints.add(path,
                   fmt::format("must be at least the time step, {} s, got {} s", step, every));
  } else if (std::abs(steps - std::round(steps)) > same) {
    complaints.add(
        path, fmt::format("must be a whole multiple of the time step, {} s, but {} s is "
                          "{:.6g} steps: write {:.9g} or {:.9g}",
                          step, every, steps, step * std::floor(steps), step * std::ceil(steps)));
  }
  scene.output.every = every;
}

/// Where a probe can stand, by the kind of its quantity.
class ProbeCheck {
 public:
  ProbeCheck(CheckContext& context, Probe& probe)
      : context_(context),
        probe_(probe),
        path_{"output", "probes", probe.name},
        supports_known_(!context.complaints.under({"supports"})) {}

  void run() {
    const QuantityKind kind = find_quantity(probe_.quantity)->kind;
    if (kind == QuantityKind::Energy) {
      check_energy();
    } else if (!probe_.rod) {
      complain(path_, fmt::format("'{}' belongs to a rod: give 'rod'", probe_.quantity));
    } else if (!probe_.at && probe_.over == Reduce::None) {
      complain(path_, fmt::format("'{}' varies along the rod: give 'at', or 'over: rod' with "
                                  "'reduce: min' or 'max'",
                                  probe_.quantity));
    } else if (const auto rod = context_.find_rod(*probe_.rod, path_ / "rod")) {
      check_along(*rod, kind == QuantityKind::Bend);
    }
  }

 private:
  void complain(const Path& where, const std::string& message) {
    context_.complaints.add(where, message);
  }

  void check_energy() {
    if (probe_.at || probe_.over != Reduce::None) {
      complain(path_ / (probe_.at ? "at" : "over"),
               fmt::format("'{}' is a sum over a rod or the whole model: it has no place",
                           probe_.quantity));
    }
    if (probe_.rod) context_.find_rod(*probe_.rod, path_ / "rod");
  }

  void check_along(int rod, bool bend) {
    const int last = context_.lines[static_cast<std::size_t>(rod)]->num_nodes() - 1;
    const auto bends = [&](int node) {
      return (node > 0 && node < last) || !supports_known_ || context_.is_clamped(rod, node);
    };
    if (!probe_.at) {
      if (bend && last < 2 && !bends(0) && !bends(last)) {
        complain(path_ / "quantity", fmt::format("a rod of 2 nodes without a clamp does not bend: "
                                                 "it has no '{}'",
                                                 probe_.quantity));
      }
      return;
    }
    const auto nodes = context_.nodes_at(rod, *probe_.at, path_ / "at", bend);
    if (bend && nodes && !bends(nodes->front())) {
      complain(path_ / "at", fmt::format("'{}' needs a node that bends: an inner node, or an end "
                                         "that is clamped",
                                         probe_.quantity));
    }
  }

  CheckContext& context_;
  Probe& probe_;
  Path path_;
  bool supports_known_;  // otherwise nobody knows which ends are clamped
};

/// Whether what a continuation varies is there.
void check_continuation(CheckContext& context) {
  const auto* continuation = std::get_if<ContinuationAnalysis>(&context.scene.analysis);
  if (!continuation || context.complaints.under({"analysis"})) return;
  const bool loads = continuation->vary == Varied::Loads;
  const char* const kind = loads ? "loads" : "supports";
  if (context.complaints.under({kind})) return;
  const std::size_t count = loads ? context.scene.loads.size() : context.scene.supports.size();
  const Path path{"analysis", "continuation", "vary"};
  if (continuation->number && static_cast<std::size_t>(*continuation->number) >= count) {
    context.complaints.add(path, fmt::format("there is no {}.{}: the scene has {} of them, counted "
                                             "from 0",
                                             kind, *continuation->number, count));
    return;
  }
  const auto moves = [](const Support& support) {
    return !support.prescribe.empty() || support.rotation.has_value();
  };
  bool varies = loads && count > 0;
  for (std::size_t i = 0; !loads && i < count; ++i) {
    const bool chosen =
        !continuation->number || static_cast<std::size_t>(*continuation->number) == i;
    varies = varies || (chosen && moves(context.scene.supports[i]));
  }
  if (!varies) {
    context.complaints.add(
        path, loads
                  ? "the scene has no loads that could vary"
                  : "no such support has a prescribed motion that could vary: give it 'prescribe'");
  }
}

}  // namespace

void check_time(CheckContext& context) {
  SceneText& scene = context.scene;
  check_continuation(context);
  if (!scene.is_dynamic() && scene.start_from == "equilibrium") {
    context.complaints.add(
        {"start_from"},
        "an analysis looks for the equilibrium itself: name the folder of a run, or "
        "leave the key out");
  }
  Complaints& complaints = context.complaints;
  scene.time = static_cast<const Time&>(scene.given_time);
  scene.output = static_cast<const Output&>(scene.given_output);
  if (!scene.is_dynamic()) return;
  if (complaints.under({"time"}) || complaints.under({"analysis"})) return;
  const double step = scene.time.step;
  if (step > scene.time.duration) {
    complaints.add({"time", "step"}, fmt::format("must not be greater than the duration, {} s, got "
                                                 "{} s",
                                                 scene.time.duration, step));
  }
  if (scene.time.duration / step > kMaxSteps) {
    complaints.add({"time", "step"}, fmt::format("makes more than {:g} steps out of the duration, "
                                                 "{} s",
                                                 kMaxSteps, scene.time.duration));
  }
  scene.time.minimum_step = scene.given_time.given_minimum_step.value_or(step * kMinimumStepShare);
  if (scene.time.minimum_step > step) {
    complaints.add({"time", "minimum_step"},
                   fmt::format("must not be greater than the step, {} s, got {} s", step,
                               scene.time.minimum_step));
  }
  if (const auto& radius = scene.given_time.given_spectral_radius) {
    scene.time.spectral_radius = *radius;
    if (scene.time.integrator != "generalized_alpha") {
      complaints.add({"time", "spectral_radius"},
                     fmt::format("only generalized_alpha has a spectral radius, not {}",
                                 scene.time.integrator));
    }
  }
  if (!complaints.under({"output", "every"})) check_every(scene, complaints);
}

void check_probes(CheckContext& context) {
  for (Probe& probe : context.scene.output.probes) {
    if (context.complaints.under({"output", "probes", probe.name})) continue;
    ProbeCheck(context, probe).run();
  }
}

}  // namespace der::scenario
