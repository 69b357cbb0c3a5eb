// OSD, VENC and display in full size: the display gets the contents of memory at the right time.
#include <gtest/gtest.h>

#include "model/video/display_sink.h"
#include "model/video/osd.h"
#include "model/video/venc.h"
#include "tb/video/bench.h"
#include "tb/video/setting.h"

namespace fovea::video {
namespace {

// Standard, lines read ahead and bursts outstanding: CMakeLists.txt lists what is tried.
const bool k625 = setting("FOVEA_625", 1u) != 0;
const unsigned kAhead = setting("FOVEA_AHEAD", 1u), kOutstanding = setting("FOVEA_OUTSTANDING", 4u);
const Standard& kStd = standard_of(k625);
const unsigned kRows = kStd.rows, kPitch = 1440;
constexpr std::uint32_t kBuffer = 0x8010'0000, kOther = 0x8020'0000;

std::uint8_t pattern(unsigned row, unsigned i) {
  return static_cast<std::uint8_t>(1 + (row * 37 + i * 5 + (row * i >> 4)) % 254);
}

/// Passes lines on and keeps the first of each field.
class Tap : public sc_core::sc_module, public DisplayLineIf {
 public:
  sc_core::sc_export<DisplayLineIf> in{"in"};
  sc_core::sc_port<DisplayLineIf> out{"out"};
  struct First {
    unsigned number;
    bool f;
    std::uint8_t byte;
    Picoseconds start;
  };
  std::vector<First> firsts;
  explicit Tap(sc_core::sc_module_name name) : sc_module(name) { in.bind(*this); }
  void line(const DisplayLine& l) override {
    if (l.number == l.standard->active_first[l.f])
      firsts.push_back({l.number, l.f, l.uyvy ? l.uyvy[0] : std::uint8_t{0}, l.start});
    out->line(l);
  }
  void raster_off() override { out->raster_off(); }
};

struct Params : VpssParams {
  Params() {
    read_ahead_lines.set(std::to_string(kAhead));
    read_outstanding.set(std::to_string(kOutstanding));
  }
};

struct Bench {
  Params params;
  sc_core::sc_signal<bool> on{"on", true}, vpbe_gate{"vpbe_gate", true}, clk_sel{"clk_sel"},
      event{"event"};
  ClockSignal clock{"clock", kByteClock};
  Osd osd{"osd", params};
  Venc venc{"venc", params};
  Tap tap{"tap"};
  DisplaySink sink{"sink"};
  FakeMemory memory{"memory"};
  RegisterPort osd_regs{"osd_regs"}, venc_regs{"venc_regs"};
  EdgeLog edges{"edges"};
  std::vector<DisplayFrame> frames;
  std::vector<Osd::Latch> latches;

  Bench() {
    osd.memory.socket.bind(memory.socket);
    osd_regs.socket.bind(osd.reg_socket);
    venc_regs.socket.bind(venc.reg_socket);
    osd.psc_enabled(on);
    osd.gate(vpbe_gate);
    venc.psc_enabled(on);
    venc.vpbe_gate(vpbe_gate);
    venc.clk_sel(clk_sel);
    venc.clock(clock);
    venc.osd.bind(osd.lines);
    venc.display.bind(tap.in);
    tap.out.bind(sink.lines);
    venc.interrupt.out(event);
    edges.in(event);
    sink.assembler.on_frame = [this](const DisplayFrame& f) { frames.push_back(f); };
    osd.on_latch = [this](const Osd::Latch& l) { latches.push_back(l); };
  }
};
Bench* bench = nullptr;

enum : std::uint32_t {
  MODE = 0x00,
  VIDWINMD = 0x04,
  VIDWIN0OFST = 0x18,
  VIDWINADH = 0x28,
  VIDWIN0ADL = 0x2C,
  BASEPX = 0x40,
  BASEPY = 0x44,
  XP = 0x48,
  YP = 0x4C,
  XL = 0x50,
  YL = 0x54,
  VMOD = 0x00,
  CLKCTL = 0x140,
  VSTAT = 0xB8
};
const std::uint32_t kOn = k625 ? 0x43 : 0x03;
const Picoseconds kField = kPsPerSecond / (k625 ? 50 : 59);

class DisplayTest : public testing::Test {
 protected:
  Bench& b = *bench;
  void SetUp() override {
    b.venc_regs.write(VMOD, 0);
    b.venc_regs.write(CLKCTL, 1);
    b.memory.latency = 100 * kPsPerNs;
    run_for(kPsPerMs);
    for (unsigned r = 0; r < kRows; ++r)
      for (unsigned i = 0; i < kPitch; ++i) b.memory.at(kBuffer + r * kPitch)[i] = pattern(r, i);
    b.osd_regs.write(MODE, 0);
    b.osd_regs.write(VIDWINMD, 3);
    b.osd_regs.write(VIDWIN0OFST, 0x1000 | kPitch / 32);
    set_address(kBuffer);
    b.osd_regs.write(BASEPX, k625 ? 0x7E : 0x79);
    b.osd_regs.write(BASEPY, k625 ? 0x16 : 0x10);
    b.osd_regs.write(XP, 0);
    b.osd_regs.write(YP, 0);
    b.osd_regs.write(XL, 720);
    b.osd_regs.write(YL, kRows / 2);
    b.frames.clear();
    b.latches.clear();
    b.tap.firsts.clear();
    b.edges.rises.clear();
    b.memory.log.clear();
    violations_ = b.sink.stats.violations.count();
    underflows_ = b.sink.stats.underflows.count();
  }
  void TearDown() override { EXPECT_EQ(b.sink.stats.violations.count(), violations_); }
  void set_address(std::uint32_t a) {
    const std::uint32_t units = (a - 0x8000'0000u) >> 5;
    b.osd_regs.write(VIDWINADH, units >> 16 & 0x7F);
    b.osd_regs.write(VIDWIN0ADL, units & 0xFFFF);
  }
  void show(std::size_t frames) {
    b.venc_regs.write(VMOD, kOn);
    const std::size_t want = b.frames.size() + frames;
    while (b.frames.size() < want) run_for(kPsPerMs);
  }
  unsigned wrong(const Picture& p) {
    unsigned n = 0;
    for (unsigned r = 0; r < kRows; ++r)
      for (unsigned i = 0; i < kPitch; ++i) n += p.row(r)[i] != pattern(r, i);
    return n;
  }
  std::uint64_t underflows() const { return b.sink.stats.underflows.count() - underflows_; }
  std::uint64_t violations_ = 0, underflows_ = 0;
};

TEST_F(DisplayTest, MemoryPictureEqualsWhatTheDisplayReceives) {
  show(2);
  EXPECT_EQ(wrong(b.frames[0].picture), 0u);
  EXPECT_EQ(b.frames[0].address[0], kBuffer);
  EXPECT_EQ(b.frames[0].address[1], kBuffer);
  EXPECT_FALSE(b.frames[0].repeated);
  EXPECT_TRUE(b.frames[1].repeated);
  EXPECT_EQ(underflows(), 0u);
}

TEST_F(DisplayTest, FirstFieldShowsTheUpperRows) {
  show(1);
  ASSERT_GE(b.tap.firsts.size(), 2u);
  EXPECT_EQ(b.tap.firsts[0].number, k625 ? 23u : 20u);
  EXPECT_EQ(b.tap.firsts[0].byte, pattern(0, 0));
  EXPECT_EQ(b.tap.firsts[1].number, k625 ? 336u : 283u);
  EXPECT_EQ(b.tap.firsts[1].byte, pattern(1, 0));
}

TEST_F(DisplayTest, FieldInversionShowsTheLowerRowsFirst) {
  b.osd_regs.write(MODE, 1u << 9);
  show(1);
  EXPECT_EQ(b.tap.firsts[0].byte, pattern(1, 0));
  EXPECT_EQ(b.tap.firsts[1].byte, pattern(0, 0));
}

TEST_F(DisplayTest, WindowFieldInversionShowsTheLowerRowsFirst) {
  b.osd_regs.write(VIDWINMD, 1u << 15 | 3u);
  show(1);
  EXPECT_EQ(b.tap.firsts[0].byte, pattern(1, 0));
  EXPECT_EQ(b.tap.firsts[1].byte, pattern(0, 0));
  b.venc_regs.write(VMOD, 0);
  run_for(kPsPerMs);
  b.tap.firsts.clear();
  b.osd_regs.write(MODE, 1u << 9);  // inverted twice
  show(1);
  EXPECT_EQ(b.tap.firsts[0].byte, pattern(0, 0));
  EXPECT_EQ(b.tap.firsts[1].byte, pattern(1, 0));
}

TEST_F(DisplayTest, WithoutFieldModeBothFieldsShowTheSameRows) {
  b.osd_regs.write(VIDWINMD, 1);
  show(1);
  EXPECT_EQ(b.frames[0].picture.row(2)[0], pattern(1, 0));
  EXPECT_EQ(b.frames[0].picture.row(3)[0], pattern(1, 0));
}

TEST_F(DisplayTest, FrameRateIsExact) {
  const unsigned n = k625 ? 25 : 30;
  show(n + 1);
  const Picoseconds expected = k625 ? kPsPerSecond : 1'001'000'000'000;
  const Picoseconds measured = b.frames[n].start - b.frames[0].start;
  EXPECT_LE(measured > expected ? measured - expected : expected - measured, 1u);
}

TEST_F(DisplayTest, RasterInterruptsAndStatusComeAtTheFieldStarts) {
  const Clock clock(kByteClock);
  const std::uint64_t origin = clock.edge_after(kernel_time());
  show(1);
  // Field 1 of the raster begins with the raster; field 2 where F changes.
  const unsigned lines = k625 ? 312 : 262;
  ASSERT_GE(b.edges.rises.size(), 2u);
  EXPECT_EQ(b.edges.rises[0], clock.edge(origin));
  EXPECT_EQ(b.edges.rises[1], clock.edge(origin + std::uint64_t{lines} * kStd.line_bytes));
  EXPECT_EQ(b.frames[0].start,
            clock.edge(origin + (k625 ? 22u : 16u) * kStd.line_bytes + kStd.active_offset()));
  b.edges.rises.clear();
  while (b.edges.rises.size() < 1) run_for(kPsPerUs);
  EXPECT_EQ(b.venc_regs.read(VSTAT) >> 4 & 1, b.latches.back().f ? 1u : 0u);
}

TEST_F(DisplayTest, NewAddressTakesEffectAtTheNextFieldStart) {
  for (unsigned i = 0; i < kRows * kPitch; ++i) b.memory.at(kOther)[i] = 0x55;
  b.venc_regs.write(VMOD, kOn);
  run_for(kField / 2);  // in the first field's picture
  set_address(kOther);
  while (b.frames.empty()) run_for(kPsPerMs);
  EXPECT_EQ(b.frames[0].address[0], kBuffer);
  EXPECT_EQ(b.frames[0].address[1], kOther);
  EXPECT_EQ(b.frames[0].picture.row(kRows - 2)[7], pattern(kRows - 2, 7));
  EXPECT_EQ(b.frames[0].picture.row(kRows - 1)[7], 0x55);
  ASSERT_GE(b.latches.size(), 2u);
  EXPECT_EQ(b.latches[0].address, kBuffer);
  EXPECT_EQ(b.latches[1].address, kOther);
}

TEST_F(DisplayTest, WithFrameLatchTheWholeFrameKeepsItsAddress) {
  b.params.osd_latch.set("frame");
  b.venc_regs.write(VMOD, kOn);
  run_for(kField / 2);
  set_address(kOther);
  while (b.frames.size() < 2) run_for(kPsPerMs);
  b.params.osd_latch.set("field");
  EXPECT_EQ(b.frames[0].address[1], kBuffer);
  EXPECT_EQ(wrong(b.frames[0].picture), 0u);
  EXPECT_EQ(b.frames[1].address[0], kOther);
}

TEST_F(DisplayTest, WindowOriginMovesThePictureByItsPixelsAndLines) {
  b.osd_regs.write(XP, 40);
  b.osd_regs.write(XL, 640);
  b.osd_regs.write(YP, 8);
  b.osd_regs.write(YL, 100);
  show(1);
  const Picture& p = b.frames[0].picture;
  EXPECT_EQ(p.row(16)[80], pattern(0, 0));
  EXPECT_EQ(p.row(17)[80], pattern(1, 0));
  EXPECT_EQ(p.row(16)[79], 0x10) << "black left of it";
  EXPECT_EQ(p.row(16)[80 + 1279], pattern(0, 1279));
  EXPECT_EQ(p.row(16)[80 + 1280], 0x80);
  EXPECT_EQ(p.row(15)[80], 0x80);
  EXPECT_EQ(p.row(16 + 199)[80], pattern(199, 0));
  EXPECT_EQ(p.row(16 + 200)[80], 0x80);
}

TEST_F(DisplayTest, BasepxOnePairFurtherMovesThePictureByOnePair) {
  b.osd_regs.write(BASEPX, (k625 ? 0x7E : 0x79) + 2);
  show(1);
  EXPECT_EQ(b.frames[0].picture.row(0)[0], 0x80);
  EXPECT_EQ(b.frames[0].picture.row(0)[4], pattern(0, 0));
}

TEST_F(DisplayTest, WindowThatBeginsLeftOfThePictureIsCutThere) {
  b.osd_regs.write(BASEPX, (k625 ? 0x7E : 0x79) - 6);
  show(1);
  const Picture& p = b.frames[0].picture;
  // Six pixels of each row lie left of the first active one; the row ends six pixels early.
  for (unsigned r : {0u, 1u, kRows - 1})
    for (unsigned i = 0; i < kPitch; ++i)
      ASSERT_EQ(p.row(r)[i], i < kPitch - 12 ? pattern(r, i + 12)
                             : i % 2         ? 0x10
                                             : 0x80)
          << "row " << r << " byte " << i;
}

TEST_F(DisplayTest, WrongPitchShears) {
  b.osd_regs.write(VIDWIN0OFST, 0x1000 | (kPitch / 32 - 1));
  show(1);
  for (unsigned r : {1u, 2u, 100u}) {
    const unsigned at = r * (kPitch - 32);
    EXPECT_EQ(b.frames[0].picture.row(r)[0], pattern(at / kPitch, at % kPitch)) << "row " << r;
  }
}

TEST_F(DisplayTest, ChromaSwapExchangesCbAndCr) {
  b.osd_regs.write(MODE, 1u << 15);
  show(1);
  EXPECT_EQ(b.frames[0].picture.row(0)[0], pattern(0, 2));
  EXPECT_EQ(b.frames[0].picture.row(0)[1], pattern(0, 1));
  EXPECT_EQ(b.frames[0].picture.row(0)[2], pattern(0, 0));
}

TEST_F(DisplayTest, WindowOffIsBlackAndReadsNothing) {
  b.osd_regs.write(VIDWINMD, 2);
  show(1);
  EXPECT_TRUE(b.memory.log.empty());
  EXPECT_EQ(b.frames[0].picture, Picture(720, kRows));
  EXPECT_FALSE(b.frames[0].window);
  EXPECT_FALSE(b.frames[0].repeated);
}

TEST_F(DisplayTest, BlankedEncoderIsBlack) {
  b.venc_regs.write(VMOD, kOn | 1u << 3);
  while (b.frames.empty()) run_for(kPsPerMs);
  EXPECT_EQ(b.frames[0].picture, Picture(720, kRows));
}

TEST_F(DisplayTest, EncoderWithoutItsClockShowsNothing) {
  for (const std::uint32_t off : {0x00u, 0x10u}) {  // bit 4 is the digital LCD's
    b.venc_regs.write(CLKCTL, off);
    b.venc_regs.write(VMOD, kOn);
    run_for(3 * kField);
    EXPECT_TRUE(b.edges.rises.empty());
    EXPECT_TRUE(b.frames.empty());
  }
  b.venc_regs.write(CLKCTL, 1);
  run_for(3 * kField);
  EXPECT_FALSE(b.frames.empty());
  b.venc_regs.write(CLKCTL, 0);
  run_for(kPsPerUs);
  const std::size_t rises = b.edges.rises.size(), frames = b.frames.size();
  run_for(3 * kField);
  EXPECT_EQ(b.edges.rises.size(), rises);
  EXPECT_EQ(b.frames.size(), frames);
}

TEST_F(DisplayTest, VpbeClockGatesTheRasterAndTheRegisters) {
  b.venc_regs.write(VMOD, kOn);
  b.vpbe_gate.write(false);
  run_for(3 * kField);
  EXPECT_TRUE(b.frames.empty());
  b.vpbe_gate.write(true);
  run_for(3 * kField);
  EXPECT_FALSE(b.frames.empty());
}

TEST_F(DisplayTest, ClockSelectorLeavesTheStandardRasterAloneByDefault) {
  b.clk_sel.write(true);
  run_for(kPsPerUs);
  show(2);
  EXPECT_EQ(wrong(b.frames[0].picture), 0u);
  const Picoseconds frame = kStd.frame_bytes() * (kPsPerSecond / 1'000'000) / 27;
  EXPECT_NEAR(static_cast<double>(b.frames[1].start - b.frames[0].start),
              static_cast<double>(frame), 1.0);
  b.clk_sel.write(false);
}

TEST_F(DisplayTest, OtherStandardIsTakenWhileTheEncoderRuns) {
  b.venc_regs.write(VMOD, kOn);
  run_for(kField / 2);
  const std::size_t first = b.tap.firsts.size();
  ASSERT_GE(first, 1u);
  b.venc_regs.write(VMOD, kOn ^ 0x40);
  const Clock clock(kByteClock);
  const std::uint64_t origin = clock.edge_after(kernel_time());
  const Standard& other = standard_of(!k625);
  while (b.tap.firsts.size() < first + 2) run_for(kPsPerMs);
  // A new raster begins at once, with the other standard's first field.
  EXPECT_EQ(b.tap.firsts[first].number, other.active_first[0]);
  EXPECT_FALSE(b.tap.firsts[first].f);
  EXPECT_EQ(
      b.tap.firsts[first].start,
      clock.edge(origin + (k625 ? 16u : 22u) * other.line_bytes + other.active_offset()));
  EXPECT_EQ(b.tap.firsts[first + 1].number, other.active_first[1]);
  b.venc_regs.write(VMOD, 0);
  run_for(kPsPerUs);
}

TEST_F(DisplayTest, SettingsWithoutEffectAreWarnedOfByName) {
  Diagnostics& d = Diagnostics::instance();
  d.clear();
  const auto names = [&d] {
    std::vector<std::string> out;
    for (const auto& [what, times] : d.counts())
      out.push_back(what.second.substr(0, what.second.find(' ', 5)));
    d.clear();
    return out;
  };
  using Names = std::vector<std::string>;
  // What Linux writes for these rasters.
  for (const auto& [offset, value] :
       std::initializer_list<std::pair<std::uint32_t, std::uint32_t>>{{CLKCTL, 1},
                                                                      {0x04, 0},
                                                                      {0x0C, 0x20},
                                                                      {0x12C, 1},
                                                                      {0x130, 2},
                                                                      {0xC4, 0},
                                                                      {0x08, 0},
                                                                      {0xE0, 0x100},
                                                                      {0xDC, 0}})
    b.venc_regs.write(offset, value);
  for (const std::uint32_t offset : {0x08u, 0x0Cu, 0x10u, 0xE0u, 0xE4u})
    b.osd_regs.write(offset, 0);
  b.osd_regs.write(0xE8, 0x10);
  EXPECT_EQ(names(), Names{});
  b.venc_regs.write(0x08, 0x100);
  EXPECT_EQ(names(), Names{"VENC VDPRO.CBMD"});
  b.venc_regs.write(0x08, 0x200);
  EXPECT_EQ(names(), Names{}) << "the kind of colour bars, without bars";
  b.venc_regs.write(0xC4, 0xF000);
  b.venc_regs.write(0x12C, 0);
  b.venc_regs.write(0x130, 1);
  EXPECT_EQ(names(), (Names{"VENC DACTST", "VENC OSDCLK0", "VENC OSDCLK1"}));
  b.osd_regs.write(0x08, 1);
  b.osd_regs.write(0x0C, 0x8001);
  b.osd_regs.write(0x10, 1);
  EXPECT_EQ(names(), (Names{"OSD OSDWIN0MD.ACT", "OSD OSDWIN1MD.ACT", "OSD RECTCUR.ACT"}));
  b.osd_regs.write(0xE8, 1u << 14 | 1u << 7);
  EXPECT_EQ(names(), (Names{"OSD MISCCTL.RGBEN", "OSD MISCCTL.S420D"}));
  b.venc_regs.write(VMOD, kOn & ~2u);
  run_for(kPsPerNs);
  EXPECT_EQ(names(), Names{"VENC VMOD.VIE"});
  for (const std::uint32_t offset : {0x08u, 0x0Cu, 0x10u, 0xE8u}) b.osd_regs.write(offset, 0);
  b.venc_regs.write(0x08, 0);
  b.venc_regs.write(0xC4, 0);
  d.clear();
}

TEST_F(DisplayTest, PositionsHaveTheirRegistersWidths) {
  b.osd_regs.write(BASEPX, ~0u);
  b.osd_regs.write(BASEPY, ~0u);
  EXPECT_EQ(b.osd_regs.read(BASEPX), 0x3FFu);
  EXPECT_EQ(b.osd_regs.read(BASEPY), 0x1FFu);
  for (std::uint32_t offset = XP; offset <= 0x94; offset += 4) {
    b.osd_regs.write(offset, ~0u);
    EXPECT_EQ(b.osd_regs.read(offset), 0x7FFu) << offset;
    b.osd_regs.write(offset, 0);
  }
  Diagnostics::instance().clear();
}

TEST_F(DisplayTest, ReadsAreBurstsOf64TheConfiguredLinesAhead) {
  const Clock clock(kByteClock);
  const std::uint64_t origin = clock.edge_after(kernel_time());
  show(1);
  ASSERT_GE(b.memory.log.size(), std::size_t{23} * kRows);
  const Picoseconds ahead =
      clock.edge(origin + ((k625 ? 22u : 16u) - kAhead) * kStd.line_bytes);
  EXPECT_EQ(b.memory.log[0].time, ahead);
  const unsigned kAtOnce = kOutstanding;
  EXPECT_EQ(b.memory.log[kAtOnce - 1].time, ahead);
  EXPECT_EQ(b.memory.log[kAtOnce].time, ahead + b.memory.latency);
  EXPECT_EQ(b.memory.log[0].bytes, 64u);
  EXPECT_EQ(b.memory.log[0].address, kBuffer);
}

TEST_F(DisplayTest, DataDueAtTheirArrivalAreTooLateAndOnePicosecondEarlierAreNot) {
  // 64 bytes a line, read kAhead lines before its own start: due after these and the blanking.
  // Rows of 1440 bytes: the upper field's are one burst of 64, the lower field's two of 32.
  b.osd_regs.write(XL, 32);
  const Clock clock(kByteClock);
  const Picoseconds due = clock.edge(kAhead * kStd.line_bytes + kStd.active_offset());
  b.memory.latency = due - 2;  // edges round down: the interval may be shorter by 1 ps
  show(1);
  EXPECT_EQ(underflows(), 0u);
  EXPECT_EQ(b.frames[0].picture.row(100)[0], pattern(100, 0));
  b.venc_regs.write(VMOD, 0);
  run_for(kPsPerMs);
  b.memory.latency = due + 1;
  show(1);
  EXPECT_EQ(underflows(), kRows) << "the first burst of each line; the second is due later";
  EXPECT_EQ(b.frames[1].picture.row(100)[0], 0x80);
  EXPECT_EQ(b.frames[1].picture.row(101)[31], 0x10);
  EXPECT_EQ(b.frames[1].picture.row(101)[32], pattern(101, 32));
  EXPECT_EQ(b.frames[1].underflows, kRows);
}

TEST_F(DisplayTest, HopelessMemoryGivesBlackAndCountsEveryBurst) {
  b.memory.latency = 5 * kPsPerMs;
  show(1);
  EXPECT_EQ(underflows(), std::uint64_t{23} * kRows);
  EXPECT_EQ(b.frames[0].picture, Picture(720, kRows));
  b.venc_regs.write(VMOD, 0);
  run_for(25 * kPsPerMs);  // late answers come to nobody
}

// Bit 6 of MISCCTL.
TEST_F(DisplayTest, LateDataSetAFlagThatStaysUntilOneIsWritten) {
  constexpr std::uint32_t kMiscctl = 0xE8, kDmang = 1u << 6;
  b.osd_regs.write(kMiscctl, kDmang | 0x10);
  show(2);
  EXPECT_EQ(b.osd_regs.read(kMiscctl), 0x10u) << "none is late";
  b.memory.latency = 5 * kPsPerMs;
  show(1);
  EXPECT_EQ(b.osd_regs.read(kMiscctl), 0x10u | kDmang);
  b.memory.latency = 100 * kPsPerNs;
  run_for(10 * kPsPerMs);
  show(2);
  EXPECT_EQ(b.osd_regs.read(kMiscctl), 0x10u | kDmang) << "it stays";
  b.osd_regs.write(kMiscctl, 0x10);
  EXPECT_EQ(b.osd_regs.read(kMiscctl), 0x10u | kDmang) << "writing 0 does not clear it";
  b.osd_regs.write(kMiscctl, 0x10 | kDmang);
  EXPECT_EQ(b.osd_regs.read(kMiscctl), 0x10u);
  show(1);
  EXPECT_EQ(b.osd_regs.read(kMiscctl), 0x10u);
  // A chip that uses the bit for something else.
  b.params.miscctl_6.set("rgbwin");
  b.memory.latency = 5 * kPsPerMs;
  show(1);
  EXPECT_EQ(b.osd_regs.read(kMiscctl), 0x10u);
  Diagnostics::instance().clear();
  b.osd_regs.write(kMiscctl, kDmang);
  ASSERT_EQ(Diagnostics::instance().counts().size(), 1u);
  EXPECT_EQ(Diagnostics::instance().counts().begin()->first.second, "OSD MISCCTL.RGBWIN");
  Diagnostics::instance().clear();
  b.params.miscctl_6.set("dmang");
  b.osd_regs.write(kMiscctl, kDmang);
  b.venc_regs.write(VMOD, 0);
  run_for(25 * kPsPerMs);
}

TEST_F(DisplayTest, WhatIsLateAlreadyIsNotRead) {
  const Clock clock(kByteClock);
  const std::uint64_t origin = clock.edge_after(kernel_time());
  b.memory.latency = 300 * kPsPerUs;  // almost five lines; places for kOutstanding bursts
  show(1);
  EXPECT_GT(underflows(), 0u);
  const std::uint64_t first[2] = {k625 ? 22u : 16u, k625 ? 335u : 279u};
  std::size_t reads = 0;
  for (const auto& r : b.memory.log) {
    if (r.time >= b.frames[0].end) break;
    ++reads;
    const unsigned row = (r.address - kBuffer) / kPitch, byte = (r.address - kBuffer) % kPitch;
    const Picoseconds due = clock.edge(origin + (first[row % 2] + row / 2) * kStd.line_bytes +
                                       kStd.active_offset() + byte);
    ASSERT_LT(r.time, due) << "row " << row << " byte " << byte;
  }
  EXPECT_GT(reads, 100u);
  b.venc_regs.write(VMOD, 0);
  run_for(kPsPerMs);
}

TEST_F(DisplayTest, WrongClockIsCaughtByTheDisplay) {
  b.clock.write(Frequency(26'538'461));
  b.venc_regs.write(VMOD, kOn);
  run_for(2 * kField);
  EXPECT_GT(b.sink.stats.violations.count(), violations_ + 100);
  b.venc_regs.write(VMOD, 0);
  b.clock.write(kByteClock);
  run_for(kPsPerUs);
  violations_ = b.sink.stats.violations.count();
}

TEST_F(DisplayTest, WithTheHalvingSelectorEachLineLastsTwiceAsLong) {
  b.params.venc_clk_sel.set("halves");
  b.venc_regs.write(VMOD, kOn);
  while (b.edges.rises.size() < 3) run_for(kPsPerMs);
  const Picoseconds whole = b.edges.rises[2] - b.edges.rises[0];
  b.edges.rises.clear();
  b.clk_sel.write(true);
  while (b.edges.rises.size() < 4) run_for(kPsPerMs);
  EXPECT_NEAR(static_cast<double>(b.edges.rises[3] - b.edges.rises[1]),
              2 * static_cast<double>(whole), 2.0);
  b.venc_regs.write(VMOD, 0);
  b.params.venc_clk_sel.set("no_effect");
  b.clk_sel.write(false);
  run_for(kPsPerMs);
  violations_ = b.sink.stats.violations.count();  // the display expects the true rate
}

TEST_F(DisplayTest, ChangedClockMovesTheLineUnderWay) {
  b.venc_regs.write(VMOD, kOn);
  while (b.edges.rises.empty()) run_for(kPsPerUs);
  // In the middle of the line before the second field the clock becomes ten times slower: the rest
  // of that line, which ends with the interrupt, lasts ten times as long.
  const unsigned lines = k625 ? 312 : 262;
  const std::uint64_t half = kStd.line_bytes / 2;
  const Clock clock(kByteClock, b.edges.rises[0]);
  run_until(clock.edge((lines - 1) * kStd.line_bytes + half));
  const Picoseconds change = kernel_time();
  b.edges.rises.clear();
  b.clock.write(Frequency(2'700'000));
  while (b.edges.rises.empty()) run_for(kPsPerUs);
  const Picoseconds slow = kPsPerSecond / 2'700'000;
  EXPECT_NEAR(static_cast<double>(b.edges.rises[0] - change), static_cast<double>(half * slow),
              static_cast<double>(slow));
  b.venc_regs.write(VMOD, 0);
  b.clock.write(kByteClock);
  run_for(kPsPerMs);
  violations_ = b.sink.stats.violations.count();
}

}  // namespace
}  // namespace fovea::video

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  fovea::video::Bench bench;
  fovea::video::bench = &bench;
  return RUN_ALL_TESTS();
}
