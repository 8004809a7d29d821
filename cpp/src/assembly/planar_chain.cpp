#include "der/assembly/planar_chain.hpp"

#include <algorithm>

#include "der/core/index.hpp"
#include "der/core/loops.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/energies/stretch.hpp"

namespace der {
namespace {

/// The slope of an edge's energy by its vector e, and what the elements on both sides of a node
/// need of the edge.
struct EdgeTerms {
  Vec2 vector;             ///< [m]
  Vec2 turn;               ///< gradient of its direction angle [1/m]
  double inverse_squared;  ///< 1 / |e|^2
  StretchResponse stretch;

  EdgeTerms(const Stretch<2>::Constants& c, double elongation, const double* node)
      : vector(node[2] - node[0], node[3] - node[1]) {
    const double squared = vector.squaredNorm();
    const double length = std::sqrt(squared);
    inverse_squared = 1.0 / squared;
    turn = direction_gradient(vector, inverse_squared);
    stretch = stretch_response(c.EA, c.rest_length, elongation, length);
  }
};

/// A symmetric 2 x 2 matrix.
struct Symmetric {
  double xx = 0.0;
  double yx = 0.0;
  double yy = 0.0;
};

/// Second derivative of the energy by the vector of an edge; `moment` is the moment of the node at
/// its start less that at its end, `stiffness` the sum of the nodes' bending stiffnesses.
Symmetric edge_hessian(const EdgeTerms& edge, double moment, double stiffness) {
  const double w = edge.inverse_squared;
  const double along = (edge.stretch.along - edge.stretch.across) * w;
  const Vec2& e = edge.vector;
  const Vec2& d = edge.turn;
  const Mat2 bent = direction_hessian(e, d, w);
  return {
      along * e.x() * e.x() + edge.stretch.across + stiffness * d.x() * d.x() + moment * bent(0, 0),
      along * e.x() * e.y() + stiffness * d.x() * d.y() + moment * bent(1, 0),
      along * e.y() * e.y() + edge.stretch.across + stiffness * d.y() * d.y() +
          moment * bent(1, 1)};
}

template <class Curvature>
std::vector<ChainRun> find_runs(const Model& model) {
  return ChainRunFinder(elements_of<Stretch<2>>(*model.elements),
                        elements_of<PlanarBend<Curvature>>(*model.elements))
      .find();
}

}  // namespace

std::vector<PlanarChain> PlanarChain::find(const Model& model, const MatrixLayout& layout) {
  std::vector<PlanarChain> chains;
  for (const bool tangent : {false, true}) {
    const auto runs =
        tangent ? find_runs<TangentCurvature>(model) : find_runs<AngleCurvature>(model);
    for (const ChainRun& run : runs) {
      PlanarChain& chain = chains.emplace_back();
      chain.edges_ = run.edges;
      chain.bends_ = run.bends;
      chain.tangent_ = tangent;
      chain.actuated_ = run.actuated;
      chain.map_nodes(model, layout);
    }
  }
  return chains;
}

void PlanarChain::map_nodes(const Model& model, const MatrixLayout& layout) {
  first_dof_ = elements_of<Stretch<2>>(*model.elements).dofs[edges_.first][0];
  const Index end = first_dof_ + 2 * static_cast<Index>(edges_.count + 1);
  for (Index dof = first_dof_; dof < end; dof += 2) {
    NodeSlots& slots = slots_.emplace_back();
    std::size_t k = 0;
    for (Index other = dof; other < dof + 6; other += 2) {
      for (Index column = dof; column < dof + 2; ++column) {
        for (Index row = std::max(column, other); row < other + 2; ++row) {
          slots[k++] = layout.slot_or_spare(row < end ? model.dofs.free_index(row) : -1,
                                            model.dofs.free_index(column));
        }
      }
    }
  }
}

template <Derivatives D>
void PlanarChain::add(const Model& model, const Configuration& here, Vector& gradient,
                      double* values) const {
  if (tangent_) {
    add_measured<D, TangentCurvature>(model, here, gradient, values);
  } else {
    add_measured<D, AngleCurvature>(model, here, gradient, values);
  }
}

/// With F_j, B_j the first and second derivative by the vector of edge j and C_j that by the
/// vectors of edges j (rows) and j - 1: node j, at the start of edge j, has the gradient
/// F_{j-1} - F_j and, in its columns of the Hessian,
///   B_{j-1} + B_j - C_j - C_j',  then -B_j + C_j + C_{j+1},  then -C_{j+1}.
template <Derivatives D, class Curvature>
void PlanarChain::add_measured(const Model& model, const Configuration& here, Vector& gradient,
                               double* values) const {
  const auto* edge_constants =
      elements_of<Stretch<2>>(*model.elements).constants.data() + edges_.first;
  const auto* bend_constants =
      elements_of<PlanarBend<Curvature>>(*model.elements).constants.data() + bends_.first;
  const double* x = here.coordinates.data() + first_dof_;
  double* g = gradient.data() + first_dof_;

  const bool actuated = actuated_;
  const auto terms_of = [&](std::size_t j) {
    const auto& c = edge_constants[j];
    return EdgeTerms(c, actuated ? c.elongation.value(here.controls) : 0.0, x + 2 * j);
  };
  EdgeTerms edge = terms_of(0);
  BendResponse start;                // of the node at the start of the edge
  Vec2 force_before = Vec2::Zero();  // F_{j-1}
  Symmetric before;                  // B_{j-1}
  Mat2 from_before = Mat2::Zero();   // C_j
  for (std::size_t j = 0; j < edges_.count; ++j, g += 2) {
    const bool last = j + 1 == edges_.count;
    const EdgeTerms next = last ? edge : terms_of(j + 1);
    BendResponse end;
    if (!last) {
      const auto& c = bend_constants[j];
      const double natural = actuated ? c.natural(here.controls) : c.rest_kappa;
      end = bend_response<Curvature>(c.stiffness_per_length, natural,
                                     angle_between(edge.vector, next.vector));
    }
    const double moment = start.moment - end.moment;
    const Vec2 force = edge.stretch.across * edge.vector + moment * edge.turn;
    g[0] += force_before.x() - force.x();
    g[1] += force_before.y() - force.y();
    force_before = force;

    if constexpr (D == Derivatives::Hessian) {
      const Symmetric own = edge_hessian(edge, moment, start.stiffness + end.stiffness);
      const Mat2 to_next = -end.stiffness * next.turn * edge.turn.transpose();
      const Index* slot = slots_[j].data();
      values[slot[0]] += before.xx + own.xx - 2.0 * from_before(0, 0);
      values[slot[1]] += before.yx + own.yx - from_before(1, 0) - from_before(0, 1);
      values[slot[2]] += before.yy + own.yy - 2.0 * from_before(1, 1);
      values[slot[3]] += from_before(0, 0) + to_next(0, 0) - own.xx;
      values[slot[4]] += from_before(1, 0) + to_next(1, 0) - own.yx;
      values[slot[5]] += from_before(0, 1) + to_next(0, 1) - own.yx;
      values[slot[6]] += from_before(1, 1) + to_next(1, 1) - own.yy;
      for (int k = 0; k < 4; ++k) values[slot[7 + k]] -= to_next.data()[k];
      before = own;
      from_before = to_next;
    }
    edge = next;
    start = end;
  }
  g[0] += force_before.x();
  g[1] += force_before.y();
  if constexpr (D == Derivatives::Hessian) {
    const Index* slot = slots_.back().data();
    values[slot[0]] += before.xx;
    values[slot[1]] += before.yx;
    values[slot[2]] += before.yy;
  }
}

void PlanarChain::add_gradient(const Model& model, const Configuration& here,
                               Vector& gradient) const {
  run_loop([&] { add<Derivatives::Gradient>(model, here, gradient, nullptr); });
}

void PlanarChain::add_gradient_and_hessian(const Model& model, const Configuration& here,
                                           Vector& gradient, double* values) const {
  run_loop([&] { add<Derivatives::Hessian>(model, here, gradient, values); });
}

}  // namespace der
