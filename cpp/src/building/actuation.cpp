#include "building/actuation.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "der/core/index.hpp"
#include "der/model/clamp_cell.hpp"
#include "der/scenario/support.hpp"
#include "der/supports/section_spring.hpp"
#include "model/actuated_turn.hpp"
#include "model/leg_curvature.hpp"

namespace der {
namespace {

using scenario::Actuated;

static_assert(scenario::kEdgePivot == kPivotShare);

/// The parts of the rest shape that the actuations of one rod change.
struct Changes {
  bool lengths = false;
  bool cells = false;
};

Changes changes_of(const scenario::Rod& rod, const scenario::Scene& scene) {
  Changes changes;
  for (const scenario::Actuation& actuation : scene.actuations) {
    if (actuation.rod != rod.name) continue;
    (actuation.what == Actuated::Length ? changes.lengths : changes.cells) = true;
  }
  return changes;
}

/// At least those of the end cells of a rod's legs.
Index entries_of_legs(const scenario::Rod& rod) {
  return 2 * NaturalStrainEntries::kMostAngles * static_cast<Index>(rod.num_edges());
}

Index strains_of_cell(int dimension) { return dimension == 2 ? 1 : 3; }

/// At least the places at which springs against turning, or bearings, hold a rod.
Index num_spring_places(const scenario::Rod& rod, const scenario::Scene& scene) {
  Index count = 0;
  for (const scenario::Support& support : scene.supports) {
    const bool holds = support.clamp == scenario::Clamp::Tangent ||
                       (support.spring && !support.spring->rotational_stiffness.empty());
    if (support.rod != rod.name || !holds) continue;
    const bool everywhere = support.at.kind == scenario::Location::Kind::All;
    count += everywhere ? static_cast<Index>(rod.points.size()) : 1;
  }
  return count;
}

/// Where a stretch ends: on the node there, if there is one.
double on_node(const RodMesh& rod, double s) {
  for (Index place = 0; place <= rod.num_edges(); ++place) {
    if (std::abs(rod.arc_length_at(place) - s) <= rod.same_place()) return rod.arc_length_at(place);
  }
  return s;
}

/// The part of one actuation in the rest shape of the elements.
class Weights {
 public:
  Weights(const ActuatedStretch& stretch, const RodMesh& rod) : stretch_(stretch), rod_(rod) {}

  [[nodiscard]] const std::vector<NaturalStrain::Term>& terms() const { return terms_; }

  void add_elongation() {
    for (Index edge = 0; edge < rod_.num_edges(); ++edge) {
      add(rod_.natural_strain_entries.edge(edge), stretch_.integral(start(edge), end(edge)),
          stretch_.controls[0]);
    }
  }

  /// Sections turn from the middle of one edge to that of the next.
  void add_twist() {
    for (Index edge = 0; edge < rod_.num_edges(); ++edge) {
      const double middle = rod_.edge_middle(edge);
      add_at_start(2, edge, stretch_.integral(start(edge), middle), 0);
      add_at_end(2, edge, stretch_.integral(middle, end(edge)), 0);
    }
  }

  /// Towards director `strain`, or in the plane, by table number `strain`.
  void add_curvature(std::size_t strain) {
    for (const Leg& leg : rod_.legs) add_curvature(leg);
    for (Index edge = 0; edge < (rod_.legs.empty() ? rod_.num_edges() : 0); ++edge) {
      const auto [at_start, at_end] = edge_turns(stretch_, rod_, edge);
      add_at_start(static_cast<Index>(strain), edge, at_start, strain);
      add_at_end(static_cast<Index>(strain), edge, at_end, strain);
    }
  }

 private:
  /// The turning angles of a leg without stress, whose curvature is linear between its nodes.
  void add_curvature(const Leg& leg) {
    const auto at = [&](Index place) {
      return stretch_.profile_at(rod_.arc_length_at(place), place == leg.last);
    };
    const auto number = static_cast<std::size_t>(&leg - rod_.legs.data());
    for (const bool from_start : {true, false}) {
      const Mat3 C = end_compliance(leg, from_start, rod_.edge_length);
      const bool has_cell = (from_start ? leg.start_cell : leg.end_cell) >= 0;
      for (Index i = 0; i < NaturalStrainEntries::kMostAngles && has_cell; ++i) {
        const Index entry = rod_.natural_strain_entries.end_cell(number, from_start).entry + i;
        add({entry}, turn_in_end_cell(leg, from_start, C, i, at), stretch_.controls[0]);
      }
    }
    for (Index place = leg.first + 1; place < leg.last; ++place) {
      if (leg.in_end_cell(place)) continue;
      add(rod_.natural_strain_entries.cell(place, false), turn_at_node(leg, rod_, place, at),
          stretch_.controls[0]);
    }
  }

  [[nodiscard]] double start(Index edge) const { return rod_.arc_length_at(edge); }
  [[nodiscard]] double end(Index edge) const { return rod_.arc_length_at(edge + 1); }

  /// Adds to a strain of the cell between an edge and what is before it; none is at a free end.
  void add_at_start(Index strain, Index edge, double weight, std::size_t table) {
    const bool leaves = rod_.clamp_at(edge) != nullptr;
    if (!leaves && !rod_.is_inner(edge)) return;
    const Mat3 half = leaves ? Mat3::Identity() : rod_.cell_halves_at(edge).after;
    add_strains(half.col(strain), rod_.natural_strain_entries.cell(rod_.position(edge), leaves),
                weight, table);
  }
  /// The same of the cell between an edge and what is after it.
  void add_at_end(Index strain, Index edge, double weight, std::size_t table) {
    const bool arrives = rod_.clamp_at(edge + 1) != nullptr;
    if (!arrives && !rod_.is_inner(edge + 1)) return;
    const Mat3 half = arrives ? Mat3::Identity() : rod_.cell_halves_at(edge + 1).before;
    add_strains(half.col(strain), rod_.natural_strain_entries.cell(rod_.position(edge + 1), false),
                weight, table);
  }

  void add_strains(const Vec3& strains, const NaturalStrainOffset& cell, double weight,
                   std::size_t table) {
    if (cell.entry < 0) return;
    for (Index i = 0; i < rod_.natural_strain_entries.strains; ++i) {
      add({cell.entry + i}, weight * strains[i], stretch_.controls[table]);
    }
  }
  void add(const NaturalStrainOffset& shift, double weight, Index control) {
    if (weight != 0.0) terms_.push_back({shift.entry, control, weight});
  }

  const ActuatedStretch& stretch_;
  const RodMesh& rod_;
  std::vector<NaturalStrain::Term> terms_;
};

NamedControl named_control(const ActuatedStretch& stretch) {
  const char* unit = stretch.what == Actuated::Length  ? ""
                     : stretch.what == Actuated::Twist ? "rad/m"
                                                       : "1/m";
  const std::string key = key_of(stretch.what);
  if (stretch.controls[1] < 0) return {stretch.name, false, {{key, unit, {stretch.controls[0]}}}};
  NamedControl pair{stretch.name, true, {}};
  for (std::size_t i = 0; i < stretch.controls.size(); ++i) {
    pair.components.push_back({i == 0 ? "k1" : "k2", unit, {stretch.controls[i]}});
  }
  return pair;
}

}  // namespace

Index num_rest_entries(const scenario::Scene& scene, int dimension) {
  Index count = 0;
  for (const scenario::Rod& rod : scene.rods) {
    const Changes changes = changes_of(rod, scene);
    if (changes.lengths) count += rod.num_edges();
    if (changes.cells) {
      const Index places =
          2 * static_cast<Index>(rod.points.size()) + num_spring_places(rod, scene);
      count += strains_of_cell(dimension) * places;
      if (!scene.joints.empty()) count += entries_of_legs(rod);
    }
  }
  return count;
}

void set_rest_entries(const scenario::Scene& scene, Model& model) {
  Index next = static_cast<Index>(model.initial_frames.size());
  for (std::size_t i = 0; i < model.rods.size(); ++i) {
    RodMesh& rod = model.rods[i];
    const Changes changes = changes_of(scene.rods[i], scene);
    rod.natural_strain_entries.strains = strains_of_cell(model.dimension);
    if (changes.lengths)
      rod.natural_strain_entries.edges = std::exchange(next, next + rod.num_edges());
    if (changes.cells) {
      const Index size =
          2 * rod.natural_strain_entries.strains * static_cast<Index>(rod.nodes.size());
      rod.natural_strain_entries.cells = std::exchange(next, next + size);
      if (!scene.joints.empty()) {
        rod.natural_strain_entries.legs =
            std::exchange(next, next + entries_of_legs(scene.rods[i]));
      }
      const Index places = num_spring_places(scene.rods[i], scene);
      if (places > 0) {
        rod.natural_strain_entries.springs =
            std::exchange(next, next + rod.natural_strain_entries.strains * places);
      }
    }
  }
}

void add_actuation(const scenario::Actuation& actuation, Model& model) {
  RodMesh& rod = model.rod(actuation.rod);
  ActuatedStretch stretch{actuation.name,
                          actuation.what,
                          actuation.profile,
                          on_node(rod, actuation.from),
                          on_node(rod, actuation.to),
                          {-1, -1}};
  for (std::size_t i = 0; i < actuation.values.size(); ++i) {
    stretch.controls[i] = model.tables.add(actuation.values[i]);
  }
  Weights weights(stretch, rod);
  switch (actuation.what) {
    case Actuated::Length:
      weights.add_elongation();
      break;
    case Actuated::Twist:
      weights.add_twist();
      break;
    case Actuated::Curvature:
      for (std::size_t i = 0; i < actuation.values.size(); ++i) {
        weights.add_curvature(i);
      }
      break;
  }
  model.natural_strain.add(weights.terms());
  model.named.push_back(named_control(stretch));
  rod.actuated_stretches.push_back(stretch);
}

void set_actuated_turns(Model& model) {
  for (RodMesh& rod : model.rods) {
    if (rod.actuated_stretches.empty()) continue;
    const auto shift = [&](const NaturalStrainOffset& spring, const ActuatedTurn& turn) {
      if (spring.entry < 0) return;
      std::vector<NaturalStrain::Term> terms;
      for (const auto& [strain, control, weight] : turn.terms) {
        terms.push_back({spring.entry + strain, control, weight});
      }
      model.natural_strain.add(terms);
    };
    for (MomentPlace& place : rod.moment_places) {
      place.actuated = actuated_turn(place.arc_length, rod);
      if (place.spring >= 0) shift(place.spring_shift, place.actuated);
    }
    for (const SectionSpringPlace& spring : rod.section_springs) {
      shift(spring.shift, actuated_turn_at(spring.arc_length, rod, model));
    }
    for (SpatialMomentPlace& place : rod.spatial_moments) {
      place.actuated = actuated_turn(place.arc_length, section_place(place.arc_length, rod), rod);
    }
  }
}

}  // namespace der
