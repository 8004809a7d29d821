#include "der/output/probe.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "der/catalog/quantities.hpp"
#include "der/core/error.hpp"
#include "der/model/location.hpp"
#include "der/scenario/scenario.hpp"
#include "output/energy_reader.hpp"
#include "output/rod_field.hpp"

namespace der {
namespace {

struct SampleWeight {
  std::size_t sample = 0;
  double weight = 0.0;
};
using Weights = std::vector<SampleWeight>;

/// Linear between the two samples nearest to `s`, and beyond the outermost ones.
Weights linear_weights(const std::vector<double>& arc, double s) {
  if (arc.size() == 1) return {{0, 1.0}};
  const auto above =
      static_cast<std::size_t>(std::upper_bound(arc.begin(), arc.end(), s) - arc.begin());
  const std::size_t right = std::clamp<std::size_t>(above, 1, arc.size() - 1);
  const double share = (s - arc[right - 1]) / (arc[right] - arc[right - 1]);
  return {{right - 1, 1.0 - share}, {right, share}};
}

/// Linear between the samples on one side of `s`, which may be a place where the field jumps.
Weights one_sided_weights(const std::vector<double>& arc, double s, scenario::Side side,
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

double weighted_sum(const Weights& weights, const RodField& field, const Model& model,
                    const State& state) {
  double sum = 0.0;
  for (const auto& [sample, weight] : weights) sum += weight * field.sample(sample, model, state);
  return sum;
}

/// A field at one place.
class PointReader : public ProbeReader {
 public:
  PointReader(std::unique_ptr<RodField> field, Weights weights)
      : field_(std::move(field)), weights_(std::move(weights)) {}
  double value(const Model& model, const State& state) override {
    return weighted_sum(weights_, *field_, model, state);
  }

 private:
  std::unique_ptr<RodField> field_;
  Weights weights_;
};

/// The speed between nodes: of the interpolated velocity, not the interpolated speed, which has a
/// kink where the velocity changes its sign.
class SpeedReader : public ProbeReader {
 public:
  SpeedReader(std::vector<Weighted> weights, const RodLayout& rod)
      : weights_(std::move(weights)), nodes_(rod.nodes) {}
  double value(const Model& model, const State& state) override {
    double squared = 0.0;
    for (int c = 0; c < model.dimension; ++c) {
      double component = 0.0;
      for (const auto& [place, weight] : weights_) {
        const Index node = nodes_[static_cast<std::size_t>(place)];
        component += weight * state.velocities[model.dof(node, c)];
      }
      squared += component * component;
    }
    return std::sqrt(squared);
  }

 private:
  std::vector<Weighted> weights_;
  std::vector<Index> nodes_;
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
  ExtremeReader(std::unique_ptr<RodField> field, const RodLayout& rod, scenario::Reduce reduce,
                bool parabola_at_ends)
      : field_(std::move(field)),
        parabola_at_ends_(parabola_at_ends),
        arc_length_(field_->arc_length()),
        sign_(reduce == scenario::Reduce::Max ? 1.0 : -1.0) {
    if (field_->continuous()) add_ends(rod);
    values_.resize(arc_length_.size());
  }

  double value(const Model& model, const State& state) override {
    evaluate(model, state);
    const auto best = static_cast<std::size_t>(std::max_element(values_.begin(), values_.end()) -
                                               values_.begin());
    const std::size_t last = values_.size() - 1;
    if (best == 0 || best == last) return sign_ * end_extreme(best, best == 0 ? 1 : last - 1);
    if (!smooth_at(best)) return sign_ * values_[best];
    return sign_ * parabola_extreme(&arc_length_[best - 1], &values_[best - 1]);
  }

 private:
  /// A field that has no sample at an end of the rod is continued to it, for its extreme may be
  /// there (the tension of a hanging cable).
  void add_ends(const RodLayout& rod) {
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

  /// The end of the rod has the largest sample: the value there, or a larger one on the way to its
  /// neighbour, of the parabola through the three outermost samples.
  [[nodiscard]] double end_extreme(std::size_t end, std::size_t next) const {
    if (!parabola_at_ends_ || values_.size() < 3 || !smooth_at(next)) return values_[end];
    const double* s = &arc_length_[next - 1];
    const double* f = &values_[next - 1];
    const auto [from, to] = std::minmax(arc_length_[end], arc_length_[next]);
    return peaks_between(s, f, from, to) ? parabola_extreme(s, f) : values_[end];
  }

  /// Whether a parabola may be laid through a value and its neighbours.
  [[nodiscard]] bool smooth_at(std::size_t i) const {
    return field_->continuous() && field_->smooth_at(start_.empty() ? i : i - 1);
  }

  void evaluate(const Model& model, const State& state) {
    std::size_t next = 0;
    if (!start_.empty()) {
      values_[next++] = sign_ * weighted_sum(start_, *field_, model, state);
    }
    for (std::size_t i = 0; i < field_->arc_length().size(); ++i) {
      values_[next++] = sign_ * field_->sample(i, model, state);
    }
    if (!end_.empty()) values_[next] = sign_ * weighted_sum(end_, *field_, model, state);
  }

  std::unique_ptr<RodField> field_;
  bool parabola_at_ends_;           // of fields that are smooth up to the ends: positions
  std::vector<double> arc_length_;  // of the samples and the ends [m]
  Weights start_, end_;             // empty where the end is a sample
  double sign_;
  std::vector<double> values_;  // times sign_, so that the largest one is looked for
};

Weights sample_weights(const std::vector<Weighted>& weights) {
  Weights result;
  for (const auto& [place, weight] : weights) {
    result.push_back({static_cast<std::size_t>(place), weight});
  }
  return result;
}

std::unique_ptr<RodField> make_probed_field(const scenario::Probe& probe, const RodLayout& rod,
                                            const Model& model) {
  auto field = make_rod_field(probe.quantity, rod, model);
  if (field->arc_length().empty()) {
    throw Error("model_error", "probe '" + probe.name + "': rod '" + rod.name + "' bends nowhere");
  }
  return field;
}

Weights point_weights(const scenario::Probe& probe, QuantityKind kind, const RodField& field,
                      const RodLayout& rod, double s) {
  switch (kind) {
    case QuantityKind::Position:
    case QuantityKind::Velocity:
      return sample_weights(node_weights(rod, s));
    case QuantityKind::Bend:
    case QuantityKind::Edge:
      return one_sided_weights(field.arc_length(), s, probe.side.value_or(scenario::Side::After),
                               rod.same_place());
    case QuantityKind::Turn:
    case QuantityKind::Energy:
      break;
  }
  return linear_weights(field.arc_length(), s);
}

std::unique_ptr<ProbeReader> make_point_reader(const scenario::Probe& probe, QuantityKind kind,
                                               const RodLayout& rod, const Model& model) {
  const double s = arc_length_of(*probe.at, rod);
  if (probe.quantity == "speed") return std::make_unique<SpeedReader>(node_weights(rod, s), rod);
  auto field = make_probed_field(probe, rod, model);
  Weights weights = point_weights(probe, kind, *field, rod, s);
  return std::make_unique<PointReader>(std::move(field), std::move(weights));
}

std::unique_ptr<ProbeReader> make_reader(const scenario::Probe& probe, QuantityKind kind,
                                         const Model& model) {
  if (kind == QuantityKind::Energy) return make_energy_reader(probe.quantity, probe.rod, model);
  const RodLayout& rod = model.rod(probe.rod.value());
  if (probe.over == scenario::Reduce::None) return make_point_reader(probe, kind, rod, model);
  return std::make_unique<ExtremeReader>(make_probed_field(probe, rod, model), rod, probe.over,
                                         kind == QuantityKind::Position);
}

}  // namespace

Probe::Probe(const scenario::Probe& probe, const Model& model) : name_(probe.name) {
  const Quantity* quantity = find_quantity(probe.quantity);
  if (quantity == nullptr) {
    throw Error("model_error",
                "probe '" + probe.name + "': there is no quantity '" + probe.quantity + "'");
  }
  unit_ = quantity->unit;
  reader_ = make_reader(probe, quantity->kind, model);
}

std::vector<Probe> make_probes(const scenario::Scene& scene, const Model& model) {
  std::vector<Probe> probes;
  for (const auto& probe : scene.output.probes) probes.emplace_back(probe, model);
  return probes;
}

}  // namespace der
