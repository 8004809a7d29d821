#include "der/assembly/planar_chain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "der/core/index.hpp"
#include "der/core/loops.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/energies/stretch.hpp"

namespace der {
namespace {

using std::sqrt;  // of a double, beside that of lanes

/// The slope of an edge's energy by its vector e, and what the elements on both sides of a node
/// need of the edge.
template <class T>
struct EdgeTerms {
  Vector2<T> vector;  ///< [m]
  Vector2<T> turn;    ///< gradient of its direction angle [1/m]
  T inverse_squared;  ///< 1 / |e|^2
  StretchResponseOf<T> stretch;

  EdgeTerms(const Vector2<T>& e, const T& EA, const T& rest_length, const T& elongation)
      : vector(e) {
    const T squared = vector.squaredNorm();
    const T length = sqrt(squared);
    inverse_squared = 1.0 / squared;
    turn = direction_gradient<T>(vector, inverse_squared);
    stretch = stretch_response(EA, rest_length, elongation, length);
  }
};

/// A symmetric 2 x 2 matrix.
template <class T>
struct Symmetric {
  T xx = 0.0;
  T yx = 0.0;
  T yy = 0.0;
};

/// Second derivative of the energy by the vector of an edge; `moment` is the moment of the node at
/// its start less that at its end, `stiffness` the sum of the nodes' bending stiffnesses.
template <class T>
Symmetric<T> edge_hessian(const EdgeTerms<T>& edge, const T& moment, const T& stiffness) {
  const T w = edge.inverse_squared;
  const T along = (edge.stretch.along - edge.stretch.across) * w;
  const Vector2<T>& e = edge.vector;
  const Vector2<T>& d = edge.turn;
  const Eigen::Matrix<T, 2, 2> bent = direction_hessian<T>(e, d, w);
  return {
      along * e.x() * e.x() + edge.stretch.across + stiffness * d.x() * d.x() + moment * bent(0, 0),
      along * e.x() * e.y() + stiffness * d.x() * d.y() + moment * bent(1, 0),
      along * e.y() * e.y() + edge.stretch.across + stiffness * d.y() * d.y() +
          moment * bent(1, 1)};
}

/// Second derivative of the energy of the joint between two edges by the vector of `next` (rows)
/// and that of `edge`.
template <class T>
Eigen::Matrix<T, 2, 2> coupling(const EdgeTerms<T>& edge, const EdgeTerms<T>& next,
                                const BendResponseOf<T>& joint) {
  return -joint.stiffness * next.turn * edge.turn.transpose();
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
  const Totals totals{gradient, values};
  in_spans(edges_.count, [&](const auto& spans) {
    if (tangent_) {
      add_in<D, TangentCurvature>(spans, model, here, totals);
    } else {
      add_in<D, AngleCurvature>(spans, model, here, totals);
    }
  });
}

/// Adds in each lane its edges, with their part of the bending at both their ends. With F_j, B_j
/// the first and second derivative by the vector of edge j and C_j that by the vectors of edges j
/// (rows) and j - 1: node j, at the start of edge j, has the gradient F_{j-1} - F_j and, in its
/// columns of the Hessian,
///   B_{j-1} + B_j - C_j - C_j',  then -B_j + C_j + C_{j+1},  then -C_{j+1}.
template <Derivatives D, class Curvature, class T>
void PlanarChain::add_in(const LaneSpans<T>& spans, const Model& model, const Configuration& here,
                         const Totals& totals) const {
  constexpr bool with_hessian = D == Derivatives::Hessian;
  using Lane = LaneTraits<T>;
  using Block = Eigen::Matrix<T, 2, 2>;
  // One lane has the whole chain, which does not bend beyond its ends.
  constexpr bool is_whole = Lane::kCount == 1;
  const auto* stretches = elements_of<Stretch<2>>(*model.elements).constants.data() + edges_.first;
  const auto* bends =
      elements_of<PlanarBend<Curvature>>(*model.elements).constants.data() + bends_.first;
  const double* x = here.coordinates.data() + first_dof_;
  const std::ptrdiff_t last = static_cast<std::ptrdiff_t>(edges_.count) - 1;

  // Edges `j` places after the first of each lane; for those beyond the chain's ends, where nothing
  // bends, its outermost.
  const auto edge_at = [&](std::ptrdiff_t j) {
    const auto number = [&](int lane) {
      return std::clamp<std::ptrdiff_t>(spans.edge(lane, j), 0, last);
    };
    const auto component = [&](int c) {
      return in_lanes<T>([&](int lane) {
        const double* node = x + 2 * number(lane);
        return node[c + 2] - node[c];
      });
    };
    T elongation = 0.0;
    if (actuated_) {
      elongation = in_lanes<T>(
          [&](int lane) { return stretches[number(lane)].elongation.value(here.controls); });
    }
    return EdgeTerms<T>({component(0), component(1)},
                        in_lanes<T>([&](int lane) { return stretches[number(lane)].EA; }),
                        in_lanes<T>([&](int lane) { return stretches[number(lane)].rest_length; }),
                        elongation);
  };
  const auto joint_after = [&](std::ptrdiff_t j, const EdgeTerms<T>& edge,
                               const EdgeTerms<T>& next) {
    const auto constants = [&](int lane) -> const auto& {
      return bends[std::clamp<std::ptrdiff_t>(spans.edge(lane, j), 0, last - 1)];
    };
    const T natural = in_lanes<T>([&](int lane) {
      const auto& c = constants(lane);
      return actuated_ ? c.natural(here.controls) : c.rest_kappa;
    });
    const T stiffness = in_lanes<T>([&](int lane) {
      const std::ptrdiff_t joint = spans.edge(lane, j);
      return joint >= 0 && joint < last ? constants(lane).stiffness_per_length : 0.0;
    });
    return bend_response<Curvature>(stiffness, natural, angle_between<T>(edge.vector, next.vector));
  };
  const auto add_force = [&](int lane, std::ptrdiff_t j, const Vector2<T>& force) {
    double* g = totals.gradient.data() + first_dof_ + 2 * spans.edge(lane, j);
    g[0] += Lane::lane(force.x(), lane);
    g[1] += Lane::lane(force.y(), lane);
  };

  EdgeTerms<T> edge = edge_at(0);
  BendResponseOf<T> start;                       // of the node at the start of the edge
  Vector2<T> force_before = Vector2<T>::Zero();  // F_{j-1}
  Symmetric<T> before;                           // B_{j-1}
  Block from_before = Block::Zero();             // C_j
  if constexpr (!is_whole) {
    const EdgeTerms<T> previous = edge_at(-1);
    start = joint_after(-1, previous, edge);
    from_before = coupling(previous, edge, start);
  }
  // The node behind the last edge of a lane, `j` places after its first.
  const auto add_last_node = [&](int lane, std::ptrdiff_t j) {
    add_force(lane, j, force_before);
    if constexpr (with_hessian) {
      const NodeSlots& slot = slots_[static_cast<std::size_t>(spans.edge(lane, j))];
      totals.values[slot[0]] += Lane::lane(before.xx, lane);
      totals.values[slot[1]] += Lane::lane(before.yx, lane);
      totals.values[slot[2]] += Lane::lane(before.yy, lane);
    }
  };

  for (std::ptrdiff_t j = 0; j < spans.count; ++j) {
    const int lanes = spans.lanes_with(j);
    for (int lane = lanes; lane < Lane::kCount; ++lane) add_last_node(lane, j);
    const bool is_last = is_whole && j == last;
    const EdgeTerms<T> next = is_last ? edge : edge_at(j + 1);
    BendResponseOf<T> end;
    if (!is_last) end = joint_after(j, edge, next);
    const T moment = start.moment - end.moment;
    const Vector2<T> force = edge.stretch.across * edge.vector + moment * edge.turn;
    const Vector2<T> force_at_node = force_before - force;
    for_each_lane<T>(lanes, [&](int lane) { add_force(lane, j, force_at_node); });
    force_before = force;

    if constexpr (with_hessian) {
      const Symmetric<T> own = edge_hessian<T>(edge, moment, start.stiffness + end.stiffness);
      const Block to_next = coupling(edge, next, end);
      const std::array<T, std::tuple_size_v<NodeSlots>> entries{
          before.xx + own.xx - 2.0 * from_before(0, 0),
          before.yx + own.yx - from_before(1, 0) - from_before(0, 1),
          before.yy + own.yy - 2.0 * from_before(1, 1),
          from_before(0, 0) + to_next(0, 0) - own.xx,
          from_before(1, 0) + to_next(1, 0) - own.yx,
          from_before(0, 1) + to_next(0, 1) - own.yx,
          from_before(1, 1) + to_next(1, 1) - own.yy,
          -to_next(0, 0),
          -to_next(1, 0),
          -to_next(0, 1),
          -to_next(1, 1)};
      for_each_lane<T>(lanes, [&](int lane) {
        const NodeSlots& slot = slots_[static_cast<std::size_t>(spans.edge(lane, j))];
        for (std::size_t k = 0; k < entries.size(); ++k) {
          totals.values[slot[k]] += Lane::lane(entries[k], lane);
        }
      });
      before = own;
      from_before = to_next;
    }
    edge = next;
    start = end;
  }
  for (int lane = 0; lane < spans.longer; ++lane) add_last_node(lane, spans.count);
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
