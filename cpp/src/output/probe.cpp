#include "der/output/probe.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "der/catalog/quantities.hpp"
#include "der/core/error.hpp"
#include "der/model/location.hpp"
#include "der/output/actuation_forces.hpp"
#include "der/output/reactions.hpp"
#include "der/scenario/find_support.hpp"
#include "der/scenario/scenario.hpp"
#include "output/axial_spring_reader.hpp"
#include "output/energy_reader.hpp"
#include "output/joint_reader.hpp"
#include "output/rod_field.hpp"

namespace der {
namespace {

/// Linear between the samples on one side of `s`, which may be a place where the field jumps.
SampleWeights one_sided_weights(const std::vector<double>& arc, double s, scenario::Side side,
                                double same_place) {
  if (arc.size() == 1) return {{0, 1.0}};
  if (side == scenario::Side::Before) {
    const auto here = std::lower_bound(arc.begin(), arc.end(), s - same_place);
    if (here != arc.end() && *here <= s + same_place) {
      return {{static_cast<std::size_t>(here - arc.begin()), 1.0}};
    }
  } else {
    const auto beyond = std::upper_bound(arc.begin(), arc.end(), s + same_place);
    if (beyond != arc.begin() && *(beyond - 1) >= s - same_place) {
      return {{static_cast<std::size_t>(beyond - arc.begin()) - 1, 1.0}};
    }
  }
  return linear_weights(arc, s);
}

/// The polynomial through the samples next to `s`, at most two on either side, that lie on the same
/// leg: where a leg ends the place stands twice.
SampleWeights weights_along_leg(const std::vector<double>& arc, SampleWeights linear, double s) {
  if (linear.size() < 2) return linear;
  std::size_t first = linear.front().sample;
  std::size_t last = linear.back().sample;
  if (first > 0 && arc[first - 1] < arc[first]) --first;
  if (last + 1 < arc.size() && arc[last + 1] > arc[last]) ++last;
  SampleWeights result;
  for (std::size_t i = first; i <= last; ++i) {
    double weight = 1.0;
    for (std::size_t j = first; j <= last; ++j) {
      if (j != i) weight *= (s - arc[j]) / (arc[i] - arc[j]);
    }
    result.push_back({i, weight});
  }
  return result;
}

/// A field at one place.
class PointReader : public ProbeReader {
 public:
  PointReader(std::unique_ptr<RodField> field, SampleWeights weights)
      : field_(std::move(field)), weights_(std::move(weights)) {}
  double value(const Model& model, const State& state) override {
    return field_->interpolate(weights_, model, state);
  }

 private:
  std::unique_ptr<RodField> field_;
  SampleWeights weights_;
};

/// Extreme value of the parabola through three points with ascending `s`, the middle one being the
/// largest (or the smallest).
double parabola_extreme(const double* s, const double* f) {
  const double left = (f[1] - f[0]) / (s[1] - s[0]);
  const double right = (f[2] - f[1]) / (s[2] - s[1]);
  const double second = (right - left) / (s[2] - s[0]);
  if (second == 0.0) return f[1];
  const double slope = left + second * (s[1] - s[0]);  // at the middle point
  return f[1] - 0.25 * slope * slope / second;
}

/// Whether the parabola through three points has its largest value between two places.
bool peaks_between(const double* s, const double* f, double from, double to) {
  const double left = (f[1] - f[0]) / (s[1] - s[0]);
  const double right = (f[2] - f[1]) / (s[2] - s[1]);
  const double second = (right - left) / (s[2] - s[0]);
  if (second >= 0.0) return false;
  const double peak = 0.5 * (s[0] + s[1] - left / second);
  return from < peak && peak < to;
}

/// The smallest or largest value of a field along its rod.
class ExtremeReader : public ProbeReader {
 public:
  ExtremeReader(std::unique_ptr<RodField> field, const RodMesh& rod, scenario::Reduce reduce,
                bool parabola_at_ends)
      : field_(std::move(field)),
        parabola_at_ends_(parabola_at_ends),
        arc_length_(field_->arc_length()),
        ring_length_(rod.closed ? rod.rest_length() : 0.0),
        sign_(reduce == scenario::Reduce::Max ? 1.0 : -1.0) {
    if (field_->continuous()) add_ends(rod);
    values_.resize(arc_length_.size());
  }

  double value(const Model& model, const State& state) override {
    const double smooth = smooth_extreme(model, state);
    return sign_ < 0.0 ? std::min(smooth, field_->dip(model, state)) : smooth;
  }

 private:
  double smooth_extreme(const Model& model, const State& state) {
    evaluate(model, state);
    const auto best = static_cast<std::size_t>(std::max_element(values_.begin(), values_.end()) -
                                               values_.begin());
    const std::size_t last = values_.size() - 1;
    const bool at_end = best == 0 || best == last;
    if (at_end && ring_length_ > 0.0) return sign_ * seam_extreme(best);
    if (at_end) return sign_ * end_extreme(best, best == 0 ? 1 : last - 1);
    // At a joint the two sides are smooth, each by itself.
    if (!smooth_at(best)) {
      return sign_ * std::max(end_extreme(best, best - 1), end_extreme(best, best + 1));
    }
    return sign_ * parabola_extreme(&arc_length_[best - 1], &values_[best - 1]);
  }

  /// A field that has no sample at an end of the rod is continued to it, for its extreme may be
  /// there (the tension of a hanging cable).
  void add_ends(const RodMesh& rod) {
    const double tolerance = 1e-9 * rod.rest_length();
    if (arc_length_.front() > tolerance) {
      start_ = linear_weights(field_->arc_length(), 0.0);
      arc_length_.insert(arc_length_.begin(), 0.0);
    }
    if (arc_length_.back() < rod.rest_length() - tolerance) {
      end_ = linear_weights(field_->arc_length(), rod.rest_length());
      arc_length_.push_back(rod.rest_length());
    }
  }

  /// An end of the rod, or of a smooth part, has the largest sample: the value there, or a larger
  /// one on the way to its neighbour, of the parabola through the three outermost samples.
  [[nodiscard]] double end_extreme(std::size_t end, std::size_t next) const {
    if (!parabola_at_ends_ || values_.size() < 3 || !smooth_at(next)) return values_[end];
    const double* s = &arc_length_[next - 1];
    const double* f = &values_[next - 1];
    const auto [from, to] = std::minmax(arc_length_[end], arc_length_[next]);
    return peaks_between(s, f, from, to) ? parabola_extreme(s, f) : values_[end];
  }

  /// The sample at the start of a ring, which is its end, is the largest: that of the parabola
  /// through it and its neighbours on both sides.
  [[nodiscard]] double seam_extreme(std::size_t best) const {
    const std::size_t last = values_.size() - 1;
    if (last < 2 || !smooth_at(0) || !smooth_at(last)) return values_[best];
    const std::array s{arc_length_[last - 1] - ring_length_, arc_length_[0], arc_length_[1]};
    const std::array f{values_[last - 1], values_[0], values_[1]};
    return parabola_extreme(s.data(), f.data());
  }

  /// Whether a parabola may be laid through a value and its neighbours.
  [[nodiscard]] bool smooth_at(std::size_t i) const {
    return field_->continuous() && field_->smooth_at(start_.empty() ? i : i - 1);
  }

  void evaluate(const Model& model, const State& state) {
    std::size_t next = 0;
    if (!start_.empty()) {
      values_[next++] = sign_ * field_->interpolate(start_, model, state);
    }
    field_->sample_all(model, state, &values_[next]);
    for (std::size_t i = 0; i < field_->arc_length().size(); ++i) values_[next++] *= sign_;
    if (!end_.empty()) values_[next] = sign_ * field_->interpolate(end_, model, state);
  }

  std::unique_ptr<RodField> field_;
  bool parabola_at_ends_;           // of fields that are smooth up to the ends: positions
  std::vector<double> arc_length_;  // of the samples and the ends [m]
  double ring_length_;              // [m]; 0: the rod is open
  SampleWeights start_, end_;       // empty where the end is a sample
  double sign_;
  std::vector<double> values_;  // times sign_, so that the largest one is looked for
};

/// A number of a ring.
class RingReader : public ProbeReader {
 public:
  RingReader(RodReading read, RodMesh rod) : read_(read), rod_(std::move(rod)) {}
  double value(const Model& model, const State& state) override {
    return read_(rod_, model, state);
  }

 private:
  RodReading read_;
  RodMesh rod_;
};

/// The reaction of a support, at all of its places together.
class SupportReader : public ProbeReader {
 public:
  SupportReader(ReactionReading read, std::size_t support, const scenario::Scene& scene,
                const Model& model)
      : read_(read), reactions_(scene, model, support) {}
  double value(const Model& model, const State& state) override {
    Reaction sum;
    for (const Reaction& reaction : reactions_.evaluate(model, state)) {
      sum.force += reaction.force;
      sum.moment += reaction.moment;
    }
    return read_(sum);
  }
  /// By EI/l^3.
  [[nodiscard]] bool amplifies_noise() const override { return true; }

 private:
  ReactionReading read_;
  Reactions reactions_;
};

/// The force or moment that an actuation exerts.
class ActuationReader : public ProbeReader {
 public:
  ActuationReader(const Quantity& quantity, const std::string& name, const Model& model)
      : read_(quantity.read_actuation),
        forces_(model, name),
        in_plane_(model.dimension == 2 && is_of_space(quantity)) {}
  double value(const Model& model, const State& state) override {
    ActuationForce force = forces_.evaluate(model, state).front();
    if (in_plane_) {
      const Vec2& director = model.rod(force.rod).director;
      force.values = {force.values[0] * director[0] + 0.0, -force.values[0] * director[1] + 0.0};
    }
    return read_(force);
  }

 private:
  ActuationReading read_;
  ActuationForces forces_;
  bool in_plane_;  // the parts towards the directors of a rod in a plane
};

SampleWeights sample_weights(const std::vector<Weighted>& weights, const RodMesh& rod) {
  SampleWeights result;
  for (const auto& [place, weight] : weights) {
    result.push_back({static_cast<std::size_t>(rod.position(place)), weight});
  }
  return result;
}

std::unique_ptr<RodField> make_probed_field(const scenario::Probe& probe, const Quantity& quantity,
                                            const RodMesh& rod, const Model& model) {
  auto field = make_rod_field(quantity.name, rod, model);
  if (field->arc_length().empty()) {
    throw Error("model_error", "probe '" + probe.name + "': rod '" + rod.name + "' bends nowhere");
  }
  return field;
}

/// Arc length [m] of a probe's place. The start of a ring is its end, too: what is before it is
/// there.
double place_of(const scenario::Probe& probe, const RodMesh& rod) {
  const double s = arc_length_of(*probe.at, rod);
  const bool before_start =
      rod.closed && probe.side == scenario::Side::Before && s <= rod.same_place();
  return before_start ? rod.rest_length() : s;
}

/// The place nearest to `s` at which a field jumps, which a probe with a side may give as a rounded
/// number; `s` where there is none so near.
double jump_near(const std::vector<double>& arc, double s, const RodMesh& rod) {
  double least = 2e-5 * rod.rest_length();
  double found = s;
  for (std::size_t i = 1; i < arc.size(); ++i) {
    if (arc[i] - arc[i - 1] > rod.same_place() || std::abs(arc[i] - s) >= least) continue;
    least = std::abs(arc[i] - s);
    found = arc[i];
  }
  return found;
}

SampleWeights point_weights(const scenario::Probe& probe, QuantityKind kind, const RodField& field,
                            const RodMesh& rod, double s, const Model& model) {
  if (kind == QuantityKind::Position || kind == QuantityKind::Velocity) {
    return sample_weights(node_weights(rod, s, model), rod);
  }
  if (can_jump(kind)) {
    if (probe.side) s = jump_near(field.arc_length(), s, rod);
    SampleWeights weights = one_sided_weights(
        field.arc_length(), s, probe.side.value_or(scenario::Side::After), rod.same_place());
    return rod.legs.empty() ? weights
                            : weights_along_leg(field.arc_length(), std::move(weights), s);
  }
  return linear_weights(field.arc_length(), s);
}

std::unique_ptr<ProbeReader> make_reader(const scenario::Probe& probe, const Quantity& quantity,
                                         const scenario::Scene& scene, const Model& model) {
  if (quantity.kind == QuantityKind::Energy) {
    return make_energy_reader(quantity.energies, probe.rod, model);
  }
  if (quantity.kind == QuantityKind::Support) {
    const std::size_t support = scenario::find_support(scene, probe.support.value()).value();
    return std::make_unique<SupportReader>(quantity.read_reaction, support, scene, model);
  }
  if (quantity.kind == QuantityKind::Actuation) {
    return std::make_unique<ActuationReader>(quantity, probe.actuation.value(), model);
  }
  if (quantity.kind == QuantityKind::Joint) {
    return make_joint_reader(probe, quantity, scene, model);
  }
  if (quantity.kind == QuantityKind::Spring) {
    return make_axial_spring_reader(quantity.read_spring, probe.spring.value(), scene, model);
  }
  const RodMesh& rod = model.rod(probe.rod.value());
  if (quantity.kind == QuantityKind::Ring) {
    return std::make_unique<RingReader>(quantity.read_rod, rod);
  }
  auto field = make_probed_field(probe, quantity, rod, model);
  if (probe.over != scenario::Reduce::None) {
    return std::make_unique<ExtremeReader>(std::move(field), rod, probe.over,
                                           quantity.kind == QuantityKind::Position);
  }
  const double s = place_of(probe, rod);
  SampleWeights weights = point_weights(probe, quantity.kind, *field, rod, s, model);
  return std::make_unique<PointReader>(std::move(field), std::move(weights));
}

}  // namespace

Probe::Probe(const scenario::Probe& probe, const scenario::Scene& scene, const Model& model)
    : name_(probe.name) {
  const Quantity* quantity = find_quantity(probe.quantity);
  if (quantity == nullptr) {
    throw Error("model_error",
                "probe '" + probe.name + "': there is no quantity '" + probe.quantity + "'");
  }
  unit_ = quantity->unit;
  reader_ = make_reader(probe, *quantity, scene, model);
}

std::vector<Probe> make_probes(const scenario::Scene& scene, const Model& model) {
  std::vector<Probe> probes;
  for (const auto& probe : scene.output.probes) probes.emplace_back(probe, scene, model);
  return probes;
}

}  // namespace der
