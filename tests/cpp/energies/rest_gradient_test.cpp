// The derivative of the energy of each kind of element by its rest shape against central
// differences of its energy of order 6. They are exact where it is of second degree in the rest
// shape; at a clamp that lets the section turn it is a trigonometric function of the natural twist,
// of frequency 1.
#include "der/energies/rest_gradient.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <type_traits>

#include "der/energies/element_energy.hpp"
#include "der/energies/registry.hpp"
#include "energies/sample_elements.hpp"

namespace der::test {
namespace {

template <class Kernel>
constexpr bool kIsSectionSpring = false;
template <int Edges>
constexpr bool kIsSectionSpring<SectionSpring<Edges>> = true;

/// Samples have sections that no spring holds, too: what they rest at does not matter.
template <class Constants>
bool has_no_spring(const Constants& constants) {
  if constexpr (std::is_same_v<Constants, SectionSpring<1>::Constants> ||
                std::is_same_v<Constants, SectionSpring<2>::Constants>) {
    return constants.spring.stiffness.isZero(0.0);
  } else {
    return false;
  }
}

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
  // The error of a function of frequency 1 and amplitude 1 is h^6 / 140 = 5e-13. The section on
  // springs is one of equations that are not linear: its higher derivatives are larger.
  constexpr double h = kIsSectionSpring<Kernel> ? 0.004 : 0.02;
  const auto gradient = Rest::of(constants, here, x);
  const Index first = Rest::shift(constants).entry;
  for (int i = 0; i < Rest::kSize; ++i) {
    const auto rise = [&](double step) {
      Configuration more = here;
      Configuration less = here;
      more.controls[first + i] += step;
      less.controls[first + i] -= step;
      return (energy(more) - energy(less)) / (2.0 * step);
    };
    const double slope = 1.5 * rise(h) - 0.6 * rise(2.0 * h) + 0.1 * rise(3.0 * h);
    CHECK(std::abs(slope - gradient[i]) < 1e-12 * (1.0 + std::abs(energy(here))));
    CHECK((gradient[i] != 0.0 || has_no_spring(constants)));
  }
}

}  // namespace

TEST_CASE("derivatives by the rest shape are those of the energy") {
  int kinds = 0;
  for_each_list(ElementLists{}, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (RestGradient<Kernel>::kExists) {
      Random random(5);  // so that a new kind leaves the samples of others as they are
      for (int i = 0; i < 50; ++i) check_rest_gradient<Kernel>(random);
      ++kinds;
    }
  });
  // Two of Stretch, in each dimension, the arcs of edges, all that bend but IsotropicBend, and
  // springs against turning.
  CHECK(kinds == 40);
}

}  // namespace der::test
