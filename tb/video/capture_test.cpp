// ISIF and VPSS top on a small raster: 8 active lines a field, every byte in memory checked.
#include <gtest/gtest.h>

#include <functional>

#include "model/video/isif.h"
#include "model/video/vpss_top.h"
#include "tb/video/bench.h"

namespace fovea::video {
namespace {

constexpr Standard kSmall{"small",
                          24,
                          1728,
                          {{{1, 2, false, true},
                            {3, 10, false, false},
                            {11, 12, false, true},
                            {13, 14, true, true},
                            {15, 22, true, false},
                            {23, 24, true, true}}},
                          {1, 13},
                          {3, 15},
                          {8, 8},
                          16,
                          {1, 14}};
constexpr unsigned kRowBytes = 128, kRows = 16;
constexpr std::uint32_t kBuffer = 0x8001'0000, kOther = 0x8002'0000;
constexpr Picoseconds kLine = 64 * kPsPerUs;  // 1728 / 27 MHz
constexpr Picoseconds kFrame = 24 * kLine;

std::uint8_t pattern(unsigned row, unsigned i) {
  return static_cast<std::uint8_t>(row * 37 + i * 5 + (row * i >> 3));
}

/// Sends the small raster without end; codes may be damaged.
class Wire : public sc_core::sc_module, private Bt656Renderer {
 public:
  sc_core::sc_port<Bt656If> video{"video"};
  Clock clock{kByteClock};
  std::function<std::uint8_t(unsigned line, std::uint8_t xy)> damage;
  SC_HAS_PROCESS(Wire);
  explicit Wire(sc_core::sc_module_name name) : sc_module(name) { SC_METHOD(tick); }
  /// Start of the next line 1 strictly after now.
  Picoseconds next_frame() const {
    return clock.edge((kernel_time() / kFrame + 1) * kSmall.frame_bytes());
  }

 private:
  void tick() {
    line_ = locate(kSmall, n_).line;
    const auto fv = kSmall.at(line_);
    std::uint8_t xy = encode_xy(fv.f, fv.v, true);
    if (damage) xy = damage(line_, xy);
    const std::uint64_t first = n_ * kSmall.line_bytes;
    ++n_;
    next_trigger(ps_time(clock.edge(n_ * kSmall.line_bytes) - kernel_time()));
    video->line({&kSmall, &clock, clock.edge(first), first, locate(kSmall, n_ - 1).field, line_, xy,
                 encode_xy(fv.f, fv.v, false), this});
  }
  std::span<const std::uint8_t> render() override {
    const auto fv = kSmall.at(line_);
    std::array<std::uint8_t, kActiveBytes> active{};
    if (!fv.v) {
      const unsigned row = 2 * (line_ - kSmall.active_first[fv.f]) + fv.f;
      for (unsigned i = 0; i < kActiveBytes; ++i) active[i] = pattern(row, i);
    }
    compose_line(kSmall, encode_xy(fv.f, fv.v, true), encode_xy(fv.f, fv.v, false),
                 fv.v ? nullptr : active.data(), {bytes_.data(), kSmall.line_bytes});
    return {bytes_.data(), kSmall.line_bytes};
  }
  std::uint64_t n_ = 0;
  unsigned line_ = 0;
  std::array<std::uint8_t, kMaxLineBytes> bytes_{};
};

struct Bench {
  VpssParams params;
  sc_core::sc_signal<bool> psc{"psc", true}, no_venc{"no_venc"};
  sc_core::sc_signal<bool> isif_gate{"isif_gate", true}, vpbe_gate{"vpbe_gate"},
      venc_clk_sel{"venc_clk_sel"}, owns_write_buffer{"owns_write_buffer"};
  sc_core::sc_signal<std::uint32_t> read_priority{"read_priority"},
      write_priority{"write_priority"};
  sc_core::sc_vector<sc_core::sc_signal<bool>> event{"event", 3}, vpssint{"vpssint", 9};
  Wire wire{"wire"};
  Isif isif{"isif", params};
  VpssTop top{"top"};
  FakeMemory memory{"memory"};
  RegisterPort regs{"regs"}, top_regs{"top_regs"};
  sc_core::sc_vector<EdgeLog> edges{"edges", 9};
  std::vector<CaptureFrame> started, ended;

  Bench() {
    wire.video.bind(isif.video);
    isif.memory.socket.bind(memory.socket);
    regs.socket.bind(isif.reg_socket);
    top_regs.socket.bind(top.reg_socket);
    isif.psc_enabled(psc);
    isif.gate(isif_gate);
    isif.owns_write_buffer(owns_write_buffer);
    top.psc_enabled(psc);
    for (unsigned i = 0; i < 3; ++i) {
      isif.vdint[i].out(event[i]);
      top.isif_int[i](event[i]);
    }
    top.venc_int(no_venc);
    for (unsigned i = 0; i < 9; ++i) {
      top.vpssint[i](vpssint[i]);
      edges[i].in(vpssint[i]);
    }
    top.isif_gate(isif_gate);
    top.vpbe_gate(vpbe_gate);
    top.venc_clk_sel(venc_clk_sel);
    top.isif_owns_write_buffer(owns_write_buffer);
    top.read_priority(read_priority);
    top.write_priority(write_priority);
    isif.on_frame_start = [this](const CaptureFrame& f) { started.push_back(f); };
    isif.on_frame_end = [this](const CaptureFrame& f) { ended.push_back(f); };
  }
};
Bench* bench = nullptr;

enum : std::uint32_t {
  SYNCEN = 0x00,
  MODESET = 0x04,
  SPH = 0x18,
  LNH = 0x1C,
  SLV0 = 0x20,
  SLV1 = 0x24,
  LNV = 0x28,
  HSIZE = 0x34,
  SDOFST = 0x38,
  CADU = 0x3C,
  CADL = 0x40,
  VDINT0 = 0x70,
  VDINT1 = 0x74,
  VDINT2 = 0x78,
  REC656IF = 0x84,
  CCDCFG = 0x88
};
constexpr std::uint32_t kUyvy = 0x812;  // Linux: 8-bit packing, YCINSWP, Y8POS

class CaptureTest : public testing::Test {
 protected:
  Bench& b = *bench;
  /// The Linux recipe for a woven frame of kRows rows of kRowBytes bytes.
  void SetUp() override {
    b.regs.write(SYNCEN, 0);
    b.top_regs.write(0x04, 0x7F);
    b.top_regs.write(0x08, 2);
    b.wire.damage = nullptr;
    b.memory.latency = 100 * kPsPerNs;
    run_for(kFrame);  // earlier writes come to rest
    b.regs.write(REC656IF, 3);
    b.regs.write(MODESET, 2u << 12 | 1u << 7 | 1u << 2);
    b.regs.write(CCDCFG, kUyvy);
    b.regs.write(SPH, 0);
    b.regs.write(LNH, kRowBytes - 1);
    b.regs.write(SLV0, 1);
    b.regs.write(SLV1, 1);
    b.regs.write(LNV, kRows / 2 - 1);
    b.regs.write(HSIZE, kRowBytes / 32);
    b.regs.write(SDOFST, 0x249);
    b.regs.write(VDINT0, 0x7FFF);
    b.regs.write(VDINT1, 0x7FFF);
    b.regs.write(VDINT2, 0x7FFF);
    set_address(kBuffer);
    run_until(b.wire.next_frame() - kPsPerUs);
    std::fill(b.memory.bytes.begin(), b.memory.bytes.end(), 0xEE);
    b.memory.log.clear();
    b.started.clear();
    b.ended.clear();
    for (auto& e : b.edges) e.rises.clear();
    frame_start_ = b.wire.next_frame();
  }
  void set_address(std::uint32_t a) {
    b.regs.write(CADU, a >> 21);
    b.regs.write(CADL, a >> 5 & 0xFFFF);
  }
  void enable() {
    b.regs.write(SYNCEN, 1);
    b.regs.write(SYNCEN, 3);
  }
  void capture_frame() {
    enable();
    run_until(frame_start_ + kFrame - kPsPerUs);
  }
  /// Time of line n (1 ... 24) of the frame under test.
  Picoseconds line_time(unsigned n) const { return frame_start_ + (n - 1) * kLine; }
  unsigned wrong_bytes(std::uint32_t at, unsigned pitch = kRowBytes) {
    unsigned wrong = 0;
    for (unsigned r = 0; r < kRows; ++r)
      for (unsigned i = 0; i < kRowBytes; ++i)
        wrong += b.memory.at(at + r * pitch)[i] != pattern(r, i);
    return wrong;
  }
  Picoseconds frame_start_ = 0;
};

TEST_F(CaptureTest, WeavesBothFieldsByteExact) {
  const std::uint64_t overflows = b.isif.stats.overflows.count();
  capture_frame();
  EXPECT_EQ(wrong_bytes(kBuffer), 0u);
  EXPECT_EQ(b.memory.at(kBuffer)[-1], 0xEE);
  EXPECT_EQ(b.memory.at(kBuffer)[kRows * kRowBytes], 0xEE);
  EXPECT_EQ(b.memory.log.size(), kRows * kRowBytes / 64);
  EXPECT_EQ(b.isif.stats.overflows.count(), overflows);
}

TEST_F(CaptureTest, BurstLeavesWhenItsLastByteHasArrived) {
  capture_frame();
  const Clock clock(kByteClock);
  const std::uint64_t line3 = clock.edge_at_or_after(line_time(3));
  ASSERT_FALSE(b.memory.log.empty());
  EXPECT_EQ(b.memory.log[0].time, clock.edge(line3 + 288 + 64));
  EXPECT_EQ(b.memory.log[1].time, clock.edge(line3 + 288 + 128));
  EXPECT_EQ(b.memory.log[0].address, kBuffer);
}

TEST_F(CaptureTest, RowAt32BytesIsSplitAtMultiplesOf64) {
  set_address(kBuffer + 32);
  capture_frame();
  EXPECT_EQ(wrong_bytes(kBuffer + 32), 0u);
  ASSERT_GE(b.memory.log.size(), 3u);
  EXPECT_EQ(b.memory.log[0].bytes, 32u);
  EXPECT_EQ(b.memory.log[1].bytes, 64u);
  EXPECT_EQ(b.memory.log[2].bytes, 32u);
}

TEST_F(CaptureTest, WrongPitchShearsThePictureByTheDifference) {
  b.regs.write(HSIZE, kRowBytes / 32 + 1);
  capture_frame();
  EXPECT_EQ(wrong_bytes(kBuffer, kRowBytes + 32), 0u);
  // Seen with the intended pitch, row r holds what lies 128 r bytes on: rows of 160 bytes.
  unsigned moved = 0;
  for (unsigned r = 0; r < kRows; ++r)
    for (unsigned i = 0; i < kRowBytes; ++i) {
      const unsigned at = r * kRowBytes + i, row = at / 160, x = at % 160;
      const std::uint8_t expected = x < kRowBytes ? pattern(row, x) : 0xEE;
      ASSERT_EQ(b.memory.at(kBuffer)[at], expected) << "row " << r << " byte " << i;
      moved += expected != pattern(r, i);
    }
  EXPECT_GT(moved, kRows * kRowBytes / 2);
}

TEST_F(CaptureTest, FieldInversionSwapsTheRowsOfTheFields) {
  b.regs.write(SDOFST, 0x249 | 1u << 14);
  capture_frame();
  for (unsigned r = 0; r < kRows; ++r)
    EXPECT_EQ(b.memory.at(kBuffer + r * kRowBytes)[9], pattern(r ^ 1, 9)) << "row " << r;
}

TEST_F(CaptureTest, LineOffsetsOfOneRowStackAFieldsLines) {
  // LOFTS0 = LOFTS1 = 0, one row: field 0's lines follow each other.
  b.regs.write(SDOFST, 0x009);
  b.regs.write(SLV1, 100);  // keep field 1 out
  capture_frame();
  for (unsigned r = 0; r < kRows / 2; ++r)
    EXPECT_EQ(b.memory.at(kBuffer + r * kRowBytes)[9], pattern(2 * r, 9)) << "row " << r;
}

TEST_F(CaptureTest, WindowStartsAtSphAndSlv) {
  b.regs.write(SPH, 8);
  b.regs.write(SLV0, 3);
  b.regs.write(SLV1, 3);
  b.regs.write(LNV, 1);
  capture_frame();
  for (unsigned r = 0; r < 4; ++r)
    EXPECT_EQ(b.memory.at(kBuffer + r * kRowBytes)[0], pattern(r + 4, 8)) << "row " << r;
  EXPECT_EQ(b.memory.at(kBuffer + 4 * kRowBytes)[0], 0xEE);
}

TEST_F(CaptureTest, EachSwapBitTogglesTheByteOrder) {
  enable();
  for (const std::uint32_t bit : {0x4u, 0x10u, 0x800u, 0x1000u}) {
    b.regs.write(CCDCFG, kUyvy ^ bit);
    run_until(b.wire.next_frame() + kFrame - kPsPerUs);
    EXPECT_EQ(b.memory.at(kBuffer)[0], pattern(0, 1)) << "bit " << bit;
    EXPECT_EQ(b.memory.at(kBuffer)[1], pattern(0, 0)) << "bit " << bit;
  }
}

TEST_F(CaptureTest, EitherMsbBitInvertsTheTopBitOfChromaAndBothLeaveIt) {
  enable();
  const auto check = [&](std::uint32_t ccdcfg, unsigned order, std::uint8_t change) {
    b.regs.write(CCDCFG, ccdcfg);
    run_until(b.wire.next_frame() + kFrame - kPsPerUs);
    for (unsigned r = 0; r < kRows; ++r)
      for (unsigned i = 0; i < kRowBytes; ++i) {
        const unsigned from = i ^ order;  // byte of the wire; chroma is on the even ones
        ASSERT_EQ(b.memory.at(kBuffer + r * kRowBytes)[i],
                  pattern(r, from) ^ (from % 2 == 0 ? change : 0))
            << std::hex << ccdcfg << std::dec << " row " << r << " byte " << i;
      }
  };
  check(kUyvy | 0x2000, 0, 0x80);
  check(kUyvy | 0x4000, 0, 0x80);
  check(kUyvy | 0x6000, 0, 0);
  check((kUyvy | 0x2000) ^ 0x800, 1, 0x80);  // Y first in memory
}

TEST_F(CaptureTest, InvertedFieldIdSwapsTheFields) {
  b.regs.write(MODESET, 2u << 12 | 1u << 7 | 1u << 4 | 1u << 2);
  enable();
  run_until(line_time(3) + kPsPerUs);
  EXPECT_EQ(b.regs.read(MODESET) >> 15, 1u);
  run_until(line_time(15) + kPsPerUs);
  EXPECT_EQ(b.regs.read(MODESET) >> 15, 0u);
  run_until(frame_start_ + 2 * kFrame - kPsPerUs);
  for (unsigned r = 0; r < kRows; ++r)
    EXPECT_EQ(b.memory.at(kBuffer + r * kRowBytes)[9], pattern(r ^ 1, 9)) << "row " << r;
  // The frame that counts begins with the wire's second field.
  ASSERT_EQ(b.ended.size(), 2u);
  EXPECT_FALSE(b.ended[0].complete);
  EXPECT_TRUE(b.ended[1].complete);
}

TEST_F(CaptureTest, WholeLineIsAWindowAndOneSampleMoreIsCut) {
  Diagnostics& d = Diagnostics::instance();
  d.clear();
  b.regs.write(HSIZE, kActiveBytes / 32);
  b.regs.write(LNH, kActiveBytes - 1);
  capture_frame();
  EXPECT_TRUE(d.counts().empty());
  for (unsigned i = 0; i < kActiveBytes; ++i)
    ASSERT_EQ(b.memory.at(kBuffer + kActiveBytes)[i], pattern(1, i)) << i;
  // Two samples further the last two do not exist; whole pairs of four samples are captured.
  std::fill(b.memory.bytes.begin(), b.memory.bytes.end(), 0xEE);
  b.regs.write(SPH, 2);
  run_until(frame_start_ + 2 * kFrame - kPsPerUs);
  ASSERT_EQ(d.counts().size(), 1u);
  EXPECT_EQ(d.counts().begin()->first.second,
            "ISIF window leaves the active part of the line; cut");
  EXPECT_EQ(b.memory.at(kBuffer)[kActiveBytes - 5], pattern(0, kActiveBytes - 3));
  EXPECT_EQ(b.memory.at(kBuffer)[kActiveBytes - 4], 0xEE);
  d.clear();
}

TEST_F(CaptureTest, CaptureSwitchedOffInTheLastRowEndsNoFrame) {
  // In a memory that takes the row at once, and in one that never gives it a place.
  for (const Picoseconds latency : {100 * kPsPerNs, 10 * kLine}) {
    SetUp();
    b.memory.latency = latency;
    const std::uint64_t frames = b.isif.stats.frames.count();
    const std::uint64_t fields = b.isif.stats.fields.count();
    enable();
    run_until(line_time(22) + kPsPerUs);
    b.regs.write(SYNCEN, 0);
    run_for(2 * kFrame);
    EXPECT_TRUE(b.ended.empty());
    EXPECT_EQ(b.isif.stats.frames.count(), frames);
    EXPECT_EQ(b.isif.stats.fields.count(), fields + 1) << "the first field";
    EXPECT_EQ(b.memory.at(kBuffer + (kRows - 1) * kRowBytes)[0],
              latency < kLine ? pattern(kRows - 1, 0) : 0xEE)
        << "a row under way is still written";
  }
}

TEST_F(CaptureTest, CaptureSwitchedOffBehindTheLastRowEndsTheFrame) {
  enable();
  run_until(line_time(23) + kPsPerUs);
  b.regs.write(SYNCEN, 0);
  run_for(kFrame);
  ASSERT_EQ(b.ended.size(), 1u);
  EXPECT_TRUE(b.ended[0].complete);
}

TEST_F(CaptureTest, FramesCountTheBurstsThatTheyLost) {
  const std::uint64_t before = b.isif.stats.overflows.count();
  b.memory.latency = 10 * kLine;  // in each field two rows find places, six find none
  enable();
  run_until(frame_start_ + kFrame - kPsPerUs);
  b.memory.latency = 100 * kPsPerNs;
  run_until(frame_start_ + 2 * kFrame - kPsPerUs);
  ASSERT_EQ(b.ended.size(), 2u);
  EXPECT_EQ(b.ended[0].overflows, 2u * 2 * (8 - 2));
  EXPECT_EQ(b.ended[1].overflows, 0u);
  EXPECT_EQ(b.isif.stats.overflows.count() - before, 2u * 2 * (8 - 2));
}

TEST_F(CaptureTest, GatedIsifWritesNothingAndGivesNoInterrupt) {
  b.top_regs.write(0x10, 0x1F1F1F00);
  b.regs.write(VDINT0, 0);
  enable();
  b.top_regs.write(0x04, 0x7F & ~2u);
  run_until(frame_start_ + 2 * kFrame);
  EXPECT_TRUE(b.memory.log.empty());
  EXPECT_TRUE(b.started.empty());
  EXPECT_TRUE(b.edges[0].rises.empty());
  b.regs.write(SPH, 5);  // lost
  b.top_regs.write(0x04, 0x7F);
  run_for(kPsPerUs);
  EXPECT_EQ(b.regs.read(SPH), 0u);
  run_for(3 * kFrame);
  EXPECT_FALSE(b.memory.log.empty());
}

TEST_F(CaptureTest, PscOffStopsCaptureToo) {
  enable();
  b.psc.write(false);
  run_until(frame_start_ + kFrame);
  EXPECT_TRUE(b.memory.log.empty());
  b.psc.write(true);
  run_for(kPsPerUs);
}

TEST_F(CaptureTest, WithoutTheWriteBufferNothingReachesMemory) {
  b.top_regs.write(0x10, 0x1F1F1F00);
  b.regs.write(VDINT0, 0);
  b.top_regs.write(0x08, 0);
  enable();
  run_until(frame_start_ + kFrame);
  EXPECT_TRUE(b.memory.log.empty());
  EXPECT_TRUE(b.started.empty());
  EXPECT_EQ(b.edges[0].rises.size(), 2u) << "interrupts go on";
  b.top_regs.write(0x08, 2);
  run_until(frame_start_ + 2 * kFrame - kPsPerUs);
  EXPECT_EQ(wrong_bytes(kBuffer), 0u);
  ASSERT_EQ(b.ended.size(), 1u);
  EXPECT_TRUE(b.ended[0].complete);
}

TEST_F(CaptureTest, WithoutWriteEnableOnlyInterruptsCome) {
  b.top_regs.write(0x10, 0x1F1F1F00);
  b.regs.write(VDINT0, 0);
  b.regs.write(SYNCEN, 1);
  run_until(frame_start_ + kFrame);
  EXPECT_TRUE(b.memory.log.empty());
  EXPECT_EQ(b.edges[0].rises.size(), 2u);
}

TEST_F(CaptureTest, VdintFiresAtTheStartOfItsLineOncePerField) {
  b.top_regs.write(0x10, 0x1F020100);  // VPSSINT0..2 = ISIF_INT0..2
  b.regs.write(VDINT0, 0);
  b.regs.write(VDINT1, 5);
  b.regs.write(VDINT2, 9);  // the line behind the last captured one
  capture_frame();
  // Line 1 of a field is the raster's line 3 and line 15.
  EXPECT_EQ(b.edges[0].rises, (std::vector<Picoseconds>{line_time(3), line_time(15)}));
  EXPECT_EQ(b.edges[1].rises, (std::vector<Picoseconds>{line_time(7), line_time(19)}));
  EXPECT_EQ(b.edges[2].rises, (std::vector<Picoseconds>{line_time(11), line_time(23)}));
  EXPECT_EQ(b.top_regs.read(0x0C) & 7, 7u);
  b.top_regs.write(0x0C, 2);
  EXPECT_EQ(b.top_regs.read(0x0C) & 7, 5u);
  b.top_regs.write(0x0C, 7);
}

TEST_F(CaptureTest, VdintOneLineLaterFiresOneLineLater) {
  b.top_regs.write(0x10, 0x1F1F1F01);
  b.regs.write(VDINT1, 6);
  capture_frame();
  EXPECT_EQ(b.edges[0].rises, (std::vector<Picoseconds>{line_time(8), line_time(20)}));
}

TEST_F(CaptureTest, FieldStatusFollowsTheFieldFromItsVd) {
  enable();
  run_until(line_time(3) + kPsPerUs);
  EXPECT_EQ(b.regs.read(MODESET) >> 15, 0u);
  run_until(line_time(15) - kPsPerUs);
  EXPECT_EQ(b.regs.read(MODESET) >> 15, 0u);
  run_until(line_time(15) + kPsPerUs);
  EXPECT_EQ(b.regs.read(MODESET) >> 15, 1u);
}

TEST_F(CaptureTest, NewAddressTakesEffectAtTheNextVd) {
  enable();
  run_until(line_time(5));
  set_address(kOther);
  run_until(line_time(24));
  // Field 0 stays in the first buffer, field 1 goes to the other.
  for (unsigned r = 0; r < kRows; ++r) {
    const std::uint32_t at = (r % 2 ? kOther : kBuffer) + r * kRowBytes;
    EXPECT_EQ(b.memory.at(at)[0], pattern(r, 0)) << "row " << r;
    EXPECT_EQ(b.memory.at((r % 2 ? kBuffer : kOther) + r * kRowBytes)[0], 0xEE) << "row " << r;
  }
}

TEST_F(CaptureTest, WithVdlcANewAddressTakesEffectAtTheNextLine) {
  b.regs.write(CCDCFG, kUyvy | 0x8000);
  enable();
  run_until(line_time(5) + kPsPerUs);
  set_address(kOther);
  run_until(line_time(11));
  EXPECT_EQ(b.memory.at(kBuffer + 4 * kRowBytes)[0], pattern(4, 0));
  EXPECT_EQ(b.memory.at(kOther + 6 * kRowBytes)[0], pattern(6, 0));
  EXPECT_EQ(b.memory.at(kBuffer + 6 * kRowBytes)[0], 0xEE);
}

TEST_F(CaptureTest, StalledMemoryOverflowsAndLosesExactlyTheBurstsWithoutAPlace) {
  // Two bursts a line, 64 us apart in pairs; answers after 10 lines: 4 places hold two lines, all
  // later lines of the field lose theirs.
  const std::uint64_t before = b.isif.stats.overflows.count();
  b.memory.latency = 10 * kLine;
  b.top_regs.write(0x10, 0x1F1F1F00);
  b.regs.write(VDINT0, 9);
  enable();
  run_until(line_time(12));
  EXPECT_EQ(b.isif.stats.overflows.count() - before, 2u * (8 - 2));
  EXPECT_TRUE(b.isif.overflowed());
  EXPECT_EQ(b.edges[0].rises.size(), 1u) << "interrupts go on";
  EXPECT_EQ(b.memory.at(kBuffer)[0], pattern(0, 0));
  EXPECT_EQ(b.memory.at(kBuffer + 4 * kRowBytes)[0], 0xEE);
}

TEST_F(CaptureTest, SmallerWriteBufferLosesMore) {
  const std::uint64_t before = b.isif.stats.overflows.count();
  b.params.write_buffer_bursts.set("2");
  b.memory.latency = 10 * kLine;
  enable();
  run_until(line_time(12));
  b.params.write_buffer_bursts.set("4");
  EXPECT_EQ(b.isif.stats.overflows.count() - before, 2u * (8 - 1));
}

TEST_F(CaptureTest, SmallerBurstParameterGivesSmallerBursts) {
  b.params.burst.set("32B");
  capture_frame();
  b.params.burst.set("64B");
  EXPECT_EQ(wrong_bytes(kBuffer), 0u);
  EXPECT_EQ(b.memory.log.size(), kRows * kRowBytes / 32);
}

TEST_F(CaptureTest, PlaceFreedAtABurstsTimeServesOnlyLaterBursts) {
  // With one line of 5 bursts and four places, the fifth burst (4 x 64 samples after the first)
  // finds a place if the first was acknowledged before, and none if at that very time.
  const Clock clock(kByteClock);
  b.regs.write(LNH, 5 * 64 - 1);
  b.regs.write(HSIZE, 10);
  b.regs.write(LNV, 0);
  b.regs.write(SLV1, 100);
  const std::uint64_t s = clock.edge_at_or_after(line_time(3)) + 288;
  const Picoseconds first = clock.edge(s + 64), fifth = clock.edge(s + 320);
  const std::uint64_t before = b.isif.stats.overflows.count();
  b.memory.latency = fifth - first - 1;
  capture_frame();
  EXPECT_EQ(b.isif.stats.overflows.count() - before, 0u);
  const std::uint64_t s2 = s + kSmall.frame_bytes();
  b.memory.latency = clock.edge(s2 + 320) - clock.edge(s2 + 64);
  run_for(kFrame);
  EXPECT_EQ(b.isif.stats.overflows.count() - before, 1u);
}

TEST_F(CaptureTest, SingleBitErrorsInTheCodesAreCorrected) {
  const std::uint64_t before = b.isif.stats.corrected_codes.count();
  b.wire.damage = [](unsigned line, std::uint8_t xy) {
    return static_cast<std::uint8_t>(xy ^ 1u << line % 8);
  };
  capture_frame();
  EXPECT_EQ(wrong_bytes(kBuffer), 0u);
  EXPECT_GE(b.isif.stats.corrected_codes.count() - before, 23u);
}

TEST_F(CaptureTest, WithoutCorrectionTheSameErrorsSpoilTheCapture) {
  b.regs.write(REC656IF, 1);
  b.wire.damage = [](unsigned line, std::uint8_t xy) {
    return static_cast<std::uint8_t>(line == 6 ? xy ^ 0x20 : xy);  // V set for one line
  };
  capture_frame();
  EXPECT_GT(wrong_bytes(kBuffer), 0u);
}

TEST_F(CaptureTest, ObserverSeesFramesWithIndexTimesAndAddress) {
  const Clock clock(kByteClock);
  enable();
  run_until(frame_start_ + 2 * kFrame - kPsPerUs);
  ASSERT_EQ(b.started.size(), 2u);
  ASSERT_EQ(b.ended.size(), 2u);
  EXPECT_EQ(b.ended[0].index, 0u);
  EXPECT_EQ(b.ended[1].index, 1u);
  EXPECT_TRUE(b.ended[0].complete);
  EXPECT_EQ(b.ended[0].address[0], kBuffer);
  EXPECT_EQ(b.ended[0].source_field[1], b.ended[0].source_field[0] + 1);
  const std::uint64_t line3 = clock.edge_at_or_after(line_time(3));
  const std::uint64_t line22 = clock.edge_at_or_after(line_time(22));
  EXPECT_EQ(b.started[0].start, clock.edge(line3 + 288));
  EXPECT_EQ(b.ended[0].end, clock.edge(line22 + 288 + kRowBytes) + b.memory.latency);
}

TEST_F(CaptureTest, StartInTheFirstFieldGivesHalfAFrameFirst) {
  b.regs.write(SYNCEN, 0);
  run_until(line_time(5));
  enable();
  run_until(frame_start_ + 2 * kFrame - kPsPerUs);
  ASSERT_EQ(b.ended.size(), 2u);
  EXPECT_FALSE(b.ended[0].complete);
  EXPECT_TRUE(b.ended[1].complete);
  EXPECT_EQ(b.ended[1].index, 0u) << "only complete frames count";
}

TEST_F(CaptureTest, FieldsOfDifferentFramesAreNoFrame) {
  enable();
  run_until(line_time(11));
  b.regs.write(SYNCEN, 1);  // the first field only
  run_until(frame_start_ + kFrame + 11 * kLine);
  b.regs.write(SYNCEN, 3);  // from the second field of the next frame on
  run_until(frame_start_ + 2 * kFrame - kPsPerUs);
  ASSERT_EQ(b.ended.size(), 1u);
  EXPECT_FALSE(b.ended[0].complete);
}

TEST_F(CaptureTest, SettingsWithoutEffectAreWarnedOfByName) {
  Diagnostics& d = Diagnostics::instance();
  d.clear();
  const auto names = [&d] {
    std::vector<std::string> out;
    for (const auto& [what, times] : d.counts()) {
      EXPECT_EQ(what.first, Diagnostics::Kind::kNotModelled);
      out.push_back(what.second);
    }
    return out;
  };
  b.regs.write(MODESET, 2u << 12 | 1u << 7 | 1u << 2);
  b.regs.write(CCDCFG, kUyvy);
  EXPECT_EQ(names(), std::vector<std::string>{}) << "the settings of the public drivers";
  b.regs.write(MODESET, 1u << 14 | 2u << 12 | 1u << 7 | 1u << 2);
  b.regs.write(MODESET, 1u << 14 | 2u << 12 | 1u << 7 | 1u << 2);
  EXPECT_EQ(names(),
            std::vector<std::string>{"ISIF MODESET.HLPF (low-pass filter): only 0 is modelled"});
  b.isif.regs.modeset.set(1u << 5 | 1u << 6);
  EXPECT_EQ(names().size(), 1u) << "no write, no warning";
  b.regs.write(CCDCFG, kUyvy | 1u << 6 | 1u << 8 | 1u << 9 | 1u << 10);
  EXPECT_EQ(names(),
            (std::vector<std::string>{
                "ISIF CCDCFG.EXTRG (external trigger): only 0 is modelled",
                "ISIF CCDCFG.FIDMD (field id: 0 latched at VD): only 0 is modelled",
                "ISIF CCDCFG.TRGSEL (trigger source): only 0 is modelled",
                "ISIF CCDCFG.WENLOG (logic of the external write enable): only 0 is modelled",
                "ISIF MODESET.HLPF (low-pass filter): only 0 is modelled"}));
  d.clear();
}

TEST_F(CaptureTest, PrioritiesAndGatesLeaveAsWritten) {
  b.top_regs.write(0x08, 5u << 2 | 3u << 5 | 2u);
  b.top_regs.write(0x200, 0x1D);
  run_for(kPsPerNs);
  EXPECT_EQ(b.read_priority.read(), 5u);
  EXPECT_EQ(b.write_priority.read(), 3u);
  EXPECT_TRUE(b.vpbe_gate.read());
  EXPECT_TRUE(b.venc_clk_sel.read());
  b.top_regs.write(0x200, 0x18);
  run_for(kPsPerNs);
  EXPECT_FALSE(b.vpbe_gate.read());
  EXPECT_FALSE(b.venc_clk_sel.read());
}

TEST_F(CaptureTest, OutOfResetAllInterruptsFollowTheFirst) {
  b.top.regs.reset();
  EXPECT_EQ(b.top_regs.read(0x00), 0x4C180800u);
  EXPECT_EQ(b.top_regs.read(0x04), 0x7Fu);
  EXPECT_EQ(b.top_regs.read(0x08), 2u);
  for (const std::uint32_t offset : {0x10u, 0x14u, 0x18u, 0x1Cu})
    EXPECT_EQ(b.top_regs.read(offset), 0u) << offset;
  EXPECT_EQ(b.top_regs.read(0x200), 0x19u);
  b.regs.write(VDINT0, 5);
  capture_frame();
  for (unsigned i = 0; i < 9; ++i)
    EXPECT_EQ(b.edges[i].rises, (std::vector<Picoseconds>{line_time(7), line_time(19)})) << i;
}

TEST_F(CaptureTest, ClockRegistersKeepTheirSelectors) {
  b.top_regs.write(0x04, 0xFF);
  EXPECT_EQ(b.top_regs.read(0x04), 0xFFu);
  b.top_regs.write(0x200, 0xFF);
  EXPECT_EQ(b.top_regs.read(0x200), 0xDFu);
  b.top_regs.write(0x200, 0x19);
}

}  // namespace
}  // namespace fovea::video

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  fovea::video::Bench bench;
  fovea::video::bench = &bench;
  return RUN_ALL_TESTS();
}
