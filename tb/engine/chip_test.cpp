// The remap engine as a block of the chip: reset, clock changes and requests beyond its places, while it works.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "model/board/board.h"
#include "model/common/host_time_slicer.h"
#include "model/engine/remap_engine.h"
#include "sw/fovea/board/loader.h"
#include "tb/own_diagnostics.h"
#include "tb/soc/reach.h"

namespace fovea::engine {
namespace {

constexpr std::uint32_t kSource = 0x1000, kTarget = 0x2000, kRam = 0x1'0000;  // offsets in internal RAM; its address
constexpr unsigned kPairs = 24, kRows = 16;
constexpr unsigned kIrq = 11;

/// A board whose core does nothing; source and result are in internal RAM, as the SDRAM is not initialised.
struct Chip : testing::Test {
  Chip() {
    params.declare(set);
    set.set("camera.kind", "chart");
    set.set("engine", "tlm");
    source = video::make_picture_source(params.camera, app::load_footage(params), params.raster_width(),
                                        params.raster_height());
    board = std::make_unique<board::Board>("board", params, *source, 0, false);
    board->load({0, {0xFE, 0xFF, 0xFF, 0xEA}});  // b .
    run(kPsPerUs);
  }
  soc::Dm365& chip() { return board->dm365; }
  RemapEngine& engine() { return chip().placed.get<RemapEngine>("engine"); }
  void run(Picoseconds t) { slicer.run(t); }
  void set_register(const Reg& r, std::uint32_t v) { engine().regs.write(r.offset(), 4, v); }
  std::uint32_t get(const Reg& r) {
    std::uint32_t v = 0;
    engine().regs.read(r.offset(), 4, v);
    return v;
  }
  std::uint32_t& word(std::uint32_t offset) {
    return *reinterpret_cast<std::uint32_t*>(chip().internal_ram.data() + offset);
  }
  /// A copy by a projection; `pitch` in words.
  void copy(unsigned pitch = kPairs) {
    for (std::uint32_t n = 0; n < kPairs * kRows; ++n) word(kSource + 4 * n) = n * 0x0101'0101 + 7;
    for (std::uint32_t n = 0; n < pitch * kRows; ++n) word(kTarget + 4 * n) = 0;
    job(pitch);
    set_register(engine().regs.submit, 1);
  }
  /// Describes it, and enables the engine.
  void job(unsigned pitch = kPairs) {
    const EngineRegs& r = engine().regs;
    set_register(r.mode, 3);
    set_register(r.size, kPairs | kRows << 16);
    set_register(r.src_base, kRam + kSource);
    set_register(r.src_pitch, kPairs * 4);
    set_register(r.src_size, kPairs * 2 | kRows << 16);
    set_register(r.dst_base, kRam + kTarget);
    set_register(r.dst_pitch, pitch * 4);
    set_register(r.a1, 2 << 8);
    set_register(r.b2, 1 << 8);
    set_register(r.c0, 1 << 8);
    set_register(r.enables, 1);
    set_register(r.ctrl, 1);
  }
  bool copied(unsigned pitch = kPairs) {
    for (std::uint32_t j = 0; j < kRows; ++j)
      for (std::uint32_t i = 0; i < kPairs; ++i)
        if (word(kTarget + 4 * (j * pitch + i)) != (j * kPairs + i) * 0x0101'0101 + 7) return false;
    return true;
  }
  OwnDiagnostics diagnostics;
  board::BoardParams params;
  ParamSet set;
  std::unique_ptr<video::PictureSource> source;
  std::unique_ptr<board::Board> board;
  HostTimeSlicer slicer;
};

// The engine has the place of the imaging coprocessor: its priority is MSTPRI0.IMCOPP, bits 18 to 16.
TEST_F(Chip, ItsPriorityIsTheImagingCoprocessors) {
  const auto priority = [&] { return chip().scr.crossbar().priority(Master::kRemapEngine); };
  EXPECT_EQ(priority(), 5u) << "after a reset";
  for (const unsigned p : {0u, 3u, 7u}) {
    chip().system.regs.write(0x3C, 4, 0x0050'0011 | p << 16);
    run(kPsPerUs);
    EXPECT_EQ(priority(), p);
  }
}

TEST_F(Chip, WhoLooksIntoMemorySeesItFromItsFirstByteOn) {
  std::memcpy(chip().ddr.store().at(0), "sdram", 5);
  word(0) = 0x7265'7469;
  EXPECT_THAT(board->peek(0x8000'0000, 5), testing::ElementsAre('s', 'd', 'r', 'a', 'm'));
  EXPECT_THAT(board->peek(kRam, 4), testing::ElementsAre('i', 't', 'e', 'r'));
  board->load({0x8000'0000, {'i', 'm', 'a', 'g', 'e'}});
  EXPECT_THAT(board->peek(0x8000'0000, 5), testing::ElementsAre('i', 'm', 'a', 'g', 'e'));
  EXPECT_THAT(board->peek(kRam, 4), testing::ElementsAre('i', 't', 'e', 'r'));
}

TEST_F(Chip, AJobRaisesItsInterrupt) {
  EXPECT_THAT(soc::unreached(board->platform), testing::IsEmpty());
  chip().aintc.regs.regs.write(0x18, 4, 1u << kIrq);
  const auto pending = [&] {
    std::uint32_t irq0 = 0;
    chip().aintc.regs.regs.read(0x08, 4, irq0);
    return (irq0 >> kIrq & 1u) == 0;
  };
  copy();
  EXPECT_FALSE(pending());
  EXPECT_EQ(get(engine().regs.status), 0x10u);
  run(kPsPerMs);
  EXPECT_TRUE(copied());
  EXPECT_TRUE(pending());
  EXPECT_EQ(get(engine().regs.events), 1u);
  EXPECT_EQ(engine().stats.jobs.count(), 1u);
  EXPECT_EQ(engine().stats.write_bytes.count(), kPairs * kRows * 4u);
  EXPECT_EQ(engine().stats.source_bytes.count(), kPairs * kRows * 4u);
}

/// As at the RTL's own port (rtl/README.md): a command is in the lowest byte. What is not written of a word is 0.
TEST_F(Chip, AWriteToTheLowestByteOfSubmitPushesAJob) {
  set_register(engine().regs.size, 1 | 1 << 16);
  const std::uint32_t submit = engine().regs.submit.offset();
  const struct {
    std::uint32_t byte;
    unsigned bytes;
    std::uint32_t value;
    bool pushes;
  } writes[] = {{0, 1, 0xA5, true}, {1, 1, 0xA5, false}, {2, 2, 0xBEEF, false}, {0, 2, 0x12C3, true}};
  unsigned pushed = 0;
  for (const auto& w : writes) {
    engine().regs.write(submit + w.byte, w.bytes, w.value);
    run(kPsPerUs);
    EXPECT_EQ(get(engine().regs.status) >> 4 & 15, pushed += w.pushes);
  }
  std::uint32_t ended = 0;
  set_register(engine().regs.enables, 0x7F);
  set_register(engine().regs.ctrl, 1);
  run(kPsPerMs);
  ended = get(engine().regs.ended);
  EXPECT_EQ(ended, 2u << 16 | 2u << 8 | 0xC3) << "a source without a row is refused; the tag of the last one";
}

TEST_F(Chip, ResetAtAnyTimeForgetsTheJob) {
  unsigned busy = 0;
  for (unsigned n = 1; n < 12; ++n) {
    copy();
    run(n * 15 * kPsPerUs);
    busy += get(engine().regs.status) & 1;
    chip().reset_chip(ResetKind::kWarm);
    run(kPsPerMs);
    EXPECT_EQ(get(engine().regs.status), 0u) << n;
    EXPECT_EQ(get(engine().regs.events), 0u) << n;
    EXPECT_EQ(get(engine().regs.a1), 0u) << n;
    EXPECT_TRUE(engine().idle());
  }
  EXPECT_GE(busy, 4u);
  EXPECT_LE(busy, 10u);
  copy();
  run(kPsPerMs);
  EXPECT_TRUE(copied());
  EXPECT_EQ(get(engine().regs.ended), 0x10101u);
}

/// Bytes that an access does not write keep their value: in registers with fields and in those without.
TEST_F(Chip, AWriteOfSomeBytesKeepsTheOthers) {
  const EngineRegs& r = engine().regs;
  const auto write = [&](const Reg& reg, unsigned byte, unsigned bytes, std::uint32_t value) {
    engine().regs.write(reg.offset() + byte, bytes, value);
  };
  set_register(r.mode, 2 | 3 << 8 | 5 << 16 | 7 << 24);
  write(r.mode, 1, 1, 4);
  EXPECT_EQ(get(r.mode), 2u | 4 << 8 | 5 << 16 | 7 << 24);
  set_register(r.size, 0x0123'0456);
  write(r.size, 2, 2, 0x0234);
  EXPECT_EQ(get(r.size), 0x0234'0456u);
  set_register(r.border, 0x1122'3344);
  write(r.border, 3, 1, 0x55);
  EXPECT_EQ(get(r.border), 0x5522'3344u);
}

/// Which of both was not answered is said, and each is counted and said once at its time.
TEST_F(Chip, ABusErrorIsNamedByItsDirection) {
  constexpr std::uint32_t kNowhere = 0x0700'0000;
  std::vector<std::string> said;
  diagnostics.set_sink([&](Diagnostics::Kind, const std::string& text) {
    if (text.starts_with("remap engine")) said.push_back(text);  // the bus says its own
  });
  const auto make = [&](const Reg& base) {
    engine().reset(ResetKind::kWarm);
    said.clear();
    job();
    set_register(base, kNowhere);
    set_register(engine().regs.submit, 1);
    run(kPsPerMs);
  };
  make(engine().regs.src_base);
  ASSERT_FALSE(said.empty());
  for (const std::string& text : said) EXPECT_THAT(text, testing::HasSubstr("a read that nobody answers"));
  EXPECT_EQ(get(engine().regs.ended) >> 8 & 0xFF, 4u);
  make(engine().regs.dst_base);
  ASSERT_FALSE(said.empty());
  for (const std::string& text : said) EXPECT_THAT(text, testing::HasSubstr("a write that nobody answers"));
  EXPECT_EQ(get(engine().regs.ended) >> 8 & 0xFF, 8u);
}

/// A reset of the engine alone, so that a job can begin while requests from before it are still under way.
TEST_F(Chip, AnswersFromBeforeAResetAreNotThoseOfTheNextJob) {
  for (unsigned n = 0; n < 200; ++n) {
    copy();
    run(20 * kPsPerUs + n * 20 * kPsPerNs);
    ASSERT_EQ(get(engine().regs.status), 1u);
    engine().reset(ResetKind::kWarm);
    EXPECT_EQ(get(engine().regs.status), 0u);
    copy();
    run(kPsPerMs / 5);
    ASSERT_TRUE(copied()) << n;
    ASSERT_EQ(get(engine().regs.ended), 0x10101u) << n;
    engine().reset(ResetKind::kWarm);
  }
}

/// PLLDIV4 of PLL 1 gives SYSCLK4; bit 15 enables it.
TEST_F(Chip, TheClockMayChangeWhileItWorks) {
  const auto divide = [&](std::uint32_t value) {
    chip().pll1.regs.write(0x160, 4, value);
    chip().pll1.regs.write(0x138, 4, 1);
  };
  for (unsigned n = 1; n < 6; ++n) {
    copy();
    run(n * 10 * kPsPerUs);
    divide(0x8000 | n);
    run(20 * kPsPerUs);
    EXPECT_EQ(get(engine().regs.status), 1u);
    divide(0x8000);
    run(kPsPerMs);
    EXPECT_TRUE(copied()) << n;
    EXPECT_EQ(get(engine().regs.ended) >> 16, n);
  }
}

/// Each word of the result by itself would be a request: more than there are places.
TEST_F(Chip, BurstsWithGapsWaitForPlaces) {
  set_register(engine().regs.b1, 0);
  copy(kPairs + 1);
  run(kPsPerMs);
  EXPECT_TRUE(copied(kPairs + 1));
  const std::uint64_t whole = engine().stats.writes.count();
  // Rows of one pair, every second word.
  set_register(engine().regs.size, 1 | kRows << 16);
  set_register(engine().regs.dst_pitch, 8);
  for (std::uint32_t n = 0; n < 64; ++n) word(kTarget + 4 * n) = 0xEEEE'EEEE;
  for (unsigned n = 0; n < 3; ++n) set_register(engine().regs.submit, 2);
  run(kPsPerMs);
  for (std::uint32_t n = 0; n < 2 * kRows; ++n)
    EXPECT_EQ(word(kTarget + 4 * n), n % 2 ? 0xEEEE'EEEE : n / 2 * kPairs * 0x0101'0101 + 7);
  EXPECT_EQ(engine().stats.writes.count() - whole, 3 * kRows);
  EXPECT_EQ(get(engine().regs.writes), 2u);
}

/// The model works ahead of the kernel; what it asks for counts when it is asked for.
TEST_F(Chip, RequestsCountFromTheirTimeOn) {
  struct Group : StatGroup {
    TimedCounter bytes{*this, "bytes", "B", "of a test"};
    Group() : StatGroup("test") {}
  } group;
  const Picoseconds now = kernel_time();
  group.bytes.add(now, 1);
  group.bytes.add(now + 1000, 2);
  group.bytes.add(now + 3000, 4);
  EXPECT_EQ(group.bytes.count(), 1u);
  run(999);
  EXPECT_EQ(group.bytes.count(), 1u);
  run(1);
  EXPECT_EQ(group.bytes.count(), 3u);
  run(500);
  group.bytes.reset();
  EXPECT_EQ(group.bytes.count(), 0u);
  run(1500);
  EXPECT_EQ(group.bytes.count(), 4u);
  // A reset of the block: what has happened stays in the count, what lies ahead does not come.
  group.bytes.add(kernel_time(), 8);
  group.bytes.add(kernel_time() + 1, 16);
  group.bytes.drop_ahead();
  run(1);
  EXPECT_EQ(group.bytes.count(), 12u);
}

/// An access to a register in the middle of a job does not find the job ended, whatever the model knows already.
TEST_F(Chip, TheEndOfAJobIsSeenAtItsTime) {
  copy();
  Picoseconds busy = 0;
  while (get(engine().regs.status) != 0 && busy < kPsPerMs) {
    EXPECT_EQ(get(engine().regs.ended), 0u);
    EXPECT_EQ(engine().stats.interrupts.count(), 0u);
    run(100 * kPsPerNs);
    busy += 100 * kPsPerNs;
  }
  EXPECT_TRUE(copied());
  EXPECT_EQ(engine().stats.interrupts.count(), 1u);
  EXPECT_EQ(get(engine().regs.ended), 0x10101u);
  // The job is taken a clock or two behind SUBMIT, and its end is seen a clock later.
  const Clock clock(engine().clk.read());
  EXPECT_NEAR(get(engine().regs.clocks), static_cast<double>(clock.edge_after(busy)), 6);
}

}  // namespace
}  // namespace fovea::engine

int sc_main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
