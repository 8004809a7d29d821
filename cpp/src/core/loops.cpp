#include "der/core/loops.hpp"

#include <array>
#include <cstdlib>
#include <string>

#include "der/core/error.hpp"

namespace der {
namespace {

struct Choice {
  SimdLevel loops;
  std::string_view name;
  bool (*suits_processor)();
};

bool suits_avx2() {
#ifdef DER_HAS_WIDE_LOOPS
  return __builtin_cpu_supports("avx2") > 0;
#else
  return false;
#endif
}

bool suits_avx512() {
#ifdef DER_HAS_WIDE_LOOPS
  return suits_avx2() && __builtin_cpu_supports("avx512f") > 0 &&
         __builtin_cpu_supports("avx512dq") > 0 && __builtin_cpu_supports("avx512vl") > 0;
#else
  return false;
#endif
}

/// In the order of `SimdLevel`.
constexpr std::array<Choice, 3> kChoices{{
    {SimdLevel::Plain, "plain", [] { return true; }},
    {SimdLevel::Avx2, "avx2", suits_avx2},
    {SimdLevel::Avx512, "avx512", suits_avx512},
}};

SimdLevel fastest() {
  SimdLevel found = SimdLevel::Plain;
  for (const Choice& choice : kChoices) {
    if (choice.suits_processor()) found = choice.loops;
  }
  return found;
}

std::string names() {
  std::string text;
  for (const Choice& choice : kChoices) {
    text += (text.empty() ? "'" : ", '") + std::string(choice.name) + "'";
  }
  return text;
}

SimdLevel named(const std::string& name) {
  for (const Choice& choice : kChoices) {
    if (choice.name != name) continue;
    if (choice.suits_processor()) return choice.loops;
    throw EnvironmentError("the environment variable DER_LOOPS asks for the loops '" + name +
                           "', which this processor or this build does not have: unset it, or "
                           "write 'plain'");
  }
  throw EnvironmentError("the environment variable DER_LOOPS is '" + name +
                         "': unset it, or write one of " + names());
}

SimdLevel chosen() {
  const char* name = std::getenv("DER_LOOPS");  // NOLINT(concurrency-mt-unsafe)
  return name == nullptr || *name == '\0' ? fastest() : named(name);
}

}  // namespace

SimdLevel loops() {
  // Left open by an exception: the next call throws it again.
  static const SimdLevel loops = chosen();
  return loops;
}

std::string_view name_of(SimdLevel loops) { return kChoices[static_cast<std::size_t>(loops)].name; }

}  // namespace der
