#include "der/model/named_control.hpp"

#include <cstddef>

namespace der {

NamedControl vector_control(const std::string& name, const std::string& unit,
                            const std::array<Index, 3>& controls) {
  constexpr std::array axes{"x", "y", "z"};
  NamedControl result{name, true, {}};
  for (std::size_t c = 0; c < axes.size(); ++c) {
    if (controls[c] >= 0) result.components.push_back({axes[c], unit, {controls[c]}});
  }
  return result;
}

}  // namespace der
