#include "tb/soc/states.h"

#include <initializer_list>

namespace fovea::soc {
namespace {

constexpr const char* kEdma = "SPRUEE4A: registers that set, clear and evaluate; QDMA triggers; shadow regions";
constexpr const char* kPll = "Linux drivers/clk/davinci/pll.c, TI's boot loader: ratios are taken with GOSET";
constexpr const char* kPsc = "Linux drivers/clk/davinci/psc.c: PTCMD begins the transitions, PTSTAT tells their end";
constexpr const char* kGpio = "Linux drivers/gpio/gpio-davinci.c: registers that set and clear";
constexpr const char* kUart = "PC16550D 8: several registers at an offset, by direction and by LCR.DLAB";
constexpr const char* kI2c = "Linux drivers/i2c/busses/i2c-davinci.c: ICMDR.STT ends by itself, ICSTR by writing 1";
/// What each register declares: its fields and their modes.
constexpr const char* kFields = "the declarations of the registers, with the sources named there";

/// The EDMA's registers that act on others: the chip's own, and those of regions with channels of their own.
std::vector<Move> edma_moves(std::initializer_list<const char*> prefixes) {
  std::vector<Move> out = {{"PARAM_*", "QER"}, {"PARAM_*", "QEMR"}};
  for (const std::string prefix : prefixes)
    for (const auto& [written, changed] : {std::pair("ESR*", "EMR*"), {"ESR*", "ESR*"}, {"EESR*", "EER*"},
                                           {"EECR*", "EER*"}, {"IESR*", "IER*"}, {"IECR*", "IER*"},
                                           {"QEESR", "QEER"}, {"QEECR", "QEER"}})
      out.push_back({prefix + written, changed});
  return out;
}

State as_declared(const char* block) { return {block, "after a reset", kFields}; }

State timing_of_sdram(bool unlocked) {
  State s{"ddr", unlocked ? "timing unlocked" : "timing locked",
          "family: SPRUEM4A 4.2, 4.4, 4.5: SDTIMR, SDTIMR2 and CL are taken with SDBCR.TIMUNLOCK only"};
  if (unlocked) {
    s.enter = {{"SDBCR", 0x0005'B832}};
    s.ones = {{"SDBCR", 0x8000}};
  } else {
    s.locked = {{"SDTIMR", ~0u}, {"SDTIMR2", ~0u}, {"SDBCR", 0x0E00}};
    s.zeros = {{"SDBCR", 0x0080'8000}};  // BOOTUNLOCK opens CL too (assumed: model/mem/README.md)
  }
  return s;
}

State edma(bool regions) {
  State s{"edma", regions ? "regions may own channels" : "no region owns a channel", kEdma};
  s.moves = regions ? edma_moves({"", "S0_", "S1_", "S2_", "S3_"}) : edma_moves({""});
  s.odd = {"ESR*", "S0_ESR*", "S1_ESR*", "S2_ESR*", "S3_ESR*"};
  if (!regions) s.left_out = {"DRAE*", "QRAE*"};
  return s;
}

State pll(const char* block, bool taking) {
  State s{block, taking ? "taking ratios" : "after a reset", kPll};
  s.moves = {{"CKEN", "CKSTAT"}, {"PLLDIV*", "DCHANGE"}, {"PLLCMD", "PLLSTAT"}};
  if (taking) s.enter = {{"PLLDIV1", 0x8003}, {"PLLCMD", 1}};
  return s;
}

State psc(bool moving) {
  State s{"psc", moving ? "in transition" : "after a reset", kPsc};
  s.moves = {{"PTCMD", "PTSTAT"}};
  s.odd = {"PTCMD"};
  if (moving) s.enter = {{"MDCTL26", 2}, {"PTCMD", 1}};
  return s;
}

State uart(const char* block, bool latch) {
  State s{block, latch ? "divisor latch open" : "after a reset", kUart};
  s.odd = {"RBR_THR", "IER", "IIR_FCR"};
  if (!latch) {
    s.zeros = {{"LCR", 0x80}};
    return s;
  }
  s.enter = {{"LCR", 0x83}};
  s.moves = {{"RBR_THR", "DLL"}, {"IER", "DLH"}};
  s.ones = {{"LCR", 0x80}};
  s.left_out = {"LCR"};
  return s;
}

State gpio() {
  State s{"gpio", "after a reset", kGpio};
  s.odd = {"SET_*", "CLR_*"};
  for (const std::string pins : {"01", "23", "45", "6"})
    for (const std::string acts : {"SET_DATA", "CLR_DATA"}) s.moves.push_back({acts + pins, "OUT_DATA" + pins});
  return s;
}

State i2c(bool running) {
  State s{"i2c", running ? "out of reset" : "in reset", kI2c};
  s.odd = {"ICMDR", "ICSTR"};
  s.left_out = {"ICMDR"};
  if (running) s.enter = {{"ICMDR", 0x20}};
  return s;
}

/// A watchdog that waits for its second key, or runs: only the keys, and what does not count, can be written.
State watchdog(bool active) {
  State s{"timer2", active ? "watchdog active" : "watchdog pre-active",
          "family: SPRUH82C 30.1.6; which registers: Linux drivers/watchdog/davinci_wdt.c"};
  s.enter = {{"PRD12", ~0u}, {"TGCR", 0xB}, {"TCR", 2u << 6}, {"WDTCR", 0xA5C6'4000}};
  if (active) s.enter.push_back({"WDTCR", 0xDA7E'4000});
  s.locked = {{"TIM12", ~0u}, {"TIM34", ~0u}, {"PRD12", ~0u}, {"PRD34", ~0u}, {"TCR", ~0u}, {"TGCR", ~0u}};
  s.left_out = {"WDTCR"};  // a word that is no key expires it
  return s;
}

/// Video ports that run take their settings with the next vertical sync, and read back what is written.
State running(const char* block, std::vector<Write> enter, std::vector<Bits> ones) {
  State s{block, "running", "assumed: what a sync takes over reads back at once, as Linux drivers modify it"};
  s.enter = std::move(enter);
  s.ones = std::move(ones);
  return s;
}

State engine(bool busy) {
  State s = as_declared("engine");
  if (!busy) return s;
  s.name = "a job under way";
  s.enter = {{"CTRL", 1}, {"SIZE", 0x0100'0100}, {"SUBMIT", 1}};
  return s;
}

}  // namespace

const std::vector<State>& states() {
  static const std::vector<State> all = {
      timing_of_sdram(false), timing_of_sdram(true), edma(true), edma(false), as_declared("edma_tc0"),
      as_declared("edma_tc1"), as_declared("edma_tc2"), as_declared("edma_tc3"), pll("pll1", false), pll("pll1", true),
      pll("pll2", false), pll("pll2", true), psc(false), psc(true), as_declared("system"), as_declared("aintc"),
      as_declared("timer0"), as_declared("timer1"),
      as_declared("timer2"), watchdog(false), watchdog(true), as_declared("timer3"), as_declared("timer4"),
      uart("uart0", false), uart("uart0", true), uart("uart1", false), uart("uart1", true), gpio(), i2c(false),
      i2c(true), as_declared("vpss"), as_declared("isif"),
      running("isif", {{"SYNCEN", 3}}, {{"SYNCEN", 3}}), as_declared("osd"),
      running("osd", {{"VIDWINMD", 3}}, {{"VIDWINMD", 3}}), as_declared("venc"),
      running("venc", {{"CLKCTL", 1}, {"VMOD", 0x43}}, {{"VMOD", 1}, {"CLKCTL", 1}}), engine(false), engine(true)};
  return all;
}

}  // namespace fovea::soc
