#pragma once

#include <utility>
#include <vector>

#include "der/core/index.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "output/actuated_shape.hpp"
#include "output/moment_recovery.hpp"
#include "output/rod_field.hpp"

namespace der {

/// Bending or twist of a rod: along each edge linear between two places where it is known, but for
/// the loads inside the edge (output/moment_recovery.hpp). `Value` is what is interpolated.
template <class Value>
class EdgewiseField : public RodField {
 public:
  [[nodiscard]] bool smooth_at(std::size_t i) const override { return samples_[i].smooth; }

 protected:
  struct Sample {
    Index edge = 0;
    MomentRecovery::Place place;
    bool smooth = true;
  };
  /// Arc lengths [m] of the two places of each edge.
  using Lines = std::vector<std::pair<double, double>>;

  EdgewiseField(std::vector<Sample> samples, Lines lines)
      : RodField(arc_lengths(samples)), samples_(std::move(samples)), lines_(std::move(lines)) {}

  /// At the nodes and at all places inside edges where the moment has a kink or jumps.
  static std::vector<Sample> samples_of(const RodMesh& rod, const MomentRecovery& recovery) {
    std::vector<Sample> samples;
    for (Index edge = 0; edge < rod.num_edges(); ++edge) {
      const auto add = [&](double s, bool before, bool smooth) {
        samples.push_back({edge, {s, before}, smooth});
      };
      const bool smooth = !recovery.has_kink_at(edge) && !recovery.jumps_at(edge);
      add(rod.arc_length[to_size(edge)], false, smooth);
      for (const auto& [s, jumps] : recovery.breaks(edge)) {
        add(s, true, false);
        if (jumps) add(s, false, false);
      }
      const bool end = !rod.is_inner(edge + 1);
      if (end || recovery.jumps_at(edge + 1)) add(rod.arc_length_at(edge + 1), true, false);
    }
    if (actuation_jumps_at_start(rod)) part_at_start(rod, samples);
    return samples;
  }

  /// Takes the two sides of the start of a ring apart: the one before it is at the end of the last
  /// edge.
  static void part_at_start(const RodMesh& rod, std::vector<Sample>& samples) {
    samples.front().smooth = false;
    if (samples.back().place.arc_length >= rod.rest_length() - rod.same_place()) return;
    samples.push_back({rod.num_edges() - 1, {rod.rest_length(), true}, false});
  }

  [[nodiscard]] const Sample& sample_at(std::size_t i) const { return samples_[i]; }

  /// By how much the actuated strains at a place between samples differ from the line between
  /// these.
  [[nodiscard]] Vec3 bulge(const ActuatedShape& actuated, const SampleWeights& weights,
                           const Model& model, const State& state) const {
    Vec3 line = Vec3::Zero();
    if (weights.size() < 2 || !actuated.is_strained()) return line;
    double s = 0.0;
    for (const auto& [sample, weight] : weights) {
      const MomentRecovery::Place& place = samples_[sample].place;
      s += weight * place.arc_length;
      line +=
          weight * actuated.strains(place.arc_length, place.loads_here_are_beyond, model, state);
    }
    return actuated.strains(s, false, model, state) - line;
  }

  /// The value at a place of an edge.
  [[nodiscard]] Value value(Index edge, const MomentRecovery::Place& place, const Model& model,
                            const State& state) const {
    const auto& [first, last] = lines_[to_size(edge)];
    const double share = (place.arc_length - first) / (last - first);
    Value value = inside(edge, place, model, state);
    if (share != 1.0) value += (1.0 - share) * line(edge, false, model, state);
    if (share != 0.0) value += share * line(edge, true, model, state);
    if (const double further = displaced(edge, place.arc_length, model, state); further != 0.0) {
      value += further * slope(edge, model, state);
    }
    return value;
  }

 private:
  /// The straight line of an edge at the first or the last of its two places.
  [[nodiscard]] virtual Value line(Index edge, bool last, const Model& model,
                                   const State& state) const = 0;
  /// Change of what is due to stress on the line along the whole edge.
  [[nodiscard]] virtual Value slope(Index edge, const Model& model, const State& state) const = 0;
  /// MomentRecovery::displaced
  [[nodiscard]] virtual double displaced(Index edge, double s, const Model& model,
                                         const State& state) const = 0;
  /// The part that loads inside the edge add to it.
  [[nodiscard]] virtual Value inside(Index edge, const MomentRecovery::Place& place,
                                     const Model& model, const State& state) const = 0;

  static std::vector<double> arc_lengths(const std::vector<Sample>& samples) {
    std::vector<double> result;
    for (const Sample& sample : samples) result.push_back(sample.place.arc_length);
    return result;
  }

  std::vector<Sample> samples_;
  Lines lines_;
};

}  // namespace der
