#include "building/arc_elements.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "der/core/constants.hpp"
#include "der/core/index.hpp"
#include "der/energies/arc_stretch.hpp"
#include "der/energies/elements_of.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "model/reference_edge.hpp"

namespace der {
namespace {

/// A leg counts as straight and even up to this relative difference of its angles and lengths.
constexpr double kDrawnRounding = 1e-9;

/// An edge of unit length with the curvatures k = (k_a, k_b) at its two nodes has an arc that is
/// shorter by k' A k.
/// A joint is on the curve, another node k/12 beside it. Between them the curvature is linear.
struct ArcForm {
  double first;  ///< of k_a^2
  double mixed;  ///< of k_a k_b, half of it
  double last;   ///< of k_b^2
  [[nodiscard]] Mat2 matrix() const { return (Mat2() << first, mixed, mixed, last).finished(); }
};
constexpr ArcForm kInner{29.0 / 1440.0, 1.0 / 1440.0, 29.0 / 1440.0};
constexpr ArcForm kFromJoint{-16.0 / 1440.0, -4.0 / 1440.0, 29.0 / 1440.0};
constexpr ArcForm kBetweenJoints{-4.0 / 360.0, -3.5 / 360.0, -4.0 / 360.0};

/// The curvature at a node times the length of a cell, by the turning angles from one on.
struct CurvatureRow {
  Index first = 0;
  Vector weights;
};

class ArcBuilder {
 public:
  ArcBuilder(Leg& leg, const RodMesh& rod, Model& model)
      : leg_(leg), rod_(rod), model_(model), cells_(leg.num_cells()) {}

  [[nodiscard]] bool suits() const {
    const double length = rod_.edge_length[to_size(leg_.first)];
    for (Index k = 0; k < cells_; ++k) {
      if (std::abs(rod_.edge_length[to_size(leg_.first + k)] - length) > kDrawnRounding * length) {
        return false;
      }
      if (k > 0 && std::abs(angle_between(edge(k - 1), edge(k))) > kDrawnRounding) return false;
    }
    return true;
  }

  void add() {
    for (Index k = 0; k < cells_; ++k) add_arc(k);
  }

 private:
  [[nodiscard]] Vec2 edge(Index k) const { return reference_edge(rod_, leg_.first + k, model_); }
  [[nodiscard]] bool is_joint(Index node) const {
    return (node == 0 && leg_.start.rotation >= 0) || (node == cells_ && leg_.end.rotation >= 0);
  }

  [[nodiscard]] CurvatureRow curvature(Index node) const {
    const bool at_start = leg_.start.rotation >= 0;
    const bool at_end = leg_.end.rotation >= 0;
    if ((node == 0 && !at_start) || (node == cells_ && !at_end)) return {};
    const bool whole = at_start && at_end && cells_ <= 2;  // one element for the leg
    const bool from_start = at_start && (node <= 1 || whole);
    const bool from_end = !from_start && at_end && node >= cells_ - 1;
    if (!from_start && !from_end) return {node, Vector::Ones(1)};
    const Index size = whole ? cells_ + 1 : std::min<Index>(cells_, 2);
    const double length = rod_.edge_length[to_size(leg_.first)];
    const Eigen::MatrixXd C =
        end_compliance(leg_, from_start, rod_.edge_length).topLeftCorner(size, size) / length;
    const Vector row = C.inverse().row(from_start ? node : cells_ - node);
    if (from_start) return {0, row};
    return {cells_ - size + 1, row.reverse()};
  }

  void add_arc(Index k) {
    const CurvatureRow before = curvature(k);
    const CurvatureRow after = curvature(k + 1);
    Index first = cells_ + 1;
    Index last = -1;
    for (const CurvatureRow* row : {&before, &after}) {
      if (row->weights.size() == 0) continue;
      first = std::min(first, row->first);
      last = std::max(last, row->first + static_cast<Index>(row->weights.size()) - 1);
    }
    if (last < 0) return;
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2, last - first + 1);
    for (const auto& [row, place] : {std::pair(&before, 0), {&after, 1}}) {
      if (row->weights.size() == 0) continue;
      rows.row(place).segment(row->first - first, row->weights.size()) = row->weights;
    }
    Mat2 A = kInner.matrix();
    if (cells_ == 1) {
      A = kBetweenJoints.matrix();
    } else if (is_joint(k)) {
      A = kFromJoint.matrix();
    } else if (is_joint(k + 1)) {
      A = kFromJoint.matrix().reverse();
    }
    const Eigen::MatrixXd form = rows.transpose() * A * rows;
    const int edges =
        static_cast<int>(std::min(last, cells_ - 1) - std::max<Index>(first - 1, 0)) + 1;
    const int joints = static_cast<int>(first == 0) + static_cast<int>(last == cells_);
    if (joints == 0) edges == 2 ? add<2, 0>(k, first, form) : add<3, 0>(k, first, form);
    if (joints == 1) {
      edges == 1   ? add<1, 1>(k, first, form)
      : edges == 2 ? add<2, 1>(k, first, form)
                   : add<3, 1>(k, first, form);
    }
    if (joints == 2) {
      edges == 1   ? add<1, 2>(k, first, form)
      : edges == 2 ? add<2, 2>(k, first, form)
                   : add<3, 2>(k, first, form);
    }
  }

  /// For edge `k` of the leg. `form` is of the turning angles at the nodes from `first` on.
  template <int Edges, int Joints>
  void add(Index k, Index first, const Eigen::MatrixXd& form) {
    using Kernel = ArcStretch<Edges, Joints>;
    const bool from_start = Joints != 1 || first == 0;
    const int step = from_start ? 1 : -1;
    // Along the element.
    const Index first_angle = from_start ? first : first + Kernel::kAngles - 1;
    const Index first_node = from_start ? std::max<Index>(first - 1, 0) : cells_;
    typename Kernel::Constants c;
    c.EA = rod_.EA;
    c.rest_length = rod_.edge_length[to_size(leg_.first + k)];
    c.form = from_start ? form : Eigen::MatrixXd(form.reverse());
    c.edge = from_start ? k - first_node : first_node - 1 - k;
    c.elongation = rod_.natural_strain_entries.edge(leg_.first + k);
    std::array<Index, Kernel::kDofs> dofs{};
    for (int i = 0; i < Kernel::kNodes; ++i) {
      const Index node = rod_.node(leg_.first + first_node + step * i);
      for (int d = 0; d < 2; ++d) dofs[to_size(2 * i + d)] = model_.dof(node, d);
    }
    const auto enter_joint = [&](int number, const LegEnd& end) {
      dofs[to_size(2 * Kernel::kNodes + number)] = model_.dofs.rotation(end.rotation);
      c.direction[to_size(number)] = end.direction + (from_start ? 0.0 : kPi);
      c.driven.control[to_size(number)] = end.driven;
    };
    if constexpr (Joints > 0) enter_joint(0, from_start ? leg_.start : leg_.end);
    if constexpr (Joints == 2) enter_joint(1, leg_.end);
    auto& list = elements_of<Kernel>(*model_.elements);
    leg_.arcs.push_back({Edges, Joints, static_cast<Index>(list.size()), k, first_angle, step});
    list.add(dofs, c);
  }

  Leg& leg_;
  const RodMesh& rod_;
  Model& model_;
  Index cells_;
};

}  // namespace

void add_arc_elements(Leg& leg, const RodMesh& rod, Model& model) {
  ArcBuilder builder(leg, rod, model);
  if (builder.suits()) builder.add();
}

}  // namespace der
