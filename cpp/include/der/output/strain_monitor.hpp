#pragma once

#include <optional>
#include <string>

#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// Looks for rods that are stretched to more than twice their rest length, compressed to less than
/// an eighth of it, or bent so that their surface is strained by more than 1: no material obeys a
/// linear law so far, and mostly a unit is wrong. Rods that actuations change are left out.
class StrainMonitor {
 public:
  void look(const Model& model, const State& state);

  /// The edge or node that was strained most where that was seen first; stretching comes first.
  struct Strained {
    std::string rod;
    double place = 0.0;        ///< rest arc length of the edge's middle, or of the node [m]
    double ratio = 1.0;        ///< of the edge's length to its rest length
    double bending = 0.0;      ///< strain of the surface by bending; 0: it is the edge's length
    double time = 0.0;         ///< [s]
    double load_factor = 1.0;  ///< of a path
  };
  [[nodiscard]] const std::optional<Strained>& found() const { return found_; }

 private:
  void look_at_lengths(const Model& model, const RodMesh& rod, const State& state);
  void look_at_bending(const Model& model, const RodMesh& rod, const State& state);

  std::optional<Strained> found_;
};

/// Says it in sentences. `when` is its place in the run.
std::string describe(const StrainMonitor::Strained& strained, const std::string& when);

}  // namespace der
