#include "der/output/replay.hpp"

#include <fmt/format.h>

#include <utility>
#include <variant>

#include "der/building/builder.hpp"
#include "der/catalog/quantities.hpp"
#include "der/core/error.hpp"
#include "der/model/followed.hpp"
#include "der/output/vertex_strain.hpp"
#include "der/scenario/scenario.hpp"
#include "output/rod_field.hpp"

namespace der {
namespace {

/// The scene with a probe of the slope of each rod, so that whole turns are followed.
scenario::Scene with_slopes(scenario::Scene scene) {
  for (const scenario::Rod& rod : scene.rods) {
    scenario::Probe probe;
    probe.quantity = kSlope;
    probe.rod = rod.name;
    scene.output.probes.push_back(std::move(probe));
  }
  return scene;
}

}  // namespace

Replay::Replay(Scenario scenario, std::vector<double> instants, bool on_path)
    : scenario_(std::move(scenario)),
      model_(build_model(with_slopes(scenario_.scene()))),
      state_(initial_state(model_)),
      instants_(std::move(instants)),
      on_path_(on_path) {
  if (!on_path) return;
  if (!std::holds_alternative<scenario::ContinuationAnalysis>(scenario_.scene().analysis)) {
    throw Error("model_error",
                "frames on a path are those of a continuation, which this scene does not ask for: "
                "give the times of the frames");
  }
}

void Replay::show(std::size_t frame) {
  if (frame >= num_frames()) {
    throw Error("model_error", fmt::format("there is no frame {}: the run has {}, counted from 0",
                                           frame, num_frames()));
  }
  (on_path_ ? state_.load_factor : state_.time) = instants_[frame];
  state_.last_step = step_before(frame);
}

/// The length of the step [s] that led to a frame; where steps are not equal, the time from the
/// frame before it. 0: no step did.
double Replay::step_before(std::size_t frame) const {
  const scenario::Scene& scene = scenario_.scene();
  if (frame == 0 || !scene.is_dynamic()) return 0.0;
  if (scene.time.stepping == scenario::Stepping::Fixed) return scene.time.step;
  return instants_[frame] - instants_[frame - 1];
}

void Replay::go_to(std::size_t frame, const SavedFrames& frames) {
  show(frame);
  const auto row = static_cast<Eigen::Index>(frame);
  const Eigen::Index nodes = frames.positions.cols();
  state_.positions.head(nodes) = frames.positions.row(row);
  state_.velocities.head(nodes) = frames.velocities.row(row);
  state_.positions.segment(nodes, frames.theta.cols()) = frames.theta.row(row);
  if (frame == 0) state_.followed = unwrapped_of_reference(model_);
  const Vector turns = frames.turns.row(row);
  if (model_.dimension == 2) restore_turns(model_, turns, state_);
  follow(model_, state_);
  // Frames depend on the way of the rod, which is not saved, so that they are.
  edge_frames(model_, state_.followed) = frames.section_frames.row(row).transpose();
  if (model_.dimension == 3 && turns.size() > 0) restore_turns(model_, turns, state_);
}

RodSeries Replay::along(const std::string& rod, const std::string& quantity,
                        const SavedFrames& frames) {
  const auto field = make_rod_field(quantity, model_.rod(rod), model_);
  const std::size_t samples = field->arc_length().size();
  RodSeries series{field->arc_length(),
                   FrameTable(frames.positions.rows(), static_cast<Eigen::Index>(samples))};
  for (Eigen::Index frame = 0; frame < frames.positions.rows(); ++frame) {
    go_to(static_cast<std::size_t>(frame), frames);
    field->sample_all(model_, state_, series.values.row(frame).data());
  }
  return series;
}

ReactionSeries Replay::reactions(const SavedFrames& frames,
                                 const Eigen::Ref<const FrameTable>& spin) {
  Reactions reader(scenario_.scene(), model_);
  ReactionSeries series;
  for (Eigen::Index frame = 0; frame < frames.positions.rows(); ++frame) {
    go_to(static_cast<std::size_t>(frame), frames);
    state_.velocities.segment(model_.dofs.num_positions(), spin.cols()) = spin.row(frame);
    series.places = reader.evaluate(model_, state_);
    const auto columns = 3 * static_cast<Eigen::Index>(series.places.size());
    for (FrameTable* table : {&series.points, &series.forces, &series.moments}) {
      if (frame == 0) table->resize(frames.positions.rows(), columns);
    }
    for (std::size_t i = 0; i < series.places.size(); ++i) {
      const Reaction& place = series.places[i];
      const auto first = 3 * static_cast<Eigen::Index>(i);
      series.points.block<1, 3>(frame, first) = place.point.transpose();
      series.forces.block<1, 3>(frame, first) = place.force.transpose();
      series.moments.block<1, 3>(frame, first) = place.moment.transpose();
    }
  }
  return series;
}

ActuationForceSeries Replay::actuation_forces(const SavedFrames& frames) {
  ActuationForces reader(model_);
  ActuationForceSeries series;
  for (Eigen::Index frame = 0; frame < frames.positions.rows(); ++frame) {
    go_to(static_cast<std::size_t>(frame), frames);
    series.actuations = reader.evaluate(model_, state_);
    const auto count = static_cast<Eigen::Index>(series.actuations.size());
    if (frame == 0) series.values.resize(frames.positions.rows(), 2 * count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto& values = series.actuations[static_cast<std::size_t>(i)].values;
      series.values.block<1, 2>(frame, 2 * i) = Eigen::Map<const Eigen::RowVector2d>(values.data());
    }
  }
  return series;
}

FrameTable Replay::directors(const SavedFrames& frames) {
  FrameTable table(frames.theta.rows(), 3 * frames.theta.cols());
  for (Eigen::Index frame = 0; frame < table.rows(); ++frame) {
    go_to(static_cast<std::size_t>(frame), frames);
    table.row(frame) = directors_of(model_, state_);
  }
  return table;
}

}  // namespace der
