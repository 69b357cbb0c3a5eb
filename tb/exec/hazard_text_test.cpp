// The sentence about a coherency hazard of each kind: who, where, and both times where both are known.
#include "sw/fovea/probes/hazard_report.h"

#include <gtest/gtest.h>

#include <systemc>

namespace fovea::app {
namespace {

using cpu::Hazard;
using cpu::HazardKind;

/// At 2 ms; the program has no symbols.
std::string text(HazardKind kind, Picoseconds before, Picoseconds filled = 0, Picoseconds stored = 0) {
  const Hazard h{kind, Master::kEdmaTc1Read, 0x8000'1234, 0x8123'4560, before, 2 * kPsPerMs, filled, stored};
  return hazard_text(h, Symbols{});
}

constexpr Picoseconds kOne = kPsPerMs + 500'000, kTwo = 2 * kPsPerMs;

TEST(HazardTextTest, NamesPlaceAndTimes) {
  EXPECT_EQ(text(HazardKind::kDirtyRead, kOne),
            "coherency hazard: edma_tc1_read read 0x81234560 at 2.000000 ms, but the bytes that were stored at "
            "0x80001234 at 1.000500 ms were still in a dirty D-cache line");
  EXPECT_EQ(text(HazardKind::kOverwrite, kOne),
            "coherency hazard: a D-cache line, dirty since the store at 0x80001234, was written back at 2.000000 ms "
            "over 0x81234560, which edma_tc1_read wrote at 1.000500 ms");
}

TEST(HazardTextTest, BytesInTheWriteBufferHaveTheirStore) {
  EXPECT_EQ(text(HazardKind::kBufferedRead, kTwo, 0, kOne),
            "coherency hazard: edma_tc1_read read 0x81234560 at 2.000000 ms, but newer bytes, stored at 0x80001234 at "
            "1.000500 ms, waited in the core's write buffer");
  EXPECT_EQ(text(HazardKind::kOverwrite, kTwo, 0, kOne),
            "coherency hazard: edma_tc1_read wrote 0x81234560 at 2.000000 ms, and older bytes, stored at 0x80001234 at "
            "1.000500 ms, that waited in the core's write buffer go over them");
}

TEST(HazardTextTest, OrThePlaceOfTheCore) {
  EXPECT_EQ(text(HazardKind::kBufferedRead, kTwo),
            "coherency hazard: edma_tc1_read read 0x81234560 at 2.000000 ms, but newer bytes waited in the core's "
            "write buffer; the core was at 0x80001234");
  EXPECT_EQ(text(HazardKind::kOverwrite, kTwo),
            "coherency hazard: edma_tc1_read wrote 0x81234560 at 2.000000 ms, and older bytes that waited in the "
            "core's write buffer go over them; the core was at 0x80001234");
}

}  // namespace
}  // namespace fovea::app

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
