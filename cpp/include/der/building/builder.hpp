#pragma once

#include "der/model/model.hpp"

namespace der {

namespace scenario {
struct Scene;
}

/// Of the error of legs in the length of their cells, where a leg can have it.
enum class LegOrder { Second, Fourth };

/// Turns a validated scene into a model: chooses the smallest model that can represent it, numbers
/// nodes and degrees of freedom, lists elements, lumps masses and collects loads and supports.
/// Throws Error where the model cannot be built.
Model build_model(const scenario::Scene& scene, LegOrder order = LegOrder::Fourth);
/// Whether any leg has order 4.
bool has_arcs(const Model& model);

}  // namespace der
