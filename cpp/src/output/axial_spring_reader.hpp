#pragma once

#include <memory>

#include "der/catalog/quantities.hpp"
#include "der/output/probe.hpp"
#include "der/scenario/scenario.hpp"

namespace der {

/// The reader of a probe of a spring between joints: its length, or its force.
std::unique_ptr<ProbeReader> make_axial_spring_reader(SpringReading read, const std::string& name,
                                                      const scenario::Scene& scene,
                                                      const Model& model);

}  // namespace der
