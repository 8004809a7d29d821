#include "der/assembly/spatial_chain.hpp"

#include <algorithm>
#include <type_traits>

#include "der/assembly/lane_spans.hpp"
#include "der/core/index.hpp"
#include "der/core/loops.hpp"
#include "der/energies/elements_of.hpp"

namespace der {
namespace {

// The terms of a chain: what the loop over its edges needs of the energies, in the lanes of the
// number type `Number`.
//   kSize                       variables of an edge: its vector, and its angle if it has one
//   Bend                        the kernel of its vertices
//   Vertex                       what is known of a vertex besides its edges
//   vertex(each)                 that of the constants c, each(f) being f(c) in all lanes
//   Edge                        an edge at a configuration
//   edge(parts, j)              that of edge j
//   response(..)                response of the vertex between two edges
//   scale(response, factor)     the response of a vertex that counts `factor` times
//   force(edge, start, end)     slope of the energy of two vertices by the edge's variables
//   own(edge, start, end)       second derivative likewise
//   coupling(edge, next, vertex) second derivative by the variables of `next` (rows) and `edge`

/// Rods whose sections count.
template <class Curvature, class T>
struct Sections {
  using Number = T;
  static constexpr int kSize = 4;
  using Bend = SpatialBend<Curvature>;
  using Vertex = VertexOf<T>;
  using Variables = Eigen::Matrix<T, 4, 1>;
  using Block = Eigen::Matrix<T, 4, 4>;
  using Response = VertexResponseOf<T>;

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

  template <class Parts>
  static Edge edge(const Parts& parts, std::ptrdiff_t j) {
    const auto followed = [&](Index entry) { return parts.frame(j, entry); };
    return {parts.vector(j),
            parts.theta(j),
            {followed(0), followed(1), followed(2)},
            {followed(3), followed(4), followed(5)}};
  }
  template <class Each>
  static Vertex vertex(const Each& each) {
    using C = typename Bend::Constants;
    return {each([](const C& c) { return c.vertex.bend_1; }),
            each([](const C& c) { return c.vertex.bend_2; }),
            each([](const C& c) { return c.vertex.twist; }),
            {each([](const C& c) { return c.vertex.rest.kappa_1; }),
             each([](const C& c) { return c.vertex.rest.kappa_2; }),
             each([](const C& c) { return c.vertex.rest.twist; })}};
  }
  /// Adds the change of its rest shape by actuations.
  template <class Each>
  static void actuate(const Each& each, const Vector& controls, Vertex& vertex) {
    using C = typename Bend::Constants;
    vertex.rest.kappa_1 += each([&](const C& c) { return c.actuated.strain(controls).kappa_1; });
    vertex.rest.kappa_2 += each([&](const C& c) { return c.actuated.strain(controls).kappa_2; });
    vertex.rest.twist += each([&](const C& c) { return c.actuated.strain(controls).twist; });
  }
  static const auto& vertices_of(const SpatialChainConstants<T>& constants) {
    return constants.vertices;
  }
  static auto& vertices_of(SpatialChainConstants<T>& constants) { return constants.vertices; }

  /// The vertex between edge j and the next one.
  template <bool with_stiffness, class Parts>
  static Response response(const Parts& parts, std::ptrdiff_t j, const Edge& edge,
                           const Edge& next) {
    const T reference = parts.frame(j + 1, FrameBlock{}.twist_at_start());
    const T twist =
        whole_twist<T>(edge.frame.frame, next.frame.frame, edge.theta, next.theta, reference);
    Response response;
    VertexKinematics<Curvature, T>(edge.frame.frame, next.frame.frame, twist)
        .template respond<with_stiffness>(parts.vertex(j), response);
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
  static Block coupling(const Edge& edge, const Edge& next, const Response& vertex) {
    const Matrix3<T> stiffness = -(vertex.stiffness + cross_matrix<T>(0.5 * vertex.moment));
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
  using Vertex = T;  ///< its stiffness over its length [N m]
  using Variables = Vector3<T>;
  using Block = Matrix3<T>;
  struct Response {
    IsotropicResponse<T> bend;
    T cosine = 0.0;
    Vector3<T> by_before = Vector3<T>::Zero();  ///< of the cosine, by the edge before [1/m]
    Vector3<T> by_after = Vector3<T>::Zero();
  };
  using Edge = TangentTermOf<T>;

  template <class Parts>
  static Edge edge(const Parts& parts, std::ptrdiff_t j) {
    return Edge(parts.vector(j));
  }
  template <class Each>
  static Vertex vertex(const Each& each) {
    return each([](const typename Bend::Constants& c) { return c.stiffness_per_length; });
  }
  template <class Each>
  static void actuate(const Each& /*each*/, const Vector& /*controls*/, Vertex& /*vertex*/) {}
  static const auto& vertices_of(const SpatialChainConstants<T>& constants) {
    return constants.bend_stiffness;
  }
  static auto& vertices_of(SpatialChainConstants<T>& constants) { return constants.bend_stiffness; }

  template <bool with_stiffness, class Parts>
  static Response response(const Parts& parts, std::ptrdiff_t j, const Edge& edge,
                           const Edge& next) {
    Response response;
    response.cosine = edge.tangent.dot(next.tangent);
    response.bend = isotropic_response<Curvature, T>(parts.vertex(j), response.cosine);
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
  /// TangentTermOf::second of both vertices at once.
  static Block own(const Edge& edge, const Response& start, const Response& end) {
    const T lean = (start.bend.slope * start.cosine + end.bend.slope * end.cosine) *
                   (edge.per_length * edge.per_length);
    const Vector3<T>& t = edge.tangent;
    const Vector3<T> with_t = (0.5 * lean) * t - edge.per_length * force(edge, start, end);
    const Vector3<T> with_start = start.bend.curvature * start.by_after;
    const Vector3<T> with_end = end.bend.curvature * end.by_before;
    Block own;
    for (int column = 0; column < 3; ++column) {
      for (int row = column; row < 3; ++row) {
        own(row, column) = with_start[row] * start.by_after[column] +
                           with_end[row] * end.by_before[column] +
                           (with_t[row] * t[column] + t[row] * with_t[column]);
        own(column, row) = own(row, column);
      }
    }
    own.diagonal().array() -= lean;
    return own;
  }
  /// With the product of the two tangents' derivatives (TangentTermOf::across) multiplied out.
  static Block coupling(const Edge& edge, const Edge& next, const Response& vertex) {
    const T slope = vertex.bend.slope * next.per_length;
    const Vector3<T> with_before = vertex.bend.curvature * vertex.by_after - slope * next.tangent;
    const T along = slope * edge.per_length;
    Block result = with_before * vertex.by_before.transpose() -
                   (along * edge.tangent) * edge.tangent.transpose();
    result.diagonal().array() += along;
    return result;
  }
};

/// Terms as a value.
template <class Terms>
struct TermsOf {
  using Type = Terms;
};

/// A chain in the lanes of a number type, for `add_chain`:
///   kIsWhole                    whether the lanes' first edge is that of the chain
///   count()                     number of edges of the longest lane
///   vector(j), theta(j)         of edge `j` of each lane; beyond the chain, of its outermost edge
///   frame(j, entry)             of the edge's FrameBlock
///   stretch(j, length)          response of edge j; zero beyond the chain's ends
///   vertex(j)                    behind edge j
///   mask(j, response)           makes the response of that vertex zero beyond the chain's ends
///   last_is_shorter()           whether the lane that has the chain's end lacks the last edge
///   add_force, add_entry        add to the node at the start of edge j
///   add_torque                  adds to the angle of edge j
///   add_end(force, block)       adds to the node at the end of the chain
/// The lanes hold parts of one rod:
template <class Terms>
class RodParts {
  using T = typename Terms::Number;

 public:
  static constexpr bool kIsWhole = LaneTraits<T>::kCount == 1;

  RodParts(const LaneSpans<T>& spans, const Model& model, const SpatialChain& chain,
           const Configuration& here, Vector& gradient, double* values)
      : spans_(spans),
        chain_(chain),
        stretches_(elements_of<Stretch<3>>(*model.elements).constants.data() + chain.edges().first),
        bends_(elements_of<typename Terms::Bend>(*model.elements).constants.data() +
               chain.bends().first),
        controls_(here.controls),
        x_(here.coordinates.data()),
        gradient_(gradient.data()),
        values_(values) {}

  [[nodiscard]] std::ptrdiff_t count() const { return spans_.count; }
  [[nodiscard]] bool last_is_shorter() const { return spans_.longer < LaneTraits<T>::kCount; }

  [[nodiscard]] Vector3<T> vector(std::ptrdiff_t j) const {
    const auto component = [&](int c) {
      return in_lanes<T>([&](int lane) {
        const double* node = x_ + chain_.first_dof() + 3 * number(lane, j);
        return node[c + 3] - node[c];
      });
    };
    return {component(0), component(1), component(2)};
  }
  [[nodiscard]] T theta(std::ptrdiff_t j) const {
    return in_lanes<T>([&](int lane) { return x_[chain_.first_theta() + number(lane, j)]; });
  }
  [[nodiscard]] T frame(std::ptrdiff_t j, Index entry) const {
    return in_lanes<T>([&](int lane) {
      return controls_[chain_.first_frame() + FrameBlock::kSize * number(lane, j) + entry];
    });
  }
  [[nodiscard]] StretchResponseOf<T> stretch(std::ptrdiff_t j, const T& length) const {
    const auto each = [&](const auto& value) {
      return in_lanes<T>([&](int lane) { return value(stretches_[number(lane, j)]); });
    };
    using C = Stretch<3>::Constants;
    T elongation = 0.0;
    if (chain_.is_actuated()) {
      elongation = each([&](const C& c) { return c.elongation.value(controls_); });
    }
    StretchResponseOf<T> stretch =
        stretch_response<T>(each([](const C& c) { return c.EA; }),
                            each([](const C& c) { return c.rest_length; }), elongation, length);
    if (j < 0) {
      const T exists = in_lanes<T>([&](int lane) { return spans_.edge(lane, j) < 0 ? 0.0 : 1.0; });
      stretch.tension *= exists;
      stretch.along *= exists;
      stretch.across *= exists;
    }
    return stretch;
  }
  [[nodiscard]] typename Terms::Vertex vertex(std::ptrdiff_t j) const {
    const auto each = [&](const auto& value) {
      return in_lanes<T>([&](int lane) {
        return value(bends_[std::clamp<std::ptrdiff_t>(spans_.edge(lane, j), 0, last() - 1)]);
      });
    };
    typename Terms::Vertex vertex = Terms::vertex(each);
    if (chain_.is_actuated()) Terms::actuate(each, controls_, vertex);
    return vertex;
  }
  void mask(std::ptrdiff_t j, typename Terms::Response& response) const {
    if (j >= 0 && !spans_.is_near_end(j)) return;
    Terms::scale(response, in_lanes<T>([&](int lane) {
                   const std::ptrdiff_t vertex = spans_.edge(lane, j);
                   return vertex >= 0 && vertex < last() ? 1.0 : 0.0;
                 }));
  }

  void add_force(std::ptrdiff_t j, const Vector3<T>& force) const {
    for_each_lane<T>(spans_.lanes_with(j),
                     [&](int lane) { add_force_of(lane, spans_.edge(lane, j), force); });
  }
  void add_torque(std::ptrdiff_t j, const T& torque) const {
    for_each_lane<T>(spans_.lanes_with(j), [&](int lane) {
      gradient_[chain_.first_theta() + spans_.edge(lane, j)] += LaneTraits<T>::lane(torque, lane);
    });
  }
  void add_entry(std::ptrdiff_t j, std::size_t k, const T& entry) const {
    for_each_lane<T>(spans_.lanes_with(j), [&](int lane) {
      values_[chain_.slots(spans_.edge(lane, j))[k]] += LaneTraits<T>::lane(entry, lane);
    });
  }
  void add_end(const Vector3<T>& force, const Matrix3<T>& block) const {
    constexpr int lane = LaneTraits<T>::kCount - 1;
    add_force_of(lane, last() + 1, force);
    if (values_ == nullptr) return;
    chain_.for_each_end_slot([&](Index slot, int row, int column) {
      values_[slot] += LaneTraits<T>::lane(block(row, column), lane);
    });
  }

 private:
  [[nodiscard]] std::ptrdiff_t last() const {
    return static_cast<std::ptrdiff_t>(chain_.edges().count) - 1;
  }
  [[nodiscard]] std::ptrdiff_t number(int lane, std::ptrdiff_t j) const {
    return std::clamp<std::ptrdiff_t>(spans_.edge(lane, j), 0, last());
  }
  void add_force_of(int lane, std::ptrdiff_t node, const Vector3<T>& force) const {
    double* g = gradient_ + chain_.first_dof() + 3 * node;
    for (int c = 0; c < 3; ++c) g[c] += LaneTraits<T>::lane(force[c], lane);
  }

  const LaneSpans<T>& spans_;
  const SpatialChain& chain_;
  const Stretch<3>::Constants* stretches_;
  const typename Terms::Bend::Constants* bends_;
  const Vector& controls_;
  const double* x_;
  double* gradient_;
  double* values_;
};

/// The lanes hold the same chain of several members.
template <class Terms>
class MemberChains {
  using T = typename Terms::Number;

 public:
  static constexpr bool kIsWhole = true;

  MemberChains(const SpatialChain& chain, const SpatialChainConstants<T>& constants, const T* x,
               const T* frames, T* gradient, T* values)
      : chain_(chain),
        constants_(constants),
        x_(x),
        frames_(frames),
        gradient_(gradient),
        values_(values) {}

  [[nodiscard]] std::ptrdiff_t count() const { return constants_.EA.size(); }
  [[nodiscard]] static bool last_is_shorter() { return false; }
  [[nodiscard]] Vector3<T> vector(std::ptrdiff_t j) const {
    const T* node = x_ + chain_.first_dof() + 3 * j;
    return {node[3] - node[0], node[4] - node[1], node[5] - node[2]};
  }
  [[nodiscard]] const T& theta(std::ptrdiff_t j) const { return x_[chain_.first_theta() + j]; }
  [[nodiscard]] const T& frame(std::ptrdiff_t j, Index entry) const {
    return frames_[chain_.first_frame() + FrameBlock::kSize * j + entry];
  }
  [[nodiscard]] StretchResponseOf<T> stretch(std::ptrdiff_t j, const T& length) const {
    return stretch_response<T>(constants_.EA[j], constants_.rest_length[j], 0.0, length);
  }
  [[nodiscard]] const typename Terms::Vertex& vertex(std::ptrdiff_t j) const {
    return Terms::vertices_of(constants_)[static_cast<std::size_t>(j)];
  }
  static void mask(std::ptrdiff_t /*j*/, typename Terms::Response& /*response*/) {}
  void add_force(std::ptrdiff_t j, const Vector3<T>& force) const {
    T* g = gradient_ + chain_.first_dof() + 3 * j;
    for (int c = 0; c < 3; ++c) g[c] += force[c];
  }
  void add_torque(std::ptrdiff_t j, const T& torque) const {
    gradient_[chain_.first_theta() + j] += torque;
  }
  void add_entry(std::ptrdiff_t j, std::size_t k, const T& entry) const {
    values_[chain_.slots(j)[k]] += entry;
  }
  void add_end(const Vector3<T>& force, const Matrix3<T>& block) const {
    add_force(count(), force);
    if (values_ == nullptr) return;
    chain_.for_each_end_slot(
        [&](Index slot, int row, int column) { values_[slot] += block(row, column); });
  }

 private:
  const SpatialChain& chain_;
  const SpatialChainConstants<T>& constants_;
  const T* x_;
  const T* frames_;
  T* gradient_;
  T* values_;
};

/// Hands the entries of the columns of node j to `add`, one after the other: B_j, B_{j-1} by the
/// vector, C_j and C_{j+1} (add_chain).
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

/// Adds in each lane its edges and the nodes at their starts. With F_j, B_j the first and second
/// derivative by the variables of edge j, its vector e and its angle, and C_j that by the variables
/// of edges j (rows) and j - 1: node j, at the start of edge j, has the gradient F_{j-1} - F_j in
/// its position, and in its columns of the Hessian
///   B_{j-1} + B_j - C_j - C_j',  then -B_j + C_j + C_{j+1},  then -C_{j+1}.
/// The angle of edge j does not enter at the edge's other end. The sums do not depend, to the last
/// bit, on how a chain is shared out to lanes.
template <Derivatives D, class Terms, class Parts>
void add_chain(const Parts& parts) {
  constexpr bool with_hessian = D == Derivatives::Hessian;
  using T = typename Terms::Number;
  using Edge = typename Terms::Edge;
  using Block = typename Terms::Block;
  using Response = typename Terms::Response;
  using Variables = typename Terms::Variables;

  const auto vertex_after = [&](std::ptrdiff_t j, const Edge& edge, const Edge& next) {
    Response response = Terms::template response<with_hessian>(parts, j, edge, next);
    parts.mask(j, response);
    return response;
  };
  const auto with_stretch = [](const Edge& edge, const StretchResponseOf<T>& stretch, Block& own) {
    own.template topLeftCorner<3, 3>() +=
        (stretch.along - stretch.across) * edge.tangent * edge.tangent.transpose();
    own.diagonal().template head<3>().array() += stretch.across;
  };

  Edge edge = Terms::edge(parts, 0);
  Response start;                                // of the vertex at the start of the edge
  Vector3<T> force_before = Vector3<T>::Zero();  // F_{j-1}
  Matrix3<T> before = Matrix3<T>::Zero();        // B_{j-1} by the vector
  Block from_before = Block::Zero();             // C_j
  if constexpr (!Parts::kIsWhole) {
    const Edge previous = Terms::edge(parts, -1);
    const Response outer = vertex_after(-2, Terms::edge(parts, -2), previous);
    start = vertex_after(-1, previous, edge);
    const StretchResponseOf<T> stretch = parts.stretch(-1, previous.length);
    const Variables slope = Terms::force(previous, outer, start);
    force_before = stretch.tension * previous.tangent + slope.template head<3>();
    if constexpr (with_hessian) {
      Block own = Terms::own(previous, outer, start);
      with_stretch(previous, stretch, own);
      before = own.template topLeftCorner<3, 3>();
      from_before = Terms::coupling(previous, edge, start);
    }
  }

  const std::ptrdiff_t count = parts.count();
  for (std::ptrdiff_t j = 0; j < count; ++j) {
    const bool is_last = j + 1 == count;
    if (is_last && parts.last_is_shorter()) parts.add_end(force_before, before);
    const bool is_end = Parts::kIsWhole && is_last;
    const Edge next = is_end ? edge : Terms::edge(parts, j + 1);
    Response end;
    if (!is_end) end = vertex_after(j, edge, next);
    const StretchResponseOf<T> stretch = parts.stretch(j, edge.length);
    const Variables slope = Terms::force(edge, start, end);
    const Vector3<T> force = stretch.tension * edge.tangent + slope.template head<3>();
    parts.add_force(j, force_before - force);
    if constexpr (Terms::kSize == 4) parts.add_torque(j, slope[3]);
    force_before = force;

    if constexpr (with_hessian) {
      Block own = Terms::own(edge, start, end);
      with_stretch(edge, stretch, own);
      const Block to_next = Terms::coupling(edge, next, end);
      add_columns<Terms>(
          own, before, from_before, to_next,
          [&, k = std::size_t{0}](const T& entry) mutable { parts.add_entry(j, k++, entry); });
      before = own.template topLeftCorner<3, 3>();
      from_before = to_next;
    }
    edge = next;
    start = end;
  }
  if (!parts.last_is_shorter()) parts.add_end(force_before, before);
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
        chain.first_frame_ = bends.constants[run.bends.first].before.first;
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

/// Calls work(Terms) with the chain's terms in a number type.
template <class T, class Work>
void SpatialChain::with_terms(const Work& work) const {
  switch (kind_) {
    case Kind::SectionAngle:
      return work(TermsOf<Sections<AngleCurvature, T>>{});
    case Kind::SectionTangent:
      return work(TermsOf<Sections<TangentCurvature, T>>{});
    case Kind::IsotropicAngle:
      return work(TermsOf<Tangents<AngleCurvature, T>>{});
    case Kind::IsotropicTangent:
      return work(TermsOf<Tangents<TangentCurvature, T>>{});
  }
}

template <Derivatives D>
void SpatialChain::add(const Model& model, const Configuration& here, Vector& gradient,
                       double* values) const {
  in_spans(edges_.count, [&](const auto& spans) {
    using T = typename std::decay_t<decltype(spans)>::Number;
    with_terms<T>([&](auto terms) {
      using Terms = typename decltype(terms)::Type;
      add_chain<D, Terms>(RodParts<Terms>(spans, model, *this, here, gradient, values));
    });
  });
}

void SpatialChain::add_gradient(const Model& model, const Configuration& here,
                                Vector& gradient) const {
  dispatch_simd([&] { add<Derivatives::Gradient>(model, here, gradient, nullptr); });
}

void SpatialChain::add_gradient_and_hessian(const Model& model, const Configuration& here,
                                            Vector& gradient, double* values) const {
  dispatch_simd([&] { add<Derivatives::Hessian>(model, here, gradient, values); });
}

template <class T>
SpatialChainConstants<T> SpatialChain::constants_of(const MemberModels<T>& models) const {
  SpatialChainConstants<T> constants;
  const auto set_edges = [&](MemberVector<T>& all, double Stretch<3>::Constants::* member) {
    all.resize(static_cast<Index>(edges_.count));
    for (std::size_t i = 0; i < edges_.count; ++i) {
      all[static_cast<Index>(i)] = in_lanes<T>([&](int lane) {
        const ElementLists& elements = *models[to_size(lane)]->elements;
        return elements_of<Stretch<3>>(elements).constants[edges_.first + i].*member;
      });
    }
  };
  set_edges(constants.EA, &Stretch<3>::Constants::EA);
  set_edges(constants.rest_length, &Stretch<3>::Constants::rest_length);
  with_terms<T>([&](auto terms) {
    using Terms = typename decltype(terms)::Type;
    for (std::size_t i = 0; i < bends_.count; ++i) {
      Terms::vertices_of(constants).push_back(Terms::vertex([&](const auto& value) {
        return in_lanes<T>([&](int lane) {
          const ElementLists& elements = *models[to_size(lane)]->elements;
          return value(elements_of<typename Terms::Bend>(elements).constants[bends_.first + i]);
        });
      }));
    }
  });
  return constants;
}

template <Derivatives D, class T>
void SpatialChain::add_members(const SpatialChainConstants<T>& constants, const T* coordinates,
                               const T* frames, T* gradient, T* values) const {
  run_member_loop<T>([&] {
    with_terms<T>([&](auto terms) {
      using Terms = typename decltype(terms)::Type;
      add_chain<D, Terms>(
          MemberChains<Terms>(*this, constants, coordinates, frames, gradient, values));
    });
  });
}

// NOLINTBEGIN(bugprone-macro-parentheses): the argument is a type
#define DER_INSTANTIATE(T)                                                                       \
  template SpatialChainConstants<T> SpatialChain::constants_of(const MemberModels<T>&) const;    \
  template void SpatialChain::add_members<Derivatives::Gradient>(                                \
      const SpatialChainConstants<T>&, const T*, const T*, T*, T*) const;                        \
  template void SpatialChain::add_members<Derivatives::Hessian>(const SpatialChainConstants<T>&, \
                                                                const T*, const T*, T*, T*) const;
// NOLINTEND(bugprone-macro-parentheses)
DER_FOR_MEMBER_LANES(DER_INSTANTIATE)
#undef DER_INSTANTIATE

}  // namespace der
