#pragma once

#include <memory>

#include "der/model/model.hpp"
#include "output/rod_field.hpp"

namespace der {

/// A field along a ring, from its start around to its start again: `own` has each of its samples
/// once, in their order, beginning anywhere. Samples at the start and the end, where it has none,
/// are interpolated between those on both sides; both have the same value unless it jumps there.
std::unique_ptr<RodField> around_ring(std::unique_ptr<RodField> own, const RodMesh& rod);

}  // namespace der
