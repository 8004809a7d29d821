#include "der/solvers/predicted_tension.hpp"

#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/stiffness_across.hpp"
#include "der/energies/stretch.hpp"
#include "der/model/dimension.hpp"

namespace der {

PredictedTension::PredictedTension(const Model& model, const Assembler& assembler)
    : model_(model), assembler_(assembler), excess_(Vector::Zero(assembler.num_plain_edges())) {}

template <int Dim>
void PredictedTension::set_excess(const Configuration& here, const Vector& step, double taken) {
  const auto& edges = elements_of<Stretch<Dim>>(*model_.elements);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto after = Stretch<Dim>::edge(gather(edges.dofs[i], here.coordinates));
    const auto change = Stretch<Dim>::edge(gather(edges.dofs[i], step));
    const auto& c = edges.constants[i];
    excess_[static_cast<Index>(i)] =
        excess_tension<double, Dim>(after - taken * change, change, after, c.EA, c.rest_length);
  }
}

template <int Dim>
void PredictedTension::set_release(const Configuration& here) {
  const auto& edges = elements_of<Stretch<Dim>>(*model_.elements);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double length = Stretch<Dim>::edge(gather(edges.dofs[i], here.coordinates)).norm();
    excess_[static_cast<Index>(i)] =
        -Stretch<Dim>::response(edges.constants[i], here.controls, length).tension;
  }
}

void PredictedTension::use(const Configuration& here, const Vector& step, double taken,
                           Vector& values) {
  with_dimension(model_, [&](auto dim) { set_excess<dim>(here, step, taken); });
  assembler_.add_tension_stiffness(here, excess_, values);
}

void PredictedTension::remove(const Configuration& here, Vector& values) {
  with_dimension(model_, [&](auto dim) { set_release<dim>(here); });
  assembler_.add_tension_stiffness(here, excess_, values);
}

}  // namespace der
