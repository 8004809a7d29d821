#pragma once

#include <string>
#include <vector>

namespace der {

namespace scenario {
struct Scene;
}

/// Warnings, in sentences, about the tables over time that have entries closer together than equal
/// steps of `step` [s], which go over kinks without seeing them, so that no stepper keeps its
/// order; and about sines that these steps hardly see.
std::vector<std::string> fine_table_warnings(const scenario::Scene& scene, double step);

}  // namespace der
