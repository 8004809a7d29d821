#include "der/assembly/spatial_chain.hpp"

#include <algorithm>

#include "der/core/index.hpp"
#include "der/core/loops.hpp"
#include "der/energies/elements_of.hpp"

namespace der {
namespace {

// The terms of a chain: what the loop over its edges needs of the energies, in the lanes of the
// number type `Number`.
//   kSize                       variables of an edge: its vector, and its angle if it has one
//   Bend                        the kernel of its joints
//   Edge                        an edge at a configuration
//   joint(..)                   response of the joint between two edges
//   scale(response, factor)     the response of a joint that counts `factor` times
//   force(edge, start, end)     slope of the energy of two joints by the edge's variables
//   own(edge, start, end)       second derivative likewise
//   coupling(edge, next, joint) second derivative by the variables of `next` (rows) and `edge`

/// Rods whose sections count.
template <class Curvature, class T>
struct Sections {
  using Number = T;
  static constexpr int kSize = 4;
  using Bend = SpatialBend<Curvature>;
  using Variables = Eigen::Matrix<T, 4, 1>;
  using Block = Eigen::Matrix<T, 4, 4>;
  using Response = JointResponseOf<T>;

  struct Edge {
    EdgeFrameOf<T> frame;
    typename EdgeFrameOf<T>::Rotation rotation;
    T theta;
    T length;
    Vector3<T> tangent;

    Edge(const Vector3<T>& vector, const T& angle, const Vector3<T>& source,
         const Vector3<T>& director)
        : frame(vector, angle, source, director),
          rotation(frame.rotation()),
          theta(angle),
          length(frame.length),
          tangent(frame.frame.tangent) {}
  };

  /// `constants(lane)` is the joint of a lane.
  template <bool with_stiffness, class Constants>
  static Response joint(const Constants& constants, const Edge& edge, const Edge& next,
                        const Vector& values, bool actuated) {
    const auto each = [&](auto member) {
      return in_lanes<T>([&](int lane) { return member(constants(lane)); });
    };
    using C = typename Bend::Constants;
    JointOf<T> joint{each([](const C& c) { return c.joint.bend_1; }),
                     each([](const C& c) { return c.joint.bend_2; }),
                     each([](const C& c) { return c.joint.twist; }),
                     {each([](const C& c) { return c.joint.rest.kappa_1; }),
                      each([](const C& c) { return c.joint.rest.kappa_2; }),
                      each([](const C& c) { return c.joint.rest.twist; })}};
    if (actuated) {
      joint.rest.kappa_1 += each([&](const C& c) { return c.actuated.strain(values).kappa_1; });
      joint.rest.kappa_2 += each([&](const C& c) { return c.actuated.strain(values).kappa_2; });
      joint.rest.twist += each([&](const C& c) { return c.actuated.strain(values).twist; });
    }
    const T reference = each([&](const C& c) { return values[c.after.twist_at_start()]; });
    const T twist =
        whole_twist<T>(edge.frame.frame, next.frame.frame, edge.theta, next.theta, reference);
    Response response;
    JointKinematics<Curvature, T>(edge.frame.frame, next.frame.frame, twist)
        .template respond<with_stiffness>(joint, response);
    return response;
  }
  static void scale(Response& response, const T& factor) {
    response.moment *= factor;
    response.stiffness *= factor;
  }
  static Variables force(const Edge& edge, const Response& start, const Response& end) {
    return edge.rotation.transpose() * (start.moment - end.moment);
  }
  static Block own(const Edge& edge, const Response& start, const Response& end) {
    const Matrix3<T> stiffness = start.stiffness + end.stiffness;
    const typename EdgeFrameOf<T>::Rotation turned = stiffness * edge.rotation;
    return edge.rotation.transpose() * turned +
           edge.frame.geometric_stiffness(start.moment - end.moment);
  }
  static Block coupling(const Edge& edge, const Edge& next, const Response& joint) {
    const Matrix3<T> stiffness = -(joint.stiffness + cross_matrix<T>(0.5 * joint.moment));
    const typename EdgeFrameOf<T>::Rotation turned = stiffness * edge.rotation;
    return next.rotation.transpose() * turned;
  }
};

/// Rods whose sections do not count.
template <class Curvature, class T>
struct Tangents {
  using Number = T;
  static constexpr int kSize = 3;
  using Bend = IsotropicBend<Curvature>;
  using Variables = Vector3<T>;
  using Block = Matrix3<T>;
  struct Response {
    IsotropicResponse<T> bend;
    T cosine = 0.0;
    Vector3<T> by_before = Vector3<T>::Zero();  ///< of the cosine, by the edge before [1/m]
    Vector3<T> by_after = Vector3<T>::Zero();
  };
  using Edge = TangentTermOf<T>;

  template <bool with_stiffness, class Constants>
  static Response joint(const Constants& constants, const Edge& edge, const Edge& next,
                        const Vector& /*values*/, bool /*actuated*/) {
    const T stiffness = in_lanes<T>([&](int lane) { return constants(lane).stiffness_per_length; });
    Response response;
    response.cosine = edge.tangent.dot(next.tangent);
    response.bend = isotropic_response<Curvature>(stiffness, response.cosine);
    response.by_before = edge.first(next.tangent, response.cosine);
    response.by_after = next.first(edge.tangent, response.cosine);
    return response;
  }
  static void scale(Response& response, const T& factor) {
    response.bend.slope *= factor;
    response.bend.curvature *= factor;
  }
  static Variables force(const Edge& /*edge*/, const Response& start, const Response& end) {
    return start.bend.slope * start.by_after + end.bend.slope * end.by_before;
  }
  static Block own(const Edge& edge, const Response& start, const Response& end) {
    const auto half = [&](const Response& joint, const Vector3<T>& by_edge) -> Block {
      return joint.bend.curvature * by_edge * by_edge.transpose() +
             joint.bend.slope * edge.second(by_edge, joint.cosine);
    };
    return half(start, start.by_after) + half(end, end.by_before);
  }
  static Block coupling(const Edge& edge, const Edge& next, const Response& joint) {
    return joint.bend.curvature * joint.by_after * joint.by_before.transpose() +
           joint.bend.slope * (next.across() * edge.across());
  }
};

/// Hands the entries of the columns of node j to `add`, one after the other: B_j, B_{j-1} by the
/// vector, C_j and C_{j+1} (SpatialChain::add_in).
template <class Terms, class Add>
void add_columns(const typename Terms::Block& own, const Matrix3<typename Terms::Number>& before,
                 const typename Terms::Block& from_before, const typename Terms::Block& to_next,
                 Add&& add) {
  using T = typename Terms::Number;
  constexpr int size = Terms::kSize;
  for (int column = 0; column < size; ++column) {
    const bool by_angle = column == 3;
    // The node's own position and angle.
    for (int row = column; row < size; ++row) {
      T entry = own(row, column);
      if (row < 3) {
        entry += before(row, column) - from_before(row, column) - from_before(column, row);
      } else if (!by_angle) {
        entry = from_before(row, column) - entry;
      }
      add(entry);
    }
    // The next node.
    for (int row = 0; row < size; ++row) {
      T entry = to_next(row, column);
      if (by_angle) {
        if (row < 3) entry = own(row, column) - entry;
      } else {
        entry = row < 3 ? entry + from_before(row, column) - own(row, column) : -entry;
      }
      add(entry);
    }
    // The position of the node after that.
    for (int row = 0; row < 3; ++row) {
      add(by_angle ? to_next(row, column) : -to_next(row, column));
    }
  }
}

}  // namespace

std::vector<SpatialChain> SpatialChain::find(const Model& model, const MatrixLayout& layout) {
  std::vector<SpatialChain> chains;
  const auto find = [&](Kind kind, auto bend) {
    const auto& bends = elements_of<decltype(bend)>(*model.elements);
    const auto runs = ChainRunFinder(elements_of<Stretch<3>>(*model.elements), bends).find();
    for (const ChainRun& run : runs) {
      SpatialChain& chain = chains.emplace_back();
      chain.kind_ = kind;
      chain.edges_ = run.edges;
      chain.bends_ = run.bends;
      if constexpr (decltype(bend)::kDofs > 9) {
        chain.first_theta_ = bends.dofs[run.bends.first][9];
      }
      chain.actuated_ = run.actuated;
      chain.map_nodes(model, layout);
    }
  };
  find(Kind::SectionAngle, SpatialBend<AngleCurvature>{});
  find(Kind::SectionTangent, SpatialBend<TangentCurvature>{});
  find(Kind::IsotropicAngle, IsotropicBend<AngleCurvature>{});
  find(Kind::IsotropicTangent, IsotropicBend<TangentCurvature>{});
  return chains;
}

void SpatialChain::map_nodes(const Model& model, const MatrixLayout& layout) {
  first_dof_ = elements_of<Stretch<3>>(*model.elements).dofs[edges_.first][0];
  const auto nodes = static_cast<Index>(edges_.count) + 1;
  const int size = first_theta_ < 0 ? 3 : 4;
  // Place in the order of elimination of the variables of a node of the chain; -1: none.
  const auto place = [&](Index node, int variable) {
    if (node >= nodes) return -1;
    if (variable < 3) return model.dofs.free_index(first_dof_ + 3 * node + variable);
    return node + 1 < nodes ? model.dofs.free_index(first_theta_ + node) : -1;
  };
  for (Index node = 0; node < nodes; ++node) {
    NodeSlots& slots = slots_.emplace_back();
    std::size_t k = 0;
    for (int column = 0; column < size; ++column) {
      for (const Index other : {node, node + 1, node + 2}) {
        const int rows = other == node + 2 ? 3 : size;
        for (int row = other == node ? column : 0; row < rows; ++row) {
          slots[k++] = layout.slot_or_spare(place(other, row), place(node, column));
        }
      }
    }
  }
}

template <Derivatives D>
void SpatialChain::add(const Model& model, const Configuration& here, Vector& gradient,
                       double* values) const {
  const Totals totals{gradient, values};
  switch (kind_) {
    case Kind::SectionAngle:
      return add_measured<D, Sections, AngleCurvature>(model, here, totals);
    case Kind::SectionTangent:
      return add_measured<D, Sections, TangentCurvature>(model, here, totals);
    case Kind::IsotropicAngle:
      return add_measured<D, Tangents, AngleCurvature>(model, here, totals);
    case Kind::IsotropicTangent:
      return add_measured<D, Tangents, TangentCurvature>(model, here, totals);
  }
}

template <Derivatives D, template <class, class> class Terms, class Curvature>
void SpatialChain::add_measured(const Model& model, const Configuration& here,
                                const Totals& totals) const {
  in_spans(edges_.count, [&](const auto& spans) {
    using Number = typename std::decay_t<decltype(spans)>::Number;
    add_in<D, Terms<Curvature, Number>>(spans, model, here, totals);
  });
}

/// Adds in each lane its edges, with their part of the joints at both their ends. With F_j, B_j the
/// first and second derivative by the variables of edge j, its vector e and its angle, and C_j that
/// by the variables of edges j (rows) and j - 1: node j, at the start of edge j, has the gradient
/// F_{j-1} - F_j in its position, and in its columns of the Hessian
///   B_{j-1} + B_j - C_j - C_j',  then -B_j + C_j + C_{j+1},  then -C_{j+1}.
/// The angle of edge j does not enter at the edge's other end.
template <Derivatives D, class Terms>
void SpatialChain::add_in(const LaneSpans<typename Terms::Number>& spans, const Model& model,
                          const Configuration& here, const Totals& totals) const {
  constexpr bool with_hessian = D == Derivatives::Hessian;
  constexpr int size = Terms::kSize;
  using T = typename Terms::Number;
  using Lane = LaneTraits<T>;
  using EdgeTerms = typename Terms::Edge;
  using Block = typename Terms::Block;
  using Response = typename Terms::Response;
  // One lane has the whole chain, which has no joints beyond its ends.
  constexpr bool is_whole = Lane::kCount == 1;
  const auto* stretches = elements_of<Stretch<3>>(*model.elements).constants.data() + edges_.first;
  const auto* bends =
      elements_of<typename Terms::Bend>(*model.elements).constants.data() + bends_.first;
  const double* x = here.coordinates.data() + first_dof_;
  const std::ptrdiff_t last = static_cast<std::ptrdiff_t>(edges_.count) - 1;

  // Edges `j` places after the first of each lane; for those beyond the chain's ends, whose joints
  // count nothing, its outermost.
  const auto number = [&](int lane, std::ptrdiff_t j) {
    return std::clamp<std::ptrdiff_t>(spans.edge(lane, j), 0, last);
  };
  const auto edge_at = [&](std::ptrdiff_t j) {
    const auto component = [&](int c) {
      return in_lanes<T>([&](int lane) {
        const double* node = x + 3 * number(lane, j);
        return node[c + 3] - node[c];
      });
    };
    const Vector3<T> e{component(0), component(1), component(2)};
    if constexpr (size == 4) {
      const auto followed = [&](Index entry) {
        return in_lanes<T>([&](int lane) {
          const std::ptrdiff_t edge = number(lane, j);
          const FrameBlock& block = edge == 0 ? bends[0].before : bends[edge - 1].after;
          return here.controls[block.first + entry];
        });
      };
      const T theta = in_lanes<T>([&](int lane) {
        return here.coordinates[first_theta_ + static_cast<Index>(number(lane, j))];
      });
      return EdgeTerms(e, theta, {followed(0), followed(1), followed(2)},
                       {followed(3), followed(4), followed(5)});
    } else {
      return EdgeTerms(e);
    }
  };
  const auto joint_after = [&](std::ptrdiff_t j, const EdgeTerms& edge, const EdgeTerms& next) {
    return Terms::template joint<with_hessian>(
        [&](int lane) -> const auto& {
          return bends[std::clamp<std::ptrdiff_t>(spans.edge(lane, j), 0, last - 1)];
        },
        edge, next, here.controls, actuated_);
  };
  const auto joint_exists = [&](std::ptrdiff_t j) {
    return in_lanes<T>([&](int lane) {
      const std::ptrdiff_t joint = spans.edge(lane, j);
      return joint >= 0 && joint < last ? 1.0 : 0.0;
    });
  };
  const auto add_force = [&](int lane, std::ptrdiff_t j, const Vector3<T>& force) {
    double* g = totals.gradient.data() + first_dof_ + 3 * spans.edge(lane, j);
    for (int c = 0; c < 3; ++c) g[c] += Lane::lane(force[c], lane);
  };

  EdgeTerms edge = edge_at(0);
  Response start;                                // of the joint at the start of the edge
  Vector3<T> force_before = Vector3<T>::Zero();  // F_{j-1}
  Matrix3<T> before = Matrix3<T>::Zero();        // B_{j-1} by the vector
  Block from_before = Block::Zero();             // C_j
  if constexpr (!is_whole) {
    const EdgeTerms previous = edge_at(-1);
    start = joint_after(-1, previous, edge);
    Terms::scale(start, joint_exists(-1));
    if constexpr (with_hessian) from_before = Terms::coupling(previous, edge, start);
  }
  // The node behind the last edge of a lane, `j` places after its first.
  const auto add_last_node = [&](int lane, std::ptrdiff_t j) {
    add_force(lane, j, force_before);
    if constexpr (with_hessian) {
      const Index* slot = slots_[static_cast<std::size_t>(spans.edge(lane, j))].data();
      for (int column = 0; column < 3; ++column) {
        const Index* entry = slot;
        for (int row = column; row < 3; ++row) {
          totals.values[*entry++] += Lane::lane(before(row, column), lane);
        }
        slot += (size - column) + size + 3;
      }
    }
  };

  for (std::ptrdiff_t j = 0; j < spans.count; ++j) {
    const int lanes = spans.lanes_with(j);
    for (int lane = lanes; lane < Lane::kCount; ++lane) add_last_node(lane, j);
    const bool is_last = is_whole && j == last;
    const EdgeTerms next = is_last ? edge : edge_at(j + 1);
    Response end;
    if (!is_last) {
      end = joint_after(j, edge, next);
      if (!is_whole && spans.is_near_end(j)) Terms::scale(end, joint_exists(j));
    }
    const auto constant = [&](double Stretch<3>::Constants::* member) {
      return in_lanes<T>([&](int lane) { return stretches[number(lane, j)].*member; });
    };
    T elongation = 0.0;
    if (actuated_) {
      elongation = in_lanes<T>(
          [&](int lane) { return stretches[number(lane, j)].elongation.value(here.controls); });
    }
    const StretchResponseOf<T> stretch =
        stretch_response(constant(&Stretch<3>::Constants::EA),
                         constant(&Stretch<3>::Constants::rest_length), elongation, edge.length);
    const typename Terms::Variables slope = Terms::force(edge, start, end);
    const Vector3<T> force = stretch.tension * edge.tangent + slope.template head<3>();
    const Vector3<T> force_at_node = force_before - force;
    for_each_lane<T>(lanes, [&](int lane) {
      add_force(lane, j, force_at_node);
      if constexpr (size == 4) {
        totals.gradient[first_theta_ + static_cast<Index>(spans.edge(lane, j))] +=
            Lane::lane(slope[3], lane);
      }
    });
    force_before = force;

    if constexpr (with_hessian) {
      Block own = Terms::own(edge, start, end);
      own.template topLeftCorner<3, 3>() +=
          (stretch.along - stretch.across) * edge.tangent * edge.tangent.transpose();
      own.diagonal().template head<3>().array() += stretch.across;
      const Block to_next = Terms::coupling(edge, next, end);
      // Adds entries of the columns of the node, one after the other.
      auto add = [&, k = std::size_t{0}](const T& entry) mutable {
        for_each_lane<T>(lanes, [&](int lane) {
          const NodeSlots& slots = slots_[static_cast<std::size_t>(spans.edge(lane, j))];
          totals.values[slots[k]] += Lane::lane(entry, lane);
        });
        ++k;
      };
      add_columns<Terms>(own, before, from_before, to_next, add);
      before = own.template topLeftCorner<3, 3>();
      from_before = to_next;
    }
    edge = next;
    start = end;
  }
  for (int lane = 0; lane < spans.longer; ++lane) add_last_node(lane, spans.count);
}

void SpatialChain::add_gradient(const Model& model, const Configuration& here,
                                Vector& gradient) const {
  run_loop([&] { add<Derivatives::Gradient>(model, here, gradient, nullptr); });
}

void SpatialChain::add_gradient_and_hessian(const Model& model, const Configuration& here,
                                            Vector& gradient, double* values) const {
  run_loop([&] { add<Derivatives::Hessian>(model, here, gradient, values); });
}

}  // namespace der
