#include "output/joint_reader.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "der/catalog/quantities.hpp"
#include "der/core/index.hpp"
#include "der/model/location.hpp"
#include "der/scenario/scenario.hpp"
#include "output/leg_field.hpp"

namespace der {
namespace {

class RotationReader : public ProbeReader {
 public:
  explicit RotationReader(Index dof) : dof_(dof) {}
  double value(const Model& /*model*/, const State& state) override {
    return state.positions[dof_];
  }

 private:
  Index dof_;
};

/// By how much the tangent of a rod at one of its nodes has turned.
class TurnReader {
 public:
  TurnReader(const scenario::JointMember& member, const Model& model) {
    const RodMesh& rod = model.rod(member.rod);
    const Index place = node_at(member.at, rod);
    std::size_t first = 0;
    for (const Leg& leg : rod.legs) {
      if (leg.first == place || leg.last == place) {
        const bool at_end = leg.last == place;
        sample_ = {{first + (at_end ? to_size(leg.num_cells()) : 0), 1.0}};
        drawn_ = (at_end ? leg.end : leg.start).direction;
      }
      first += to_size(leg.num_cells()) + 1;
    }
    field_ = make_leg_field(LegQuantity::Slope, rod, model);
  }
  [[nodiscard]] double value(const Model& model, const State& state) const {
    return field_->interpolate(sample_, model, state) - drawn_;
  }

 private:
  std::unique_ptr<RodField> field_;
  SampleWeights sample_;
  double drawn_ = 0.0;
};

class AngleReader : public ProbeReader {
 public:
  AngleReader(const scenario::Joint& joint, const Model& model)
      : first_(joint.of[0], model), second_(joint.of[1], model) {}
  double value(const Model& model, const State& state) override {
    return second_.value(model, state) - first_.value(model, state);
  }

 private:
  TurnReader first_;
  TurnReader second_;
};

/// The sum of what the legs of one rod exert at one of its nodes.
class LegEndReader : public ProbeReader {
 public:
  LegEndReader(LegQuantity quantity, const RodMesh& rod, Index place, const Model& model)
      : field_(make_leg_field(quantity, rod, model)) {
    std::size_t first = 0;
    for (const Leg& leg : rod.legs) {
      const std::size_t last = first + to_size(leg.num_cells());
      // The rod behind the joint exerts what it bears, the rod before it the negative.
      if (leg.first == place) ends_.push_back({first, 1.0});
      if (leg.last == place) ends_.push_back({last, -1.0});
      first = last + 1;
    }
  }
  double value(const Model& model, const State& state) override {
    return field_->interpolate(ends_, model, state);
  }
  [[nodiscard]] bool amplifies_noise() const override { return true; }

 private:
  std::unique_ptr<RodField> field_;
  SampleWeights ends_;
};

LegQuantity leg_quantity(JointQuantity quantity) {
  switch (quantity) {
    case JointQuantity::ForceX:
      return LegQuantity::ForceX;
    case JointQuantity::ForceY:
      return LegQuantity::ForceY;
    default:
      return LegQuantity::Moment;
  }
}

}  // namespace

std::unique_ptr<ProbeReader> make_joint_reader(const scenario::Probe& probe,
                                               const Quantity& quantity,
                                               const scenario::Scene& scene, const Model& model) {
  const auto joint = std::find_if(scene.joints.begin(), scene.joints.end(),
                                  [&](const auto& other) { return other.name == *probe.joint; });
  if (quantity.of_joint == JointQuantity::Rotation) {
    // A rod without bending stiffness does not follow the rotation.
    for (const auto& member : joint->of) {
      const RodMesh& rod = model.rod(member.rod);
      const Index rotation = rod.rotation_at(node_at(member.at, rod));
      if (rotation >= 0) return std::make_unique<RotationReader>(model.dofs.rotation(rotation));
    }
    throw Error("model_error", "probe '" + probe.name + "': no rod of joint '" + joint->name +
                                   "' has a stiffness against bending: it has no rotation");
  }
  if (quantity.of_joint == JointQuantity::Angle) {
    return std::make_unique<AngleReader>(*joint, model);
  }
  const auto member = std::find_if(joint->of.begin(), joint->of.end(),
                                   [&](const auto& each) { return each.rod == *probe.leg; });
  const RodMesh& rod = model.rod(member->rod);
  return std::make_unique<LegEndReader>(leg_quantity(quantity.of_joint), rod,
                                        node_at(member->at, rod), model);
}

}  // namespace der
