#pragma once

#include <optional>
#include <string>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// An edge that elongations together shorten too much.
struct ShortenedEdge {
  /// One of them.
  struct Part {
    std::string name;
    Index control = 0;
    double weight = 0.0;  ///< what the edge grows by, over its length, where the value is 1
    double value = 0.0;
  };
  std::string rod;
  double from = 0.0, to = 0.0;  ///< arc lengths [m]
  double shortening = 0.0;      ///< share of the length
  double least = 0.0;           ///< what the sum of elongations has to be greater than
  bool at_clamp = false;
  std::vector<Part> parts;

  /// The bound that the elongation by a control must exceed, with the others as they are.
  [[nodiscard]] double least_of(Index control) const;
  /// The elongations but that by a control, in words: "'a' is -0.6 and 'b' is -0.2".
  [[nodiscard]] std::string of_others(Index control) const;
};

/// Which edges of a model keep a length only if several elongations, or one beside a clamp, are not
/// too small together. A single one is limited by its own value.
class ElongationLimits {
 public:
  explicit ElongationLimits(const Model& model);

  /// Whether there is no such edge.
  [[nodiscard]] bool empty() const { return edges_.empty(); }
  /// Whether a control is that of an elongation on such an edge.
  [[nodiscard]] bool sums(Index control) const;
  /// The edge that is shortened most beyond its limit at `time` [s] of a motion from `state` on, if
  /// there is one; with `set` in place of what its control follows, of the edges that it
  /// elongates. Allocates nothing if there is none.
  std::optional<ShortenedEdge> shortest(const Model& model, const State& state, double time,
                                        const Ramp* set = nullptr);

 private:
  struct Elongation {
    std::string name;
    Index control = 0;
    double value = 0.0;  // at the time
  };
  struct Part {
    std::size_t elongation = 0;
    double weight = 0.0;
  };
  struct Edge {
    std::size_t rod = 0;
    Index number = 0;  // in the rod
    double least = 0.0;
    std::vector<Part> parts;
  };

  [[nodiscard]] bool is_known(const Edge& edge) const;
  [[nodiscard]] ShortenedEdge describe(const Edge& edge, const Model& model) const;
  [[nodiscard]] double sum(const Edge& edge) const;
  [[nodiscard]] bool has(const Edge& edge, Index control) const;

  std::vector<Elongation> elongations_;
  std::vector<Edge> edges_;  // one of those with the same limit and weights
};

}  // namespace der
