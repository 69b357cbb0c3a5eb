// Makes a program hang at a place of its own, from outside, and lets it go on again; or takes work from it.
#pragma once
#include <cstdint>
#include <string>

#include "model/board/board.h"
#include "model/cpu/core/debug.h"
#include "sw/fovea/board/board_debug.h"
#include "sw/fovea/program/elf_image.h"

namespace fovea::e2e {

/// From a wanted time on, the next instruction of a function becomes an endless loop, which lies in memory that the
/// program does not use: as if the program had got lost there. Interrupts are served meanwhile, or are masked.
class ProgramHang : private cpu::BoundaryObserver {
 public:
  /// Where the loop lies: behind the uncached variables.
  static constexpr std::uint32_t kLoop = 0x80FF'FF00;

  /// Before the simulation starts.
  ProgramHang(board::Board& board, const app::ElfImage& program);
  /// To be called while the simulation pauses. In a function that a handler calls too, not in the handler.
  void arm(const std::string& function, bool masked);
  /// From now on a function returns 0 to each of its callers at once: the program goes on without its work.
  void skip(const std::string& function);
  /// When the program began to hang; 0: not yet.
  Picoseconds since() const { return since_; }
  /// The program goes on where it was.
  void release();

 private:
  void at_boundary() override;

  const app::ElfImage& program_;
  cpu::Core& core_;
  app::BoardDebugMemory memory_;
  cpu::CoreDebug debug_;
  const app::ElfSymbol* function_ = nullptr;
  bool masked_ = false, skip_ = false;
  Picoseconds since_ = 0;
  std::uint32_t back_to_ = 0;
  Subscription observing_;
};

}  // namespace fovea::e2e
