#pragma once

/// DER_HAS_SANITIZER: whether the compiler adds the checks of memory or of threads, for GCC and
/// clang.
#ifdef __has_feature
#define DER_HAS_SANITIZER (__has_feature(address_sanitizer) || __has_feature(thread_sanitizer))
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define DER_HAS_SANITIZER 1
#else
#define DER_HAS_SANITIZER 0
#endif
