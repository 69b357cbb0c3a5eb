// Finds updates that an interrupt could lose: the program changes what an interrupt handler changes too, and an
// interrupt may come in between.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>

#include "model/board/board.h"
#include "model/cpu/core/debug.h"
#include "sw/fovea/board/board_debug.h"
#include "sw/fovea/program/elf_image.h"

namespace fovea::e2e {

/// Looks at every load and store of a run, and so finds what this run executes, whether or not an interrupt came at the
/// worst moment. What runs in IRQ mode is the handler, all else is the program. Of memory that the handler has stored
/// to before, a store of the program is safe if IRQs are masked, and have been since the program loaded it last. A
/// register that both write may also be stored to with interrupts open, if the program has not loaded it. Loads of
/// several words that belong together are not looked at.
class InterruptRaces : private cpu::BoundaryObserver {
 public:
  InterruptRaces(board::Board& board, const app::ElfImage& program);

  /// Unsafe stores, as "function stores object, which handler stores too", each once.
  const std::set<std::string>& lost() const { return lost_; }
  /// Functions with at least one safe store, which would not be safe without the mask.
  const std::set<std::string>& safe() const { return safe_; }

 private:
  static constexpr std::uint64_t kNotLoaded = ~std::uint64_t{0};
  /// A word of which the handler stores some bytes.
  struct Word {
    std::array<bool, 4> shared{};
    /// In which masked stretch the program has loaded each byte since its last store; 0: with interrupts open.
    std::array<std::uint64_t, 4> loaded{kNotLoaded, kNotLoaded, kNotLoaded, kNotLoaded};
    std::uint32_t handler = 0;  ///< pc of the handler's last store
  };
  void at_boundary() override;
  const std::optional<cpu::Instruction>& instruction(std::uint32_t pc);
  void handler_stores(std::uint32_t pc, std::uint32_t address, std::uint32_t bytes);
  void program_accesses(std::uint32_t pc, std::uint32_t address, std::uint32_t bytes, bool store);
  std::string function(std::uint32_t pc) const;
  /// Name of the variable; empty if there is none, as at a register.
  std::string object(std::uint32_t address) const;

  const app::ElfImage& program_;
  cpu::Core& core_;
  app::BoardDebugMemory memory_;
  cpu::CoreDebug debug_;
  std::unordered_map<std::uint32_t, std::optional<cpu::Instruction>> decoded_;  // loads and stores; others are empty
  std::unordered_map<std::uint32_t, Word> words_;                               // by address / 4
  std::uint64_t stretch_ = 0, stretches_ = 0;  // the program's masked stretch; 0: interrupts are open
  std::set<std::string> lost_, safe_;
  Subscription observing_;
};

}  // namespace fovea::e2e
