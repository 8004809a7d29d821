#include "building/actuation.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "der/core/index.hpp"
#include "der/model/location.hpp"
#include "der/supports/clamp.hpp"

namespace der {
namespace {

using scenario::Actuated;

/// What the actuations of one rod change.
struct Changes {
  bool lengths = false;
  bool cells = false;
};

Changes changes_of(const scenario::Rod& rod, const scenario::Scene& scene) {
  Changes changes;
  for (const scenario::Actuation& actuation : scene.actuations) {
    if (actuation.rod != rod.name) continue;
    (actuation.what == Actuated::Elongation ? changes.lengths : changes.cells) = true;
  }
  return changes;
}

Index strains_of_cell(int dimension) { return dimension == 2 ? 1 : 3; }

/// Where a stretch ends: on the node there, if there is one.
double on_node(const RodLayout& rod, double s) {
  for (Index place = 0; place <= rod.num_edges(); ++place) {
    if (std::abs(rod.arc_length_at(place) - s) <= rod.same_place()) return rod.arc_length_at(place);
  }
  return s;
}

/// The part of one actuation in the rest shape.
class Weights {
 public:
  Weights(const ActuatedStretch& stretch, const RodLayout& rod) : stretch_(stretch), rod_(rod) {}

  [[nodiscard]] const std::vector<RestShape::Term>& terms() const { return terms_; }

  void add_elongation() {
    for (Index edge = 0; edge < rod_.num_edges(); ++edge) {
      add(rod_.rest_entries.edge(edge), 0,
          integral(rod_.arc_length_at(edge), rod_.arc_length_at(edge + 1)));
    }
  }

  /// Changes the strain number `strain` of a cell by a table: the curvatures are 0 and 1, the twist
  /// 2.
  void add_strain(Index strain, std::size_t table) {
    for (Index place = 0; place <= rod_.num_edges(); ++place) {
      const bool arrives = place > 0;
      const bool leaves = place < rod_.num_edges();
      if (rod_.clamp_at(place) != nullptr) {
        if (arrives) add_cell(place, false, strain, table, from_edge(place - 1, strain), at(place));
        if (leaves) add_cell(place, true, strain, table, at(place), from_edge(place, strain));
      } else if (arrives && rod_.is_inner(place)) {
        add_cell(place, false, strain, table, from_edge(place - 1, strain), from_edge(place, strain));
        if (strain < 2) add_free_ends(place, strain, table);
      }
    }
  }

 private:
  [[nodiscard]] double at(Index place) const { return rod_.arc_length_at(place); }

  /// Where the rod has the direction of an edge, or its section.
  [[nodiscard]] double from_edge(Index edge, Index strain) const {
    return strain < 2 ? tangent_place(rod_, edge) : rod_.edge_middle(edge);
  }

  /// Integral [m] of the profile; around a ring, over parts beyond its ends too.
  [[nodiscard]] double integral(double a, double b) const {
    double sum = stretch_.integral(a, b);
    if (rod_.closed) {
      const double turn = rod_.rest_length();
      sum += stretch_.integral(a - turn, b - turn) + stretch_.integral(a + turn, b + turn);
    }
    return sum;
  }

  void add_cell(Index place, bool leaves, Index strain, std::size_t table, double a, double b) {
    add(rod_.rest_entries.cell(rod_.position(place), leaves), strain, integral(a, b), table);
  }

  /// A free end lies on the curve, the node next to it l^2 kappa/12 beside it (supports/clamp.hpp).
  void add_free_ends(Index place, Index strain, std::size_t table) {
    if (rod_.closed) return;
    const Index last = rod_.num_edges();
    const RestShift cell = rod_.rest_entries.cell(place, false);
    if (place == 1 && rod_.clamp_at(0) == nullptr) {
      add(cell, strain, stretch_.profile_at(0.0, false) * rod_.edge_length.front() / 12.0, table);
    }
    if (place == last - 1 && rod_.clamp_at(last) == nullptr) {
      add(cell, strain, stretch_.profile_at(at(last), true) * rod_.edge_length.back() / 12.0,
          table);
    }
  }

  void add(const RestShift& shift, Index strain, double weight, std::size_t table = 0) {
    if (weight == 0.0) return;
    terms_.push_back({shift.entry + strain, stretch_.controls[table], weight});
  }

  const ActuatedStretch& stretch_;
  const RodLayout& rod_;
  std::vector<RestShape::Term> terms_;
};

}  // namespace

Index num_rest_entries(const scenario::Scene& scene, int dimension) {
  Index count = 0;
  for (const scenario::Rod& rod : scene.rods) {
    const Changes changes = changes_of(rod, scene);
    if (changes.lengths) count += rod.num_edges();
    if (changes.cells) {
      count += 2 * strains_of_cell(dimension) * static_cast<Index>(rod.points.size());
    }
  }
  return count;
}

void set_rest_entries(const scenario::Scene& scene, Model& model) {
  Index next = static_cast<Index>(model.drawn_frames.size());
  for (std::size_t i = 0; i < model.rods.size(); ++i) {
    RodLayout& rod = model.rods[i];
    const Changes changes = changes_of(scene.rods[i], scene);
    rod.rest_entries.strains = strains_of_cell(model.dimension);
    if (changes.lengths) rod.rest_entries.edges = std::exchange(next, next + rod.num_edges());
    if (changes.cells) {
      const Index size = 2 * rod.rest_entries.strains * static_cast<Index>(rod.nodes.size());
      rod.rest_entries.cells = std::exchange(next, next + size);
    }
  }
}

void add_actuation(const scenario::Actuation& actuation, Model& model) {
  RodLayout& rod = model.rod(actuation.rod);
  ActuatedStretch stretch{actuation.name, actuation.what, actuation.profile,
                          on_node(rod, actuation.from), on_node(rod, actuation.to), {-1, -1}};
  for (std::size_t i = 0; i < actuation.values.size(); ++i) {
    stretch.controls[i] = model.tables.add(actuation.values[i]);
  }
  Weights weights(stretch, rod);
  switch (actuation.what) {
    case Actuated::Elongation:
      weights.add_elongation();
      break;
    case Actuated::NaturalTwist:
      weights.add_strain(2, 0);
      break;
    case Actuated::NaturalCurvature:
      for (std::size_t i = 0; i < actuation.values.size(); ++i) {
        weights.add_strain(static_cast<Index>(i), i);
      }
      break;
  }
  model.rest_shape.add(weights.terms());
  rod.actuated_stretches.push_back(stretch);
}

}  // namespace der
