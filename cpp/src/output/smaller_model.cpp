#include "output/smaller_model.hpp"

#include <utility>

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
