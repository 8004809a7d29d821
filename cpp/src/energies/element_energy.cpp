#include "der/energies/element_energy.hpp"

#include <array>

#include "energies/every_kind.hpp"

namespace der {

template <class Kernel, Derivatives D>
void evaluate_element(const typename Kernel::Constants& constants, const Configuration& here,
                      const Eigen::Matrix<double, Kernel::kDofs, 1>& x,
                      LocalTerm<Kernel::kDofs>& out) {
  Kernel::template evaluate<D>(constants, here, x, out);
}

namespace {

template <class Kernel>
struct Evaluations {
  static constexpr std::array value{&evaluate_element<Kernel, Derivatives::Energy>,
                                    &evaluate_element<Kernel, Derivatives::Gradient>,
                                    &evaluate_element<Kernel, Derivatives::Hessian>};
};

[[gnu::used]] constexpr auto kEvaluations = of_every_kind<Evaluations>();

}  // namespace
}  // namespace der
