#pragma once

#include "der/model/model.hpp"

namespace der {

namespace scenario {
struct Scene;
}

/// Turns a validated scene into a model: chooses the smallest model that can represent it, numbers
/// nodes and degrees of freedom, lists elements, lumps masses and collects loads and supports.
/// Throws Error where the model cannot be built.
Model build_model(const scenario::Scene& scene);

}  // namespace der
