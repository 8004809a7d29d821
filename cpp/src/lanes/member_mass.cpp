#include "der/lanes/member_mass.hpp"

#include <algorithm>

#include "der/assembly/pattern.hpp"

namespace der {

template <class T>
bool MemberMass<T>::suits(const Model& model) {
  return model.mass.coupling.empty() || MemberBand<T>::suits(build_mass_pattern(model));
}

template <class T>
MemberMass<T>::MemberMass(const MemberModel<T>& model)
    : model_(model), free_(model.structure().num_free()) {
  const Model& structure = model.structure();
  if (structure.mass.coupling.empty()) return;
  const Pattern pattern = build_mass_pattern(structure);
  const auto layout = MatrixLayout::band(pattern.size, pattern.half_bandwidth);
  const auto free = [&](Index dof) { return structure.dofs.free_index(dof); };
  MemberVector<T>& values = band_.emplace(pattern, Elimination::FromStart).values();
  for (const Index dof : structure.dofs.free()) {
    values[layout.slot(free(dof), free(dof))] = model.lumped[dof];
  }
  for (std::size_t i = 0; i < structure.mass.coupling.size(); ++i) {
    const auto& [a, b, unused] = structure.mass.coupling[i];
    const T& mass = model.coupling[static_cast<Index>(i)];
    values[layout.slot(free(a), free(a))] -= mass;
    values[layout.slot(free(b), free(b))] -= mass;
    values[layout.slot(std::max(free(a), free(b)), std::min(free(a), free(b)))] += mass;
  }
  band_->factorize();
}

template <class T>
void MemberMass<T>::solve(MemberVector<T>& b) {
  const Model& structure = model_.structure();
  const std::vector<Index>& free = structure.dofs.free();
  if (band_) {
    run_member_loop<T>([&] {
      for (Index i = 0; i < free_.size(); ++i) free_[i] = b[free[to_size(i)]];
    });
    band_->solve(free_);
    run_member_loop<T>([&] {
      for (Index i = 0; i < free_.size(); ++i) b[free[to_size(i)]] = free_[i];
    });
  } else {
    run_member_loop<T>([&] {
      for (Index i = 0; i < b.size(); ++i) b[i] /= model_.lumped[i];
    });
  }
  for (const HeldDof& held : structure.held) b[held.dof] = T(0.0);
}

#define DER_INSTANTIATE(T) template class MemberMass<T>;
DER_FOR_MEMBER_LANES(DER_INSTANTIATE)
#undef DER_INSTANTIATE

}  // namespace der
