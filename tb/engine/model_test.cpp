// The model of the remap engine against tb/rtl's golden model, on memories of different latency: pictures bit by bit,
// errors, ends before time; registers, queue and events.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tb/engine/model_bench.h"
#include "tb/rtl/random_jobs.h"

namespace fovea::engine {
namespace {

using rtl::Dice;
using rtl::MappedJob;
using rtl::Mode;

constexpr std::uint32_t kWord = ModelBench::kBase / 4;
constexpr std::uint32_t kMap = 0x20'0000, kTarget = 0x40'0000, kSize = 0x60'0000;
constexpr std::uint32_t kUntouched = 0x5A5A5A5A, kBorder = 0x10801080;

void fill(ModelBench& bench, const MappedJob& m, Dice& dice) {
  for (std::uint32_t n = 0; n < kSize / 4; ++n) bench.word(kWord + n) = kUntouched;
  for (std::uint32_t n = 0; n < m.job.src_pitch * m.job.src_height; ++n) bench.word(kWord + n) = dice.word();
  for (std::size_t n = 0; n < m.map.size(); ++n)
    bench.word(kWord + kMap / 4 + static_cast<std::uint32_t>(n)) = m.map[n];
}

void place(MappedJob& m, std::uint32_t offset_words = 0) {
  m.job.src_base = kWord;
  m.job.dst_base = kWord + kTarget / 4 + offset_words;
}

std::vector<std::uint32_t> expected(ModelBench& bench, const MappedJob& m) {
  return picture(m.job, m.map, kBorder, [&](std::uint32_t at) { return bench.word(at); });
}

void expect_picture(ModelBench& bench, const MappedJob& m, const std::vector<std::uint32_t>& want) {
  for (unsigned j = 0; j < m.job.rows; ++j)
    for (unsigned i = 0; i < m.job.pairs; ++i) {
      std::uint32_t& got = bench.word(m.job.dst_base + j * m.job.dst_pitch + i);
      ASSERT_EQ(got, want[std::size_t{j} * m.job.pairs + i]) << "pair " << i << " of row " << j;
      got = kUntouched;
    }
  for (std::uint32_t n = kTarget / 4; n < kSize / 4; ++n) ASSERT_EQ(bench.word(kWord + n), kUntouched);
}

TEST(ModelTest, RandomJobsMakeTheGoldenPicture) {
  Dice dice(rtl::seed() + 7);
  ModelBench bench(kSize);
  for (unsigned n = 0; n < 80; ++n) {
    MappedJob m = rtl::random_job(dice, static_cast<Mode>(n % 4));
    place(m, dice.to(40));
    m.job.dst_pitch = m.job.pairs + dice.to(20);
    fill(bench, m, dice);
    const auto want = expected(bench, m);
    EXPECT_EQ(bench.run(m.job, ModelBench::kBase + kMap, kBorder, {.latency = 1 + dice.to(60)}), kDone);
    expect_picture(bench, m, want);
    if (HasFatalFailure()) FAIL() << "job " << n;
    std::uint32_t bad = 0;
    for (const rtl::Beat& b : addresses(m.job, m.map)) bad += b.bad;
    EXPECT_EQ(bench.get(bench.regs.bad), bad);
  }
}

}  // namespace
}  // namespace fovea::engine
