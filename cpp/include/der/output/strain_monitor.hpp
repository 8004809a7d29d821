#pragma once

#include <optional>
#include <string>

#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// Looks for rods that are stretched to more than twice their rest length, at which no material
/// obeys a linear law: mostly a unit is wrong. Rods that actuations lengthen are left out.
class StrainMonitor {
 public:
  void look(const Model& model, const State& state);

  /// The edge that was stretched most where that was seen first.
  struct Stretched {
    std::string rod;
    double place = 0.0;        ///< rest arc length of its middle [m]
    double ratio = 0.0;        ///< of its length to its rest length
    double time = 0.0;         ///< [s]
    double load_factor = 1.0;  ///< of a path
  };
  [[nodiscard]] const std::optional<Stretched>& found() const { return found_; }

 private:
  std::optional<Stretched> found_;
};

}  // namespace der
