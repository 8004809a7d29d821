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

bool overlap(const Actuation& a, const Actuation& b) {
  return a.rod == b.rod && a.from < b.to && b.from < a.to;
}

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
    check_value(context_.scene.rods[number]);
    if (context_.diagnostics.under(path_of(number_))) return;
    check_resolution(context_.scene.rods[number], *context_.lines[number]);
  }

 private:
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

  void check_value(const Rod& rod) {
    if (actuation_.what == Actuated::Elongation) {
      check_elongation();
    } else if (does_not_bend(rod)) {
      report(value_path_, fmt::format("has no effect: rod '{}' does not resist bending (EI is 0), "
                                      "only 'elongation' acts on it",
                                      rod.name));
    } else if (actuation_.what == Actuated::NaturalCurvature) {
      check_curvature(rod);
    }
  }

  void check_elongation() {
    const double own = least(actuation_.values.front());
    if (own <= -1.0) {
      report(value_path_, fmt::format("must be greater than -1, at which the stretch has no length "
                                      "left, got {:g}",
                                      own));
      return;
    }
    double sum = own;
    for (int i = 0; i < number_; ++i) {
      const Actuation& other = context_.scene.actuations[static_cast<std::size_t>(i)];
      if (context_.diagnostics.under(path_of(i)) || other.what != Actuated::Elongation) continue;
      if (overlap(other, actuation_)) sum += std::min(0.0, least(other.values.front()));
    }
    if (sum > -1.0) return;
    report(value_path_, fmt::format("the actuations that overlap here shorten the rod by {:g} of "
                                    "its length or more: give smaller elongations, or stretches "
                                    "that do not overlap",
                                    -sum));
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
    if (actuation_.what != Actuated::NaturalCurvature) return;
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
