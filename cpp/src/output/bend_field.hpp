#pragma once

#include <memory>
#include <string>

#include "output/rod_field.hpp"

namespace der {

/// The field of `turning_angle`, at the nodes that bend, or of `curvature` or `moment`, at all
/// nodes and wherever loads between them make a kink or a jump: there linear in between, of order 2
/// up to the ends (output/moment_recovery.hpp). A rod without bending stiffness has a curvature at
/// its inner nodes alone.
std::unique_ptr<RodField> make_bend_field(const std::string& quantity, const RodLayout& rod,
                                          const Model& model);

}  // namespace der
