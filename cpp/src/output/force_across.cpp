#include "output/force_across.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "der/core/index.hpp"
#include "output/around_ring.hpp"
#include "output/bend_field.hpp"

namespace der {
namespace {

/// Calls use(length, first, last) with the values at the ends of the parts between two arc lengths
/// on which a field is a line.
template <class Use>
void for_each_line(const RodField& field, double from, double to, const Model& model,
                   const State& state, const Use& use) {
  const std::vector<double>& samples = field.arc_length();
  const auto beyond = std::upper_bound(samples.begin(), samples.end(), from);
  auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(beyond - samples.begin(), 1));
  for (; i < samples.size() && samples[i - 1] < to; ++i) {
    const double spacing = samples[i] - samples[i - 1];
    const double start = std::max(from, samples[i - 1]);
    const double end = std::min(to, samples[i]);
    if (spacing <= 0.0 || end <= start) continue;
    const double first = field.sample(i - 1, model, state);
    const double slope = (field.sample(i, model, state) - first) / spacing;
    use(end - start, first + slope * (start - samples[i - 1]),
        first + slope * (end - samples[i - 1]));
  }
}

/// The mean of a field, and by how much it changes but for its jumps.
struct Course {
  double mean = 0.0;
  double change = 0.0;
};

Course course_of(const RodField& field, double from, double to, const Model& model,
                 const State& state) {
  Course course;
  for_each_line(field, from, to, model, state, [&](double length, double first, double last) {
    course.mean += 0.5 * length * (first + last) / (to - from);
    course.change += last - first;
  });
  return course;
}

}  // namespace

bool bears_forces_across(const RodMesh& rod, const Model& model) {
  return model.dimension == 2 ? rod.EI > 0.0 : !rod.vertices.empty();
}

ForceAcross::ForceAcross(const RodMesh& rod, const Model& model) {
  const auto field = [&](const char* quantity) { return make_rod_field(quantity, rod, model); };
  if (model.dimension == 2) {  // with a sign, whatever probes of the scene have
    const auto around = [&](std::unique_ptr<RodField> own) {
      return rod.closed ? around_ring(std::move(own), rod) : std::move(own);
    };
    bends_.push_back(
        {around(make_curvature_field(rod, model)), around(make_moment_field(rod, model))});
    return;
  }
  if (!model.has_sections()) {
    bends_.push_back({field("curvature"), field("moment")});
    return;
  }
  bends_.push_back({field("curvature_1"), field("moment_1")});
  bends_.push_back({field("curvature_2"), field("moment_2")});
  twist_ = field("twist");
  torque_ = field("torque");
}

/// F = -M', with the components of M along directors that turn with the twist u as F1 = -M1' + u M2
/// - k2 T, F2 = -M2' - u M1 + k1 T with the torque T.
ForceAcross::Mean ForceAcross::mean(double from, double to, const Model& model,
                                    const State& state) const {
  const auto course = [&](const RodField& field) {
    return course_of(field, from, to, model, state);
  };
  Mean mean;
  Vec2 moment = Vec2::Zero();
  for (std::size_t k = 0; k < bends_.size(); ++k) {
    const auto component = static_cast<Index>(k);
    const Course bending = course(*bends_[k].moment);
    moment[component] = bending.mean;
    mean.curvature[component] = course(*bends_[k].curvature).mean;
    mean.force[component] = -bending.change / (to - from);
  }
  if (twist_) {
    mean.force += course(*twist_).mean * Vec2(moment[1], -moment[0]) +
                  course(*torque_).mean * Vec2(-mean.curvature[1], mean.curvature[0]);
  }
  return mean;
}

}  // namespace der
