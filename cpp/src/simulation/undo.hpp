#pragma once

#include "der/model/state.hpp"

namespace der {

/// Puts a state back to what it was when this was made, unless the change of it is kept.
class Undo {
 public:
  /// `before` keeps its memory from one time to the next.
  Undo(State& state, State& before) : state_(state), before_(before) { before_ = state_; }
  ~Undo() {
    if (!kept_) state_ = before_;
  }
  Undo(const Undo&) = delete;
  Undo& operator=(const Undo&) = delete;
  void keep() { kept_ = true; }

 private:
  State& state_;
  State& before_;
  bool kept_ = false;
};

}  // namespace der
