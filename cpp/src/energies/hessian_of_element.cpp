#include "der/energies/element_energy.hpp"
#include "energies/every_kind.hpp"

namespace der {

template <class Kernel>
void hessian_of_element(const typename Kernel::Constants& constants, const Configuration& here,
                        const Eigen::Matrix<double, Kernel::kDofs, 1>& x,
                        LocalTerm<Kernel::kDofs>& out) {
  Kernel::template evaluate<Derivatives::Hessian>(constants, here, x, out);
}

namespace {

template <class Kernel>
struct Compiled {
  static constexpr auto value = &hessian_of_element<Kernel>;
};

[[gnu::used]] constexpr auto kCompiled = of_every_kind<Compiled>();

}  // namespace
}  // namespace der
