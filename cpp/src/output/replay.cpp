#include "der/output/replay.hpp"

#include <fmt/format.h>

#include <utility>
#include <variant>

#include "der/building/builder.hpp"
#include "der/core/error.hpp"
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

RodSeries Replay::along(const std::string& rod, const std::string& quantity,
                        const Eigen::Ref<const FrameTable>& positions,
                        const Eigen::Ref<const FrameTable>& velocities) {
  const auto field = make_rod_field(quantity, model_.rod(rod), model_);
  const std::size_t samples = field->arc_length().size();
  RodSeries series{field->arc_length(),
                   FrameTable(positions.rows(), static_cast<Eigen::Index>(samples))};
  for (Eigen::Index frame = 0; frame < positions.rows(); ++frame) {
    show(static_cast<std::size_t>(frame));
    state_.positions = positions.row(frame);
    state_.velocities = velocities.row(frame);
    follow(model_, state_);
    for (std::size_t i = 0; i < samples; ++i) {
      series.values(frame, static_cast<Eigen::Index>(i)) = field->sample(i, model_, state_);
    }
  }
  return series;
}

}  // namespace der
