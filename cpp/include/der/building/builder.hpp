#pragma once

#include "der/model/model.hpp"

namespace der {

namespace scenario {
struct Scene;
}

/// The order at which the error of a leg falls with the length of its cells, where it can.
enum class LegOrder { Second, Fourth };

/// Turns a validated scene into a model: chooses the smallest model that can represent it, numbers
/// nodes and degrees of freedom, lists elements, lumps masses and collects loads and supports.
/// Throws Error where the model cannot be built.
Model build_model(const scenario::Scene& scene, LegOrder order = LegOrder::Fourth);
/// Whether any leg has order 4.
bool has_arcs(const Model& model);

}  // namespace der
