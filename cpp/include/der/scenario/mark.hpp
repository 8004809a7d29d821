#pragma once

namespace der::scenario {

/// Where a thing stands in the scene text (1-based; 0 when there is no text), for later messages.
struct Mark {
  int line = 0;
  int column = 0;
};

}  // namespace der::scenario
