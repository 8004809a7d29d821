#pragma once

#include <memory>
#include <string>
#include <vector>

#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

namespace scenario {
struct Probe;
struct Scene;
}  // namespace scenario

/// Reads one scalar off a state; what it needs is worked out beforehand, so that reading allocates
/// nothing.
class ProbeReader {
 public:
  ProbeReader() = default;
  ProbeReader(const ProbeReader&) = delete;
  ProbeReader& operator=(const ProbeReader&) = delete;
  virtual ~ProbeReader() = default;
  [[nodiscard]] virtual double value(const Model& model, const State& state) = 0;
  /// Whether the value within an adaptive step is to be interpolated, and not read off interpolated
  /// positions, whose error it would amplify.
  [[nodiscard]] virtual bool amplifies_noise() const { return false; }
};

/// A scalar read off a state, as the scene's `output.probes` name it, with order 2 in the element
/// length or better wherever the solution is smooth:
/// - positions and velocities between nodes by the weights that also spread a point force
///   (model/node_weights.hpp);
/// - strain and tension, which belong to the middles of the edges, linearly between those and
///   beyond the outermost ones;
/// - turning angles at the nodes that bend;
/// - slope and tangent linearly between nodes and places where moments act
///   (output/tangent_line.hpp);
/// - curvature and moment linearly between nodes, with the kinks and jumps that loads cause
///   there (output/moment_recovery.hpp); at a clamp they are extrapolated from its cells to the
///   node, so that the moment is the clamp's reaction;
/// - an extreme over a rod is that of the parabola through the three samples around the extreme
///   one, where there is no kink; not for the turning angle, a sum over a cell;
/// - what a support bears, summed over its places (output/reactions.hpp);
/// - the energies of a rod count a node that rods share in each of them.
class Probe {
 public:
  Probe(const scenario::Probe& probe, const scenario::Scene& scene, const Model& model);
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::string& unit() const { return unit_; }
  [[nodiscard]] double value(const Model& model, const State& state) const {
    return reader_->value(model, state);
  }
  [[nodiscard]] bool amplifies_noise() const { return reader_->amplifies_noise(); }

 private:
  std::string name_;
  std::string unit_;
  std::unique_ptr<ProbeReader> reader_;
};

std::vector<Probe> make_probes(const scenario::Scene& scene, const Model& model);

}  // namespace der
