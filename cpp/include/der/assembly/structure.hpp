#pragma once

#include <string>

#include "der/model/model.hpp"

namespace der {

/// Describes where a model differs from another one in its structure, as a sentence about `here`;
/// empty if it does not. Models of one structure have the same numbering, elements between the same
/// degrees of freedom in the same order, and masses between the same ones: what they share is every
/// place of a matrix. Their numbers may differ.
std::string structural_difference(const Model& here, const Model& other);

}  // namespace der
