#pragma once

#include <string>

#include "der/core/error.hpp"

namespace der {

/// A file or folder that cannot be read or written.
class IoError : public Error {
 public:
  explicit IoError(const std::string& message) : Error("io_error", message) {}
};

}  // namespace der
