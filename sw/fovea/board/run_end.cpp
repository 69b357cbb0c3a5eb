#include "sw/fovea/board/run_end.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace fovea::app {
namespace {

/// Interval in which a halted core is searched for. If two successive checks find it at the same
/// address, the run ends.
constexpr Picoseconds kHaltCheck = kPsPerMs;

}  // namespace

RunEnd::RunEnd(board::Board& board, cpu::DebugMemory& memory, std::vector<EndCondition> conditions)
    : board_(board),
      conditions_(std::move(conditions)),
      debug_(board.dm365.arm.core(), memory) {
  using Kind = EndCondition::Kind;
  auto& soc = board_.dm365;
  for (const auto& c : conditions_) {
    if (c.kind == Kind::kTime)
      soc.end_of_instant.at(c.time, InstantRank::kObservers, [this, &c] { end(c.written, false, c.time); });
    if (c.kind == Kind::kPc) {
      if (!control_) control_.emplace(soc.arm.core(), debug_);
      control_->set_breakpoint(c.address);
    }
  }
  if (control_)
    control_->on_stop = [this](const cpu::CoreControl::Stop&) {
      const auto& core = board_.dm365.arm.core();
      const auto met = std::find_if(conditions_.begin(), conditions_.end(), [&](const auto& c) {
        return c.kind == Kind::kPc && c.address == core.reg(15);
      });
      if (met == conditions_.end()) return;
      core_ended_ = true;
      control_->clear();
      board_.dm365.arm.core().request_stop();
      end(met->written, false, core.boundary_time());
    };
  if (wants(Kind::kHalt)) check_for_halt();
  if (wants(Kind::kReset))
    reset_ = board_.observe_chip_reset([this](const board::ChipReset&) { meet(Kind::kReset); });
  if (wants(Kind::kUart)) uart_ = board_.observe_uart([this](std::uint8_t) { uart_sent(); });
}

bool RunEnd::wants(EndCondition::Kind kind) const {
  return std::any_of(conditions_.begin(), conditions_.end(),
                     [kind](const EndCondition& c) { return c.kind == kind; });
}

void RunEnd::meet(EndCondition::Kind kind) {
  for (const auto& c : conditions_)
    if (c.kind == kind) return end(c.written, false, kernel_time());
}

void RunEnd::end(const std::string& what, bool limit, Picoseconds at) {
  if (met_ || board_.window_end()) return;
  met_ = Met{what, limit, at, board_.dm365.arm.core().current_pc()};
  if (core_ended_) return;
  board_.close_window(kernel_time());
  sc_core::sc_pause();
}

void RunEnd::program_exited() {
  core_ended_ = true;
  const auto& core = board_.dm365.arm.core();
  for (const auto& c : conditions_)
    if (c.kind == EndCondition::Kind::kExit) end(c.written, false, core.boundary_time());
}

void RunEnd::uart_sent() {
  for (const auto& c : conditions_)
    if (c.kind == EndCondition::Kind::kUart && board_.uart_text().ends_with(c.text))
      return end(c.written, false, kernel_time());
}

void RunEnd::check_for_halt() {
  board_.dm365.end_of_instant.at(kernel_time() + kHaltCheck, InstantRank::kObservers, [this] {
    if (met_) return;
    const std::uint32_t pc = board_.dm365.arm.core().current_pc();
    const bool now = halted();
    if (now && halted_at_ == pc) return meet(EndCondition::Kind::kHalt);
    halted_at_ = now ? std::optional(pc) : std::nullopt;
    check_for_halt();
  });
}

/// True if the core waits for an interrupt or executes a branch to itself, and no interrupt can
/// change that: none is enabled in the controller, or both are masked at the branch.
bool RunEnd::halted() {
  auto& soc = board_.dm365;
  const auto& enables = soc.aintc.core().regs;
  const bool deaf = enables.eint0.get() == 0 && enables.eint1.get() == 0;
  if (soc.arm.asleep()) return deaf;
  constexpr std::uint32_t kMasks = 0xC0, kThumb = 0x20;
  const std::uint32_t cpsr = soc.arm.core().cpsr();
  if (!deaf && (cpsr & kMasks) != kMasks) return false;
  const std::array<std::uint8_t, 4> arm = {0xFE, 0xFF, 0xFF, 0xEA}, thumb = {0xFE, 0xE7};
  const std::size_t bytes = (cpsr & kThumb) ? 2 : 4;
  std::array<std::uint8_t, 4> found{};
  return debug_.read(soc.arm.core().current_pc(), std::span(found).first(bytes)) &&
         found == ((cpsr & kThumb) ? thumb : arm);
}

}  // namespace fovea::app
