#include "der/solvers/predicted_tension.hpp"

#include "der/assembly/element_energy.hpp"
#include "der/core/index.hpp"

namespace der {

PredictedTension::PredictedTension(const Model& model, const Assembler& assembler)
    : model_(model), assembler_(assembler) {
  const auto edges = static_cast<Index>(std::get<ElementList<Stretch<2>>>(model.elements).size());
  tension_.setZero(edges);
  excess_.setZero(edges);
}

void PredictedTension::predict(const Vector& positions, const Vector& direction) {
  const auto& edges = std::get<ElementList<Stretch<2>>>(model_.elements);
  const auto component = [&](Index dof) {
    const Index free = model_.free_index[at(dof)];
    return free < 0 ? 0.0 : direction[free];
  };
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto& dofs = edges.dofs[i];
    const auto ends = gather(dofs, positions);
    const Vec2 e = ends.tail<2>() - ends.head<2>();
    const Vec2 change{component(dofs[2]) - component(dofs[0]),
                      component(dofs[3]) - component(dofs[1])};
    const double length = e.norm();
    const auto& c = edges.constants[i];
    tension_[static_cast<Index>(i)] =
        c.EA * ((length + e.dot(change) / length) / c.rest_length - 1.0);
  }
}

void PredictedTension::use(const Vector& positions, Vector& values) {
  const auto& edges = std::get<ElementList<Stretch<2>>>(model_.elements);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto ends = gather(edges.dofs[i], positions);
    const auto& c = edges.constants[i];
    const Index n = static_cast<Index>(i);
    excess_[n] =
        tension_[n] - c.EA * ((ends.tail<2>() - ends.head<2>()).norm() / c.rest_length - 1.0);
  }
  assembler_.add_tension_stiffness(positions, excess_, values);
}

}  // namespace der
