#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// Edges of a coarse mesh that actuations together turn far.
struct SharpTurn {
  std::string rod;
  Index node = 0;                  ///< of the rod: between the edges, or of a clamp
  double angle = 0.0;              ///< without stress [rad]
  double curvature = 0.0;          ///< the largest that the actuations have there together [1/m]
  std::vector<std::string> names;  ///< of the actuations, in the order of the scene
  bool is_possible = true;         ///< whether edges can turn so far
};

/// The angles by which the curvatures that programs set, several together, turn the edges of a
/// model.
class TurningLimits {
 public:
  explicit TurningLimits(const Model& model);

  /// Whether no actuation bends a rod.
  [[nodiscard]] bool empty() const { return curvatures_.empty(); }
  /// Whether a control is that of a curvature.
  [[nodiscard]] bool bends(Index control) const { return find(control) < curvatures_.size(); }

  /// Values that a program is about to set, one for each component, to be reached at `end` [s].
  struct Setting {
    const ControlComponent* begin = nullptr;
    const double* values = nullptr;
    std::size_t size = 0;
    double end = 0.0;
  };
  /// The sharpest turn between edges that a setting bends, once all is reached that has been set.
  /// None: it is no more than a mesh resolves (scenario::kCoarseTurn). Fast where that is certain.
  std::optional<SharpTurn> sharpest(const Model& model, const State& state, const Setting& set);
  /// That of all edges at a time [s], if it is half a turn or more.
  std::optional<SharpTurn> sharpest(const Model& model, const State& state, double time);

 private:
  struct Part {
    std::size_t curvature = 0;
    std::size_t direction = 0;  // 0 or 1: towards which director, in space
    double weight = 0.0;        // turn over curvature [m]
  };
  struct Cell {
    std::size_t rod = 0;
    Index node = 0;
    std::vector<Part> parts;
  };
  struct Curvature {
    std::string name;
    Index control = 0;
    double value = 0.0;                 // at the time that is looked at [1/m]
    double largest_weight = 0.0;        // of all cells [m]
    std::vector<std::size_t> cells;     // that it bends
    std::vector<std::size_t> partners;  // that bend one of them, itself too
  };

  void add_rod(const Model& model, std::size_t number);
  /// Number of the curvature with this control; as many as there are if there is none.
  [[nodiscard]] std::size_t find(Index control) const;
  void evaluate(const Model& model, const State& state, double time, const Setting* set);
  /// At least the turn in each cell of a curvature, of the present values.
  [[nodiscard]] double bound(const Curvature& curvature) const;
  [[nodiscard]] double angle(const Cell& cell) const;
  [[nodiscard]] SharpTurn describe(const Cell& cell, const Model& model) const;
  /// The sharper one of `found` and of the turns that a curvature bends, of the present values.
  void look(const Curvature& curvature, const Cell*& found) const;

  std::vector<Curvature> curvatures_;
  std::vector<Cell> cells_;
};

}  // namespace der
