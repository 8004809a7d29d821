#pragma once

#include <memory>
#include <optional>
#include <string>

#include "der/output/probe.hpp"

namespace der {

/// Reads an energy [J] of one rod, or of the whole model.
std::unique_ptr<ProbeReader> make_energy_reader(const std::string& quantity,
                                                const std::optional<std::string>& rod,
                                                const Model& model);

}  // namespace der
