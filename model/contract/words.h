// The words of experiments for the enumerations of the parameter page: each word with its code in the page.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "model/contract/param_page.h"

namespace fovea::contract {

struct Word {
  std::string_view word;
  std::uint32_t code;
};

#define FOVEA_WORD(constant, code, word) Word{word, code},
inline constexpr std::array kMappings = {PARAM_MAPPINGS(FOVEA_WORD)};
inline constexpr std::array kPairMethods = {PARAM_PAIR_METHODS(FOVEA_WORD)};
inline constexpr std::array kKernels = {PARAM_KERNELS(FOVEA_WORD)};
inline constexpr std::array kBuilders = {PARAM_BUILDERS(FOVEA_WORD)};
inline constexpr std::array kFlows = {PARAM_FLOWS(FOVEA_WORD)};
inline constexpr std::array kMasterWords = {PARAM_MASTERS(FOVEA_WORD)};
#undef FOVEA_WORD

/// The kernel that is taken in place of this one; itself at the end of a chain.
constexpr std::uint32_t fallback_of(std::uint32_t kernel) {
  constexpr std::uint32_t kTaken[][2] = {
#define FOVEA_FALLBACK(one, otherwise) {one, otherwise},
      PARAM_KERNEL_FALLBACKS(FOVEA_FALLBACK)
#undef FOVEA_FALLBACK
  };
  for (const auto& row : kTaken)
    if (row[0] == kernel) return row[1];
  return kernel;
}
/// Kernels whose pixels the remap engine computes, and ones in which the EDMA moves pixels.
constexpr bool needs_engine(std::uint32_t kernel) {
  return kernel == KERNEL_ENGINE || kernel == KERNEL_ENGINE_GRID || kernel == KERNEL_ENGINE_RADIAL;
}
constexpr bool uses_edma(std::uint32_t kernel) {
  return kernel == KERNEL_STAGED || kernel == KERNEL_GATHER || kernel == KERNEL_RUNS || kernel == KERNEL_COPY;
}
/// Whether the EDMA may move pixels if this kernel is asked for.
constexpr bool may_use_edma(std::uint32_t kernel) {
  for (;; kernel = fallback_of(kernel))
    if (uses_edma(kernel) || fallback_of(kernel) == kernel) return uses_edma(kernel);
}

/// The words alone, for a parameter that takes them.
template <std::size_t N>
std::vector<std::string> words(const std::array<Word, N>& table) {
  std::vector<std::string> out;
  for (const Word& w : table) out.emplace_back(w.word);
  return out;
}

/// The code of a word; the order of the words means nothing.
template <std::size_t N>
constexpr std::uint32_t code_of(const std::array<Word, N>& table, std::string_view word) {
  for (const Word& w : table)
    if (w.word == word) return w.code;
  return ~0u;
}

}  // namespace fovea::contract
