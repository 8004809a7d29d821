// Tangents of loads without a potential against finite differences of their forces: highly twisted,
// near folds, and away from the step's start. And the virtual work that defines them.
#include "der/energies/circulatory_load.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <utility>
#include <vector>

#include "energies/sample_elements.hpp"

namespace der::test {
namespace {

constexpr int kSamples = 100;
constexpr Index kNodes = 3;

/// Two edges in a row, in a plane or in space, and a load on them.
template <int Dim>
struct LoadedEdges {
  static constexpr Index kPositions = Dim * kNodes;
  Configuration here;
  CirculatoryLoad load;

  [[nodiscard]] static std::vector<CirculatoryLoad::Term> difference(Index node, int component) {
    return {{Dim * (node + 1) + component, 1.0}, {Dim * node + component, -1.0}};
  }
  void add_point() {
    for (int c = 0; c < Dim; ++c) {
      load.coordinates.push_back({{c, -0.2}, {Dim + c, 0.3}, {2 * Dim + c, 0.9}});
    }
  }
};

using Bent = SpatialBend<AngleCurvature>;

LoadedEdges<3> sample_edges(Shape shape, Random& random) {
  LoadedEdges<3> sample;
  sample.here = sample_configuration(random);
  const auto constants = sample_constants(Bent{}, random);
  const auto x = sample_positions<Bent>(shape, random);
  sample_frames(Bent{}, constants, x, random, sample.here);
  sample.here.coordinates = x;
  sample.here.controls.conservativeResize(kNumControls + 3);
  for (Index c = 0; c < 3; ++c) {
    sample.here.controls[kNumControls + c] = uniform(random, -2.0, 2.0);
    sample.load.amount.components[static_cast<std::size_t>(c)] = kNumControls + c;
  }
  return sample;
}

FramedEdge sample_edge(Index edge, Random& random) {
  FramedEdge framed;
  framed.edge = {3 * edge, 3 * edge + 3, 3 * kNodes + edge, {}, {}};
  framed.block = FrameBlock::of(edge);
  framed.drawn = sample_frame(direction(random), random);
  return framed;
}

void add_edge(Index edge, LoadedEdges<3>& sample) {
  for (int c = 0; c < 3; ++c) {
    sample.load.coordinates.push_back(LoadedEdges<3>::difference(edge, c));
  }
  sample.load.coordinates.push_back({{3 * kNodes + edge, 1.0}});
}

LoadedEdges<3> sample_force(Shape shape, Random& random) {
  LoadedEdges<3> sample = sample_edges(shape, random);
  FollowerForce force;
  sample.add_point();
  const double weight = uniform(random, -0.5, 1.5);
  for (Index edge = 0; edge < 2; ++edge) {
    force.edges.push_back({sample_edge(edge, random), edge == 0 ? weight : 1.0 - weight});
    add_edge(edge, sample);
  }
  sample.load.kind = force;
  return sample;
}

LoadedEdges<3> sample_moment(bool follower, Shape shape, Random& random) {
  LoadedEdges<3> sample = sample_edges(shape, random);
  SpatialMoment moment;
  moment.follower = follower;
  for (Index edge = 0; edge < 2; ++edge) {
    const auto weight = [&] { return uniform(random, -0.5, 1.5); };
    moment.edges.push_back({sample_edge(edge, random), weight(), weight(), weight()});
    add_edge(edge, sample);
  }
  sample.load.kind = moment;
  return sample;
}

/// A section that springs hold, that of an element of springs, or that nothing holds. `before`:
/// under two moments, one of which follows.
template <int Edges>
LoadedSection<Edges> sample_loaded_section(bool before, Shape shape, Random& random,
                                           LoadedEdges<3>& sample) {
  using Kernel = SectionSpring<Edges>;
  sample = sample_edges(shape, random);
  LoadedSection<Edges> loaded;
  loaded.section = sample_constants(Kernel{}, random);
  Eigen::Matrix<double, Kernel::kDofs, 1> x;
  x << sample.here.coordinates.head<3 * Kernel::kNodes>(),
      sample.here.coordinates.segment<Edges>(3 * kNodes);
  sample_frames(Kernel{}, loaded.section, x, random, sample.here);
  if (Edges == 2 && uniform(random, 0.0, 1.0) < 0.3) loaded.section.spring.stiffness.setZero();
  for (Index edge = 0; edge < Edges; ++edge) {
    const auto& held = loaded.section.edges[static_cast<std::size_t>(edge)];
    FramedEdge& framed = loaded.edges.emplace_back(sample_edge(edge, random));
    framed.edge.first = held.first;
    framed.edge.last = held.last;
  }
  for (Index c = 0; c < 3; ++c) {
    sample.here.controls[kNumControls + c] = uniform(random, -0.3, 0.3);
  }
  if (before) loaded.moments = {{sample.load.amount, false}, {sample.load.amount, true}};
  return loaded;
}

template <int Edges>
LoadedEdges<3> sample_held_moment(bool follower, bool before, Shape shape, Random& random) {
  LoadedEdges<3> sample;
  sample.load.kind =
      HeldMoment<Edges>{sample_loaded_section<Edges>(before, shape, random, sample), follower};
  for (Index edge = 0; edge < Edges; ++edge) add_edge(edge, sample);
  return sample;
}

template <int Edges>
LoadedEdges<3> sample_held_force(bool before, Shape shape, Random& random) {
  LoadedEdges<3> sample;
  HeldForce<Edges> force{sample_loaded_section<Edges>(before, shape, random, sample)};
  sample.add_point();
  for (Index edge = 0; edge < Edges; ++edge) add_edge(edge, sample);
  sample.load.kind = std::move(force);
  return sample;
}

LoadedEdges<2> sample_planar(Shape shape, Random& random) {
  LoadedEdges<2> sample;
  sample.here = sample_configuration(random);
  sample.here.coordinates = sample_planar_positions<6>(shape, random);
  sample.load.amount.components = {kMoment, kTurn, -1};
  sample.add_point();
  PlanarFollowerForce force;
  for (Index edge = 0; edge < 2; ++edge) {
    const double drawn = uniform(random, -3.0, 3.0);
    EffectiveEdge effective{{2 * edge, 2 * edge + 1, 2 * edge + 2, 2 * edge + 3}, {}, {}};
    effective.first = {0.01, 0.3, kRotation};
    force.edges.push_back(
        {effective, uniform(random, -0.5, 1.5), {std::cos(drawn), std::sin(drawn)}});
    for (int c = 0; c < 2; ++c) {
      sample.load.coordinates.push_back(LoadedEdges<2>::difference(edge, c));
    }
  }
  sample.load.kind = force;
  return sample;
}

/// A joint that has turned by up to 1.7 rad since the start of the step, with a load that acts
/// there.
template <class Kind>
LoadedEdges<3> sample_at_joint(Kind kind, Random& random) {
  LoadedEdges<3> sample = sample_edges(Shape::Arbitrary, random);
  Configuration& here = sample.here;
  const auto rotation = static_cast<Index>(here.coordinates.size());
  here.coordinates.conservativeResize(rotation + 3);
  here.coordinates.tail<3>() = direction(random);
  kind.rotation = rotation;
  kind.joint.first = kJoints;
  here.controls.segment<3>(kJoints) =
      here.coordinates.tail<3>() - uniform(random, 0.0, 1.7) * direction(random);
  const Eigen::Quaterniond base = rotation_by(3.0 * direction(random));
  here.controls.segment<4>(kJoints + 3) << base.w(), base.vec();
  if (kind.size() == 6) sample.add_point();
  for (Index c = 0; c < 3; ++c) sample.load.coordinates.push_back({{rotation + c, 1.0}});
  sample.load.kind = kind;
  return sample;
}

Vector forces_of(const CirculatoryLoad& load, const Configuration& here) {
  Vector total = Vector::Zero(here.coordinates.size());
  add_circulatory_forces({load}, here, 1.0, total);
  return total;
}

template <class Sample>
void check_tangent(const Sample& sample, double h) {
  const Index size = static_cast<Index>(sample.here.coordinates.size());
  CirculatoryTerm term;
  sample.load.evaluate(sample.here, term);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(size, term.force.size());
  for (Index k = 0; k < columns.cols(); ++k) {
    for (const auto& [dof, weight] : sample.load.coordinates[static_cast<std::size_t>(k)]) {
      columns(dof, k) += weight;
    }
  }
  const Eigen::MatrixXd tangent = columns * term.tangent * columns.transpose();
  const double scale = 1.0 + tangent.lpNorm<Eigen::Infinity>();
  for (Index j = 0; j < size; ++j) {
    const auto force = [&](double step) {
      Configuration there = sample.here;
      there.coordinates[j] += step;
      return forces_of(sample.load, there);
    };
    // Sixth order, as in finite_differences_test.cpp.
    const Vector slope = (45.0 * (force(h) - force(-h)) - 9.0 * (force(2 * h) - force(-2 * h)) +
                          (force(3 * h) - force(-3 * h))) /
                         (60.0 * h);
    CHECK((slope + tangent.col(j)).lpNorm<Eigen::Infinity>() < 1e-6 * scale);
  }
}

}  // namespace

TEST_CASE("circulatory loads: tangents are the derivatives of the forces") {
  Random random(20261122);
  for (const Shape shape : kShapes) {
    const double h = shape == Shape::NearFolded || shape == Shape::Stretched ? 4e-4 : 2e-3;
    for (int i = 0; i < kSamples; ++i) {
      check_tangent(sample_planar(shape, random), h);
      check_tangent(sample_force(shape, random), h);
      check_tangent(sample_at_joint(SpatialJointFollowerForce{}, random), h);
      check_tangent(sample_at_joint(JointMoment{0, {}, false}, random), h);
      check_tangent(sample_at_joint(JointMoment{0, {}, true}, random), h);
      check_tangent(sample_moment(false, shape, random), h);
      check_tangent(sample_moment(true, shape, random), h);
      for (const bool before : {false, true}) {
        for (const bool follower : {false, true}) {
          check_tangent(sample_held_moment<1>(follower, before, shape, random), h);
          check_tangent(sample_held_moment<2>(follower, before, shape, random), h);
        }
        check_tangent(sample_held_force<1>(before, shape, random), h);
        check_tangent(sample_held_force<2>(before, shape, random), h);
      }
    }
  }
}

TEST_CASE("circulatory loads: a moment does no work in a translation and M . phi in a rotation") {
  Random random(3);
  for (int i = 0; i < kSamples; ++i) {
    LoadedEdges<3> sample = sample_moment(i % 2 == 0, Shape::Arbitrary, random);
    auto& edges = std::get<SpatialMoment>(sample.load.kind).edges;
    edges[1].across = 1.0 - edges[0].across;
    edges[1].along = 1.0 - edges[0].along;
    edges[1].weight = 1.0 - edges[0].weight;
    // The drawn sections are those here: a moment that follows is then the one given.
    for (FramedEdge* edge :
         {static_cast<FramedEdge*>(&edges[0]), static_cast<FramedEdge*>(&edges[1])}) {
      edge->drawn = edge->frame(sample.here).frame;
    }
    const Vec3 moment = sample.here.controls.tail<3>();
    const Vec3 axis = direction(random);
    Vector rotation = Vector::Zero(sample.here.coordinates.size());
    Vector translation = rotation;
    for (Index node = 0; node < kNodes; ++node) {
      rotation.segment<3>(3 * node) =
          axis.cross(Vec3(sample.here.coordinates.segment<3>(3 * node)));
      translation.segment<3>(3 * node) = axis;
    }
    for (Index edge = 0; edge < 2; ++edge) {
      const EdgeFrame frame = edges[static_cast<std::size_t>(edge)].frame(sample.here);
      const Vec3 vector = frame.length * frame.frame.tangent;
      rotation[3 * kNodes + edge] =
          axis.dot(frame.frame.tangent) - frame.spin.dot(axis.cross(vector));
    }
    CHECK(std::abs(circulatory_work({sample.load}, sample.here, translation)) < 1e-12);
    CHECK(circulatory_work({sample.load}, sample.here, rotation) ==
          doctest::Approx(moment.dot(axis)).epsilon(1e-9));
  }
}

}  // namespace der::test
