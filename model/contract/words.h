// The words of experiments for the enumerations of the parameter page: each word with its code in the page.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/contract/param_page.h"

namespace fovea::contract {

struct Word {
  std::string_view word;
  std::uint32_t code;
};

#define FOVEA_WORD(constant, code, word, ...) Word{word, code},
inline constexpr std::array kMappings = {PARAM_MAPPINGS(FOVEA_WORD)};
inline constexpr std::array kPairMethods = {PARAM_PAIR_METHODS(FOVEA_WORD)};
inline constexpr std::array kBuilders = {PARAM_BUILDERS(FOVEA_WORD)};
inline constexpr std::array kFlows = {PARAM_FLOWS(FOVEA_WORD)};
inline constexpr std::array kMasterWords = {PARAM_MASTERS(FOVEA_WORD)};
#undef FOVEA_WORD

/// What is known of a kernel (PARAM_KERNELS).
struct KernelFacts {
  std::uint32_t code;
  param_mover mover;        ///< who moves its pixels
  std::uint32_t otherwise;  ///< the kernel that is taken in its place; itself at the end of a chain
  bool views;               ///< it has a form for several sources
};
/// Of all kernels, by their codes. In kernels.cpp alone, so that a program can have another table.
extern const std::span<const Word> kKernels;
extern const std::span<const KernelFacts> kKernelFacts;
const KernelFacts& facts_of(std::uint32_t kernel);

/// Whether the EDMA may move pixels if this kernel is asked for.
bool may_use_edma(std::uint32_t kernel);

/// The words alone, for a parameter that takes them.
inline std::vector<std::string> words(std::span<const Word> table) {
  std::vector<std::string> out;
  for (const Word& w : table) out.emplace_back(w.word);
  return out;
}

/// The code of a word; the order of the words means nothing.
constexpr std::uint32_t code_of(std::span<const Word> table, std::string_view word) {
  for (const Word& w : table)
    if (w.word == word) return w.code;
  return ~0u;
}

}  // namespace fovea::contract
