#include "tb/soc/states.h"

#include <initializer_list>

namespace fovea::soc {
namespace {

constexpr const char* kEdma = "SPRUEE4A: registers that set, clear and evaluate; QDMA triggers; shadow regions";
constexpr const char* kTc =
    "SPRUH82C (family), EDMA3 Transfer Controller Registers: of a request's registers none can be written; "
    "INTCLR and ERRCLR act while it runs";
constexpr const char* kPending =
    "SPRUEE4A (family): events, missed events, errors and interrupts end by the registers that clear them only";
constexpr const char* kAintc =
    "SPRUE14 (DM644x, family) INTCTL.IDMODE; Linux drivers/irqchip/irq-davinci-aintc.c: a 1 acknowledges";
constexpr const char* kPllOn = "SPRUH82C (family), PLLC: the multiplier is written while PLLEN is 0";
constexpr const char* kVtp = "TI's boot loader for DM36x: VTPIOCR.READY tells the end of the calibration";
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

/// SDRAM's type, drive, strobe, DLL and termination.
constexpr std::uint32_t kSdramType = 0x1B7F'0000;

/// The type bits are taken while BOOTUNLOCK stays set.
State type_of_sdram() {
  State s{"ddr", "type unlocked", "SPRUFI2 (type), SPRUH82C (family) 14.4.2 SDCR: written with BOOTUNLOCK set before"};
  s.enter = {{"SDBCR", 0x0085'3832}};
  s.signs = {{"SDBCR", 0x0080'8000, 0x0080'0000}};
  s.ones = {{"SDBCR", 0x0080'0000}};
  s.zeros = {{"SDBCR", 0x8000}};
  s.locked = {{"SDTIMR", ~0u}, {"SDTIMR2", ~0u}};
  return s;
}

State timing_of_sdram(bool unlocked) {
  State s{"ddr", unlocked ? "timing unlocked" : "timing locked",
          "family: SPRUEM4A 4.2, 4.4, 4.5: SDTIMR, SDTIMR2 and CL are taken with SDBCR.TIMUNLOCK only"};
  if (unlocked) {
    s.enter = {{"SDBCR", 0x0005'B832}};
    s.signs = {{"SDBCR", 0x0080'8000, 0x8000}};
    s.locked = {{"SDBCR", kSdramType}};
    s.zeros = {{"SDBCR", 0x0080'0000}};
    s.ones = {{"SDBCR", 0x8000}};
  } else {
    s.locked = {{"SDTIMR", ~0u}, {"SDTIMR2", ~0u}, {"SDBCR", 0x0E00 | kSdramType}};
    s.warned = {{"SDTIMR", ~0u, "SDTIMR written without SDBCR TIMUNLOCK: write lost"},
                {"SDTIMR2", 0x7FFF'FFFF, "SDTIMR2 written without SDBCR TIMUNLOCK: write lost"},
                {"SDBCR", 0x0E00, "SDBCR CL written without TIMUNLOCK or BOOTUNLOCK: write lost"}};
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

/// Three requests that take a second each, on queue and transfer controller n, between two places of the internal
/// RAM: the first one moves, the second one waits in the program register, the third one in its queue.
std::vector<Write> long_requests(unsigned n) {
  std::vector<Write> out = {{"DMAQNUM0", 0x1110'0000 | 0x1110 * n, "edma"}};
  static constexpr const char* kWords[3][7] = {{"PARAM_OPT1", "PARAM_SRC1", "PARAM_A_B_CNT1", "PARAM_DST1",
                                                "PARAM_SRC_DST_BIDX1", "PARAM_LINK_BCNTRLD1", "PARAM_CCNT1"},
                                               {"PARAM_OPT2", "PARAM_SRC2", "PARAM_A_B_CNT2", "PARAM_DST2",
                                                "PARAM_SRC_DST_BIDX2", "PARAM_LINK_BCNTRLD2", "PARAM_CCNT2"},
                                               {"PARAM_OPT3", "PARAM_SRC3", "PARAM_A_B_CNT3", "PARAM_DST3",
                                                "PARAM_SRC_DST_BIDX3", "PARAM_LINK_BCNTRLD3", "PARAM_CCNT3"}};
  constexpr std::uint32_t kValues[7] = {0x4, 0x1'1000, 0xFFFF'1000, 0x1'3000, 0, 0xFFFF, 1};
  for (const auto& set : kWords)
    for (unsigned w = 0; w < 7; ++w) out.push_back({set[w], kValues[w], "edma"});
  return out;
}

void append(std::vector<Write>& to, std::initializer_list<Write> more) { to.insert(to.end(), more); }

/// A transfer controller at work, with an error that nobody has cleared: a request of channel 0 with constant
/// addressing and an address that is no multiple of 32.
State tc_busy(unsigned n) {
  static constexpr const char* kBlocks[] = {"edma_tc0", "edma_tc1", "edma_tc2", "edma_tc3"};
  State s{kBlocks[n], "requests under way and an error", kTc};
  s.enter = long_requests(n);
  append(s.enter, {{"DMAQNUM0", 0x1111u * n, "edma"},
                   {"PARAM_OPT0", 0x5, "edma"},
                   {"PARAM_SRC0", 0x1'1004, "edma"},
                   {"PARAM_A_B_CNT0", 0x1'0020, "edma"},
                   {"PARAM_DST0", 0x1'3000, "edma"},
                   {"PARAM_LINK_BCNTRLD0", 0xFFFF, "edma"},
                   {"PARAM_CCNT0", 1, "edma"},
                   {"ESR", 0xF, "edma"},
                   {nullptr, 2'000}});
  s.signs = {{"TCSTAT", 0x73, 0x13}, {"INTSTAT", 1, 1}, {"ERRSTAT", 0xF, 4}, {"PCNT", ~0u, 0xFFFF'1000}};
  s.moves = {{"INTCLR", "INTSTAT", Move::Effect::kClears}, {"ERRCLR", "ERRSTAT", Move::Effect::kClears}};
  s.computed = {"*"};
  return s;
}

/// Everything that may be pending in the channel controller is: an event that is not enabled (48), one in its queue
/// (channel 3), which has a software and a chained trigger more, a queue above its threshold, missed events (channel 5
/// and QDMA channel 0: null sets), and a completion code (7).
State edma_pending() {
  State s{"edma", "events, missed events, errors and a code pending", kPending};
  s.enter = long_requests(0);
  append(s.enter, {{"QWMTHRA", 0x1010'1000},
                   {"PARAM_OPT6", 1u << 22 | 3u << 12},  // a dummy set chains to channel 3
                   {"PARAM_A_B_CNT6", 1},
                   {"PARAM_LINK_BCNTRLD6", 0xFFFF},
                   {"PARAM_OPT7", 1u << 20 | 7u << 12},
                   {"PARAM_A_B_CNT7", 1},
                   {"PARAM_LINK_BCNTRLD7", 0xFFFF},
                   {"PARAM_A_B_CNT5", 0},
                   {"PARAM_CCNT5", 0},
                   {"ESR", 0xE},
                   {nullptr, 1'000},
                   {"ESR", 0xE8},
                   {"QDMAQNUM", 1},
                   {"QCHMAP0", 100u << 5 | 7u << 2},
                   {"QEESR", 1},
                   {"PARAM_A_B_CNT100", 0},
                   {"PARAM_CCNT100", 0},
                   {"PRD12", 12, "timer0"},
                   {"TGCR", 5, "timer0"},
                   {"TCR", 0x40, "timer0"},
                   {nullptr, 2'000}});
  s.signs = {
      {"QSTAT0", 0x0100'1F00, 0x0100'0100}, {"SER", 0x28, 0x28}, {"ESR", 8, 8},  {"CER", 8, 8},   {"EMR", 0x20, 0x20},
      {"ERH", 1u << 16, 1u << 16},          {"QEMR", 1, 1},      {"QSER", 1, 1}, {"CCERR", 1, 1}, {"IPR", 0x80, 0x80},
      {"CCSTAT", 0x0001'0011, 0x0001'0011}};
  for (const std::string half : {"", "H"})
    for (const auto& [written, changed] :
         {std::pair("ECR", "ER"), {"EECR", "EER"}, {"SECR", "SER"}, {"IECR", "IER"}, {"ICR", "IPR"}, {"EMCR", "EMR"}})
      s.moves.push_back({written + half, changed + half, Move::Effect::kClears});
  for (const std::string half : {"", "H"})
    for (const auto& [written, changed] : {std::pair("EESR", "EER"), {"IESR", "IER"}, {"ESR", "ESR"}})
      s.moves.push_back({written + half, changed + half, Move::Effect::kSets});
  for (const auto& [written, changed] : {std::pair("QEMCR", "QEMR"), {"QEECR", "QEER"}, {"QSECR", "QSER"}})
    s.moves.push_back({written, changed, Move::Effect::kClears});
  for (const auto& [written, changed] : {std::pair("QEESR", "QEER"),
                                         {"QSECR", "QER"},
                                         {"ESR*", "EMR*"},
                                         {"CCERRCLR", "CCERR"},
                                         {"CCERRCLR", "QSTAT*"},
                                         {"PARAM_*", "QER"},
                                         {"PARAM_*", "QEMR"}})
    s.moves.push_back({written, changed});
  s.odd = {"ESR*"};
  s.left_out = {"DRAE*", "QRAE*"};  // with these the shadow regions act on the channels (the other states)
  return s;
}

/// An interrupt of each kind is pending and enabled: TIMER0's lower half (32) as IRQ, its upper half (33) as FIQ. With
/// IDMODE an input that is disabled stays in effect until it is acknowledged.
State aintc(bool keeps) {
  State s{"aintc", keeps ? "interrupts pending, IDMODE 1" : "interrupts pending, IDMODE 0", kAintc};
  s.enter = {{"INTCTL", keeps ? 4u : 0u},    {"INTPRI4", 0x7777'7707}, {"EINT1", 3},
             {"PRD12", 12, "timer0"},        {"PRD34", 12, "timer0"},  {"TGCR", 7, "timer0"},
             {"TCR", 0x0040'0040, "timer0"}, {nullptr, 4'000}};
  s.signs = {{"IRQ1", 3, 2}, {"FIQ1", 3, 1}, {"IRQENTRY", ~0u, 4 * 33}, {"FIQENTRY", ~0u, 4 * 34}};
  s.moves = {{"IRQ*", "IRQENTRY"},   {"FIQ*", "FIQENTRY"},   {"INTPRI*", "IRQ*"},    {"INTPRI*", "FIQ*"},
             {"INTCTL", "IRQENTRY"}, {"INTCTL", "FIQENTRY"}, {"EABASE", "IRQENTRY"}, {"EABASE", "FIQENTRY"}};
  if (!keeps) s.moves.push_back({"EINT1", "IRQENTRY"}), s.moves.push_back({"EINT1", "FIQENTRY"});
  s.odd = {"IRQ*", "FIQ*"};
  s.computed = {"IRQ*", "FIQ*"};
  return s;
}

State pll_on(const char* block) {
  State s{block, "locked and in use", kPllOn};
  s.moves = {{"CKEN", "CKSTAT"}, {"PLLDIV*", "DCHANGE"}, {"PLLCMD", "PLLSTAT"}};
  // 24 MHz times 20, divided by 16
  s.enter = {{"PLLM", 10},       {"PREDIV", 0x8000}, {"POSTDIV", 0x800F}, {"PLLCTL", 0x40},
             {nullptr, 200'000}, {"PLLCTL", 0x41},   {nullptr, 1'000}};
  s.signs = {{"PLLSTAT", 2, 2}, {"PLLCTL", 0x2B, 0x01}};
  s.ones = {{"PLLCTL", 1}};
  s.zeros = {{"PLLCTL", 0x2A}};
  s.warned = {{"PLLM", ~0u, "multiplier or pre-divider changed while PLLEN = 1"},
              {"PREDIV", ~0u, "multiplier or pre-divider changed while PLLEN = 1"}};
  return s;
}

/// PINMUX has no lock on this chip, unlike OMAP-L138 with its KICK registers: TI's boot loader and Linux write it as it
/// is.
State calibrated() {
  State s{"system", "SDRAM's pads calibrated, PLLs locked", kVtp};
  s.enter = {{"PLLM", 10, "pll1"}, {"PREDIV", 0x8000, "pll1"}, {"PLLCTL", 0x60, "pll1"},
             {"PLLM", 10, "pll2"}, {"PREDIV", 0x8000, "pll2"}, {"PLLCTL", 0x60, "pll2"},
             {"VTPIOCR", 0},       {"VTPIOCR", 0x2000},        {nullptr, 200'000}};
  s.signs = {{"VTPIOCR", 0xA000, 0xA000}, {"PLL0_CONFIG", ~0u, 0x1F00'0000}, {"PLL1_CONFIG", ~0u, 0x1F00'0000}};
  s.ones = {{"VTPIOCR", 0x2000}};
  s.computed = {"VTPIOCR", "PLL0_CONFIG", "PLL1_CONFIG"};
  return s;
}

State pll(const char* block, bool taking) {
  State s{block, taking ? "taking ratios" : "after a reset", kPll};
  s.moves = {{"CKEN", "CKSTAT"}, {"PLLDIV*", "DCHANGE"}, {"PLLCMD", "PLLSTAT"}};
  if (taking) {
    s.enter = {{"PLLDIV1", 0x8003}, {"PLLCMD", 1}};
    s.signs = {{"PLLSTAT", 1, 1}};
  }
  return s;
}

State psc(bool moving) {
  State s{"psc", moving ? "in transition" : "after a reset", kPsc};
  s.moves = {{"PTCMD", "PTSTAT"}};
  s.odd = {"PTCMD"};
  if (moving) {
    s.enter = {{"MDCTL26", 2}, {"PTCMD", 1}};
    s.signs = {{"PTSTAT", 1, 1}, {"MDSTAT26", 0x3F, 3}};
  }
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
  for (const char* reg : {"TIM12", "TIM34", "PRD12", "PRD34", "TCR", "TGCR"})
    s.warned.push_back({reg, 0, "is written while the watchdog is armed, and keeps its value"});
  return s;
}

/// Video ports that run take their settings with the next vertical sync, and read back what is written. When they act:
/// video.capture, video.display (EachSetting...).
constexpr const char* kRunning = "assumed: what a sync takes over reads back at once, as Linux drivers modify it";

/// The encoder shows the second field of its first frame, with a window whose memory does not answer.
State displaying(const char* block) {
  State s{block, "in the second field of a frame", kRunning};
  s.enter = {{"VPSS_CLK_CTRL", 0x18, "system"},
             {"VIDWINMD", 3, "osd"},
             {"CLKCTL", 1, "venc"},
             {"VMOD", 0x43, "venc"},
             {nullptr, 30'000'000}};
  s.signs = {{"VSTAT", 0x10, 0x10, "venc"}, {"INTSTAT", 1u << 21, 1u << 21, "vpss"}};
  return s;
}

State capturing(const char* block) {
  State s{block, "capturing", kRunning};
  s.enter = {{"REC656IF", 3, "isif"}, {"MODESET", 0x2084, "isif"}, {"CCDCFG", 0x812, "isif"}, {"LNH", 1439, "isif"},
             {"LNV", 287, "isif"},    {"HSIZE", 45, "isif"},       {"SYNCEN", 3, "isif"},     {nullptr, 45'000'000}};
  s.signs = {{"INTSTAT", 1, 1, "vpss"}, {"SYNCEN", 3, 3, "isif"}};
  return s;
}

State osd() {
  State s = displaying("osd");
  s.signs.push_back({"VIDWINMD", 1, 1});
  s.ones = {{"VIDWINMD", 1}};
  return s;
}

State venc() {
  State s = displaying("venc");
  s.ones = {{"VMOD", 1}, {"CLKCTL", 1}};
  return s;
}

State isif() {
  State s = capturing("isif");
  s.ones = {{"SYNCEN", 3}};
  return s;
}

/// With the interrupts of both ports seen; a 1 ends them, and they come again with the next field.
State vpss() {
  State s = displaying("vpss");
  const State c = capturing("vpss");
  s.name = "interrupts seen";
  s.enter.insert(s.enter.begin(), c.enter.begin(), c.enter.end() - 1);
  s.signs.insert(s.signs.end(), c.signs.begin(), c.signs.end());
  s.moves = {{"INTSTAT", "INTSTAT", Move::Effect::kClears}};
  s.odd = {"INTSTAT"};
  return s;
}

State engine(bool busy) {
  State s = as_declared("engine");
  if (!busy) return s;
  s.name = "a job under way";
  s.enter = {{"CTRL", 1}, {"SIZE", 0x0100'0100}, {"SUBMIT", 1}, {nullptr, 100}};
  s.signs = {{"STATUS", 1, 1}};
  return s;
}

}  // namespace

const std::vector<State>& states() {
  static const std::vector<State> all = {timing_of_sdram(false),
                                         timing_of_sdram(true), type_of_sdram(),
                                         edma(true),
                                         edma(false),
                                         edma_pending(),
                                         as_declared("edma_tc0"),
                                         tc_busy(0),
                                         tc_busy(1),
                                         tc_busy(2),
                                         tc_busy(3),
                                         as_declared("edma_tc1"),
                                         as_declared("edma_tc2"),
                                         as_declared("edma_tc3"),
                                         pll("pll1", false),
                                         pll("pll1", true),
                                         pll("pll2", false),
                                         pll("pll2", true),
                                         pll_on("pll1"),
                                         pll_on("pll2"),
                                         psc(false),
                                         psc(true),
                                         as_declared("system"),
                                         calibrated(),
                                         as_declared("aintc"),
                                         aintc(false),
                                         aintc(true),
                                         as_declared("timer0"),
                                         as_declared("timer1"),
                                         as_declared("timer2"),
                                         watchdog(false),
                                         watchdog(true),
                                         as_declared("timer3"),
                                         as_declared("timer4"),
                                         uart("uart0", false),
                                         uart("uart0", true),
                                         uart("uart1", false),
                                         uart("uart1", true),
                                         gpio(),
                                         i2c(false),
                                         i2c(true),
                                         as_declared("vpss"),
                                         vpss(),
                                         as_declared("isif"),
                                         isif(),
                                         as_declared("osd"),
                                         osd(),
                                         as_declared("venc"),
                                         venc(),
                                         engine(false),
                                         engine(true)};
  return all;
}

}  // namespace fovea::soc
