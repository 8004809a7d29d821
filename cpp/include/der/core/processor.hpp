#pragma once

/// Compiles a function, with all that it calls inlined, a second time for x86 processors with AVX2
/// and fused multiply-add; which of the two runs is decided when the program starts. For the few
/// innermost loops. Results may differ between the two by rounding.
/// Sanitizers cannot be loaded early enough for it, and Clang does not combine it with inlining.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define DER_FOR_EACH_PROCESSOR __attribute__((target_clones("arch=haswell", "default"), flatten))
#else
#define DER_FOR_EACH_PROCESSOR
#endif
