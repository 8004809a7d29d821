#include "der/core/lanes.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "der/energies/vertex_response.hpp"
#include "der/kinematics/direction_angle.hpp"
#include "der/kinematics/edge_frame.hpp"
#include "der/kinematics/sine_and_cosine.hpp"

namespace der::test {
namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(random);
}

Vec3 vector(Random& random) {
  return {uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0)};
}

Vector3<TwoLanes> in_two_lanes(const Vec3& first, const Vec3& second) {
  return Vector3<TwoLanes>(TwoLanes(first[0], second[0]), TwoLanes(first[1], second[1]),
                           TwoLanes(first[2], second[2]));
}

/// To the last bit: members of a batch rely on it.
template <class Matrix, class LaneMatrix>
bool is_lane(const Matrix& each, const LaneMatrix& both, int lane) {
  for (Eigen::Index i = 0; i < each.size(); ++i) {
    if (both(i).lane(lane) != each(i)) return false;
  }
  return true;
}

struct Sample {
  Vec3 edge, source, director;
  double theta = 0.0;

  /// The edge lies within 0.2 of its source, that within 0.4 of the x axis; `turns` bounds its
  /// angle.
  Sample(Random& random, double turns) {
    source = (Vec3::UnitX() + 0.4 * vector(random)).normalized();
    director = made_perpendicular(vector(random), source);
    edge = 0.3 * (source + 0.2 * vector(random));
    theta = uniform(random, -turns, turns);
  }
  [[nodiscard]] EdgeFrame frame() const { return {edge, theta, source, director}; }
};

EdgeFrameOf<TwoLanes> frame_of(const Sample& a, const Sample& b) {
  return {in_two_lanes(a.edge, b.edge),
          {a.theta, b.theta},
          in_two_lanes(a.source, b.source),
          in_two_lanes(a.director, b.director)};
}

/// The stiffness of a vertex by the variables of an edge.
template <class T>
Eigen::Matrix<T, 4, 4> by_edge(const VertexResponseOf<T>& response, const EdgeFrameOf<T>& edge) {
  const typename EdgeFrameOf<T>::Rotation turned = response.stiffness * edge.rotation();
  return edge.rotation().transpose() * turned;
}

}  // namespace

// The library's functions are right to a unit in the last place.
TEST_CASE("sines and cosines are those of the library to rounding") {
  Random random(20261124);
  for (const double limit : {0.8, 12.0, 99999.0, 1e9}) {
    for (int i = 0; i < 10000; ++i) {
      const double angle = uniform(random, -limit, limit);
      const auto [sine, cosine] = sine_and_cosine(angle);
      CHECK(std::abs(sine - std::sin(angle)) <= 2.3e-16);
      CHECK(std::abs(cosine - std::cos(angle)) <= 2.3e-16);
    }
  }
}

TEST_CASE("angles of directions are those of the library to rounding") {
  Random random(20261122);
  for (int i = 0; i < 10000; ++i) {
    const double angle = uniform(random, -3.0, 3.0);
    const double back = direction_angle(std::cos(angle), std::sin(angle));
    CHECK(std::abs(back - angle) <= 5e-16 * (1.0 + std::abs(angle)));
  }
}

TEST_CASE("the angle of a direction is that of the library to two units in the last place") {
  Random random(20261124);
  const auto error = [](double x, double y) {
    return std::abs(direction_angle(x, y) - std::atan2(y, x));
  };
  for (int i = 0; i < 10000; ++i) {
    const double size = std::exp(uniform(random, -600.0, 600.0));
    const double x = size * uniform(random, -1.0, 1.0);
    const double y = size * uniform(random, -1.0, 1.0);
    CHECK(error(x, y) <= 4.5e-16 * std::abs(std::atan2(y, x)));
  }
  // Along the axes, between them, and where one quarter follows another.
  for (const double x : {-1.0, 0.0, 0.125, 0.375, 0.625, 0.875, 1.0}) {
    for (const double y : {-1.0, 0.0, 1e-300, 0.125, 0.375, 0.625, 0.875, 1.0}) {
      CHECK(error(x, y) <= 4.5e-16 * std::abs(std::atan2(y, x)));
    }
  }
  CHECK(direction_angle(-1.0, -0.0) > 0.0);
  CHECK(std::isnan(direction_angle(std::nan(""), 1.0)));
  CHECK(std::isnan(direction_angle(1.0, std::nan(""))));
}

TEST_CASE("the angle of a direction has the same bits in lanes, small or not") {
  Random random(7);
  for (const double largest : {0.1, 3.1}) {
    for (int i = 0; i < 1000; ++i) {
      EightLanes x;
      EightLanes y;
      for (int lane = 0; lane < 8; ++lane) {
        const double angle = uniform(random, -largest, largest);
        x.set_lane(lane, std::cos(angle));
        y.set_lane(lane, std::sin(angle));
      }
      const EightLanes all = direction_angle(x, y);
      for (int lane = 0; lane < 8; ++lane) {
        CHECK(all.lane(lane) == direction_angle(x.lane(lane), y.lane(lane)));
      }
    }
  }
}

// Angles up to 0.5 take the series in both lanes, angles up to 12 in one lane, in both or in none.
TEST_CASE("each lane has the values that a double alone has") {
  Random random(7);
  for (const double turns : {0.5, 12.0}) {
    for (int i = 0; i < 1000; ++i) {
      const Sample a0(random, turns);
      const Sample a1(random, turns);
      const Sample b0(random, turns);
      const Sample b1(random, turns);
      const EdgeFrameOf<TwoLanes> a = frame_of(a0, a1);
      const EdgeFrameOf<TwoLanes> b = frame_of(b0, b1);
      const TwoLanes twist = twist_between(a.frame, b.frame);
      const VertexKinematics<AngleCurvature, TwoLanes> both(a.frame, b.frame, twist);
      VertexResponseOf<TwoLanes> response;
      both.respond<true>({{0.3, 0.3}, {0.5, 0.5}, {0.7, 0.7}, {0.1, 0.2, 0.3}}, response);
      for (const int lane : {0, 1}) {
        const EdgeFrame a_alone = (lane == 0 ? a0 : a1).frame();
        const EdgeFrame b_alone = (lane == 0 ? b0 : b1).frame();
        CHECK(is_lane(a_alone.rotation(), a.rotation(), lane));
        const double twist_alone = twist_between(a_alone.frame, b_alone.frame);
        CHECK(twist.lane(lane) == twist_alone);
        VertexResponse alone;
        VertexKinematics<AngleCurvature>(a_alone.frame, b_alone.frame, twist_alone)
            .respond<true>({0.3, 0.5, 0.7, {0.1, 0.2, 0.3}}, alone);
        CHECK(is_lane(alone.moment, response.moment, lane));
        CHECK(is_lane(alone.stiffness, response.stiffness, lane));
        CHECK(is_lane(by_edge(alone, a_alone), by_edge(response, a), lane));
        CHECK(is_lane(a_alone.geometric_stiffness(alone.moment),
                      a.geometric_stiffness(response.moment), lane));
      }
    }
  }
}

}  // namespace der::test
