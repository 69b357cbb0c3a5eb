#include "tb/e2e/interrupt_races.h"

#include "model/cpu/core/addressing.h"
#include "model/cpu/core/conditions.h"

namespace fovea::e2e {
namespace {

// ARM DDI 0100I, A2.5: the status register.
constexpr std::uint32_t kModeBits = 0x1F, kIrqMode = 0x12, kIrqMasked = 0x80, kCarry = 1u << 29;

}  // namespace

InterruptRaces::InterruptRaces(board::Board& board, const app::ElfImage& program)
    : program_(program), core_(board.dm365.arm.core()), memory_(board.dm365), debug_(core_, memory_),
      observing_(core_.observe_boundaries(*this)) {}

const std::optional<cpu::Instruction>& InterruptRaces::instruction(std::uint32_t pc) {
  const auto [found, is_new] = decoded_.try_emplace(pc);
  if (is_new) {
    const auto decoded = debug_.instruction(pc);
    if (decoded && decoded->op >= cpu::Op::kLdr && decoded->op <= cpu::Op::kSwpb && !cpu::is_swap(decoded->op))
      found->second = decoded;
  }
  return found->second;
}

void InterruptRaces::at_boundary() {
  const std::uint32_t status = core_.cpsr(), pc = core_.reg(15);
  const bool handler = (status & kModeBits) == kIrqMode;
  if (!handler) stretch_ = !(status & kIrqMasked) ? 0 : stretch_ ? stretch_ : ++stretches_;
  const auto& access = instruction(pc);
  if (!access || !cpu::condition_holds(access->cond, status)) return;
  auto registers = core_.view().registers.r;
  registers[15] = cpu::pc_ahead(*access, pc);
  const cpu::DataAddress a = cpu::data_address(*access, registers, status & kCarry);
  const bool store = cpu::is_store(access->op);
  if (!handler) return program_accesses(pc, a.touched(), a.bytes, store);
  if (store) handler_stores(pc, a.touched(), a.bytes);
}

void InterruptRaces::handler_stores(std::uint32_t pc, std::uint32_t address, std::uint32_t bytes) {
  for (std::uint32_t at = address; at != address + bytes; ++at) {
    Word& word = words_[at / 4];
    word.shared[at % 4] = true;
    word.handler = pc;
  }
}

void InterruptRaces::program_accesses(std::uint32_t pc, std::uint32_t address, std::uint32_t bytes, bool store) {
  for (std::uint32_t at = address; at != address + bytes; ++at) {
    const auto found = words_.find(at / 4);
    if (found == words_.end()) {
      at |= 3;
      if (at - address >= bytes) return;
      continue;
    }
    Word& word = found->second;
    if (!word.shared[at % 4]) continue;
    std::uint64_t& loaded = word.loaded[at % 4];
    if (!store) {
      loaded = stretch_;
      continue;
    }
    if (stretch_ != 0 && (loaded == kNotLoaded || loaded == stretch_)) {
      safe_.insert(function(pc));
    } else if (const std::string name = object(at); loaded != kNotLoaded || !name.empty()) {
      lost_.insert(function(pc) + " stores " + (name.empty() ? "a register" : name) + ", which " +
                   function(word.handler) + " stores too");
    }
    loaded = kNotLoaded;
  }
}

/// Without the distance from the function's start.
std::string InterruptRaces::function(std::uint32_t pc) const {
  const std::string name = program_.describe(pc);
  return name.substr(0, name.find('+'));
}

std::string InterruptRaces::object(std::uint32_t address) const {
  for (const app::ElfSymbol& s : program_.symbols())
    if (!s.function && address - s.address < s.size) return s.name;
  return "";
}

}  // namespace fovea::e2e
