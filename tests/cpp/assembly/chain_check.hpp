#pragma once

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <random>

#include "der/assembly/assembler.hpp"
#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/registry.hpp"
#include "der/model/state.hpp"

/// Chains, assembled as a whole, against the sum of their elements' kernels one by one: both are
/// exact, so they differ by rounding only.
namespace der::test {

struct Derivatives2 {
  Vector gradient;
  Eigen::MatrixXd hessian;  // over all degrees of freedom
};

inline Derivatives2 sum_of_kernels(const Model& model, const Configuration& here) {
  Derivatives2 sum{Vector::Zero(model.num_dofs()),
                   Eigen::MatrixXd::Zero(model.num_dofs(), model.num_dofs())};
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    LocalTerm<Kernel::kDofs> local;
    for (std::size_t e = 0; e < list.size(); ++e) {
      const auto& dofs = list.dofs[e];
      evaluate_element<Kernel, Derivatives::Hessian>(list.constants[e], here,
                                                     gather(dofs, here.coordinates), local);
      for (Index i = 0; i < Kernel::kDofs; ++i) {
        sum.gradient[dofs[to_size(i)]] += local.gradient[i];
        for (Index j = 0; j <= i; ++j) {
          sum.hessian(dofs[to_size(i)], dofs[to_size(j)]) += local.hessian(i, j);
          if (i != j) sum.hessian(dofs[to_size(j)], dofs[to_size(i)]) += local.hessian(i, j);
        }
      }
    }
  });
  return sum;
}

/// At shapes ever farther from the initial one, and from its frames.
inline void check_chains(const Model& model) {
  const Pattern pattern = build_pattern(model);
  std::mt19937_64 random(11);
  std::normal_distribution<double> shake(0.0, 0.1);
  for (const double disorder : {0.0, 0.01, 0.2, 2.0}) {
    Configuration here = configuration_of(model, initial_state(model));
    for (double& x : here.coordinates) x += disorder * shake(random);
    const Derivatives2 expected = sum_of_kernels(model, here);
    const double rounding = 1e-14 * expected.hessian.lpNorm<Eigen::Infinity>();

    for (const MatrixLayout& layout :
         {MatrixLayout::compressed(pattern), MatrixLayout::bordered_band(pattern)}) {
      const Assembler assembler(model, layout);
      Vector gradient(model.num_dofs());
      Vector values(assembler.num_values());
      assembler.gradient(here, gradient);
      CHECK((gradient - expected.gradient).lpNorm<Eigen::Infinity>() <= rounding);
      assembler.gradient_and_hessian(here, gradient, values);
      CHECK((gradient - expected.gradient).lpNorm<Eigen::Infinity>() <= rounding);
      double worst = 0.0;
      for (Index j = 0; j < pattern.size; ++j) {
        for (Index k = pattern.outer[to_size(j)]; k < pattern.outer[to_size(j) + 1]; ++k) {
          const Index i = pattern.inner[to_size(k)];
          const double entry =
              expected.hessian(model.dofs.free()[to_size(i)], model.dofs.free()[to_size(j)]);
          worst = std::max(worst, std::abs(values[layout.slot(i, j)] - entry));
        }
      }
      CHECK(worst <= rounding);
    }
  }
}

}  // namespace der::test
