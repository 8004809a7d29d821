#include "der/scenario/support.hpp"

namespace der::scenario {

const char* name_of(Component component) {
  switch (component) {
    case Component::X:
      return "x";
    case Component::Y:
      return "y";
    case Component::Z:
      break;
  }
  return "z";
}

}  // namespace der::scenario
