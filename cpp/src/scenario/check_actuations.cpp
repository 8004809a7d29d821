#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "der/core/constants.hpp"
#include "der/scenario/stretch_profile.hpp"
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

/// The values that a table has at a time: of a sine, those at any time.
struct Range {
  double least = 0.0;
  double most = 0.0;
  void add(const Range& other, double weight) {
    least += std::min(weight * other.least, weight * other.most);
    most += std::max(weight * other.least, weight * other.most);
  }
  [[nodiscard]] double size() const { return std::max(std::abs(least), std::abs(most)); }
};

Range range_at(const Series& series, double time) {
  if (series.course.kind == Course::Kind::Sine) {
    const double amplitude = std::abs(series.values[1]);
    return {series.values[0] - amplitude, series.values[0] + amplitude};
  }
  const double value = value_at(series, time);
  return {value, value};
}

StretchProfile profile_of(const Actuation& actuation) {
  return {actuation.profile, actuation.from, actuation.to};
}

/// The edges of a rod, with the places where it is clamped.
class Edges {
 public:
  Edges(const CheckContext& context, int rod)
      : context_(context), rod_(rod), line_(*context.lines[static_cast<std::size_t>(rod)]) {}

  [[nodiscard]] int size() const { return line_.num_nodes() - (line_.closed() ? 0 : 1); }
  [[nodiscard]] double start(int edge) const { return line_.arc_length(edge); }
  [[nodiscard]] double end(int edge) const {
    return edge + 1 < line_.num_nodes() ? line_.arc_length(edge + 1) : line_.length();
  }
  [[nodiscard]] double length(int edge) const { return end(edge) - start(edge); }
  [[nodiscard]] int node_at_end(int edge) const { return (edge + 1) % line_.num_nodes(); }
  [[nodiscard]] bool clamp_at_start(int edge) const { return context_.is_clamped(rod_, edge); }
  [[nodiscard]] bool clamp_at_end(int edge) const {
    return context_.is_clamped(rod_, node_at_end(edge));
  }
  [[nodiscard]] bool at_clamp(int edge) const { return clamp_at_start(edge) || clamp_at_end(edge); }
  /// Whether the rod bends at a node: edges meet there, or one is clamped.
  [[nodiscard]] bool bends(int node) const {
    const bool inner = 0 < node && node + 1 < line_.num_nodes();
    return inner || line_.closed() || context_.is_clamped(rod_, node);
  }

 private:
  const CheckContext& context_;
  int rod_;
  const RestLine& line_;
};

/// All entries of the tables of actuations [s].
std::vector<double> times_of(const std::vector<const Actuation*>& all) {
  std::vector<double> times{0.0};
  for (const Actuation* each : all) {
    for (const Series& series : each->values) {
      times.insert(times.end(), series.times.begin(), series.times.end());
    }
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

/// By how much the curvatures of a rod turn its edges.
class ActuatedTurns {
 public:
  /// The largest turn between edges.
  struct Turn {
    double angle = 0.0;      ///< [rad]
    int node = 0;            ///< between the edges, or of a clamp
    double curvature = 0.0;  ///< the largest that the actuations have together there [1/m]
    std::vector<const Actuation*> by;
  };

  /// `all` are actuations of that rod, curvatures all.
  ActuatedTurns(const Edges& edges, const Rod& rod, std::vector<const Actuation*> all)
      : all_(std::move(all)) {
    const std::vector<double> times = times_of(all_);
    const bool pairs = std::any_of(all_.begin(), all_.end(),
                                   [](const Actuation* each) { return each->values.size() == 2; });
    for (const Actuation* each : all_) {
      std::vector<Values>& values = values_.emplace_back();
      for (const double time : times) values.push_back(values_at(*each, time, pairs, rod));
    }
    find_cells(edges);
  }

  [[nodiscard]] Turn largest() const {
    Turn found;
    for (const Cell& cell : cells_) enter(cell, found);
    return found;
  }

 private:
  using Values = std::array<Range, 2>;  // of the curvatures towards two directions [1/m]
  struct Part {
    std::size_t actuation = 0;
    double weight = 0.0;  // turn over curvature [m]
  };
  /// Where edges turn against each other, or one against a clamp.
  struct Cell {
    int node = 0;
    std::vector<Part> parts;
  };

  static Values values_at(const Actuation& actuation, double time, bool pairs, const Rod& rod) {
    Values values;
    const Range first = range_at(actuation.values[0], time);
    if (actuation.values.size() == 2) return {first, range_at(actuation.values[1], time)};
    if (!pairs) return {first, Range{}};
    const auto [towards_1, towards_2] = flat_director(rod).pair(1.0);
    values[0].add(first, towards_1);
    values[1].add(first, towards_2);
    return values;
  }

  void find_cells(const Edges& edges) {
    std::map<std::pair<int, bool>, Cell> cells;  // by node, and whether it is that after a clamp
    for (std::size_t i = 0; i < all_.size(); ++i) {
      const StretchProfile profile = profile_of(*all_[i]);
      for (int edge = 0; edge < edges.size(); ++edge) {
        if (edges.end(edge) <= profile.from || profile.to <= edges.start(edge)) continue;
        const bool start = edges.clamp_at_start(edge);
        const bool end = edges.clamp_at_end(edge);
        const EdgeTurns turns = edge_turns(profile, edges.start(edge), edges.end(edge), start, end);
        add(cells[{edge, start}], edge, {i, turns.at_start});
        add(cells[{edges.node_at_end(edge), false}], edges.node_at_end(edge), {i, turns.at_end});
      }
    }
    for (auto& [key, cell] : cells) {
      if (edges.bends(key.first)) cells_.push_back(std::move(cell));
    }
  }

  static void add(Cell& cell, int node, const Part& part) {
    cell.node = node;
    if (!cell.parts.empty() && cell.parts.back().actuation == part.actuation) {
      cell.parts.back().weight += part.weight;
    } else {
      cell.parts.push_back(part);
    }
  }

  void enter(const Cell& cell, Turn& largest) const {
    for (std::size_t time = 0; time < values_.front().size(); ++time) {
      Values turn;
      Values curvature;
      for (const Part& part : cell.parts) {
        const Values& values = values_[part.actuation][time];
        for (std::size_t c = 0; c < 2; ++c) {
          turn[c].add(values[c], part.weight);
          curvature[c].add(values[c], 1.0);
        }
      }
      const double angle = std::hypot(turn[0].size(), turn[1].size());
      if (!(angle > (1.0 + kRounding) * largest.angle)) continue;
      largest = {angle, cell.node, std::hypot(curvature[0].size(), curvature[1].size()), {}};
      for (const Part& part : cell.parts) {
        const Values& values = values_[part.actuation][time];
        const bool acts = values[0].size() > 0.0 || values[1].size() > 0.0;
        if (acts) largest.by.push_back(all_[part.actuation]);
      }
    }
  }

  std::vector<const Actuation*> all_;
  std::vector<std::vector<Values>> values_;  // of each, at each time
  std::vector<Cell> cells_;
};

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
    check_value(context_.scene.rods[number], *rod);
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

  void check_value(const Rod& rod, int number) {
    if (actuation_.what == Actuated::Length) {
      check_elongation(Edges(context_, number));
    } else if (does_not_bend(rod)) {
      report(value_path_, fmt::format("has no effect: rod '{}' does not resist bending (EI is 0), "
                                      "only 'elongation' acts on it",
                                      rod.name));
    } else if (actuation_.what == Actuated::Curvature) {
      check_curvature(rod);
    }
  }

  void check_elongation(const Edges& edges) {
    const double own = least(actuation_.values.front());
    if (own <= kLeastElongation) {
      report(value_path_, fmt::format("must be greater than -1, at which the stretch has no length "
                                      "left, got {:g}",
                                      own));
      return;
    }
    const std::vector<const Actuation*> all = elongations_so_far();
    const double sum = least_sum(all);
    if (sum <= kLeastElongation) {
      report(value_path_, fmt::format("the actuations that overlap here shorten the rod by {:g} of "
                                      "its length: give smaller elongations, or stretches that do "
                                      "not overlap",
                                      -sum));
      return;
    }
    for (int edge = 0; edge < edges.size(); ++edge) {
      if (edges.at_clamp(edge)) check_edge_at_clamp(edges, edge, all);
    }
  }

  /// A clamp's edge as a whole keeps more than the part up to its pivot.
  void check_edge_at_clamp(const Edges& edges, int edge, const std::vector<const Actuation*>& all) {
    const auto share = [&](const Actuation& each) {
      return profile_of(each).integral(edges.start(edge), edges.end(edge)) / edges.length(edge);
    };
    if (share(actuation_) == 0.0 || context_.diagnostics.at(value_path_)) return;
    double shortest = 0.0;
    for (const double time : times_of(all)) {
      double sum = 0.0;
      for (const Actuation* each : all) {
        sum += share(*each) * range_at(each->values.front(), time).least;
      }
      shortest = std::min(shortest, sum);
    }
    if (shortest > kLeastElongationAtClamp) return;
    const double own = least(actuation_.values.front());
    const double own_limit = kLeastElongationAtClamp / share(actuation_);
    report(value_path_,
           own <= own_limit
               ? fmt::format("must be greater than {:.4g} beside a clamp, whose edge starts from a "
                             "pivot at a fifth of its length, got {:g}",
                             own_limit, own)
               : fmt::format("the actuations that overlap here shorten the edge beside a clamp by "
                             "{:g} of its length, which has to be less than {:g}: give smaller "
                             "elongations, or stretches that do not overlap",
                             -shortest, -kLeastElongationAtClamp));
  }

  /// This elongation and those of the same rod before it in the scene.
  [[nodiscard]] std::vector<const Actuation*> elongations_so_far() const {
    std::vector<const Actuation*> all;
    for (int i = 0; i <= number_; ++i) {
      const Actuation& other = context_.scene.actuations[static_cast<std::size_t>(i)];
      if (other.what != Actuated::Length || other.rod != actuation_.rod) continue;
      if (!context_.diagnostics.under(path_of(i))) all.push_back(&other);
    }
    return all;
  }

  /// The least sum of elongations at a place of this stretch and at any time.
  [[nodiscard]] double least_sum(const std::vector<const Actuation*>& all) const {
    std::vector<double> places;
    for (const Actuation* each : all) {
      places.insert(places.end(), {each->from, 0.5 * (each->from + each->to), each->to});
    }
    std::sort(places.begin(), places.end());
    const std::vector<double> times = times_of(all);
    double smallest = 0.0;
    for (std::size_t k = 0; k + 1 < places.size(); ++k) {
      const double a = places[k];
      const double b = places[k + 1];
      if (a < actuation_.from || b > actuation_.to || !(a < b)) continue;
      for (const double s : {a, 0.5 * (a + b), b}) {
        for (const double time : times) {
          smallest = std::min(smallest, elongation_at(all, a, b, s, time));
        }
      }
    }
    return smallest;
  }

  /// The sum at a place of a part from `a` to `b`, which every stretch covers or does not reach.
  static double elongation_at(const std::vector<const Actuation*>& all, double a, double b,
                              double s, double time) {
    double sum = 0.0;
    for (const Actuation* each : all) {
      if (each->from > a || each->to < b) continue;
      sum += profile_of(*each).at(s) * range_at(each->values.front(), time).least;
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

  CheckContext& context_;
  int number_;
  Actuation& actuation_;
  Path value_path_;
};

/// That edges turn by less than half a turn, whatever actuations do so together. Warns of a coarse
/// mesh.
void check_turns(CheckContext& context, int number) {
  const Rod& rod = context.scene.rods[static_cast<std::size_t>(number)];
  std::vector<const Actuation*> all;
  for (int i = 0; i < static_cast<int>(context.scene.actuations.size()); ++i) {
    const Actuation& each = context.scene.actuations[static_cast<std::size_t>(i)];
    if (each.rod != rod.name || each.what != Actuated::Curvature) continue;
    if (context.diagnostics.under(path_of(i)) || context.diagnostics.at(path_of(i))) continue;
    all.push_back(&each);
  }
  if (all.empty()) return;
  const RestLine& line = *context.lines[static_cast<std::size_t>(number)];
  const ActuatedTurns::Turn turn = ActuatedTurns(Edges(context, number), rod, all).largest();
  if (turn.angle <= kCoarseTurn) return;
  const double nodes = fine_nodes(turn.curvature, line.length());
  if (rod.curvature == CurvatureMeasure::Angle && turn.angle >= kPi) {
    const auto last = static_cast<int>(turn.by.back() - context.scene.actuations.data());
    context.diagnostics.add(
        path_of(last) / key_of(Actuated::Curvature),
        fmt::format("{}asks for a turn of {:.3g} rad at node {}, and edges turn by less than half "
                    "a turn: give the rod more nodes, about {:g} for this curvature",
                    turn.by.size() > 1 ? "together with what overlaps it " : "", turn.angle,
                    turn.node, nodes));
    return;
  }
  std::vector<std::string> names;
  for (const Actuation* each : turn.by) names.push_back("actuation." + each->name);
  context.scene.warnings.push_back(
      fmt::format("rod '{}' is too coarse for {}: without stress the edges turn by {:.2g} rad at "
                  "node {}. Give it about {:g} nodes",
                  rod.name, fmt::join(names, " and "), turn.angle, turn.node, nodes));
}

}  // namespace

void check_actuations(CheckContext& context) {
  for (int i = 0; i < static_cast<int>(context.scene.actuations.size()); ++i) {
    if (context.diagnostics.under(path_of(i)) || context.diagnostics.at(path_of(i))) continue;
    ActuationCheck(context, i).run();
  }
  for (int rod = 0; rod < static_cast<int>(context.lines.size()); ++rod) {
    if (context.lines[static_cast<std::size_t>(rod)]) check_turns(context, rod);
  }
}

}  // namespace der::scenario
