#include "model/contract/words.h"

namespace fovea::contract {
namespace {

constexpr std::array kWords = {
#define FOVEA_WORD(constant, code, word, ...) Word{word, code},
    PARAM_KERNELS(FOVEA_WORD)
#undef FOVEA_WORD
};
constexpr std::array kFacts = {
#define FOVEA_FACTS(constant, code, word, mover, otherwise, views) KernelFacts{code, mover, otherwise, views != 0},
    PARAM_KERNELS(FOVEA_FACTS)
#undef FOVEA_FACTS
};
static_assert([] {
  for (std::size_t k = 0; k < kFacts.size(); ++k)
    if (kFacts[k].code != k || kFacts[k].otherwise >= kFacts.size()) return false;
  return kFacts.size() == KERNEL_COUNT;
}());

}  // namespace

constinit const std::span<const Word> kKernels = kWords;
constinit const std::span<const KernelFacts> kKernelFacts = kFacts;

const KernelFacts& facts_of(std::uint32_t kernel) { return kFacts[kernel]; }

bool may_use_edma(std::uint32_t kernel) {
  for (;; kernel = facts_of(kernel).otherwise)
    if (facts_of(kernel).mover == PARAM_BY_EDMA || facts_of(kernel).otherwise == kernel)
      return facts_of(kernel).mover == PARAM_BY_EDMA;
}

}  // namespace fovea::contract
