#include "output/rod_field.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "der/core/error.hpp"
#include "der/core/index.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/output/quantities.hpp"
#include "der/supports/clamp.hpp"

namespace der {
namespace {

/// A component of position or velocity at every node.
class ComponentField : public RodField {
 public:
  ComponentField(Vector State::* values, int component, const RodLayout& rod, const Model& model)
      : RodField(rod.arc_length), values_(values) {
    for (const Index node : rod.nodes) dofs_.push_back(model.dof(node, component));
  }
  [[nodiscard]] double sample(std::size_t i, const Model& /*model*/,
                              const State& state) const override {
    return (state.*values_)[dofs_[i]];
  }

 private:
  Vector State::* values_;
  std::vector<Index> dofs_;
};

class SpeedField : public RodField {
 public:
  SpeedField(const RodLayout& rod, const Model& model) : RodField(rod.arc_length) {
    for (const Index node : rod.nodes) dofs_.push_back(model.dof(node, 0));
  }
  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    return state.velocities.segment(dofs_[i], model.dimension).norm();
  }

 private:
  std::vector<Index> dofs_;  // of the first component
};

std::vector<double> edge_middles(const RodLayout& rod) {
  std::vector<double> middles;
  for (std::size_t i = 1; i < rod.arc_length.size(); ++i) {
    middles.push_back(0.5 * (rod.arc_length[i - 1] + rod.arc_length[i]));
  }
  return middles;
}

/// An edge's vector [m] as its elements see it.
Vec2 vector_of(const Link& link, const Model& model, const State& state) {
  const auto turn = [&](const Pivot& pivot) {
    return pivot.rotation >= 0 ? model.controls.value(pivot.rotation, state.time, state.ramps)
                               : 0.0;
  };
  return link.vector(state.positions, turn(link.first), turn(link.last));
}

/// Strain of every edge, times a stiffness (1 for the strain itself, EA for the tension).
class StretchField : public RodField {
 public:
  StretchField(double stiffness, const RodLayout& rod, const Model& model)
      : RodField(edge_middles(rod)), stiffness_(stiffness), edge_length_(rod.edge_length) {
    for (Index edge = 0; edge < rod.num_edges(); ++edge) {
      links_.push_back(link_of(rod, edge, model));
      rest_length_.push_back(links_.back().vector(model.initial_positions, 0.0, 0.0).norm());
    }
  }
  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    const double length = vector_of(links_[i], model, state).norm();
    return stiffness_ * (length - rest_length_[i]) / edge_length_[i];
  }

 private:
  double stiffness_;
  std::vector<double> edge_length_;
  std::vector<double> rest_length_;  // of the links
  std::vector<Link> links_;
};

/// Where a rod bends: the turn from one direction to the next, and the length over which it acts.
struct BendCell {
  Link before;
  Link after;
  std::optional<Clamp> start;  // its tangent stands in place of the link before
  std::optional<Clamp> end;    // its tangent stands in place of the link after
  double length = 0.0;         // [m]
  double rest_angle = 0.0;     // [rad]
};

Vec2 tangent(const Clamp& clamp, const Model& model, const State& state) {
  const double angle = tangent_angle(clamp, model, state);
  return {std::cos(angle), std::sin(angle)};
}

double turning_angle(const BendCell& cell, const Model& model, const State& state) {
  const Vec2 before =
      cell.start ? tangent(*cell.start, model, state) : vector_of(cell.before, model, state);
  const Vec2 after =
      cell.end ? tangent(*cell.end, model, state) : vector_of(cell.after, model, state);
  return angle_between(before, after);
}

BendCell bend_cell(const RodLayout& rod, Index place, const Model& model) {
  BendCell cell;
  const Clamp* clamp = rod.clamp_at(place);
  cell.rest_angle = rod.rest_turning_angle[at(place)];
  if (place > 0) cell.before = link_of(rod, place - 1, model);
  if (place < rod.num_edges()) cell.after = link_of(rod, place, model);
  if (clamp == nullptr) {
    cell.length = bend_length(rod, place);
    return cell;
  }
  if (place > 0) cell.length += clamp_cell_length(rod, place - 1);
  if (place < rod.num_edges()) cell.length += clamp_cell_length(rod, place);
  if (place == 0) cell.start = *clamp;
  if (place == rod.num_edges()) cell.end = *clamp;
  return cell;
}

/// Turning angle, curvature or moment at the nodes that bend.
template <class Measure>
class BendField : public RodField {
 public:
  enum class What { TurningAngle, Curvature, Moment };

  /// `places`: positions in the rod of the nodes that bend.
  BendField(What what, const RodLayout& rod, const std::vector<Index>& places, const Model& model)
      : RodField(arc_lengths(rod, places)), what_(what), EI_(rod.EI) {
    for (const Index place : places) cells_.push_back(bend_cell(rod, place, model));
  }
  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    const double here = cell_value(cells_[i], model, state);
    if (what_ == What::TurningAngle || cells_.size() < 2) return here;
    // The value of a clamp's cell is that at its pivot; carried on to the node it is the clamp's.
    const double share = clamp_pivot_share() / (1.0 - clamp_pivot_share());
    if (cells_[i].start) return here + share * (here - cell_value(cells_[i + 1], model, state));
    if (cells_[i].end) return here + share * (here - cell_value(cells_[i - 1], model, state));
    return here;
  }
  [[nodiscard]] bool continuous() const override { return what_ != What::TurningAngle; }

 private:
  [[nodiscard]] double cell_value(const BendCell& cell, const Model& model,
                                  const State& state) const {
    const double angle = turning_angle(cell, model, state);
    switch (what_) {
      case What::TurningAngle:
        return angle;
      case What::Curvature:
        return angle / cell.length;
      case What::Moment:
        break;
    }
    const double rest_kappa = Measure::of(cell.rest_angle).kappa;
    return bend_response<Measure>(EI_ / cell.length, rest_kappa, angle).moment;
  }
  static std::vector<double> arc_lengths(const RodLayout& rod, const std::vector<Index>& places) {
    std::vector<double> result;
    for (const Index place : places) result.push_back(rod.arc_length[at(place)]);
    return result;
  }

  What what_;
  double EI_;
  std::vector<BendCell> cells_;
};

/// Inner nodes, and ends that are clamped.
std::vector<Index> bending_nodes(const RodLayout& rod) {
  std::vector<Index> places;
  for (Index i = 0; i <= rod.num_edges(); ++i) {
    const bool inner = i > 0 && i < rod.num_edges();
    if (inner || rod.clamp_at(i) != nullptr) places.push_back(i);
  }
  return places;
}

template <class Measure>
std::unique_ptr<RodField> make_bend_field(const std::string& quantity, const RodLayout& rod,
                                          const Model& model) {
  using Field = BendField<Measure>;
  auto what = Field::What::Moment;
  if (quantity == "turning_angle") what = Field::What::TurningAngle;
  if (quantity == "curvature") what = Field::What::Curvature;
  return std::make_unique<Field>(what, rod, bending_nodes(rod), model);
}

std::string quantities_along_rods() {
  std::string names;
  for (const Quantity& quantity : quantities()) {
    if (quantity.kind == QuantityKind::Energy) continue;
    names += (names.empty() ? "" : ", ") + quantity.name;
  }
  return names;
}

}  // namespace

std::unique_ptr<RodField> make_rod_field(const std::string& quantity, const RodLayout& rod,
                                         const Model& model) {
  const auto component = [&](Vector State::* values, int number) {
    return std::make_unique<ComponentField>(values, number, rod, model);
  };
  if (quantity == "x") return component(&State::positions, 0);
  if (quantity == "y") return component(&State::positions, 1);
  if (quantity == "vx") return component(&State::velocities, 0);
  if (quantity == "vy") return component(&State::velocities, 1);
  if (quantity == "speed") return std::make_unique<SpeedField>(rod, model);
  if (quantity == "strain") return std::make_unique<StretchField>(1.0, rod, model);
  if (quantity == "tension") return std::make_unique<StretchField>(rod.EA, rod, model);
  if (quantity == "turning_angle" || quantity == "curvature" || quantity == "moment") {
    return rod.curvature == scenario::CurvatureMeasure::Angle
               ? make_bend_field<AngleCurvature>(quantity, rod, model)
               : make_bend_field<TangentCurvature>(quantity, rod, model);
  }
  throw Error("model_error", fmt::format("'{}' is not a quantity along a rod; these are: {}",
                                         quantity, quantities_along_rods()));
}

}  // namespace der
