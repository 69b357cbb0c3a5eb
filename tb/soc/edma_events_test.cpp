// The numbers of the EDMA's hardware events. The table is typed from the list of channels in Linux'
// arch/arm/mach-davinci/include/mach/edma.h, as TI's Linux for its DM365 camera kit has it (enum dm365_edma_ch, with
// both names where EDMA_EVTMUX chooses), and shares nothing with model/soc/edma_events.h.
#include "model/soc/edma_events.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace fovea::soc {
namespace {

/// `first`: a part of the first source's name; `second`: of the other one's, or empty.
struct Row {
  unsigned channel;
  const char *first, *second;
  bool wired;  ///< the source is a block of the model
};
constexpr Row kRows[] = {
    {0, "TINT6", "", true},            {1, "TINT7", "", true},
    {2, "McBSP XEVT", "codec", false}, {3, "McBSP REVT", "codec", false},
    {4, "VPSS_EVT1", "", true},        {5, "VPSS_EVT2", "", true},
    {6, "VPSS_EVT3", "", true},        {7, "VPSS_EVT4", "", true},
    {8, "TINT4", "", true},            {9, "TINT5", "", true},
    {10, "SPI2XEVT", "", false},       {11, "SPI2REVT", "", false},
    {12, "IMX0INT", "ARMINT", false},  {13, "SEQINT", "", false},
    {14, "SPI1XEVT", "", false},       {15, "SPI1REVT", "", false},
    {16, "SPI0XEVT", "", false},       {17, "SPI0REVT", "", false},
    {18, "URXEVT0", "SPI3XEVT", true}, {19, "UTXEVT0", "SPI3REVT", true},
    {20, "URXEVT1", "", true},         {21, "UTXEVT1", "", true},
    {22, "TINT8", "", true},           {23, "TINT9", "", true},
    {24, "RTO", "", false},            {25, "GPIO9", "", true},
    {26, "MMC0RXEVT", "MSEVT", false}, {27, "MMC0TXEVT", "", false},
    {28, "ICREVT", "", true},          {29, "ICXEVT", "", true},
    {30, "MMC1RXEVT", "", false},      {31, "MMC1TXEVT", "", false},
    {32, "GPIO0", "", true},           {33, "GPIO1", "", true},
    {34, "GPIO2", "", true},           {35, "GPIO3", "", true},
    {36, "GPIO4", "", true},           {37, "GPIO5", "", true},
    {38, "GPIO6", "", true},           {39, "GPIO7", "", true},
    {40, "GPIO10", "RXTHRESH", true},  {41, "GPIO11", "RXPULSE", true},
    {42, "GPIO12", "TXPULSE", true},   {43, "GPIO13", "MISCPULSE", true},
    {44, "GPIO14", "SPI4XEVT", true},  {45, "GPIO15", "SPI4REVT", true},
    {46, "ADINT", "", false},          {47, "GPIO8", "", true},
    {48, "TINT0", "", true},           {49, "TINT1", "", true},
    {50, "TINT2", "", true},           {51, "TINT3", "", true},
    {52, "PWM0", "", false},           {53, "PWM1", "IMX1INT", false},
    {54, "PWM2", "NSFINT", false},     {55, "PWM3", "CP_UNDEF", false},
    {56, "VLCDINT", "CP_ECDCMP", false}, {57, "BIMINT", "CP_ME", false},
    {58, "DCTINT", "CP_CALC", false},  {59, "QIQINT", "CP_IPE", false},
    {60, "BPSINT", "CP_BS", false},    {61, "VLCDERRINT", "CP_LPF", false},
    {62, "RCNTINT", "CP_MC", false},   {63, "COPCINT", "CP_ECDEND", false},
};

/// Interrupts of the events that come with one, typed from Linux' arch/arm/mach-davinci/irqs.h (DM365 and the numbers
/// that it shares with the DM355); TINT8, TINT9 and GPIO10 to GPIO15 are not in it, but in headers of boot programs for
/// the chip. TINT4, GPIO8 and GPIO9 were found in neither: TINT5 follows TINT4, GPIO9 shares a line with the EMAC.
struct Interrupt {
  unsigned channel, number;
};
constexpr Interrupt kInterrupts[] = {{0, 15},  {1, 22},  {8, 13},  {9, 14},  {22, 38}, {23, 28}, {25, 53}, {32, 44},
                                     {33, 45}, {34, 46}, {35, 47}, {36, 48}, {37, 49}, {38, 50}, {39, 51}, {40, 54},
                                     {41, 55}, {42, 56}, {43, 57}, {44, 58}, {45, 59}, {47, 52}, {48, 32}, {49, 33},
                                     {50, 34}, {51, 35}};

/// EDMA_EVTMUX, by bit (TI's register header for the DM36x).
constexpr unsigned kChoices[] = {2,  3,  12, 18, 19, 26, 40, 41, 42, 43, 44, 45,
                                 53, 54, 55, 56, 57, 58, 59, 60, 61, 62, 63};

TEST(EdmaEvents, EachChannelHasItsSource) {
  ASSERT_EQ(std::size(kRows), kEdmaEvents.size());
  for (const Row& r : kRows) {
    const EdmaEvent& e = kEdmaEvents[r.channel];
    const auto words = " " + std::string(e.first) + " ", part = " " + std::string(r.first);
    const auto at = words.find(part);
    ASSERT_NE(at, std::string::npos) << r.channel << ": " << e.first << " for " << r.first;
    EXPECT_FALSE(std::isdigit(words[at + part.size()])) << r.channel << ": " << e.first;
    EXPECT_EQ(e.has_choice(), *r.second != 0) << r.channel;
    EXPECT_NE(e.second.find(r.second), std::string_view::npos) << r.channel << ": " << e.second;
    EXPECT_EQ(e.wire != EdmaEvent::Wire::kNone, r.wired) << r.channel;
  }
}

TEST(EdmaEvents, ThoseOfInterruptsHaveTheirNumber) {
  std::set<unsigned> seen;
  for (const auto& [channel, number] : kInterrupts) {
    EXPECT_EQ(kEdmaEvents[channel].wire, EdmaEvent::Wire::kInterrupt) << channel;
    EXPECT_EQ(kEdmaEvents[channel].input, number) << channel;
    seen.insert(channel);
  }
  for (const EdmaEvent& e : kEdmaEvents)
    EXPECT_EQ(e.wire == EdmaEvent::Wire::kInterrupt, seen.count(e.channel) == 1) << e.channel;
}

TEST(EdmaEvents, TheMultiplexersBitsBelongToTheirChannels) {
  std::set<unsigned> seen;
  for (unsigned bit = 0; bit < std::size(kChoices); ++bit) {
    EXPECT_EQ(kEdmaEvents[kChoices[bit]].bit, static_cast<int>(bit));
    seen.insert(kChoices[bit]);
  }
  for (const EdmaEvent& e : kEdmaEvents) EXPECT_EQ(e.has_choice(), seen.count(e.channel) == 1) << e.channel;
}

}  // namespace
}  // namespace fovea::soc
