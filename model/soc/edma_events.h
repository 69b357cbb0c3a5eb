// The hardware events of the EDMA's channels, and EDMA_EVTMUX. Sources: TI's register header for the DM36x
// and the Linux port of its camera kit (mach-davinci/include/mach/edma.h), which agree on the channels. The inputs of
// the interrupt controller with which events come are those of Linux' irqs.h and of boot programs for the chip; of
// TINT4 (13), GPIO8 (52) and GPIO9 (53) both lack it, and it is assumed from ARM_INTMUX (periph/interrupt_mux.h) and
// the neighbours: TINT5 and TINT6 are 14 and 15, GPIO7 and GPIO10 are 51 and 54.
#pragma once
#include <array>
#include <string_view>

#include "model/dma/core/edma_registers.h"

namespace fovea::soc {

struct EdmaEvent {
  enum class Wire {
    kNone,       ///< its source is not modelled
    kInterrupt,  ///< it comes with the interrupt `input`
    kOwn,        ///< a line of its own
  };
  static constexpr int kNoChoice = -1;

  unsigned channel = 0;
  std::string_view first;         ///< source, as TI names it
  std::string_view second = {};   ///< source while the bit of EDMA_EVTMUX is 1; none is modelled
  int bit = kNoChoice;            ///< of EDMA_EVTMUX
  Wire wire = Wire::kNone;        ///< of the first source
  unsigned input = 0;             ///< of the interrupt controller
  bool second_source_of_input = false;  ///< what ARM_INTMUX calls the second one; before that multiplexer

  constexpr bool has_choice() const { return bit != kNoChoice; }
};

inline constexpr unsigned kVpssEvent1 = 4, kUart0Receive = 18, kUart1Receive = 20, kI2cReceive = 28;

namespace edma_events {
constexpr EdmaEvent none(unsigned n, std::string_view source) { return {n, source}; }
constexpr EdmaEvent none(unsigned n, std::string_view first, std::string_view second, int bit) {
  return {n, first, second, bit};
}
constexpr EdmaEvent own(unsigned n, std::string_view first, std::string_view second = {},
                        int bit = EdmaEvent::kNoChoice) {
  return {n, first, second, bit, EdmaEvent::Wire::kOwn};
}
constexpr EdmaEvent irq(unsigned n, std::string_view first, unsigned input, bool second_source = false) {
  return {n, first, {}, EdmaEvent::kNoChoice, EdmaEvent::Wire::kInterrupt, input, second_source};
}
constexpr EdmaEvent pin(unsigned n, std::string_view first, unsigned input, std::string_view second,
                        int bit) {
  return {n, first, second, bit, EdmaEvent::Wire::kInterrupt, input};
}
constexpr bool kSecond = true;
}  // namespace edma_events

/// By channel.
inline constexpr std::array<EdmaEvent, dma::kChannels> kEdmaEvents = [] {
  using namespace edma_events;
  return std::array<EdmaEvent, dma::kChannels>{{
      irq(0, "TINT6 (TIMER3)", 15),
      irq(1, "TINT7 (TIMER3)", 22),
      none(2, "McBSP XEVT", "voice codec", 0),
      none(3, "McBSP REVT", "voice codec", 1),
      own(4, "VPSS_EVT1"),
      own(5, "VPSS_EVT2"),
      own(6, "VPSS_EVT3"),
      own(7, "VPSS_EVT4"),
      irq(8, "TINT4 (TIMER2)", 13, kSecond),
      irq(9, "TINT5 (TIMER2)", 14),
      none(10, "SPI2XEVT"),
      none(11, "SPI2REVT"),
      none(12, "IMX0INT", "HDVICP ARMINT", 2),
      none(13, "SEQINT"),
      none(14, "SPI1XEVT"),
      none(15, "SPI1REVT"),
      none(16, "SPI0XEVT"),
      none(17, "SPI0REVT"),
      own(18, "URXEVT0 (UART0)", "SPI3XEVT", 3),
      own(19, "UTXEVT0 (UART0)", "SPI3REVT", 4),
      own(20, "URXEVT1 (UART1)"),
      own(21, "UTXEVT1 (UART1)"),
      irq(22, "TINT8 (TIMER4)", 38, kSecond),
      irq(23, "TINT9 (TIMER4)", 28, kSecond),
      none(24, "RTOEVT"),
      irq(25, "GPIO9", 53),
      none(26, "MMC0RXEVT", "Memory Stick MSEVT", 5),
      none(27, "MMC0TXEVT"),
      own(28, "ICREVT (I2C)"),
      own(29, "ICXEVT (I2C)"),
      none(30, "MMC1RXEVT"),
      none(31, "MMC1TXEVT"),
      irq(32, "GPIO0", 44),
      irq(33, "GPIO1", 45),
      irq(34, "GPIO2", 46),
      irq(35, "GPIO3", 47),
      irq(36, "GPIO4", 48),
      irq(37, "GPIO5", 49),
      irq(38, "GPIO6", 50),
      irq(39, "GPIO7", 51),
      pin(40, "GPIO10", 54, "EMAC RXTHRESH", 6),
      pin(41, "GPIO11", 55, "EMAC RXPULSE", 7),
      pin(42, "GPIO12", 56, "EMAC TXPULSE", 8),
      pin(43, "GPIO13", 57, "EMAC MISCPULSE", 9),
      pin(44, "GPIO14", 58, "SPI4XEVT", 10),
      pin(45, "GPIO15", 59, "SPI4REVT", 11),
      none(46, "ADINT"),
      irq(47, "GPIO8", 52),
      irq(48, "TINT0 (TIMER0)", 32),
      irq(49, "TINT1 (TIMER0)", 33),
      irq(50, "TINT2 (TIMER1)", 34),
      irq(51, "TINT3 (TIMER1)", 35),
      none(52, "PWM0"),
      none(53, "PWM1", "IMX1INT", 12),
      none(54, "PWM2", "NSFINT", 13),
      none(55, "PWM3", "HDVICP CP_UNDEF", 14),
      none(56, "VLCDINT", "HDVICP CP_ECDCMP", 15),
      none(57, "BIMINT", "HDVICP CP_ME", 16),
      none(58, "DCTINT", "HDVICP CP_CALC", 17),
      none(59, "QIQINT", "HDVICP CP_IPE", 18),
      none(60, "BPSINT", "HDVICP CP_BS", 19),
      none(61, "VLCDERRINT", "HDVICP CP_LPF", 20),
      none(62, "RCNTINT", "HDVICP CP_MC", 21),
      none(63, "COPCINT", "HDVICP CP_ECDEND", 22),
  }};
}();

static_assert([] {
  for (unsigned n = 0; n < kEdmaEvents.size(); ++n)
    if (kEdmaEvents[n].channel != n) return false;
  return true;
}(), "a row of the EDMA's events is missing or out of order");

}  // namespace fovea::soc
