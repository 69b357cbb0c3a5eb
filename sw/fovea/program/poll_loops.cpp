#include "sw/fovea/program/poll_loops.h"

#include <algorithm>
#include <optional>

namespace fovea::app {
namespace {

/// Registers that an instruction reads and writes, as bits.
struct LoopEffect {
  std::uint32_t reads = 0, writes = 0;
  bool load = false, flags = false;
  bool counts = false;  // adds a constant to a register, or subtracts one
};

constexpr std::uint32_t register_bit(std::uint32_t word, unsigned from) { return 1u << (word >> from & 15); }

/// LDR and LDRB with an offset (ARM DDI 0100, A3.11.1) that leave the base register as it is.
std::optional<LoopEffect> word_load(std::uint32_t w) {
  const bool loads = w >> 20 & 1, before = w >> 24 & 1, writes_back = w >> 21 & 1;
  if (!loads || !before || writes_back) return std::nullopt;
  const bool by_register = w >> 25 & 1;
  return LoopEffect{register_bit(w, 16) | (by_register ? register_bit(w, 0) : 0), register_bit(w, 12), true, false};
}

/// LDRH, LDRSB and LDRSH (A3.11.2): bits 7 and 4 are 1, bits 6 and 5 not both 0.
std::optional<LoopEffect> half_load(std::uint32_t w) {
  const bool loads = w >> 20 & 1, before = w >> 24 & 1, writes_back = w >> 21 & 1;
  if ((w >> 5 & 3) == 0 || !loads || !before || writes_back) return std::nullopt;
  const bool immediate = w >> 22 & 1;
  return LoopEffect{register_bit(w, 16) | (immediate ? 0 : register_bit(w, 0)), register_bit(w, 12), true, false};
}

/// Data-processing instructions (A3.4).
std::optional<LoopEffect> computation(std::uint32_t w) {
  const unsigned opcode = w >> 21 & 15;
  const bool sets_flags = w >> 20 & 1, compares = opcode >= 8 && opcode <= 11;
  const bool moves = opcode == 13 || opcode == 15, immediate = w >> 25 & 1;
  if (compares && !sets_flags) return std::nullopt;  // MRS, MSR, BX, CLZ and others
  LoopEffect e;
  if (!moves) e.reads |= register_bit(w, 16);
  if (!immediate) e.reads |= register_bit(w, 0) | (w >> 4 & 1 ? register_bit(w, 8) : 0);
  if (!compares) e.writes = register_bit(w, 12);
  e.flags = sets_flags;
  constexpr unsigned kSub = 2, kAdd = 4;
  e.counts = immediate && (opcode == kSub || opcode == kAdd) && register_bit(w, 16) == register_bit(w, 12);
  return e;
}

/// Empty for what no loop that only waits does.
std::optional<LoopEffect> effect_of(std::uint32_t w) {
  if (w >> 28 == 15) return std::nullopt;
  switch (w >> 25 & 7) {
    case 0:
      if ((w & 0x90) == 0x90) return half_load(w);
      return computation(w);
    case 1:
      return computation(w);
    case 2:
      return word_load(w);
    case 3:
      return w & 0x10 ? std::nullopt : word_load(w);
    default:
      return std::nullopt;
  }
}

bool is_arm_branch(std::uint32_t w) { return (w & 0x0f00'0000) == 0x0a00'0000 && w >> 28 != 15; }
std::uint32_t arm_branch_target(std::uint32_t w, std::uint32_t from) {
  return from + 8 + static_cast<std::uint32_t>(static_cast<std::int32_t>(w << 8) >> 6);
}

/// @param body the loop's instructions, the last of which branches back to the first
bool only_waits(std::span<const std::uint32_t> body) {
  std::vector<LoopEffect> effects;
  std::uint32_t written = 0, counted = 0, otherwise = 0;
  for (const std::uint32_t w : body.first(body.size() - 1)) {
    if (is_arm_branch(w)) continue;  // out of the loop, or within it
    const auto e = effect_of(w);
    if (!e) return false;
    effects.push_back(*e);
    written |= e->writes;
    (e->counts ? counted : otherwise) |= e->writes;
  }
  const std::uint32_t counters = counted & ~otherwise;  // may be compared with the most turns
  constexpr std::uint32_t kPcBit = 1u << 15;
  if (written & kPcBit) return false;
  std::uint32_t fresh = 0, loaded = 0;  // written in this turn; what was loaded, or computed from it
  bool compares = false;
  for (const LoopEffect& e : effects) {
    if (e.load && (e.reads & written)) return false;
    if (!e.load && !e.counts && (e.reads & written & ~fresh & ~(e.writes == 0 ? counters : 0))) return false;
    const bool of_loaded = e.load || (e.reads & loaded);
    compares = compares || (e.flags && (e.reads & loaded));
    fresh |= e.writes;
    loaded = of_loaded ? loaded | e.writes : loaded & ~e.writes;
  }
  return compares;
}

}  // namespace

PollLoops::PollLoops(std::span<const ElfImage* const> programs) {
  for (const ElfImage* const image : programs) {
    if (!image) continue;
    for (const ElfSegment& s : image->segments()) {
      std::vector<std::uint32_t> words(s.data.size() / 4);
      for (std::size_t n = 0; n < s.data.size() / 4 * 4; ++n) words[n / 4] |= std::uint32_t{s.data[n]} << 8 * (n % 4);
      for (std::size_t n = 1; n < words.size(); ++n) {
        const auto at = static_cast<std::uint32_t>(s.virtual_address + 4 * n);
        if (!is_arm_branch(words[n])) continue;
        const std::uint32_t first = arm_branch_target(words[n], at), length = (at - first) / 4 + 1;
        if (first >= at || length > kMost || length > n + 1) continue;
        const ElfSymbol* const function = image->function_at(at);
        if (!function || function->thumb || function != image->function_at(first)) continue;
        if (only_waits(std::span(words).subspan(n + 1 - length, length))) loops_[first] = std::max(loops_[first], at);
      }
    }
  }
}

bool PollLoops::contains(std::uint32_t address) const {
  const auto above = loops_.upper_bound(address);
  return above != loops_.begin() && address <= std::prev(above)->second;
}

}  // namespace fovea::app
