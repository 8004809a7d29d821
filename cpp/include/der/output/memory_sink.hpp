#pragma once

#include "der/output/frame.hpp"
#include "der/output/frame_data.hpp"

namespace der {

/// Keeps the saved instants in memory; the probes are in the order of the scene.
class MemorySink : public FrameSink, public FrameData {
 public:
  void write(const Frame& frame) override;
};

}  // namespace der
