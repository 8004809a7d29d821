#include "der/scenario/model_choice.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>
#include <variant>
#include <vector>

#include "der/scenario/load.hpp"
#include "scenario/directions.hpp"

namespace der::scenario {
namespace {

// Each of these functions returns what stands against a model, as a clause; "" if nothing does.

/// The first clause of those about the parts of a list that is not empty.
template <class Part, class About>
std::string first_of(const std::vector<Part>& parts, About&& about) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    std::string clause = about(parts[i], i);
    if (!clause.empty()) return clause;
  }
  return {};
}

bool asks_for_modes(const Scene& scene) {
  return std::holds_alternative<ModesAnalysis>(scene.analysis);
}

bool acts_along_z(const Components& value) { return along_z(value) != 0.0; }
bool acts_along_z(const VectorSeries& series) {
  return std::any_of(series.values.begin(), series.values.end(),
                     [](const Components& value) { return acts_along_z(value); });
}

// ---- planar

/// Whether bending in the x-y plane stays in it.
bool bends_in_plane(const Rod& rod) {
  if (is_isotropic(rod.cross_section)) return true;
  const FlatDirector director = flat_director(rod);
  return std::min(std::abs(director.normal), std::abs(director.z)) <= kRounding;
}

/// Whether a spring turns a rod that lies in the plane about z where it turns it at all.
bool turns_in_plane(const Spring& spring, const Rod& rod) {
  const Components& k = spring.rotational_stiffness;
  if (k.empty() || k[0] == k[1]) return true;
  const FlatDirector director = flat_director(rod);
  return std::min(std::abs(director.normal), std::abs(director.z)) <= kRounding;
}

/// Whether the natural curvature of a rod that lies in the plane is about z.
bool is_curved_in_plane(const Rod& rod) {
  const FlatDirector director = flat_director(rod);
  const auto in_plane = [&director](const CurvaturePair& pair) {
    return std::abs(director.out_of_plane(pair)) <= kRounding * std::hypot(pair.first, pair.second);
  };
  if (const auto* pair = std::get_if<CurvaturePair>(&rod.natural_curvature)) return in_plane(*pair);
  const auto* pairs = std::get_if<std::vector<CurvaturePair>>(&rod.natural_curvature);
  return !pairs || std::all_of(pairs->begin(), pairs->end(), in_plane);
}

std::string out_of_plane(const Rod& rod) {
  std::string clause = first_of(rod.points, [&](const Components& point, std::size_t node) {
    return along_z(point) == 0.0 ? std::string()
                                 : fmt::format("node {} of rod '{}' lies at z = {:g} m", node,
                                               rod.name, along_z(point));
  });
  if (!clause.empty()) return clause;
  if (std::any_of(rod.initial_velocity.begin(), rod.initial_velocity.end(),
                  [](const Components& velocity) { return acts_along_z(velocity); })) {
    return fmt::format("rod '{}' begins to move along z", rod.name);
  }
  if (!bends_in_plane(rod)) {
    return fmt::format("neither the width nor the height of rod '{}' lies in the x-y plane",
                       rod.name);
  }
  if (!is_curved_in_plane(rod)) {
    return fmt::format("the natural curvature of rod '{}' is not about z", rod.name);
  }
  return {};
}

std::string out_of_plane(const Support& support, std::size_t number, const Scene& scene) {
  for (const Prescribed& motion : support.prescribe) {
    if (motion.component == Component::Z && !is_zero(motion.displacement)) {
      return fmt::format("supports.{} moves along z", number);
    }
  }
  if (support.clamps() && !support.clamps(Component::Z)) {
    return fmt::format("supports.{} lets its node move along z", number);
  }
  if (support.axis_rotation) {
    const Components& axis = support.axis_rotation->axis;
    if (axis[0] != 0.0 || axis[1] != 0.0) {
      return fmt::format("supports.{} turns about an axis that is not z", number);
    }
  }
  if (support.spring && acts_along_z(support.spring->anchor) &&
      acts_along_z(support.spring->stiffness)) {
    return fmt::format("the spring of supports.{} pulls along z", number);
  }
  for (const Rod& rod : scene.rods) {
    if (rod.name != support.rod || !support.spring || turns_in_plane(*support.spring, rod))
      continue;
    return fmt::format("the spring of supports.{} does not turn rod '{}' about z", number,
                       rod.name);
  }
  return {};
}

struct OutOfPlane {
  std::size_t number;

  std::string operator()(const Moment& load) const {
    const auto& values = load.moment_vector.values;
    const bool about_z = std::all_of(values.begin(), values.end(), [](const Components& moment) {
      return moment[0] == 0.0 && moment[1] == 0.0;
    });
    return about_z ? std::string()
                   : fmt::format("loads.{}.moment is about an axis that is not z", number);
  }
  template <class Kind>
  std::string operator()(const Kind& load) const {
    std::string clause;
    for_each_amount(load, [&](const char* /*key*/, const auto& amount) {
      if (acts_along_z(amount)) {
        clause = fmt::format("loads.{}.{} has a z component", number, Kind::kKey);
      }
    });
    return clause;
  }
};

std::string out_of_plane(const Actuation& actuation, const Scene& scene) {
  if (actuation.what != Actuated::Curvature || actuation.values.size() != 2) return {};
  for (const Rod& rod : scene.rods) {
    if (rod.name != actuation.rod) continue;
    const FlatDirector director = flat_director(rod);
    // A program may drive what is 0 in the scene, but for the one that stays beside another.
    const bool toward_first = std::abs(director.normal) > kRounding;
    const bool toward_second = std::abs(director.z) > kRounding;
    const bool in_plane = (toward_first && !toward_second && is_zero(actuation.values[1]) &&
                           !is_zero(actuation.values[0])) ||
                          (toward_second && !toward_first && is_zero(actuation.values[0]) &&
                           !is_zero(actuation.values[1]));
    if (!in_plane)
      return fmt::format("actuation.{} bends rod '{}' to two sides", actuation.name, rod.name);
  }
  return {};
}

// ---- no twist

struct IsZero {
  bool operator()(const StressFreeReference& /*curvature*/) const { return false; }
  bool operator()(double curvature) const { return curvature == 0.0; }
  bool operator()(const CurvaturePair& pair) const {
    return pair.first == 0.0 && pair.second == 0.0;
  }
  template <class Value>
  bool operator()(const std::vector<Value>& list) const {
    return std::all_of(list.begin(), list.end(), *this);
  }
};

/// A twist that the rod has by itself.
std::string own_twist(const Rod& rod) {
  if (rod.initial_twist != 0.0) return fmt::format("rod '{}' has an initial twist", rod.name);
  const bool as_drawn = std::holds_alternative<StressFreeReference>(rod.natural_twist);
  if (!as_drawn && !std::visit(IsZero{}, rod.natural_twist)) {
    return fmt::format("rod '{}' has a natural twist", rod.name);
  }
  return {};
}

std::string actuated_twist(const Actuation& actuation) {
  if (actuation.what != Actuated::Twist) return {};
  return fmt::format("actuation.{} twists rod '{}'", actuation.name, actuation.rod);
}

/// A rod that an actuation bends has a natural curvature.
std::string actuated_bend(const Actuation& actuation) {
  if (actuation.what != Actuated::Curvature) return {};
  return fmt::format("actuation.{} curves rod '{}' without stress", actuation.name, actuation.rod);
}

std::string prescribed_twist(const Support& support, std::size_t number) {
  if (!support.twist || is_zero(*support.twist)) return {};
  return fmt::format("supports.{} twists rod '{}'", number, support.rod);
}

bool is_naturally_straight(const Rod& rod) {
  if (std::holds_alternative<StressFreeReference>(rod.natural_curvature)) return is_straight(rod);
  return std::visit(IsZero{}, rod.natural_curvature);
}

std::string may_twist(const Rod& rod, const Scene& scene) {
  if (!is_isotropic(rod.cross_section)) {
    return fmt::format("the two bending stiffnesses of rod '{}' differ", rod.name);
  }
  if (!is_cable(rod) && !is_naturally_straight(rod)) {
    return fmt::format("rod '{}' is curved without stress", rod.name);
  }
  const auto* direct = std::get_if<Stiffness>(&rod.cross_section);
  const bool moves = scene.is_dynamic() || asks_for_modes(scene);
  if (moves && direct && direct->rotary_inertia.value_or(0.0) > 0.0) {
    return fmt::format("the sections of rod '{}' have a rotary inertia", rod.name);
  }
  if (scene.is_dynamic() && !is_cable(rod) && damping_of(rod).bending > 0.0) {
    return fmt::format("the damping of bending inside rod '{}' turns its sections", rod.name);
  }
  return {};
}

/// Whether the rotation of a clamp over time, or by a program, spins the section about the rod. A
/// rotation about an axis across the held tangent does not.
bool spins(const Support& support, const Rod& rod) {
  if (!support.axis_rotation) return false;
  if (support.axis_rotation->angle.constant() && support.name.empty()) return false;
  if (!is_straight(rod)) return true;
  const Vec3 axis = in_space(support.axis_rotation->axis);
  const Vec3 along = in_space(rod.points.back()) - in_space(rod.points.front());
  return std::abs(axis.dot(along)) > kRounding * axis.norm() * along.norm();
}

/// Two sections that are held could hold a twist between them.
std::string holds_sections(const Rod& rod, const Scene& scene) {
  std::optional<std::size_t> first;
  return first_of(scene.supports, [&](const Support& support, std::size_t number) {
    if (support.rod != rod.name || support.clamp != Clamp::Section) return std::string();
    if (first) {
      return fmt::format("supports.{} and supports.{} both hold the section of rod '{}'", *first,
                         number, rod.name);
    }
    first = number;
    if (support.at.kind == Location::Kind::All) {
      return fmt::format("supports.{} holds every section of rod '{}'", number, rod.name);
    }
    if (spins(support, rod)) {
      return fmt::format("supports.{} spins the section of rod '{}'", number, rod.name);
    }
    return std::string();
  });
}

std::string may_twist(const Support& support, std::size_t number) {
  if (support.spring && !support.spring->rotational_stiffness.empty()) {
    return fmt::format("supports.{} has a spring against rotation", number);
  }
  return {};
}

struct MayTwist {
  std::size_t number;

  std::string operator()(const Moment& load) const {
    return fmt::format("loads.{}.moment can twist rod '{}'", number, load.rod);
  }
  std::string operator()(const PointForce& load) const {
    if (!load.follower) return {};
    return fmt::format("loads.{}.point_force turns with rod '{}'", number, load.rod);
  }
  template <class Kind>
  std::string operator()(const Kind& /*load*/) const {
    return {};
  }
};

// ---- both

template <class AboutLoad>
std::string about_loads(const Scene& scene) {
  return first_of(scene.loads, [](const Load& load, std::size_t number) {
    return std::visit(AboutLoad{number}, load.what);
  });
}

std::string first_clause(std::initializer_list<std::string> clauses) {
  const auto* found = std::find_if(clauses.begin(), clauses.end(),
                                   [](const std::string& clause) { return !clause.empty(); });
  return found == clauses.end() ? std::string() : *found;
}

std::string why_it_twists(const Scene& scene) {
  return first_clause(
      {first_of(scene.rods, [](const Rod& rod, std::size_t /*number*/) { return own_twist(rod); }),
       first_of(scene.supports, prescribed_twist),
       first_of(scene.actuations, [](const Actuation& each, std::size_t /*number*/) {
         return actuated_twist(each);
       })});
}

std::string why_not_planar(const Scene& scene) {
  return first_clause(
      {first_of(scene.rods,
                [](const Rod& rod, std::size_t /*number*/) { return out_of_plane(rod); }),
       first_of(scene.supports, [&](const Support& support,
                                    std::size_t i) { return out_of_plane(support, i, scene); }),
       about_loads<OutOfPlane>(scene),
       first_of(scene.actuations,
                [&](const Actuation& each, std::size_t /*number*/) {
                  return out_of_plane(each, scene);
                }),
       why_it_twists(scene)});
}

/// The reason against `planar` where nobody asked for it. Modes leave the plane in which a
/// structure rests, so that those of a flat scene are those of its neighbours.
std::string why_not_planar_by_itself(const Scene& scene) {
  if (std::string clause = why_not_planar(scene); !clause.empty()) return clause;
  if (!asks_for_modes(scene) || !scene.in_space) return {};
  return "vibration modes of a scene of three components are those in space";
}

/// A ring has no end to let go of the twist that its writhe makes, and writhe needs space.
std::string writhes(const Scene& scene) {
  const auto ring = std::find_if(scene.rods.begin(), scene.rods.end(),
                                 [](const Rod& rod) { return rod.closed && !is_cable(rod); });
  if (ring == scene.rods.end()) return {};
  if (why_not_planar(scene).empty() && !asks_for_modes(scene)) return {};
  return fmt::format("rod '{}' is closed, so that its writhe twists it", ring->name);
}

std::string why_not_spatial_bend(const Scene& scene) {
  return first_clause(
      {why_it_twists(scene), writhes(scene),
       first_of(scene.rods,
                [&](const Rod& rod, std::size_t /*number*/) { return may_twist(rod, scene); }),
       first_of(scene.actuations,
                [](const Actuation& each, std::size_t /*number*/) { return actuated_bend(each); }),
       first_of(scene.rods,
                [&](const Rod& rod, std::size_t /*number*/) { return holds_sections(rod, scene); }),
       first_of(scene.supports,
                [](const Support& support, std::size_t i) { return may_twist(support, i); }),
       about_loads<MayTwist>(scene)});
}

}  // namespace

const char* name_of(ModelChoice kind) {
  switch (kind) {
    case ModelChoice::Spatial:
      return "spatial";
    case ModelChoice::SpatialBend:
      return "spatial_bend";
    default:
      return "planar";
  }
}

std::string why_not(ModelChoice kind, const Scene& scene) {
  if (kind == ModelChoice::Planar) return why_not_planar(scene);
  if (kind == ModelChoice::SpatialBend) return why_not_spatial_bend(scene);
  return {};
}

ChosenModel choose_model(const Scene& scene) {
  if (scene.model != ModelChoice::Auto) return {scene.model, "asked for by the scene"};
  if (scene.in_space && !scene.joints.empty()) {
    return {ModelChoice::Spatial, "the scene has joints and vectors of three components"};
  }
  const std::string planar = why_not_planar_by_itself(scene);
  if (planar.empty()) {
    return {ModelChoice::Planar, "every position, force and support lies in the x-y plane"};
  }
  const std::string bend = why_not_spatial_bend(scene);
  if (bend.empty()) return {ModelChoice::SpatialBend, planar + ", and no rod can twist"};
  return {ModelChoice::Spatial, planar == bend ? planar : planar + ", and " + bend};
}

}  // namespace der::scenario
