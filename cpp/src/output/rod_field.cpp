#include "output/rod_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "der/core/error.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/energies/planar_clamp.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {
namespace {

using EdgeDofs = std::array<Index, 4>;

Vec2 edge_vector(const EdgeDofs& dofs, const Vector& positions) {
  return {positions[dofs[2]] - positions[dofs[0]], positions[dofs[3]] - positions[dofs[1]]};
}

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

/// Strain of every edge, times a stiffness (1 for the strain itself, EA for the tension).
class StretchField : public RodField {
 public:
  StretchField(double stiffness, const RodLayout& rod, const Model& model)
      : RodField(edge_middles(rod)), stiffness_(stiffness), rest_length_(rod.edge_length) {
    for (Index edge = 0; edge < rod.num_edges(); ++edge) {
      dofs_.push_back(rod.edge_dofs(edge, model));
    }
  }
  [[nodiscard]] double sample(std::size_t i, const Model& /*model*/,
                              const State& state) const override {
    const double length = edge_vector(dofs_[i], state.positions).norm();
    return stiffness_ * (length / rest_length_[i] - 1.0);
  }

 private:
  double stiffness_;
  std::vector<double> rest_length_;
  std::vector<EdgeDofs> dofs_;
};

/// The tangent that a clamp at the end of a rod holds.
struct EndClamp {
  double direction = 0.0;   // initial [rad]
  double rest_kappa = 0.0;  // of the half cell
  Index rotation = -1;      // control that turns it; -1: none
};

template <class Measure>
std::optional<EndClamp> find_clamp(const EdgeDofs& edge, double side, const Model& model) {
  const auto& list = std::get<ElementList<PlanarClamp<Measure>>>(model.elements);
  for (std::size_t e = 0; e < list.size(); ++e) {
    const auto& c = list.constants[e];
    if (list.dofs[e] == edge && c.side == side) {
      return EndClamp{c.direction, c.rest_kappa, c.rotation};
    }
  }
  return std::nullopt;
}

/// Where a rod bends: a cell of length `length` around a node, with the edge before and behind it;
/// at a clamped end one of the two is the clamp's tangent.
struct BendCell {
  EdgeDofs before{};
  EdgeDofs after{};
  std::optional<EndClamp> start;  // in place of the edge before
  std::optional<EndClamp> end;    // in place of the edge behind
  double length = 0.0;            // [m]
  double rest_kappa = 0.0;
};

Vec2 tangent(const EndClamp& clamp, const Model& model, double time) {
  double angle = clamp.direction;
  if (clamp.rotation >= 0) angle += value_at(model.controls[clamp.rotation], time);
  return {std::cos(angle), std::sin(angle)};
}

double turning_angle(const BendCell& cell, const Model& model, const State& state) {
  const Vec2 before = cell.start ? tangent(*cell.start, model, state.time)
                                 : edge_vector(cell.before, state.positions);
  const Vec2 after =
      cell.end ? tangent(*cell.end, model, state.time) : edge_vector(cell.after, state.positions);
  return angle_between(before, after);
}

template <class Measure>
std::vector<std::pair<double, BendCell>> bend_cells(const RodLayout& rod, const Model& model) {
  std::vector<std::pair<double, BendCell>> cells;
  const Index last = rod.num_edges();
  for (Index i = 0; i <= last; ++i) {
    const auto place = static_cast<std::size_t>(i);
    BendCell cell;
    cell.length = rod.voronoi_length(i);
    cell.rest_kappa = Measure::of(rod.rest_turning_angle[place]).kappa;
    if (i > 0) cell.before = rod.edge_dofs(i - 1, model);
    if (i < last) cell.after = rod.edge_dofs(i, model);
    if (i == 0 && !(cell.start = find_clamp<Measure>(cell.after, 1.0, model))) continue;
    if (i == last && !(cell.end = find_clamp<Measure>(cell.before, -1.0, model))) continue;
    if (cell.start) cell.rest_kappa = cell.start->rest_kappa;
    if (cell.end) cell.rest_kappa = cell.end->rest_kappa;
    cells.emplace_back(rod.arc_length[place], cell);
  }
  return cells;
}

/// Turning angle, curvature or moment at the nodes that bend.
template <class Measure>
class BendField : public RodField {
 public:
  enum class What { TurningAngle, Curvature, Moment };

  BendField(What what, const RodLayout& rod, std::vector<std::pair<double, BendCell>> cells)
      : RodField(arc_lengths(cells)), what_(what), EI_(rod.EI) {
    for (auto& [arc_length, cell] : cells) cells_.push_back(cell);
  }
  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    const BendCell& cell = cells_[i];
    const double angle = turning_angle(cell, model, state);
    switch (what_) {
      case What::TurningAngle:
        return angle;
      case What::Curvature:
        return angle / cell.length;
      case What::Moment:
        break;
    }
    return bend_response<Measure>(EI_ / cell.length, cell.rest_kappa, angle).moment;
  }
  [[nodiscard]] bool continuous() const override { return what_ != What::TurningAngle; }

 private:
  static std::vector<double> arc_lengths(const std::vector<std::pair<double, BendCell>>& cells) {
    std::vector<double> result;
    for (const auto& [arc_length, cell] : cells) result.push_back(arc_length);
    return result;
  }

  What what_;
  double EI_;
  std::vector<BendCell> cells_;
};

template <class Measure>
std::unique_ptr<RodField> make_bend_field(const std::string& quantity, const RodLayout& rod,
                                          const Model& model) {
  using Field = BendField<Measure>;
  auto what = Field::What::Moment;
  if (quantity == "turning_angle") what = Field::What::TurningAngle;
  if (quantity == "curvature") what = Field::What::Curvature;
  auto cells = bend_cells<Measure>(rod, model);
  if (cells.empty()) throw Error("model_error", "rod '" + rod.name + "' bends nowhere");
  return std::make_unique<Field>(what, rod, std::move(cells));
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
  throw Error("model_error", "'" + quantity + "' is not a quantity along a rod");
}

}  // namespace der
