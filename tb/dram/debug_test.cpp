// A debugger sees acknowledged writes, and its own are not undone by them.
#include <gtest/gtest.h>

#include <array>

#include "tb/dram/path.h"

namespace fovea::dram {
namespace {

/// Writes to one row until they are acknowledged, some before their data have moved.
struct DdrDebugTest : testing::Test {
  static constexpr unsigned kWrites = 4;
  Path path;
  std::array<std::array<std::uint8_t, 16>, kWrites> data{};
  std::array<PathRequest, kWrites> requests;
  unsigned unmoved = 0;

  void start(unsigned count) {
    for (unsigned k = 0; k < count; ++k) {
      data[k].fill(static_cast<std::uint8_t>(k + 1));
      PathRequest& r = requests[k];
      r.master = static_cast<Master>(k);
      r.write = true;
      r.bytes = 16;
      r.address = 0x1000 + 8 * k;  // each overlaps the one before
      r.data = data[k].data();
      path.submit(r, 1'000'000);
    }
    while (!std::all_of(requests.begin(), requests.begin() + count,
                        [](const PathRequest& r) { return r.responses == 1; }))
      path.step();
    for (unsigned k = 0; k < count; ++k) unmoved += *path.store.at(0x1000 + 8 * k) == 0;
  }
};

TEST_F(DdrDebugTest, LoneWriteInFifoIsSeenAndPatched) {
  start(1);
  ASSERT_EQ(unmoved, 1u);  // else the test says nothing
  std::array<std::uint8_t, 24> seen;
  path.ddr.debug_read(0x0FF8, seen.data(), 24);
  for (unsigned i = 0; i < 24; ++i) EXPECT_EQ(seen[i], i < 8 ? 0 : 1) << i;
  const std::array<std::uint8_t, 4> patch = {9, 9, 9, 9};
  path.ddr.debug_write(0x0FFE, patch.data(), 4);
  path.drain();
  for (unsigned i = 0; i < 18; ++i) EXPECT_EQ(*path.store.at(0x0FFE + i), i < 4 ? 9 : 1) << i;
}

TEST_F(DdrDebugTest, QueuedWritesAreSeenAsTheyWillBe) {
  start(kWrites);
  ASSERT_GE(unmoved, 2u);
  std::array<std::uint8_t, 40> seen, later;
  path.ddr.debug_read(0x1000, seen.data(), 40);
  path.drain();
  path.ddr.debug_read(0x1000, later.data(), 40);
  EXPECT_EQ(seen, later);
  EXPECT_EQ(0, std::memcmp(later.data(), path.store.at(0x1000), 40));
  EXPECT_NE(later[0], 0);
}

}  // namespace
}  // namespace fovea::dram
