#include "der/supports/bearing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "der/core/error.hpp"
#include "der/core/index.hpp"
#include "der/scenario/support.hpp"
#include "der/supports/section_spring.hpp"
#include "model/corner.hpp"

namespace der {
namespace {

/// The stiffness of a bearing over that of an edge beside it: the tangent yields by a part of the
/// edge's turn that rounding hides.
constexpr double kStifferThanEdge = 1e14;

[[noreturn]] void refuse(const char* what, Index place, const RodMesh& rod) {
  throw Error("model_error",
              fmt::format("a 'clamp: tangent' inside rod '{}', at arc length {:.6g} m, {}",
                          rod.name, rod.arc_length_at(place), what));
}

}  // namespace

bool lets_spin_inside(const scenario::Support& support, Index place, const RodMesh& rod) {
  return support.clamp == scenario::Clamp::Tangent && rod.is_inner(place);
}

bool is_bearing(const scenario::Support& support, Index place, const RodMesh& rod,
                const Model& model) {
  return model.has_sections() && lets_spin_inside(support, place, rod);
}

void hold_in_bearing(const scenario::Support& support, Index place, RodMesh& rod,
                     const Model& model) {
  if (is_corner(rod, place, model)) {
    refuse(
        "is at a corner, where the rod has two tangents: to spin about one turns the other. "
        "Write 'clamp: true'",
        place, rod);
  }
  if (support.axis_rotation) {
    refuse(
        "does not turn: write 'clamp: true', which turns the section, too, or leave out its "
        "'rotation'",
        place, rod);
  }
  const double shorter = std::min(rod.edge_length[to_size(rod.edge_before(place))],
                                  rod.edge_length[to_size(rod.edge_after(place))]);
  const double stiffness = kStifferThanEdge * std::max(rod.EI_1, rod.EI_2) / shorter;
  add_to_section_spring(rod.arc_length_at(place), Vec3(stiffness, stiffness, 0.0), rod);
}

}  // namespace der
