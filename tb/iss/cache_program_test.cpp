// The core's caches against the functional oracle in compiled programs, and tests of the oracle
// itself.
#include <cstring>

#include "tb/iss/cache_bench.h"

namespace fovea::cpu::test {
namespace {

class CacheProgramTest : public testing::TestWithParam<const char*> {
 protected:
  static Outcome outcome(bool round_robin) {
    const std::string name = GetParam();
    const auto image = read_file(std::string(PROGRAM_DIR "/") + name + ".bin");
    const auto elf = read_file(std::string(PROGRAM_DIR "/") + name + ".elf");
    std::uint32_t entry = 0;
    std::memcpy(&entry, elf.data() + 24, 4);  // e_entry
    const Program boot = assemble(kCachesOn + (round_robin ? kRoundRobin : "") +
                                      " ldr r0, =" + std::to_string(entry) + "\n bx r0\n .ltorg\n",
                                  0);
    const Outcome out = compare(
        [&] {
          auto m = std::make_unique<NotingMachine>();
          std::memcpy(m->port.at(kMemory), image.data(), image.size());
          m->load(boot);
          return m;
        },
        CacheOracle::Fault::kNone, round_robin);
    print(name, out);
    return out;
  }
};

TEST_P(CacheProgramTest, FillsAndWritesBackWhatTheOracleDoes) {
  const Outcome out = outcome(true);
  EXPECT_EQ(out.difference, "");
  EXPECT_GT(out.counts.dcache_fills, 100u);
}

TEST_P(CacheProgramTest, SeesTheSameWithRandomReplacement) {
  EXPECT_EQ(outcome(false).difference, "");
}
INSTANTIATE_TEST_SUITE_P(Programs, CacheProgramTest,
                         testing::Values("compress_arm_O2", "sorting_thumb_O2", "hashes_arm_Os",
                                         "objects_arm_O2", "formats_thumb_Os", "integers_arm_O2"),
                         [](const auto& row) { return std::string(row.param); });
/// The oracle by hand: lines 2 KB apart share a set.
TEST(CacheOracleTest, ReplacesAndWritesBackAsTheManualSays) {
  CacheOracle o(
      0, std::vector<std::uint8_t>(65536),
      [](std::uint32_t a) {
        return CacheOracle::Page{a, true, true};
      },
      16384, 8192);
  o.control = 0x5005;
  for (std::uint32_t k = 0; k < 4; ++k) o.load(k * 2048 + 4 * k, 4);
  o.store(0x10, 1, {0x55});             // second half of the first line
  o.store(2048 + 28, 4, {7});           // and of the second
  o.store(2048, 4, {8});                // and its first
  o.store(0x8000, 4, {1, 2, 3, 4, 5});  // misses: to memory
  o.load(4 * 2048, 4);                  // drives out the first
  o.load(5 * 2048, 4);                  // the second
  o.load(2 * 2048, 4);                  // is still there
  o.lock(false, 0x8);
  o.load(6 * 2048, 4);  // the third way
  o.load(7 * 2048, 4);  // the fourth is locked: the first again
  o.load(4 * 2048, 4);  // gone
  const Traffic& t = o.traffic();
  std::vector<std::uint32_t> fills;
  for (const auto& f : t.data_fills) fills.push_back(f.address);
  EXPECT_EQ(fills,
            (std::vector<std::uint32_t>{0, 2052, 4104, 6156, 8192, 10240, 12288, 14336, 8192}));
  ASSERT_EQ(t.write_backs.size(), 2u);
  EXPECT_EQ(t.write_backs[0].address, 16u);
  EXPECT_EQ(t.write_backs[0].data.size(), 16u);
  EXPECT_EQ(t.write_backs[0].data[0], 0x55u);
  EXPECT_EQ(t.write_backs[1].address, 2048u);
  EXPECT_EQ(t.write_backs[1].data.size(), 32u);
  ASSERT_EQ(t.buffered.size(), 2u);
  EXPECT_EQ(t.buffered[0].data.size(), 16u);
  EXPECT_EQ(t.buffered[1], (Transfer{0x8010, {5, 0, 0, 0}}));
  EXPECT_EQ(o.counts().dcache_write_misses, 5u);
  o.store(7 * 2048, 4, {9});
  EXPECT_FALSE(o.test_and_clean(true));
  EXPECT_TRUE(o.test_and_clean(true));
  EXPECT_EQ(o.memory()[7 * 2048], 9u);
  o.load(7 * 2048, 4);
  EXPECT_EQ(o.counts().dcache_fills, 10u);
}

/// The comparison of what went over the bus, by itself.
TEST(CacheOracleTest, ComparisonComplains) {
  const Transfer a{0x100, {1, 2, 3, 4}}, b{0x200, {5}}, c{0x300, {6}};
  Traffic expected, good;
  expected.data_fills = good.data_fills = {a, b};
  expected.write_backs = {a, b};
  expected.buffered = {c, a};
  good.buffered = {a, c, b, a};
  EXPECT_EQ(difference(expected, good), "");
  // The first write may be of either buffer; only what follows tells.
  expected.write_backs = {a, b};
  Traffic either = good;
  either.buffered = {a, a, c, b};
  EXPECT_NE(difference(expected, either), "");
  expected.buffered = {a, c};
  EXPECT_EQ(difference(expected, either), "");
  either.buffered = {a, c, a, b};
  EXPECT_EQ(difference(expected, either), "");
  expected.buffered = {c, a};
  const auto complains = [&](const std::function<void(Traffic&)>& change) {
    Traffic bad = good;
    change(bad);
    return !difference(expected, bad).empty();
  };
  EXPECT_TRUE(complains([&](Traffic& t) { t.data_fills = {b, a}; })) << "order";
  EXPECT_TRUE(complains([&](Traffic& t) { t.data_fills[0].data[2] = 9; })) << "data";
  EXPECT_TRUE(complains([&](Traffic& t) { t.data_fills.pop_back(); })) << "one too few";
  EXPECT_TRUE(complains([&](Traffic& t) { t.data_fills.push_back(a); })) << "one too many";
  EXPECT_TRUE(complains([&](Traffic& t) { t.reads.push_back(a); })) << "another kind";
  EXPECT_TRUE(complains([&](Traffic& t) { t.instruction_fills.push_back(a); })) << "another port";
  EXPECT_TRUE(complains([&](Traffic& t) { t.unbuffered.push_back(a); })) << "not buffered";
  EXPECT_TRUE(complains([&](Traffic& t) { t.buffered = {b, a, c, a}; })) << "order of a buffer";
  EXPECT_TRUE(complains([&](Traffic& t) { t.buffered[2].address += 16; })) << "the other half";
  EXPECT_TRUE(complains([&](Traffic& t) { t.buffered = {a, b, c}; })) << "a write is lost";
  EXPECT_TRUE(complains([&](Traffic& t) { t.buffered = {a, c, a}; })) << "a write-back is lost";
}

}  // namespace
}  // namespace fovea::cpu::test
