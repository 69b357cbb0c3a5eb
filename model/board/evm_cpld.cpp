#include "model/board/evm_cpld.h"

namespace fovea::board {

namespace {
/// No card in either slot: Linux' cpld_mmc_get_cd takes bit 0 (slot 0) or bit 4 (slot 1) = 0 for
/// one.
constexpr std::uint32_t kNoCards = 0x11;
constexpr std::uint32_t kTvp5146 = 5;
}  // namespace

CpldRegs::CpldRegs(std::uint32_t switch_value)
    : RegBank("CPLD"),
      switches(*this, "SWITCH", 0x400, Mode::kRo, "switches of the board", switch_value),
      cardstat(*this, "CARDSTAT", 0x418, Mode::kRo,
               "memory cards: 0, 4 no card in slot 0, 1; 1, 5 write protection", kNoCards) {}

EvmCpld::EvmCpld(sc_core::sc_module_name name, const DevicesParams& params)
    : WithRegs(static_cast<std::uint32_t>(params.cpld_switch())), BusTarget(name, regs) {
  regs.mux.on_write([this](std::uint32_t) {
    if (regs.video.get() != kTvp5146) diagnostics().not_modelled("CPLD MUX: a video input other than the TVP5146 (5)");
  });
  regs.resets.on_write([this](std::uint32_t) {
    if (regs.reset_tvp5146) diagnostics().not_modelled("CPLD RESETS: the video decoder held in reset");
  });
}

}  // namespace fovea::board
