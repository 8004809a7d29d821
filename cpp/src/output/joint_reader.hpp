#pragma once

#include <memory>

#include "der/output/probe.hpp"

namespace der {

struct Quantity;

/// The reader of a probe of a joint: its rotation, or what a rod exerts on it.
std::unique_ptr<ProbeReader> make_joint_reader(const scenario::Probe& probe,
                                               const Quantity& quantity,
                                               const scenario::Scene& scene, const Model& model);

}  // namespace der
