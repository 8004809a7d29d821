#include <algorithm>
#include <cmath>
#include <vector>

#include "der/core/constants.hpp"
#include "scenario/checks.hpp"
#include "scenario/directions.hpp"

namespace der::scenario {
namespace {

Path path_of(int number) { return {"actuation", number}; }

/// The least value that a table has at any time.
double least(const Series& series) {
  if (series.course.kind == Course::Kind::Sine) {
    return series.values[0] - std::abs(series.values[1]);
  }
  return *std::min_element(series.values.begin(), series.values.end());
}

/// The largest magnitude that a table has at any time.
double largest(const Series& series) {
  if (series.course.kind == Course::Kind::Sine) {
    return std::abs(series.values[0]) + std::abs(series.values[1]);
  }
  double size = 0.0;
  for (const double value : series.values) size = std::max(size, std::abs(value));
  return size;
}

/// The longest edge of a stretch [m].
double longest_edge(const RestLine& line, const Actuation& actuation) {
  double longest = 0.0;
  for (int node = 0; node < line.num_nodes(); ++node) {
    const bool last = node + 1 == line.num_nodes();
    const double start = line.arc_length(node);
    const double end = last ? line.length() : line.arc_length(node + 1);
    if (start < actuation.to && actuation.from < end) longest = std::max(longest, end - start);
  }
  return longest;
}

/// The profile at an arc length [m] of the stretch.
double profile_at(const Actuation& actuation, double s) {
  const double u = (s - actuation.from) / (actuation.to - actuation.from);
  switch (actuation.profile) {
    case Profile::Constant:
      return 1.0;
    case Profile::Linear:
      return u;
    case Profile::Smooth:
      break;
  }
  return std::pow(std::sin(kPi * u), 2);
}

/// Elongation that leaves the edge beside a clamp a length from its pivot on.
constexpr double kLeastAtClamp = -0.75;

/// The checks of one actuation.
class ActuationCheck {
 public:
  ActuationCheck(CheckContext& context, int number)
      : context_(context),
        number_(number),
        actuation_(context.scene.actuations[static_cast<std::size_t>(number)]),
        value_path_(path_of(number) / key_of(actuation_.what)) {}

  void run() {
    check_tables();
    const auto rod = context_.find_rod(actuation_.rod, path_of(number_) / "rod");
    if (!rod) return;
    const auto number = static_cast<std::size_t>(*rod);
    check_stretch(*context_.lines[number]);
    check_value(context_.scene.rods[number], *context_.lines[number], *rod);
    if (context_.diagnostics.under(path_of(number_))) return;
    check_resolution(context_.scene.rods[number], *context_.lines[number]);
  }

 private:
  /// A part of a rod [m].
  struct Part {
    double from = 0.0;
    double to = 0.0;
    [[nodiscard]] bool overlaps(double a, double b) const { return from < b && a < to; }
  };

  void report(const Path& where, const std::string& message) {
    context_.diagnostics.add(where, message);
  }

  void check_tables() {
    if (context_.scene.is_dynamic()) return;
    if (std::all_of(actuation_.values.begin(), actuation_.values.end(),
                    [](const Series& series) { return series.constant(); })) {
      return;
    }
    report(value_path_, "a static analysis has no time: give a constant in place of a table");
  }

  void check_stretch(const RestLine& line) {
    if (actuation_.from >= line.length()) {
      report(path_of(number_) / "from",
             fmt::format("must be less than the rod's length, {:.9g} m, got {} m", line.length(),
                         actuation_.from));
    }
    if (std::isfinite(actuation_.to) && actuation_.to > line.length() + line.same_place()) {
      report(path_of(number_) / "to",
             fmt::format("arc length {} m lies beyond the rod's length, {:.9g} m", actuation_.to,
                         line.length()));
    }
    actuation_.to = std::min(actuation_.to, line.length());
  }

  void check_value(const Rod& rod, const RestLine& line, int number) {
    if (actuation_.what == Actuated::Length) {
      check_elongation(line, number);
    } else if (does_not_bend(rod)) {
      report(value_path_, fmt::format("has no effect: rod '{}' does not resist bending (EI is 0), "
                                      "only 'elongation' acts on it",
                                      rod.name));
    } else if (actuation_.what == Actuated::Curvature) {
      check_curvature(rod);
    }
  }

  void check_elongation(const RestLine& line, int rod) {
    const std::vector<Part> at_clamps = edges_at_clamps(line, rod);
    const double own = least(actuation_.values.front());
    const bool clamped = std::any_of(at_clamps.begin(), at_clamps.end(), [&](const Part& edge) {
      return edge.overlaps(actuation_.from, actuation_.to);
    });
    if (own <= (clamped ? kLeastAtClamp : -1.0)) {
      report(value_path_,
             clamped
                 ? fmt::format("must be greater than {:g} beside a clamp, whose edge starts from "
                               "a pivot at a fifth of its length, got {:g}",
                               kLeastAtClamp, own)
                 : fmt::format("must be greater than -1, at which the stretch has no length "
                               "left, got {:g}",
                               own));
      return;
    }
    const Shortening together = largest_shortening(at_clamps);
    if (together.sum > together.limit) return;
    report(value_path_, fmt::format("the actuations that overlap here shorten the rod by {:g} of "
                                    "its length: give smaller elongations, or stretches that do "
                                    "not overlap",
                                    -together.sum));
  }

  [[nodiscard]] std::vector<Part> edges_at_clamps(const RestLine& line, int rod) const {
    std::vector<Part> edges;
    const int count = line.num_nodes();
    for (int node = 0; node < count; ++node) {
      if (!context_.is_clamped(rod, node)) continue;
      const double before = line.arc_length(std::max(0, node - 1));
      const double after = node + 1 < count ? line.arc_length(node + 1) : line.length();
      edges.push_back({before, after});
    }
    return edges;
  }

  /// A sum of elongations and what it has to be greater than.
  struct Shortening {
    double sum = 0.0;
    double limit = -1.0;
  };

  /// Of this elongation and those before it in the scene, at one place and time.
  [[nodiscard]] Shortening largest_shortening(const std::vector<Part>& at_clamps) const {
    std::vector<const Actuation*> all;
    std::vector<double> places{actuation_.from, actuation_.to};
    std::vector<double> times{0.0};
    for (int i = 0; i <= number_; ++i) {
      const Actuation& other = context_.scene.actuations[static_cast<std::size_t>(i)];
      if (other.what != Actuated::Length || other.rod != actuation_.rod) continue;
      if (context_.diagnostics.under(path_of(i))) continue;
      all.push_back(&other);
      places.insert(places.end(), {other.from, 0.5 * (other.from + other.to), other.to});
      const std::vector<double>& own = other.values.front().times;
      times.insert(times.end(), own.begin(), own.end());
    }
    for (const Part& edge : at_clamps) places.insert(places.end(), {edge.from, edge.to});
    std::sort(places.begin(), places.end());
    Shortening largest;
    for (std::size_t k = 0; k + 1 < places.size(); ++k) {
      const double a = places[k];
      const double b = places[k + 1];
      if (a < actuation_.from || b > actuation_.to || !(a < b)) continue;
      const bool at_clamp = std::any_of(at_clamps.begin(), at_clamps.end(),
                                        [&](const Part& edge) { return edge.overlaps(a, b); });
      const double limit = at_clamp ? kLeastAtClamp : -1.0;
      for (const double s : {a, 0.5 * (a + b), b}) {
        for (const double time : times) {
          const double sum = elongation_at(all, a, b, s, time);
          if (sum - limit < largest.sum - largest.limit) largest = {sum, limit};
        }
      }
    }
    return largest;
  }

  /// The sum at a place of a part from `a` to `b`, which every stretch covers or does not reach.
  static double elongation_at(const std::vector<const Actuation*>& all, double a, double b,
                              double s, double time) {
    double sum = 0.0;
    for (const Actuation* each : all) {
      if (each->from > a || each->to < b) continue;
      const Series& series = each->values.front();
      const bool sine = series.course.kind == Course::Kind::Sine;
      sum += profile_at(*each, s) * (sine ? least(series) : value_at(series, time));
    }
    return sum;
  }

  void check_curvature(const Rod& rod) {
    if (actuation_.values.size() == 2) {
      if (context_.diagnostics.dimension() == 2) {
        report(value_path_,
               "a pair of curvatures needs a scene of three components: give one number or table, "
               "the curvature about z, or vectors of three components");
      }
      return;
    }
    if (is_flat(rod) && rod.initial_twist == 0.0) return;
    report(value_path_,
           "a number is a curvature about z, of a rod drawn without twist at one z: give a pair "
           "[k1, k2], the curvatures toward the director and across it");
  }

  /// Edges turn by less than half a turn, and a mesh is coarse from 1 rad on
  /// (check_resolution.cpp).
  void check_resolution(const Rod& rod, const RestLine& line) {
    if (actuation_.what != Actuated::Curvature) return;
    double squares = 0.0;
    for (const Series& series : actuation_.values) squares += std::pow(largest(series), 2);
    const double angle = std::sqrt(squares) * longest_edge(line, actuation_);
    const auto enough = [&] {
      return std::round(2.0 * angle * static_cast<double>(line.num_nodes()));
    };
    if (rod.curvature == CurvatureMeasure::Angle && angle >= kPi) {
      report(value_path_,
             fmt::format("asks for a turn of {:.3g} rad between edges, and edges turn by less than "
                         "half a turn: give the rod more nodes, about {:g} for this curvature",
                         angle, enough()));
    } else if (angle > 1.0) {
      context_.scene.warnings.push_back(
          fmt::format("rod '{}' is too coarse for actuation.{}: without stress the edges turn by "
                      "{:.2g} rad. Give it about {:g} nodes",
                      rod.name, actuation_.name, angle, enough()));
    }
  }

  CheckContext& context_;
  int number_;
  Actuation& actuation_;
  Path value_path_;
};

}  // namespace

void check_actuations(CheckContext& context) {
  for (int i = 0; i < static_cast<int>(context.scene.actuations.size()); ++i) {
    if (context.diagnostics.under(path_of(i)) || context.diagnostics.at(path_of(i))) continue;
    ActuationCheck(context, i).run();
  }
}

}  // namespace der::scenario
