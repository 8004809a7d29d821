#include "der/scenario/load.hpp"

namespace der::scenario {
namespace {

template <class... Kinds>
std::vector<std::string_view> keys(const std::variant<Kinds...>* /*kinds*/) {
  return {Kinds::kKey...};
}

}  // namespace

const std::vector<std::string_view>& load_kinds() {
  static const std::vector<std::string_view> kinds = keys(static_cast<const AnyLoad*>(nullptr));
  return kinds;
}

void set_to_zero(Load& load) {
  const auto zero = [](const char* /*key*/, auto& amount) { set_to_zero(amount); };
  std::visit([&](auto& what) { for_each_amount(what, zero); }, load.what);
}

}  // namespace der::scenario
