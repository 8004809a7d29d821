#pragma once

#include <string_view>

#include "der/core/sanitizer.hpp"

namespace der {

/// The processors that the innermost loops are compiled for.
enum class SimdLevel {
  Plain,  ///< all that the rest of the library runs on
  Avx2,   ///< those with AVX2
  Avx512  ///< those with AVX-512, for loops over members of a batch; other loops are those of AVX2
};

/// The loops that run: those named by the environment variable DER_LOOPS, else the last of
/// `SimdLevel` that the processor has. They are chosen at the first call. Throws EnvironmentError
/// at every call if DER_LOOPS names none, or one that the processor does not have.
SimdLevel loops();

/// "plain", "avx2" or "avx512".
std::string_view name_of(SimdLevel loops);

// Sanitizers add so much to each call that the compiler would take minutes for a whole loop in one.
#if DER_HAS_SANITIZER
#define DER_INLINE_ALL
#else
#define DER_INLINE_ALL __attribute__((flatten))
#endif

// Clang inlines but one level of calls into a function of another target.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define DER_HAS_WIDE_LOOPS
#endif

namespace compiled {

template <class Loop>
DER_INLINE_ALL auto plain(const Loop& loop) {
  return loop();
}

#ifdef DER_HAS_WIDE_LOOPS
// Not arch=haswell: GCC inlines no function that is compiled for another architecture.
// Multiplications and additions are not fused, so that all processors find the same numbers to the
// last bit.
template <class Loop>
DER_INLINE_ALL __attribute__((target("avx2"))) auto avx2(const Loop& loop) {
  return loop();
}
template <class Loop>
DER_INLINE_ALL __attribute__((target("avx512f,avx512dq,avx512vl,prefer-vector-width=512"))) auto
avx512(const Loop& loop) {
  return loop();
}
#endif

}  // namespace compiled

/// Calls `loop`, which is compiled with all that it calls inlined, once for each of `SimdLevel`.
/// For the few innermost loops: each choice costs some nanoseconds, so that a loop is one over a
/// whole rod.
template <class Loop>
auto dispatch_simd(const Loop& loop) {
#ifdef DER_HAS_WIDE_LOOPS
  if (loops() != SimdLevel::Plain) return compiled::avx2(loop);
#endif
  return compiled::plain(loop);
}

}  // namespace der
