#include "der/lanes/loose_lanes.hpp"

#include <type_traits>

#include "der/assembly/loose_elements.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/lane_values.hpp"
#include "der/energies/registry.hpp"

namespace der {
namespace {

template <class Kernel, class T>
class OffChainOf final : public OffChainKind<T> {
 public:
  OffChainOf(const OffChainElements<Kernel>& loose, const MemberModels<T>& models)
      : loose_(loose),
        models_(models),
        dofs_(elements_of<Kernel>(*models[0]->elements).dofs),
        values_(loose.elements.size()) {
    const Vector controls = Vector::Zero(models[0]->tables.size());
    set_values([&](int /*lane*/) -> const Vector& { return controls; });
  }

  void follow(const MemberConfigurations<T>& here) override {
    if constexpr (FollowsFrames<Kernel>::value) {
      set_values([&](int lane) -> const Vector& { return here[to_size(lane)].controls; });
    }
  }
  void add_gradient(const MemberVector<T>& coordinates, MemberVector<T>& gradient) const override {
    add<Derivatives::Gradient>(coordinates.data(), gradient.data(), nullptr);
  }
  void add_hessian(const MemberVector<T>& coordinates, MemberVector<T>& gradient,
                   MemberVector<T>& values) const override {
    add<Derivatives::Hessian>(coordinates.data(), gradient.data(), values.data());
  }

 private:
  template <class Controls>
  void set_values(const Controls& controls) {
    for (std::size_t k = 0; k < values_.size(); ++k) {
      values_[k] = values_in_lanes<Kernel, T>([&](int lane) {
        const auto& list = elements_of<Kernel>(*models_[to_size(lane)]->elements);
        return Kernel::values(list.constants[loose_.elements[k]], controls(lane));
      });
    }
  }
  template <Derivatives D>
  void add(const T* coordinates, T* gradient, T* values) const {
    run_member_loop<T>([&] {
      LocalTerm<Kernel::kDofs, T> local;
      for (std::size_t k = 0; k < values_.size(); ++k) {
        const auto& dofs = dofs_[loose_.elements[k]];
        Kernel::template evaluate<D, T>(values_[k], gather<T>(dofs, coordinates), local);
        add_local<D>(local, dofs, loose_.slots[k], gradient, values);
      }
    });
  }

  const OffChainElements<Kernel>& loose_;
  const MemberModels<T>& models_;
  const std::vector<std::array<Index, Kernel::kDofs>>& dofs_;
  std::vector<typename Kernel::template Values<T>> values_;
};

}  // namespace

template <class T>
std::vector<std::unique_ptr<OffChainKind<T>>> loose_kinds(const Assembler& assembler,
                                                          const MemberModels<T>& models) {
  std::vector<std::unique_ptr<OffChainKind<T>>> kinds;
  for_each_list(*models[0]->elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (GoesInLanes<Kernel>::value) {
      const OffChainElements<Kernel>& loose = assembler.loose<Kernel>();
      if (loose.elements.empty()) return;
      kinds.push_back(std::make_unique<OffChainOf<Kernel, T>>(loose, models));
    }
  });
  return kinds;
}

// NOLINTBEGIN(bugprone-macro-parentheses): the argument is a type
#define DER_INSTANTIATE(T)                                                             \
  template std::vector<std::unique_ptr<OffChainKind<T>>> loose_kinds(const Assembler&, \
                                                                     const MemberModels<T>&);
// NOLINTEND(bugprone-macro-parentheses)
DER_FOR_MEMBER_LANES(DER_INSTANTIATE)
#undef DER_INSTANTIATE

}  // namespace der
