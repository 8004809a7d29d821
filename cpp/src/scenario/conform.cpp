#include "scenario/conform.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "der/scenario/load.hpp"
#include "der/scenario/model_choice.hpp"
#include "scenario/directions.hpp"

namespace der::scenario {
namespace {

class Conform {
 public:
  Conform(Scene& scene, ModelChoice model) : scene_(scene), planar_(model == ModelChoice::Planar) {}

  void run() {
    scene_.dimension = planar_ ? 2 : 3;
    for (Rod& rod : scene_.rods) conform(rod);
    for (Support& support : scene_.supports) conform(support);
    for (Actuation& actuation : scene_.actuations) conform(actuation);
    for (Load& load : scene_.loads) {
      std::visit([this](auto& what) { conform(what); }, load.what);
    }
  }

 private:
  void resize(Components& vector) const {
    if (!vector.empty()) vector.resize(static_cast<std::size_t>(scene_.dimension), 0.0);
  }
  void resize(VectorSeries& series) const {
    for (Components& value : series.values) resize(value);
  }
  void resize(Series& /*series*/) const {}

  void conform(Rod& rod) const {
    if (planar_) {
      make_planar(rod);
    } else {
      make_spatial(rod);
    }
    for (Components& point : rod.points) resize(point);
    for (Components& velocity : rod.initial_velocity) resize(velocity);
  }

  static void make_planar(Rod& rod) {
    const FlatDirector director = flat_director(rod);
    if (const auto* pair = std::get_if<CurvaturePair>(&rod.natural_curvature)) {
      rod.natural_curvature = director.in_plane(*pair);
    } else if (const auto* list = std::get_if<std::vector<CurvaturePair>>(&rod.natural_curvature)) {
      std::vector<double> signed_values(list->size());
      std::transform(list->begin(), list->end(), signed_values.begin(),
                     [&](const CurvaturePair& each) { return director.in_plane(each); });
      rod.natural_curvature = std::move(signed_values);
    }
  }

  static void make_spatial(Rod& rod) {
    const auto pair_of = [&rod](double curvature) {
      return curvature == 0.0 ? CurvaturePair{} : flat_director(rod).pair(curvature);
    };
    if (const auto* curvature = std::get_if<double>(&rod.natural_curvature)) {
      rod.natural_curvature = pair_of(*curvature);
    } else if (const auto* list = std::get_if<std::vector<double>>(&rod.natural_curvature)) {
      std::vector<CurvaturePair> pairs(list->size());
      std::transform(list->begin(), list->end(), pairs.begin(), pair_of);
      rod.natural_curvature = std::move(pairs);
    }
  }

  void conform(Actuation& actuation) const {
    if (actuation.what != Actuated::Curvature) return;
    const auto rod = std::find_if(scene_.rods.begin(), scene_.rods.end(),
                                  [&](const Rod& each) { return each.name == actuation.rod; });
    std::vector<Series>& values = actuation.values;
    if (planar_ && values.size() == 2) {
      const auto [first, second] = flat_director(*rod).pair(1.0);
      const bool toward_first = std::abs(first) > std::abs(second);
      values = {scaled(values[toward_first ? 0 : 1], toward_first ? first : second)};
    } else if (!planar_ && values.size() == 1) {
      const auto [first, second] = flat_director(*rod).pair(1.0);
      values = {scaled(values[0], first), scaled(values[0], second)};
    }
  }

  static Series scaled(Series series, double factor) {
    for (double& value : series.values) value *= factor;
    return series;
  }

  void conform(Support& support) const {
    if (planar_) {
      make_planar(support);
    } else if (support.rotation) {
      support.axis_rotation = AxisRotation{{0.0, 0.0, 1.0}, std::move(*support.rotation)};
      support.rotation.reset();
    }
    if (!support.spring) return;
    resize(support.spring->stiffness);
    resize(support.spring->anchor);
    if (planar_) make_planar(support.rod, support.spring->rotational_stiffness);
  }

  /// The stiffness against turning about z for all three.
  void make_planar(const std::string& name, Components& stiffness) const {
    const auto rod = std::find_if(scene_.rods.begin(), scene_.rods.end(),
                                  [&](const Rod& each) { return each.name == name; });
    if (stiffness.empty() || rod == scene_.rods.end()) return;
    const bool towards_first = std::abs(flat_director(*rod).z) < 0.5;
    const double in_plane = stiffness[towards_first ? 0 : 1];
    stiffness = in_plane > 0.0 ? Components(3, in_plane) : Components();
  }

  static void make_planar(Support& support) {
    auto& fix = support.fix;
    fix.erase(std::remove(fix.begin(), fix.end(), Component::Z), fix.end());
    auto& moved = support.prescribe;
    moved.erase(
        std::remove_if(moved.begin(), moved.end(),
                       [](const Prescribed& motion) { return motion.component == Component::Z; }),
        moved.end());
    support.twist.reset();
    if (!support.axis_rotation) return;
    support.rotation = std::move(support.axis_rotation->angle);
    if (support.axis_rotation->axis[2] < 0.0) {
      for (double& angle : support.rotation->values) angle = -angle;
    }
    support.axis_rotation.reset();
  }

  template <class Kind>
  void conform(Kind& load) const {
    for_each_amount(load, [&](const char* /*key*/, auto& amount) { resize(amount); });
  }

  void conform(Foundation& load) const { resize(load.stiffness); }

  void conform(Moment& load) const {
    VectorSeries& vector = load.moment_vector;
    if (planar_ && !vector.values.empty()) {
      load.moment = component_of(vector, 2);
      vector = {};
    } else if (!planar_ && vector.values.empty()) {
      vector = {std::move(load.moment.times), {}, load.moment.course};
      for (const double about_z : load.moment.values) vector.values.push_back({0.0, 0.0, about_z});
      load.moment = {};
    }
  }

  Scene& scene_;
  bool planar_;
};

}  // namespace

void conform(Scene& scene, ModelChoice model) { Conform(scene, model).run(); }

}  // namespace der::scenario
