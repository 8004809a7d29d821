#pragma once

#include <array>
#include <cstddef>

namespace der {

/// The kinds of energy. A kernel says by its `kTerm` which one its elements store; `Load` stands
/// last and is not recorded, for loads are counted by their work (`kLedger` in model/state.hpp).
enum class EnergyTerm { Kinetic, Stretch, Bend, Spring, Gravity, Load };

/// One row of the table of recorded terms.
struct EnergyTermInfo {
  EnergyTerm term;
  const char* name;     ///< its column in a run file and its key in a summary; probes: NAME_energy
  bool elastic;         ///< stored in elements: a part of `elastic_energy`
  const char* meaning;  ///< in words
};

/// Every recorded term, in the order of `EnergyTerm`. A new term is a name there and a row here:
/// run files, summaries, probes, exports and Python follow this table.
inline constexpr std::array kEnergyTerms{
    EnergyTermInfo{EnergyTerm::Kinetic, "kinetic", false, "energy of motion"},
    EnergyTermInfo{EnergyTerm::Stretch, "stretch", true, "energy of stretching"},
    EnergyTermInfo{EnergyTerm::Bend, "bend", true, "energy of bending"},
    EnergyTermInfo{EnergyTerm::Spring, "spring", true, "energy of springs and foundations"},
    EnergyTermInfo{EnergyTerm::Gravity, "gravity", false,
                   "potential energy of the weight, zero at the origin"},
};

constexpr const char* kEnergyUnit = "J";

/// Row number of a term in `kEnergyTerms`.
constexpr std::size_t row_of(EnergyTerm term) { return static_cast<std::size_t>(term); }

/// Whether energy of this term is recorded.
constexpr bool is_recorded(EnergyTerm term) { return row_of(term) < kEnergyTerms.size(); }

constexpr bool has_row_for_every_term() {
  for (std::size_t row = 0; row < kEnergyTerms.size(); ++row) {
    if (row_of(kEnergyTerms[row].term) != row) return false;
  }
  return row_of(EnergyTerm::Load) == kEnergyTerms.size();
}
static_assert(has_row_for_every_term(), "kEnergyTerms and EnergyTerm differ");

}  // namespace der
