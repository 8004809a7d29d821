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

  EdgeTerms(const Vector2<T>& e, const Stretch<2>::Values<T>& values) : vector(e) {
    const T squared = vector.squaredNorm();
    const T length = sqrt(squared);
    inverse_squared = 1.0 / squared;
    turn = direction_gradient<T>(vector, inverse_squared);
    stretch = Stretch<2>::response<T>(values, length);
  }
};

/// Entries of the Hessian in the columns of a node, in the order of PlanarChain::NodeSlots.
template <class T>
using NodeEntries = std::array<T, std::tuple_size_v<PlanarChain::NodeSlots>>;

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

/// Second derivative of the energy of the vertex between two edges by the vector of `next` (rows)
/// and that of `edge`.
template <class T>
Eigen::Matrix<T, 2, 2> coupling(const EdgeTerms<T>& edge, const EdgeTerms<T>& next,
                                const BendResponseOf<T>& vertex) {
  return -vertex.stiffness * next.turn * edge.turn.transpose();
}

/// Slope of the energy by the vector of an edge.
template <class T>
Vector2<T> edge_force(const EdgeTerms<T>& edge, const T& moment) {
  return edge.stretch.across * edge.vector + moment * edge.turn;
}

/// A chain in the lanes of a number type, for `add_chain`:
///   Number                      the number type
///   kIsWhole                    whether the lanes' first edge is that of the chain
///   count()                     number of edges of the longest lane
///   edge(j), edge_before()      edge `j` of each lane, and the one before edge 0
///   vertex(j, edge, next)        response of the vertex behind edge j; zero beyond the chain's
///   ends last_is_shorter()           whether the lane that has the chain's end lacks the last edge
///   add_force, add_entries      add to the node at the start of edge j
///   add_end(force, block)       adds to the node at the end of the chain
/// The lanes hold parts of one rod:
template <class Curvature, class T>
class RodParts {
 public:
  using Number = T;
  static constexpr bool kIsWhole = LaneTraits<T>::kCount == 1;

  RodParts(const LaneSpans<T>& spans, const Model& model, const PlanarChain& chain,
           const Configuration& here, Vector& gradient, double* values)
      : spans_(spans),
        chain_(chain),
        stretches_(elements_of<Stretch<2>>(*model.elements).constants.data() + chain.edges().first),
        bends_(elements_of<PlanarBend<Curvature>>(*model.elements).constants.data() +
               chain.bends().first),
        controls_(here.controls),
        x_(here.coordinates.data() + chain.first_dof()),
        gradient_(gradient.data() + chain.first_dof()),
        values_(values) {}

  [[nodiscard]] std::ptrdiff_t count() const { return spans_.count; }
  [[nodiscard]] bool last_is_shorter() const { return spans_.longer < LaneTraits<T>::kCount; }

  /// Beyond the ends of the chain, where nothing bends, its outermost edge.
  [[nodiscard]] EdgeTerms<T> edge(std::ptrdiff_t j) const {
    const auto constant = [&](double Stretch<2>::Constants::* member) {
      return in_lanes<T>([&](int lane) { return stretches_[number(lane, j)].*member; });
    };
    T elongation = 0.0;
    if (chain_.is_actuated()) {
      elongation = in_lanes<T>(
          [&](int lane) { return stretches_[number(lane, j)].elongation.value(controls_); });
    }
    const T rest_length = constant(&Stretch<2>::Constants::rest_length);
    return EdgeTerms<T>(
        {component(j, 0), component(j, 1)},
        {constant(&Stretch<2>::Constants::EA) / rest_length, rest_length, elongation});
  }
  /// Without a force where there is none.
  [[nodiscard]] EdgeTerms<T> edge_before() const {
    EdgeTerms<T> edge = this->edge(-1);
    const T exists = in_lanes<T>([&](int lane) { return spans_.edge(lane, -1) < 0 ? 0.0 : 1.0; });
    edge.stretch.along *= exists;
    edge.stretch.across *= exists;
    return edge;
  }
  [[nodiscard]] BendResponseOf<T> vertex(std::ptrdiff_t j, const EdgeTerms<T>& edge,
                                         const EdgeTerms<T>& next) const {
    const auto constants = [&](int lane) -> const auto& {
      return bends_[std::clamp<std::ptrdiff_t>(spans_.edge(lane, j), 0, last() - 1)];
    };
    const T natural = in_lanes<T>([&](int lane) {
      const auto& c = constants(lane);
      return chain_.is_actuated() ? c.natural(controls_) : c.rest_kappa;
    });
    const T stiffness = in_lanes<T>([&](int lane) {
      const std::ptrdiff_t vertex = spans_.edge(lane, j);
      return vertex >= 0 && vertex < last() ? constants(lane).stiffness_per_length : 0.0;
    });
    return bend_response<Curvature>(stiffness, natural, angle_between<T>(edge.vector, next.vector));
  }

  void add_force(std::ptrdiff_t j, const Vector2<T>& force) const {
    for_each_lane<T>(spans_.lanes_with(j), [&](int lane) {
      double* g = gradient_ + 2 * spans_.edge(lane, j);
      g[0] += LaneTraits<T>::lane(force.x(), lane);
      g[1] += LaneTraits<T>::lane(force.y(), lane);
    });
  }
  void add_entries(std::ptrdiff_t j, const NodeEntries<T>& entries) const {
    for_each_lane<T>(spans_.lanes_with(j), [&](int lane) {
      const PlanarChain::NodeSlots& slot = chain_.slots(spans_.edge(lane, j));
      for (std::size_t k = 0; k < entries.size(); ++k) {
        values_[slot[k]] += LaneTraits<T>::lane(entries[k], lane);
      }
    });
  }
  void add_end(const Vector2<T>& force, const Symmetric<T>& block) const {
    constexpr int lane = LaneTraits<T>::kCount - 1;
    double* g = gradient_ + 2 * (last() + 1);
    g[0] += LaneTraits<T>::lane(force.x(), lane);
    g[1] += LaneTraits<T>::lane(force.y(), lane);
    if (values_ == nullptr) return;
    const PlanarChain::NodeSlots& slot = chain_.slots(last() + 1);
    values_[slot[0]] += LaneTraits<T>::lane(block.xx, lane);
    values_[slot[1]] += LaneTraits<T>::lane(block.yx, lane);
    values_[slot[2]] += LaneTraits<T>::lane(block.yy, lane);
  }

 private:
  [[nodiscard]] std::ptrdiff_t last() const {
    return static_cast<std::ptrdiff_t>(chain_.edges().count) - 1;
  }
  [[nodiscard]] std::ptrdiff_t number(int lane, std::ptrdiff_t j) const {
    return std::clamp<std::ptrdiff_t>(spans_.edge(lane, j), 0, last());
  }
  [[nodiscard]] T component(std::ptrdiff_t j, int c) const {
    return in_lanes<T>([&](int lane) {
      const double* node = x_ + 2 * number(lane, j);
      return node[c + 2] - node[c];
    });
  }

  const LaneSpans<T>& spans_;
  const PlanarChain& chain_;
  const Stretch<2>::Constants* stretches_;
  const typename PlanarBend<Curvature>::Constants* bends_;
  const Vector& controls_;
  const double* x_;
  double* gradient_;
  double* values_;
};

/// The lanes hold the same chain of several members.
template <class Curvature, class T>
class MemberChains {
 public:
  using Number = T;
  static constexpr bool kIsWhole = true;

  MemberChains(const PlanarChain& chain, const PlanarChainConstants<T>& constants, const T* x,
               T* gradient, T* values)
      : chain_(chain),
        constants_(constants),
        x_(x + chain.first_dof()),
        gradient_(gradient + chain.first_dof()),
        values_(values) {}

  [[nodiscard]] std::ptrdiff_t count() const { return constants_.along.size(); }
  [[nodiscard]] static bool last_is_shorter() { return false; }
  [[nodiscard]] EdgeTerms<T> edge(std::ptrdiff_t j) const {
    const T* node = x_ + 2 * j;
    return EdgeTerms<T>({node[2] - node[0], node[3] - node[1]},
                        {constants_.along[j], constants_.rest_length[j], 0.0});
  }
  [[nodiscard]] BendResponseOf<T> vertex(std::ptrdiff_t j, const EdgeTerms<T>& edge,
                                         const EdgeTerms<T>& next) const {
    return bend_response<Curvature>(constants_.bend_stiffness[j], constants_.rest_kappa[j],
                                    angle_between<T>(edge.vector, next.vector));
  }
  void add_force(std::ptrdiff_t j, const Vector2<T>& force) const {
    gradient_[2 * j] += force.x();
    gradient_[2 * j + 1] += force.y();
  }
  void add_entries(std::ptrdiff_t j, const NodeEntries<T>& entries) const {
    const PlanarChain::NodeSlots& slot = chain_.slots(j);
    for (std::size_t k = 0; k < entries.size(); ++k) values_[slot[k]] += entries[k];
  }
  void add_end(const Vector2<T>& force, const Symmetric<T>& block) const {
    add_force(count(), force);
    if (values_ == nullptr) return;
    const PlanarChain::NodeSlots& slot = chain_.slots(count());
    values_[slot[0]] += block.xx;
    values_[slot[1]] += block.yx;
    values_[slot[2]] += block.yy;
  }

 private:
  const PlanarChain& chain_;
  const PlanarChainConstants<T>& constants_;
  const T* x_;
  T* gradient_;
  T* values_;
};

/// Adds in each lane its edges and the nodes at their starts. With F_j, B_j the first and second
/// derivative by the vector of edge j and C_j that by the vectors of edges j (rows) and j - 1: node
/// j, at the start of edge j, has the gradient F_{j-1} - F_j and, in its columns of the Hessian,
///   B_{j-1} + B_j - C_j - C_j',  then -B_j + C_j + C_{j+1},  then -C_{j+1}.
/// The sums do not depend, to the last bit, on how a chain is shared out to lanes.
template <Derivatives D, class Parts>
void add_chain(const Parts& parts) {
  constexpr bool with_hessian = D == Derivatives::Hessian;
  using T = typename Parts::Number;
  using Block = Eigen::Matrix<T, 2, 2>;

  EdgeTerms<T> edge = parts.edge(0);
  BendResponseOf<T> start;                       // of the node at the start of the edge
  Vector2<T> force_before = Vector2<T>::Zero();  // F_{j-1}
  Symmetric<T> before;                           // B_{j-1}
  Block from_before = Block::Zero();             // C_j
  if constexpr (!Parts::kIsWhole) {
    const EdgeTerms<T> previous = parts.edge_before();
    const BendResponseOf<T> outer = parts.vertex(-2, parts.edge(-2), previous);
    start = parts.vertex(-1, previous, edge);
    const T moment = outer.moment - start.moment;
    force_before = edge_force(previous, moment);
    if constexpr (with_hessian) {
      before = edge_hessian<T>(previous, moment, outer.stiffness + start.stiffness);
      from_before = coupling(previous, edge, start);
    }
  }

  const std::ptrdiff_t count = parts.count();
  for (std::ptrdiff_t j = 0; j < count; ++j) {
    const bool is_last = j + 1 == count;
    if (is_last && parts.last_is_shorter()) parts.add_end(force_before, before);
    const bool is_end = Parts::kIsWhole && is_last;
    const EdgeTerms<T> next = is_end ? edge : parts.edge(j + 1);
    BendResponseOf<T> end;
    if (!is_end) end = parts.vertex(j, edge, next);
    const T moment = start.moment - end.moment;
    const Vector2<T> force = edge_force(edge, moment);
    parts.add_force(j, force_before - force);
    force_before = force;

    if constexpr (with_hessian) {
      const Symmetric<T> own = edge_hessian<T>(edge, moment, start.stiffness + end.stiffness);
      const Block to_next = coupling(edge, next, end);
      parts.add_entries(
          j,
          {before.xx + own.xx - 2.0 * from_before(0, 0),
           before.yx + own.yx - from_before(1, 0) - from_before(0, 1),
           before.yy + own.yy - 2.0 * from_before(1, 1), from_before(0, 0) + to_next(0, 0) - own.xx,
           from_before(1, 0) + to_next(1, 0) - own.yx, from_before(0, 1) + to_next(0, 1) - own.yx,
           from_before(1, 1) + to_next(1, 1) - own.yy, -to_next(0, 0), -to_next(1, 0),
           -to_next(0, 1), -to_next(1, 1)});
      before = own;
      from_before = to_next;
    }
    edge = next;
    start = end;
  }
  if (!parts.last_is_shorter()) parts.add_end(force_before, before);
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
  in_spans(edges_.count, [&](const auto& spans) {
    using T = typename std::decay_t<decltype(spans)>::Number;
    if (tangent_) {
      add_chain<D>(RodParts<TangentCurvature, T>(spans, model, *this, here, gradient, values));
    } else {
      add_chain<D>(RodParts<AngleCurvature, T>(spans, model, *this, here, gradient, values));
    }
  });
}

void PlanarChain::add_gradient(const Model& model, const Configuration& here,
                               Vector& gradient) const {
  dispatch_simd([&] { add<Derivatives::Gradient>(model, here, gradient, nullptr); });
}

void PlanarChain::add_gradient_and_hessian(const Model& model, const Configuration& here,
                                           Vector& gradient, double* values) const {
  dispatch_simd([&] { add<Derivatives::Hessian>(model, here, gradient, values); });
}

template <class T>
PlanarChainConstants<T> PlanarChain::constants_of(const MemberModels<T>& models) const {
  PlanarChainConstants<T> constants;
  const auto set = [&](MemberVector<T>& all, std::size_t count, const auto& value) {
    all.resize(static_cast<Index>(count));
    for (std::size_t i = 0; i < count; ++i) {
      all[static_cast<Index>(i)] =
          in_lanes<T>([&](int lane) { return value(*models[to_size(lane)]->elements, i); });
    }
  };
  const auto edge = [&](double Stretch<2>::Constants::* member) {
    return [this, member](const ElementLists& elements, std::size_t i) {
      return elements_of<Stretch<2>>(elements).constants[edges_.first + i].*member;
    };
  };
  set(constants.along, edges_.count, [&](const ElementLists& elements, std::size_t i) {
    const auto& c = elements_of<Stretch<2>>(elements).constants[edges_.first + i];
    return c.EA / c.rest_length;
  });
  set(constants.rest_length, edges_.count, edge(&Stretch<2>::Constants::rest_length));
  const auto set_bends = [&](auto curvature) {
    using Bend = PlanarBend<decltype(curvature)>;
    const auto bend = [&](double Bend::Constants::* member) {
      return [this, member](const ElementLists& elements, std::size_t i) {
        return elements_of<Bend>(elements).constants[bends_.first + i].*member;
      };
    };
    set(constants.bend_stiffness, bends_.count, bend(&Bend::Constants::stiffness_per_length));
    set(constants.rest_kappa, bends_.count, bend(&Bend::Constants::rest_kappa));
  };
  if (tangent_) {
    set_bends(TangentCurvature{});
  } else {
    set_bends(AngleCurvature{});
  }
  return constants;
}

template <Derivatives D, class T>
void PlanarChain::add_members(const PlanarChainConstants<T>& constants, const T* coordinates,
                              T* gradient, T* values) const {
  run_member_loop<T>([&] {
    if (tangent_) {
      add_chain<D>(
          MemberChains<TangentCurvature, T>(*this, constants, coordinates, gradient, values));
    } else {
      add_chain<D>(
          MemberChains<AngleCurvature, T>(*this, constants, coordinates, gradient, values));
    }
  });
}

// NOLINTBEGIN(bugprone-macro-parentheses): the argument is a type
#define DER_INSTANTIATE(T)                                                                      \
  template PlanarChainConstants<T> PlanarChain::constants_of(const MemberModels<T>&) const;     \
  template void PlanarChain::add_members<Derivatives::Gradient>(const PlanarChainConstants<T>&, \
                                                                const T*, T*, T*) const;        \
  template void PlanarChain::add_members<Derivatives::Hessian>(const PlanarChainConstants<T>&,  \
                                                               const T*, T*, T*) const;
// NOLINTEND(bugprone-macro-parentheses)
DER_FOR_MEMBER_LANES(DER_INSTANTIATE)
#undef DER_INSTANTIATE

}  // namespace der
