#include "output/smaller_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "output/bend_field.hpp"

namespace der {
namespace {

class ScaledField : public RodField {
 public:
  ScaledField(double factor, std::unique_ptr<RodField> field)
      : RodField(field->arc_length()), factor_(factor), field_(std::move(field)) {}

  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    return scaled(field_->sample(i, model, state));
  }
  void sample_all(const Model& model, const State& state, double* values) const override {
    field_->sample_all(model, state, values);
    for (std::size_t i = 0; i < arc_length().size(); ++i) values[i] = scaled(values[i]);
  }
  [[nodiscard]] double interpolate(const SampleWeights& weights, const Model& model,
                                   const State& state) const override {
    return scaled(field_->interpolate(weights, model, state));
  }
  [[nodiscard]] bool continuous() const override { return field_->continuous(); }
  [[nodiscard]] bool smooth_at(std::size_t i) const override { return field_->smooth_at(i); }

 private:
  /// No -0.
  [[nodiscard]] double scaled(double value) const { return factor_ * value + 0.0; }

  double factor_;
  std::unique_ptr<RodField> field_;
};

class MagnitudeField : public RodField {
 public:
  MagnitudeField(std::unique_ptr<RodField> field, const RodMesh& rod)
      : RodField(field->arc_length()),
        field_(std::move(field)),
        same_place_(rod.same_place()),
        ring_length_(rod.closed ? rod.rest_length() : 0.0) {}

  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    return std::abs(field_->sample(i, model, state));
  }
  void sample_all(const Model& model, const State& state, double* values) const override {
    field_->sample_all(model, state, values);
    for (std::size_t i = 0; i < arc_length().size(); ++i) values[i] = std::abs(values[i]);
  }
  [[nodiscard]] double interpolate(const SampleWeights& weights, const Model& model,
                                   const State& state) const override {
    return std::abs(field_->interpolate(weights, model, state));
  }
  /// It is 0 where the sign changes, but for jumps: there it does not pass what lies between.
  [[nodiscard]] double dip(const Model& model, const State& state) const override {
    const std::vector<double>& arc = arc_length();
    if (arc.empty()) return RodField::dip(model, state);
    const double first = field_->sample(0, model, state);
    double before = first;
    double s_before = arc.front();
    bool passes_zero = false;
    const auto go_on_to = [&](double s, double here) {
      passes_zero = passes_zero || (before * here < 0.0 && s > s_before + same_place_);
      before = here;
      s_before = s;
    };
    for (std::size_t i = 1; i < arc.size(); ++i) go_on_to(arc[i], field_->sample(i, model, state));
    if (ring_length_ > 0.0) go_on_to(arc.front() + ring_length_, first);
    return passes_zero ? 0.0 : RodField::dip(model, state);
  }
  [[nodiscard]] bool continuous() const override { return field_->continuous(); }
  [[nodiscard]] bool smooth_at(std::size_t i) const override { return field_->smooth_at(i); }

 private:
  std::unique_ptr<RodField> field_;
  double same_place_;   // [m]
  double ring_length_;  // [m]; 0: the rod is open
};

/// Component toward a director of a curvature in the plane.
double share_toward_director(SectionQuantity quantity, const RodMesh& rod) {
  switch (quantity) {
    case SectionQuantity::Curvature1:
    case SectionQuantity::Moment1:
    case SectionQuantity::NaturalCurvature1:
      return rod.director[0];
    case SectionQuantity::Curvature2:
    case SectionQuantity::Moment2:
    case SectionQuantity::NaturalCurvature2:
      return -rod.director[1];
    default:
      return 0.0;  // there is no twist
  }
}

RodFieldMaker planar_maker(SectionQuantity quantity) {
  switch (quantity) {
    case SectionQuantity::Moment1:
    case SectionQuantity::Moment2:
      return make_moment_field;
    case SectionQuantity::NaturalCurvature1:
    case SectionQuantity::NaturalCurvature2:
      return make_natural_curvature_field;
    default:
      return make_curvature_field;
  }
}

}  // namespace

std::unique_ptr<RodField> scaled(double factor, std::unique_ptr<RodField> field) {
  return std::make_unique<ScaledField>(factor, std::move(field));
}

std::unique_ptr<RodField> magnitude(std::unique_ptr<RodField> field, const RodMesh& rod) {
  return std::make_unique<MagnitudeField>(std::move(field), rod);
}

std::unique_ptr<RodField> make_section_field_in_smaller(SectionQuantity quantity,
                                                        const RodMesh& rod, const Model& model) {
  if (model.dimension == 2) {
    return scaled(share_toward_director(quantity, rod), planar_maker(quantity)(rod, model));
  }
  if (is_towards_director(quantity)) return make_section_field(quantity, rod, model);
  // A rod of this model is straight without stress.
  return scaled(0.0, make_section_field(SectionQuantity::Curvature, rod, model));
}

}  // namespace der
