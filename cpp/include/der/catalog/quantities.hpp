#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "der/catalog/energy_terms.hpp"

namespace der {

struct Model;
struct RodMesh;
struct State;
class RodField;
struct Reaction;
struct ActuationForce;

/// The object that a quantity belongs to; it determines where a probe of it can be placed.
enum class QuantityKind {
  Position,   ///< of the rod's points: known at nodes, read at any arc length
  Velocity,   ///< of the rod's points: known at nodes, read at any arc length
  Tangent,    ///< of the rod's tangent: any arc length, with two values at corners as drawn
  Turn,       ///< of the nodes that bend: inner nodes, and ends that are clamped
  Bend,       ///< of the rod's bending: any arc length, with two values where moments jump
  Edge,       ///< of the edges: any arc length, with two values where forces jump
  Section,    ///< of the sections of a rod in space: as of its bending
  Natural,    ///< of the rod without stress: as of its bending
  Ring,       ///< of a closed rod as a whole: no place
  Support,    ///< of a support: no place but that of the support
  Actuation,  ///< of an actuation: no place but its stretch
  Joint,      ///< of a joint: no place but that of the joint
  Spring,     ///< of a spring between joints
  Energy,     ///< of a rod or of the whole model: no place
};

/// Whether a quantity has two values at the places where it jumps.
constexpr bool can_jump(QuantityKind kind) {
  return kind == QuantityKind::Bend || kind == QuantityKind::Edge ||
         kind == QuantityKind::Section || kind == QuantityKind::Natural ||
         kind == QuantityKind::Tangent;
}

/// The models that have a quantity.
enum class QuantityScope {
  All,
  Planar,
  Space,     ///< `spatial_bend` and `spatial`
  Sections,  ///< `spatial`
};

/// Makes the reader of a quantity along a rod (output/rod_field.hpp).
using RodFieldMaker = std::unique_ptr<RodField> (*)(const RodMesh& rod, const Model& model);

/// Reads a quantity of a rod as a whole (output/ring_numbers.hpp).
using RodReading = double (*)(const RodMesh& rod, const Model& model, const State& state);

/// Reads a quantity of a support off the sum of what it bears at its places (output/reactions.hpp).
using ReactionReading = double (*)(const Reaction& sum);

/// Reads a quantity of an actuation off what it exerts (output/actuation_forces.hpp).
using ActuationReading = double (*)(const ActuationForce& force);

/// The quantity of a joint that a probe reads (output/joint_reader.hpp).
enum class JointQuantity {
  None,
  Rotation,
  RotationX,
  RotationY,
  RotationZ,
  Angle,
  ForceX,
  ForceY,
  ForceZ,
  MomentX,
  MomentY,
  MomentZ
};

/// Reads a quantity of a spring between joints off its length [m] and its tension [N].
using SpringReading = double (*)(double length, double tension);

/// Whether it is of the joint as a whole, not of a rod's part in it.
constexpr bool is_rotation(JointQuantity quantity) {
  return quantity == JointQuantity::Rotation || quantity == JointQuantity::RotationX ||
         quantity == JointQuantity::RotationY || quantity == JointQuantity::RotationZ;
}

/// One row of the table of quantities: probes, `Replay::along`, exports and views follow it.
struct Quantity {
  std::string name;
  std::string unit;  ///< "" for a pure number
  QuantityKind kind;
  std::string meaning;
  RodFieldMaker make_field = nullptr;  ///< of energies and of numbers of rings none
  std::vector<EnergyTerm> energies;    ///< the terms that an energy adds up; else empty
  bool is_component = false;  ///< of the position or velocity, which exports write as vectors
  QuantityScope scope = QuantityScope::All;
  /// Makes quantities of space along rods of a smaller model that stands for a larger one.
  RodFieldMaker make_field_in_smaller = nullptr;
  /// Whether it is the part of a curvature or moment towards a director of the section.
  bool is_towards_director = false;
  RodReading read_rod = nullptr;            ///< of numbers of rings
  ReactionReading read_reaction = nullptr;  ///< of supports
  ActuationReading read_actuation = nullptr;
  JointQuantity of_joint = JointQuantity::None;
  SpringReading read_spring = nullptr;
  std::string actuates{};  ///< of actuations: the key of those that have the quantity
  std::string advice{};    ///< what to take in its place in a model that lacks it; may be empty
};

/// The quantity whose whole turns the state of a planar rod follows where a probe asks for it.
inline constexpr std::string_view kSlope = "slope";

/// The table. It is written in output/quantities.cpp, where the makers are; this header is all that
/// the reader of scenes knows of it.
const std::vector<Quantity>& quantities();
/// Whether models of a kind have the quantity by themselves.
bool is_available_in(int dimension, bool has_sections, const Quantity& quantity);
/// Whether a model has it by itself.
bool is_own(const Quantity& quantity, const Model& model);
/// Whether all rods of a model have the quantity. The dimension of the scene decides: where `auto`
/// chose `planar` for a scene of three components, it has the quantities of space, such as `z`, and
/// none that only a plane has, such as `slope`. So a sweep may pass a scene that is flat.
bool is_available(const Quantity& quantity, const Model& model);
/// Whether it is available, or is the value of a larger model that `spatial_bend` stands for, such
/// as `twist`. Those towards directors need a clamp that holds the section of the rod.
bool is_answered(const Quantity& quantity, const Model& model);
/// Whether only planar models have it, and whether only models in space have it by themselves.
bool is_of_plane(const Quantity& quantity);
bool is_of_space(const Quantity& quantity);
/// The message that the model of this name does not have the quantity, with what to write.
std::string lacks(std::string_view model, const Quantity& quantity);
/// The message that a flat scene of three components lacks a quantity of planar scenes.
std::string lacks_in_flat_scene(const Quantity& quantity);
/// The message that the model 'spatial_bend', which stands for 'spatial', does not tell where the
/// directors of a rod are.
std::string lacks_held_section(std::string_view rod, std::string_view quantity);
/// Null for an unknown name.
const Quantity* find_quantity(std::string_view name);

}  // namespace der
