// ARM_INTMUX: selects which of two sources drives an input of the interrupt controller.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <systemc>

#include "model/periph/clocked_target.h"

namespace fovea::periph {

/// One bit of ARM_INTMUX (TI's register header for the system module).
struct InterruptChoice {
  unsigned interrupt;  ///< input of the AINTC
  unsigned bit;        ///< bit of ARM_INTMUX: 0 selects `first`, 1 selects `second`
  const char* first;
  const char* second;
};
inline constexpr std::array<InterruptChoice, 27> kInterruptChoices = {{
    {0, 31, "VPSSINT0", "PBIST"},         {7, 25, "VPSSINT7", "NSFINT"},
    {8, 24, "VPSSINT8", "IMXINT1"},       {10, 0, "IMXINT0", "KLD_ARMINT"},
    {13, 1, "RTOINT", "TINT4"},           {17, 2, "SPINT1_0", "CCERRINT"},
    {18, 3, "SPINT1_1", "TCERRINT0"},     {19, 4, "SPINT2_0", "TCERRINT1"},
    {20, 5, "PSCINT", "TVINT"},           {21, 6, "SPINT2_1", "SPINT4_0"},
    {24, 7, "MBXINT", "VCINT"},           {26, 8, "MMCINT0", "MSINT"},
    {28, 9, "PWMINT3", "TINT9"},          {29, 10, "DDRINT", "RTCINT"},
    {30, 11, "AEMIFINT", "UHPIINT"},      {38, 12, "PWMINT2", "TINT8"},
    {43, 13, "SPINT0_1", "SPINT3_0"},     {52, 14, "GPIO8", "EMAC_RXTHRESH"},
    {53, 15, "GPIO9", "EMAC_RXPULSE"},    {54, 16, "GPIO10", "EMAC_TXPULSE"},
    {55, 17, "GPIO11", "EMAC_MISCPULSE"}, {56, 18, "GPIO12", "PRTCINT0"},
    {57, 19, "GPIO13", "PRTCINT1"},       {58, 20, "GPIO14", "PRTCINT2"},
    {59, 21, "GPIO15", "ADCINT"},         {61, 22, "COMMTX", "TCERRINT2"},
    {62, 23, "COMMRX", "TCERRINT3"},
}};

/// Inputs of sources that are not modelled stay unbound and are always low. Selecting one gives a
/// warning, once for each source.
class InterruptMux : public sc_core::sc_module {
 public:
  SC_HAS_PROCESS(InterruptMux);
  sc_core::sc_in<std::uint32_t> arm_intmux{"arm_intmux"};
  /// Indexed like kInterruptChoices.
  sc_core::sc_vector<OptionalIn<bool>> first{"first", kInterruptChoices.size()};
  sc_core::sc_vector<OptionalIn<bool>> second{"second", kInterruptChoices.size()};
  sc_core::sc_vector<OptionalOut<bool>> out{"out", kInterruptChoices.size()};

  explicit InterruptMux(sc_core::sc_module_name name);
  /// Index of the choice that drives an input of the interrupt controller; none: a single source
  /// drives it.
  static std::optional<std::size_t> find_choice(unsigned interrupt);

 private:
  void select();
  void update();
  DiagnosticsRef diagnostics_ = DiagnosticsRef::current();
};

}  // namespace fovea::periph
