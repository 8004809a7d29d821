// The derivative of the energy of each kind of element by its rest shape against differences of its
// energy, in which that is of second degree: central ones are exact.
#include "der/energies/rest_gradient.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "der/energies/element_energy.hpp"
#include "der/energies/registry.hpp"
#include "energies/sample_elements.hpp"

namespace der::test {
namespace {

template <class Kernel>
void check_rest_gradient(Random& random) {
  using Rest = RestGradient<Kernel>;
  auto constants = sample_constants(Kernel{}, random);
  Configuration here = sample_configuration(random);
  const auto x = sample_positions<Kernel>(Shape::Arbitrary, random);
  sample_frames(Kernel{}, constants, x, random, here);

  const auto energy = [&](const Configuration& there) {
    LocalTerm<Kernel::kDofs> term;
    evaluate_element<Kernel, Derivatives::Energy>(constants, there, x, term);
    return term.energy;
  };
  const auto gradient = Rest::of(constants, here, x);
  const Index first = Rest::shift(constants).entry;
  for (int i = 0; i < Rest::kSize; ++i) {
    Configuration more = here;
    Configuration less = here;
    more.controls[first + i] += 0.25;
    less.controls[first + i] -= 0.25;
    const double slope = (energy(more) - energy(less)) / 0.5;
    CHECK(std::abs(slope - gradient[i]) < 1e-12 * (1.0 + std::abs(energy(more))));
    CHECK(gradient[i] != 0.0);
  }
}

}  // namespace

TEST_CASE("derivatives by the rest shape are those of the energy") {
  Random random(5);
  int kinds = 0;
  for_each_list(ElementLists{}, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (RestGradient<Kernel>::kExists) {
      for (int i = 0; i < 50; ++i) check_rest_gradient<Kernel>(random);
      ++kinds;
    }
  });
  CHECK(kinds == 18);  // two of Stretch, in each dimension, and all that bend but IsotropicBend
}

}  // namespace der::test
