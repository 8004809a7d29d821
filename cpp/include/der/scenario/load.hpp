#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <variant>
#include <vector>

#include "der/scenario/location.hpp"
#include "der/scenario/mark.hpp"
#include "der/scenario/series.hpp"

namespace der::scenario {

// A kind of load is a struct with
//   static constexpr const char* kKey;       its key in the scene
//   static constexpr auto kAmounts = ...;    if it has a force or a moment, constant or over time
// and a place in the variant `AnyLoad`. Its keys are in src/scenario/load_table.cpp, its mechanics
// in src/loads/ (loads.hpp). The checks of names and places come with the structs that it derives
// from. A path of loads scales the amounts, a static analysis wants them constant, and warnings
// look at their tables.

/// On a whole rod.
struct OnRod {
  std::string rod;
};
/// At a place of a rod.
struct AtPlace : OnRod {
  std::string joint;  ///< in place of the rod and the place, which the checks then set
  Location at;
};
/// On a part of a rod, [m] of its rest length.
struct OnPart : OnRod {
  double from = 0.0;
  double to = std::numeric_limits<double>::infinity();  ///< the reader limits it to the rod
};

/// A value that a load is proportional to: its key below that of the load, empty where the load has
/// no other, and the member that holds it (Series or VectorSeries).
template <class Load, class Value>
struct Amount {
  const char* key;
  Value Load::* member;
};
/// The amounts of a load that has one. A load with more joins them by std::tuple_cat.
template <class Load, class Value>
constexpr auto single_amount(const char* key, Value Load::* member) {
  return std::tuple{Amount<Load, Value>{key, member}};
}

struct Gravity {
  static constexpr const char* kKey = "gravity";
  VectorSeries acceleration;  ///< [m/s^2]
  static constexpr auto kAmounts = single_amount("", &Gravity::acceleration);
};
/// Stokes drag 6 pi mu R u and buoyancy on the spheres. The buoyancy follows gravity.
struct Fluid {
  static constexpr const char* kKey = "fluid";
  double density = 0.0;    ///< [kg/m^3]; 0: no buoyancy
  double viscosity = 0.0;  ///< [Pa s]
};
/// Linear damping: a force -coefficient * velocity per unit rest length, on one rod or on all.
struct Damping {
  static constexpr const char* kKey = "damping";
  std::optional<std::string> rod;
  double coefficient = 0.0;  ///< [N s/m^2]
};
struct PointForce : AtPlace {
  static constexpr const char* kKey = "point_force";
  VectorSeries force;     ///< [N]
  bool follower = false;  ///< whether it turns with the rod; otherwise it keeps its direction
  static constexpr auto kAmounts = single_amount("force", &PointForce::force);
};
struct Moment : AtPlace {
  static constexpr const char* kKey = "moment";
  Series moment;               ///< [N m] about z, positive counter-clockwise: of the planar model
  VectorSeries moment_vector;  ///< [N m] of the spatial models; not given in the planar one
  bool follower = false;       ///< whether it turns with the rod
  static constexpr auto kAmounts = std::tuple_cat(single_amount("moment", &Moment::moment),
                                                  single_amount("moment", &Moment::moment_vector));
};
/// A dead force per unit rest length.
struct DistributedForce : OnPart {
  static constexpr const char* kKey = "distributed_force";
  VectorSeries force;  ///< [N/m]
  static constexpr auto kAmounts = single_amount("force", &DistributedForce::force);
};

/// An elastic (Winkler) foundation: springs along a part that pull every point to where it is
/// drawn. It holds the rod as a support does: a path of loads leaves it as it is.
struct Foundation : OnPart {
  static constexpr const char* kKey = "foundation";
  Components stiffness;  ///< [N/m^2] along each axis, per unit rest length
};

/// Every kind of load.
using AnyLoad =
    std::variant<Gravity, Fluid, Damping, PointForce, Moment, DistributedForce, Foundation>;

struct Load {
  std::string name;  ///< by which programs set it and overrides find it; empty: none
  AnyLoad what;
  Mark mark;
};

/// The keys of all kinds of load, in the order of `AnyLoad`.
const std::vector<std::string_view>& load_kinds();

template <class Kind, class = void>
struct HasAmounts : std::false_type {};
template <class Kind>
struct HasAmounts<Kind, std::void_t<decltype(Kind::kAmounts)>> : std::true_type {};

/// Calls `f(key, value)` for each amount of one kind of load, which may be const.
template <class Kind, class F>
void for_each_amount(Kind& load, F&& f) {
  if constexpr (HasAmounts<Kind>::value) {
    std::apply([&](const auto&... amount) { (f(amount.key, load.*amount.member), ...); },
               Kind::kAmounts);
  }
}

/// Sets the amounts of a load to zero. Its tables remain, so that the model has as many controls.
void set_to_zero(Load& load);

}  // namespace der::scenario
