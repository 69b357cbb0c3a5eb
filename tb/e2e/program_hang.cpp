#include "tb/e2e/program_hang.h"

#include "model/common/check.h"

namespace fovea::e2e {
namespace {

// ARM DDI 0100I, A2.5: the status register.
constexpr std::uint32_t kModeBits = 0x1F, kIrqMode = 0x12, kIrqMasked = 0x80;

}  // namespace

ProgramHang::ProgramHang(board::Board& board, const app::ElfImage& program)
    : program_(program), core_(board.dm365.arm.core()), memory_(board.dm365), debug_(core_, memory_) {
  board.load({kLoop, {0xFE, 0xFF, 0xFF, 0xEA}});  // b .
}

void ProgramHang::arm(const std::string& function, bool masked) {
  function_ = program_.find(function);
  FOVEA_CHECK(function_, "no such function");
  masked_ = masked;
  observing_ = core_.observe_boundaries(*this);
}

void ProgramHang::skip(const std::string& function) {
  arm(function, false);
  skip_ = true;
}

void ProgramHang::release() {
  function_ = nullptr;
  observing_ = core_.observe_boundaries(*this);
}

void ProgramHang::at_boundary() {
  const std::uint32_t status = core_.cpsr(), pc = core_.reg(15);
  if ((status & kModeBits) == kIrqMode) return;
  if (!function_) {
    if (pc != kLoop || !back_to_) return;
    debug_.set_reg(15, back_to_);
    back_to_ = 0;
    observing_.reset();
    return;
  }
  if (skip_) {
    if (pc != function_->address) return;
    debug_.set_reg(0, 0);
    debug_.set_reg(15, core_.reg(14));
    return;
  }
  if (since_ || pc - function_->address >= function_->size || status & kIrqMasked) return;
  since_ = debug_.now();
  back_to_ = pc;
  if (masked_) debug_.set_cpsr(status | kIrqMasked);
  debug_.set_reg(15, kLoop);
  observing_.reset();
}

}  // namespace fovea::e2e
