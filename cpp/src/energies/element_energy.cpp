#include "der/energies/element_energy.hpp"

#include "energies/every_kind.hpp"

namespace der {

template <class Kernel>
void energy_of_element(const typename Kernel::Constants& constants, const Configuration& here,
                       const Eigen::Matrix<double, Kernel::kDofs, 1>& x,
                       LocalTerm<Kernel::kDofs>& out) {
  Kernel::template evaluate<Derivatives::Energy>(constants, here, x, out);
}

template <class Kernel>
void gradient_of_element(const typename Kernel::Constants& constants, const Configuration& here,
                         const Eigen::Matrix<double, Kernel::kDofs, 1>& x,
                         LocalTerm<Kernel::kDofs>& out) {
  Kernel::template evaluate<Derivatives::Gradient>(constants, here, x, out);
}

template <class Kernel>
void hessian_of_element(const typename Kernel::Constants& constants, const Configuration& here,
                        const Eigen::Matrix<double, Kernel::kDofs, 1>& x,
                        LocalTerm<Kernel::kDofs>& out) {
  Kernel::template evaluate<Derivatives::Hessian>(constants, here, x, out);
}

namespace {

template <class Kernel>
struct Evaluations {
  static constexpr std::array value{&energy_of_element<Kernel>, &gradient_of_element<Kernel>,
                                    &hessian_of_element<Kernel>};
};

[[gnu::used]] constexpr auto kEvaluations = of_every_kind<Evaluations>();

}  // namespace
}  // namespace der
