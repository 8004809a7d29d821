#include "output/glue_kink.hpp"

#include "der/output/vertex_strain.hpp"
#include "model/glue.hpp"
#include "output/section_field.hpp"

namespace der {

std::optional<GlueKink> GlueKink::make(const RodMesh& rod, const Model& model) {
  const bool has_vertex = rod.closed && model.has_sections() && !rod.vertices.empty();
  if (!has_vertex || !parts_bending(rod.vertices.back(), rod)) return std::nullopt;
  return GlueKink(rod, model);
}

GlueKink::GlueKink(const RodMesh& rod, const Model& model)
    : first_edge_(rod.first_edge),
      last_edge_(rod.first_edge + rod.num_edges() - 1),
      curvature_1_(make_section_field(SectionQuantity::Curvature1, rod, model)),
      curvature_2_(make_section_field(SectionQuantity::Curvature2, rod, model)) {}

Vec3 GlueKink::jump(const Model& model, const State& state) const {
  const auto bent = [&](Index edge, std::size_t sample) -> Vec3 {
    const SectionFrame section = section_frame(model, edge, state);
    return curvature_1_->sample(sample, model, state) * section.first +
           curvature_2_->sample(sample, model, state) * section.second;
  };
  return bent(first_edge_, 0) - bent(last_edge_, curvature_1_->arc_length().size() - 1);
}

}  // namespace der
