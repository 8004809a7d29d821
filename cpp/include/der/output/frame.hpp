#pragma once

#include <cstdint>

#include "der/core/types.hpp"
#include "der/model/state.hpp"

namespace der {

class Recorder;
class Simulation;

/// One saved instant of a run. It refers to vectors that live on in the simulation: a sink copies
/// what it keeps.
struct Frame {
  double time = 0.0;                        ///< [s]
  std::int64_t step = 0;                    ///< steps done
  Eigen::Ref<const Vector> positions;       ///< of the nodes [m]
  Eigen::Ref<const Vector> velocities;      ///< of the nodes [m/s]
  Eigen::Ref<const Vector> theta;           ///< of the edges [rad]; none without sections
  Eigen::Ref<const Vector> spin;            ///< its rate [rad/s]
  Eigen::Ref<const Vector> section_frames;  ///< blocks of the edges (kinematics/frame_block.hpp)
  Eigen::Ref<const Vector> turns;  ///< of followed edges or joints, whole turns included [rad]
  Energies energies;               ///< [J]
  const Work& work;                ///< [J] since the start
  const Vector& probes;            ///< one value a probe, in the order of the scene
};

/// Takes the saved instants of a run, one after the other: into memory, into a file, ...
class FrameSink {
 public:
  FrameSink() = default;
  FrameSink(const FrameSink&) = delete;
  FrameSink& operator=(const FrameSink&) = delete;
  virtual ~FrameSink() = default;

  virtual void write(const Frame& frame) = 0;
  /// Called after every step, saved or not (behind `write`): for work now and then, like writing
  /// out what has gathered. Must cost next to nothing when there is nothing to do.
  virtual void stepped(const Simulation& /*simulation*/, const Recorder& /*recorder*/) {}
};

}  // namespace der
