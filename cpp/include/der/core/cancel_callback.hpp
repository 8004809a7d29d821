#pragma once

#include <functional>

namespace der {

/// Called again and again in the course of long work, such as the search for an equilibrium, and so
/// often that it must be cheap (FlushTimer). What it throws ends the work. Empty: nothing is
/// called.
using CancelCallback = std::function<void()>;

}  // namespace der
