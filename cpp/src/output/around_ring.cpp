#include "output/around_ring.hpp"

#include <algorithm>
#include <utility>

namespace der {
namespace {

/// A sample by those of the ring's own field.
struct Sample {
  double arc_length = 0.0;  ///< [m]
  SampleWeights own;
};

/// The own samples between the start and the end of the ring, in the order of the arc length.
std::vector<Sample> own_samples(const RodField& own, const RodMesh& rod) {
  const double length = rod.rest_length();
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < own.arc_length().size(); ++i) {
    double s = own.arc_length()[i];
    if (s < -rod.same_place()) s += length;
    if (s > length + rod.same_place()) s -= length;
    samples.push_back({std::clamp(s, 0.0, length), {{i, 1.0}}});
  }
  const auto descends = [](const Sample& a, const Sample& b) {
    return b.arc_length < a.arc_length;
  };
  const auto last = std::adjacent_find(samples.begin(), samples.end(), descends);
  if (last != samples.end()) std::rotate(samples.begin(), last + 1, samples.end());
  return samples;
}

std::vector<Sample> closed_samples(const RodField& own, const RodMesh& rod) {
  std::vector<Sample> samples = own_samples(own, rod);
  if (samples.empty() || !own.continuous()) return samples;
  const double length = rod.rest_length();
  const bool has_start = samples.front().arc_length <= rod.same_place();
  const bool has_end = samples.back().arc_length >= length - rod.same_place();
  SampleWeights seam;
  if (has_start) {
    seam = samples.front().own;
  } else if (has_end) {
    seam = samples.back().own;
  } else {
    const double before = length - samples.back().arc_length;
    const double after = samples.front().arc_length;
    const double share = before / (before + after);
    seam = {{samples.back().own.front().sample, 1.0 - share},
            {samples.front().own.front().sample, share}};
  }
  if (!has_start) samples.insert(samples.begin(), {0.0, seam});
  if (!has_end) samples.push_back({length, seam});
  return samples;
}

class RingField : public RodField {
 public:
  RingField(std::unique_ptr<RodField> own, std::vector<Sample> samples)
      : RodField(arc_lengths(samples)), own_(std::move(own)), samples_(std::move(samples)) {}

  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    const SampleWeights& weights = samples_[i].own;
    return weights.size() == 1 ? own_->sample(weights.front().sample, model, state)
                               : own_->interpolate(weights, model, state);
  }
  void sample_all(const Model& model, const State& state, double* values) const override {
    own_values_.resize(own_->arc_length().size());
    own_->sample_all(model, state, own_values_.data());
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const SampleWeights& weights = samples_[i].own;
      values[i] = weights.size() == 1 ? own_values_[weights.front().sample]
                                      : own_->interpolate(weights, model, state);
    }
  }
  [[nodiscard]] double interpolate(const SampleWeights& weights, const Model& model,
                                   const State& state) const override {
    own_weights_.clear();
    for (const auto& [number, weight] : weights) {
      for (const auto& [own, share] : samples_[number].own) {
        own_weights_.push_back({own, weight * share});
      }
    }
    return own_->interpolate(own_weights_, model, state);
  }
  [[nodiscard]] double dip(const Model& model, const State& state) const override {
    return own_->dip(model, state);
  }
  [[nodiscard]] bool continuous() const override { return own_->continuous(); }
  [[nodiscard]] bool smooth_at(std::size_t i) const override {
    const SampleWeights& weights = samples_[i].own;
    return weights.size() > 1 || own_->smooth_at(weights.front().sample);
  }

 private:
  static std::vector<double> arc_lengths(const std::vector<Sample>& samples) {
    std::vector<double> result;
    for (const Sample& sample : samples) result.push_back(sample.arc_length);
    return result;
  }

  std::unique_ptr<RodField> own_;
  std::vector<Sample> samples_;
  mutable SampleWeights own_weights_;  // kept, so that reading allocates nothing
  mutable std::vector<double> own_values_;
};

}  // namespace

std::unique_ptr<RodField> around_ring(std::unique_ptr<RodField> own, const RodMesh& rod) {
  std::vector<Sample> samples = closed_samples(*own, rod);
  return std::make_unique<RingField>(std::move(own), std::move(samples));
}

}  // namespace der
