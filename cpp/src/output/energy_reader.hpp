#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "der/catalog/energy_terms.hpp"
#include "der/output/probe.hpp"

namespace der {

/// Reads the sum of some terms of the energy [J] of one rod, or of the whole model.
std::unique_ptr<ProbeReader> make_energy_reader(const std::vector<EnergyTerm>& terms,
                                                const std::optional<std::string>& rod,
                                                const Model& model);

}  // namespace der
