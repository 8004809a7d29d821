#include "der/assembly/spatial_chain.hpp"

#include <algorithm>

#include "der/core/index.hpp"
#include "der/core/processor.hpp"
#include "der/energies/elements_of.hpp"

namespace der {
namespace {

// The terms of a chain: what the loop over its edges needs of the energies.
//   kSize                       variables of an edge: its vector, and its angle if it has one
//   Bend                        the kernel of its joints
//   Edge                        an edge at a configuration
//   JointResponse joint(..)     of the joint between two edges
//   force(edge, start, end)     slope of the energy of two joints by the edge's variables
//   own(edge, start, end)       second derivative likewise
//   coupling(edge, next, joint) second derivative by the variables of `next` (rows) and `edge`

/// Rods whose sections count.
template <class Curvature>
struct Sections {
  static constexpr int kSize = 4;
  using Bend = SpatialBend<Curvature>;
  using Variables = Eigen::Vector4d;
  using Block = Eigen::Matrix4d;
  using Response = JointResponse;

  struct Edge {
    EdgeFrame frame;
    Eigen::Matrix<double, 3, 4> rotation;
    double theta;

    Edge(const Vec3& vector, double angle, const FrameBlock& block, const Vector& values)
        : frame(vector, angle, block.tangent(values), block.director(values)),
          rotation(frame.rotation()),
          theta(angle) {}
  };

  template <bool with_stiffness>
  static Response joint(const typename Bend::Constants& c, const Edge& edge, const Edge& next,
                        const Vector& values) {
    const double twist = whole_twist(edge.frame.frame, next.frame.frame, edge.theta, next.theta,
                                     values[c.after.twist_at_start()]);
    Response response;
    JointKinematics<Curvature>(edge.frame.frame, next.frame.frame, twist)
        .template respond<with_stiffness>(c.joint, response);
    return response;
  }
  static Variables force(const Edge& edge, const Response& start, const Response& end) {
    return edge.rotation.transpose() * (start.moment - end.moment);
  }
  static Block own(const Edge& edge, const Response& start, const Response& end) {
    const Mat3 stiffness = start.stiffness + end.stiffness;
    const Eigen::Matrix<double, 3, 4> turned = stiffness * edge.rotation;
    return edge.rotation.transpose() * turned +
           edge.frame.geometric_stiffness(start.moment - end.moment);
  }
  static Block coupling(const Edge& edge, const Edge& next, const Response& joint) {
    const Mat3 stiffness = -(joint.stiffness + 0.5 * cross_matrix(joint.moment));
    const Eigen::Matrix<double, 3, 4> turned = stiffness * edge.rotation;
    return next.rotation.transpose() * turned;
  }
};

/// Rods whose sections do not count.
template <class Curvature>
struct Tangents {
  static constexpr int kSize = 3;
  using Bend = IsotropicBend<Curvature>;
  using Variables = Vec3;
  using Block = Mat3;
  struct Response {
    IsotropicResponse bend;
    double cosine = 0.0;
    Vec3 by_before = Vec3::Zero();  ///< derivative of the cosine by the edge before [1/m]
    Vec3 by_after = Vec3::Zero();
  };
  using Edge = TangentTerm;

  template <bool with_stiffness>
  static Response joint(const typename Bend::Constants& c, const Edge& edge, const Edge& next,
                        const Vector& /*values*/) {
    Response response;
    response.cosine = edge.tangent.dot(next.tangent);
    response.bend = isotropic_response<Curvature>(c.stiffness_per_length, response.cosine);
    response.by_before = edge.first(next.tangent, response.cosine);
    response.by_after = next.first(edge.tangent, response.cosine);
    return response;
  }
  static Variables force(const Edge& /*edge*/, const Response& start, const Response& end) {
    return start.bend.slope * start.by_after + end.bend.slope * end.by_before;
  }
  static Block own(const Edge& edge, const Response& start, const Response& end) {
    const auto half = [&](const Response& joint, const Vec3& by_edge) -> Block {
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
  switch (kind_) {
    case Kind::SectionAngle:
      return add_terms<D, Sections<AngleCurvature>>(model, here, gradient, values);
    case Kind::SectionTangent:
      return add_terms<D, Sections<TangentCurvature>>(model, here, gradient, values);
    case Kind::IsotropicAngle:
      return add_terms<D, Tangents<AngleCurvature>>(model, here, gradient, values);
    case Kind::IsotropicTangent:
      return add_terms<D, Tangents<TangentCurvature>>(model, here, gradient, values);
  }
}

/// With F_j, B_j the first and second derivative by the variables of edge j, its vector e and its
/// angle, and C_j that by the variables of edges j (rows) and j - 1: node j, at the start of edge
/// j, has the gradient F_{j-1} - F_j in its position, and in its columns of the Hessian
///   B_{j-1} + B_j - C_j - C_j',  then -B_j + C_j + C_{j+1},  then -C_{j+1}.
/// The angle of edge j does not enter at the edge's other end.
template <Derivatives D, class Terms>
void SpatialChain::add_terms(const Model& model, const Configuration& here, Vector& gradient,
                             double* values) const {
  constexpr bool with_hessian = D == Derivatives::Hessian;
  constexpr int size = Terms::kSize;
  using EdgeTerms = typename Terms::Edge;
  using Block = typename Terms::Block;
  using Response = typename Terms::Response;
  const auto* edge_constants =
      elements_of<Stretch<3>>(*model.elements).constants.data() + edges_.first;
  const auto* bend_constants =
      elements_of<typename Terms::Bend>(*model.elements).constants.data() + bends_.first;
  const double* x = here.coordinates.data() + first_dof_;
  double* g = gradient.data() + first_dof_;
  const auto vector = [&](std::size_t j) -> Vec3 {
    return Eigen::Map<const Vec3>(x + 3 * j + 3) - Eigen::Map<const Vec3>(x + 3 * j);
  };
  const auto edge_at = [&](std::size_t j) {
    const Vec3 e = vector(j);
    if constexpr (size == 4) {
      const auto& block = j == 0 ? bend_constants[0].before : bend_constants[j - 1].after;
      return EdgeTerms(e, here.coordinates[first_theta_ + static_cast<Index>(j)], block,
                       here.controls);
    } else {
      return EdgeTerms(e, e.norm());
    }
  };

  EdgeTerms edge = edge_at(0);
  Response start;                     // of the joint at the start of the edge
  Vec3 force_before = Vec3::Zero();   // F_{j-1}
  Mat3 before = Mat3::Zero();         // B_{j-1} by the vector
  Block from_before = Block::Zero();  // C_j
  for (std::size_t j = 0; j < edges_.count; ++j, g += 3) {
    const bool last = j + 1 == edges_.count;
    const EdgeTerms next = last ? edge : edge_at(j + 1);
    Response end;
    if (!last) {
      end = Terms::template joint<with_hessian>(bend_constants[j], edge, next, here.controls);
    }
    const Vec3 e = vector(j);
    const double length = e.norm();
    const StretchResponse stretch = Stretch<3>::response(edge_constants[j], length);
    const typename Terms::Variables slope = Terms::force(edge, start, end);
    const Vec3 force = stretch.across * e + slope.template head<3>();
    Eigen::Map<Vec3>(g) += force_before - force;
    if constexpr (size == 4) gradient[first_theta_ + static_cast<Index>(j)] += slope[3];
    force_before = force;

    if constexpr (with_hessian) {
      Block own = Terms::own(edge, start, end);
      own.template topLeftCorner<3, 3>() +=
          (stretch.along - stretch.across) / (length * length) * e * e.transpose();
      own.diagonal().template head<3>().array() += stretch.across;
      const Block to_next = last ? Block::Zero().eval() : Terms::coupling(edge, next, end);
      const Index* slot = slots_[j].data();
      for (int column = 0; column < size; ++column) {
        const bool by_angle = column == 3;
        // The node's own position and angle.
        for (int row = column; row < size; ++row) {
          double entry = own(row, column);
          if (row < 3) {
            entry += before(row, column) - from_before(row, column) - from_before(column, row);
          } else if (!by_angle) {
            entry = from_before(row, column) - entry;
          }
          values[*slot++] += entry;
        }
        // The next node.
        for (int row = 0; row < size; ++row) {
          double entry = to_next(row, column);
          if (by_angle) {
            if (row < 3) entry = own(row, column) - entry;
          } else {
            entry = row < 3 ? entry + from_before(row, column) - own(row, column) : -entry;
          }
          values[*slot++] += entry;
        }
        // The position of the node after that.
        for (int row = 0; row < 3; ++row) {
          values[*slot++] += by_angle ? to_next(row, column) : -to_next(row, column);
        }
      }
      before = own.template topLeftCorner<3, 3>();
      from_before = to_next;
    }
    edge = next;
    start = end;
  }
  Eigen::Map<Vec3>(g) += force_before;
  if constexpr (with_hessian) {
    const Index* slot = slots_.back().data();
    for (int column = 0; column < 3; ++column) {
      const Index* entry = slot;
      for (int row = column; row < 3; ++row) values[*entry++] += before(row, column);
      slot += (size - column) + size + 3;
    }
  }
}

DER_FOR_EACH_PROCESSOR
void SpatialChain::add_gradient(const Model& model, const Configuration& here,
                                Vector& gradient) const {
  add<Derivatives::Gradient>(model, here, gradient, nullptr);
}

DER_FOR_EACH_PROCESSOR
void SpatialChain::add_gradient_and_hessian(const Model& model, const Configuration& here,
                                            Vector& gradient, double* values) const {
  add<Derivatives::Hessian>(model, here, gradient, values);
}

}  // namespace der
