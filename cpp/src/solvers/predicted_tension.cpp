#include "der/solvers/predicted_tension.hpp"

#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/stretch.hpp"

namespace der {

PredictedTension::PredictedTension(const Model& model, const Assembler& assembler)
    : model_(model), assembler_(assembler) {
  const auto edges = static_cast<Index>(elements_of<Stretch<2>>(*model.elements).size());
  excess_.setZero(edges);
}

void PredictedTension::use(const Configuration& here, const Vector& step, Vector& values) {
  const auto& edges = elements_of<Stretch<2>>(*model_.elements);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Vec2 after = Stretch<2>::edge(gather(edges.dofs[i], here.coordinates));
    const Vec2 change = Stretch<2>::edge(gather(edges.dofs[i], step));
    const Vec2 before = after - change;
    const double length = before.norm();
    const double predicted = length + before.dot(change) / length;
    const auto& c = edges.constants[i];
    excess_[static_cast<Index>(i)] = c.EA * (predicted - after.norm()) / c.rest_length;
  }
  assembler_.add_tension_stiffness(here, excess_, values);
}

}  // namespace der
