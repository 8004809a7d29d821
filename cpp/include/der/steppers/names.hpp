#pragma once

#include <string>
#include <vector>

namespace der {

/// The names that a scene can give as `time.integrator`.
const std::vector<std::string>& integrator_names();
bool is_implicit(const std::string& integrator);

}  // namespace der
