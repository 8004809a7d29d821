#include "der/output/replay.hpp"

#include <fmt/format.h>

#include <utility>
#include <variant>

#include "der/building/builder.hpp"
#include "der/core/error.hpp"
#include "der/output/joint_strain.hpp"
#include "der/scenario/scenario.hpp"
#include "output/rod_field.hpp"

namespace der {

Replay::Replay(Scenario scenario, std::vector<double> instants, bool on_path)
    : scenario_(std::move(scenario)),
      model_(build_model(scenario_.scene())),
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
}

void Replay::go_to(std::size_t frame, const SavedFrames& frames) {
  show(frame);
  const auto row = static_cast<Eigen::Index>(frame);
  const Eigen::Index nodes = frames.positions.cols();
  state_.positions.head(nodes) = frames.positions.row(row);
  state_.velocities.head(nodes) = frames.velocities.row(row);
  state_.positions.tail(frames.theta.cols()) = frames.theta.row(row);
  follow(model_, state_);
  // Frames depend on the way of the rod, which is not saved, so that they are.
  state_.followed.tail(frames.section_frames.cols()) = frames.section_frames.row(row);
}

RodSeries Replay::along(const std::string& rod, const std::string& quantity,
                        const SavedFrames& frames) {
  const auto field = make_rod_field(quantity, model_.rod(rod), model_);
  const std::size_t samples = field->arc_length().size();
  RodSeries series{field->arc_length(),
                   FrameTable(frames.positions.rows(), static_cast<Eigen::Index>(samples))};
  for (Eigen::Index frame = 0; frame < frames.positions.rows(); ++frame) {
    go_to(static_cast<std::size_t>(frame), frames);
    for (std::size_t i = 0; i < samples; ++i) {
      series.values(frame, static_cast<Eigen::Index>(i)) = field->sample(i, model_, state_);
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
