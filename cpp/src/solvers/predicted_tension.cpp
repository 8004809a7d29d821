#include "der/solvers/predicted_tension.hpp"

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"

namespace der {

PredictedTension::PredictedTension(const Model& model, const Assembler& assembler)
    : model_(model), assembler_(assembler) {
  const auto edges = static_cast<Index>(std::get<ElementList<Stretch<2>>>(model.elements).size());
  excess_.setZero(edges);
}

void PredictedTension::use(const Vector& positions, const Vector& direction, Vector& values) {
  const auto& edges = std::get<ElementList<Stretch<2>>>(model_.elements);
  const auto component = [&](Index dof) {
    const Index free = model_.free_index[at(dof)];
    return free < 0 ? 0.0 : direction[free];
  };
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto& dofs = edges.dofs[i];
    const auto ends = gather(dofs, positions);
    const Vec2 after = ends.tail<2>() - ends.head<2>();
    const Vec2 change{component(dofs[2]) - component(dofs[0]),
                      component(dofs[3]) - component(dofs[1])};
    const Vec2 before = after - change;
    const double length = before.norm();
    const double predicted = length + before.dot(change) / length;
    const auto& c = edges.constants[i];
    excess_[static_cast<Index>(i)] = c.EA * (predicted - after.norm()) / c.rest_length;
  }
  assembler_.add_tension_stiffness(positions, excess_, values);
}

}  // namespace der
