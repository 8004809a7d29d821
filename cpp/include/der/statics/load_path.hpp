#pragma once

#include <optional>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/scenario/analysis.hpp"

namespace der {

namespace scenario {
struct Scene;
}

/// Loads and prescribed motions in proportion to one factor: 1 is the scene as written, 0 the scene
/// without what varies. The one thing that changes a model after it was built.
class LoadPath {
 public:
  /// What varies: all loads, all prescribed motions, or only number `number` of them.
  LoadPath(const scenario::Scene& scene, const Model& model, scenario::Varied varied,
           std::optional<int> number);

  /// Sets weight, forces and tables of the model to their values at `factor`.
  void apply(double factor, Model& model) const;
  /// Whether the forces of a given shape are linear in the factor: not where supports move.
  [[nodiscard]] bool is_linear() const { return linear_; }
  /// By how much a unit of the factor changes a control.
  [[nodiscard]] double change_of(Index control) const {
    return controls1_[control] - controls0_[control];
  }
  /// Whether anything varies at all.
  [[nodiscard]] bool varies() const {
    return (controls1_ - controls0_).norm() + (gravity1_ - gravity0_).norm() +
               (dead1_ - dead0_).norm() >
           0.0;
  }

 private:
  Vector gravity0_, gravity1_;  // [N]
  Vector dead0_, dead1_;        // [N]
  bool linear_;
  Vector controls0_, controls1_;  // values of the tables at time 0
};

/// Sets a model back to a factor of its loads when it goes out of scope, however that comes about.
class FactorGuard {
 public:
  FactorGuard(const LoadPath& loads, Model& model, double factor = 1.0)
      : loads_(loads), model_(model), factor_(factor) {}
  ~FactorGuard() { loads_.apply(factor_, model_); }
  FactorGuard(const FactorGuard&) = delete;
  FactorGuard& operator=(const FactorGuard&) = delete;
  /// Another factor than that of the constructor.
  void leave_at(double factor) { factor_ = factor; }

 private:
  const LoadPath& loads_;
  Model& model_;
  double factor_;
};

}  // namespace der
