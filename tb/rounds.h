// How often a random test repeats itself.
#pragma once

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define FOVEA_SANITIZED 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define FOVEA_SANITIZED 1
#endif

namespace fovea {

/// `n` times, but a tenth of that, and at least once, under a sanitizer, which makes each round ten
/// to twenty times slower and looks for other errors than the rounds' results. The builds without
/// one run them all.
constexpr unsigned rounds(unsigned n) {
#ifdef FOVEA_SANITIZED
  return n < 10 ? 1 : n / 10;
#else
  return n;
#endif
}

}  // namespace fovea
