// What controls the ISIF: enables, gates, interrupts, double-buffered registers, frames and their ends.
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tb/video/capture_bench.h"

namespace fovea::video {
namespace {

/// Settings that would change the picture and do nothing here are named when capture is switched on, and only then.
TEST_F(CaptureTest, SettingsThatAreNotModelledAreNamed) {
  constexpr std::uint32_t CULH = 0x2C, CULV = 0x30;
  struct Setting {
    std::uint32_t offset, word, usual;
    const char* text;
  };
  auto& notes = b.diagnostics;
  for (const Setting& s : {Setting{REC656IF, 0, 3, "ISIF without BT.656 embedded syncs"},
                           Setting{MODESET, 1u << 12 | 1u << 7 | 1u << 2, 2u << 12 | 1u << 7 | 1u << 2,
                                   "ISIF input other than 8-bit YC"},
                           Setting{CCDCFG, kUyvy & ~2u, kUyvy, "ISIF packing other than 8 bit"},
                           Setting{CULH, 0xFF7F, 0xFFFF, "ISIF culling"}, Setting{CULV, 0x7F, 0xFF, "ISIF culling"},
                           Setting{HSIZE, 1u << 12 | kRowBytes / 32, kRowBytes / 32, "ISIF addresses going down"},
                           Setting{MODESET, 2u << 12 | 1u << 7 | 1u << 2 | 1, 2u << 12 | 1u << 7 | 1u << 2,
                                   "ISIF as HD/VD master"}}) {
    b.regs.write(s.offset, s.word);
    notes.clear();
    b.regs.write(SYNCEN, 1);
    const auto counts = notes.counts();
    ASSERT_EQ(counts.size(), 1u) << s.text;
    EXPECT_EQ(counts.begin()->first.first, Diagnostics::Kind::kNotModelled);
    EXPECT_EQ(counts.begin()->first.second, s.text);
    b.regs.write(SYNCEN, 0);
    b.regs.write(s.offset, s.usual);
    notes.clear();
    b.regs.write(SYNCEN, 1);
    EXPECT_TRUE(notes.counts().empty()) << s.text;
    b.regs.write(SYNCEN, 0);
  }
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

// An output follows the source that is selected, not only the source's next change.
TEST_F(CaptureTest, AnotherSourceIsSeenAtOnce) {
  constexpr std::uint32_t kVenc = 21, kNone = 0x1F;
  b.no_venc.write(true);
  b.top_regs.write(0x10, kNone << 24 | 0x1F1F1F);
  run_for(kPsPerNs);
  EXPECT_FALSE(b.vpssint[3].read());
  b.top_regs.write(0x10, kVenc << 24 | 0x1F1F1F);
  run_for(kPsPerNs);
  EXPECT_TRUE(b.vpssint[3].read());
  b.top_regs.write(0x10, kNone << 24 | 0x1F1F1F);
  b.top_regs.write(0x18, kVenc);
  run_for(kPsPerNs);
  EXPECT_FALSE(b.vpssint[3].read());
  EXPECT_TRUE(b.vpssint[8].read());
  b.no_venc.write(false);
  run_for(kPsPerNs);
  EXPECT_FALSE(b.vpssint[8].read());
  b.top_regs.write(0x18, kNone);
}

/// Rising edges of VPSS_EVT1 to 4 while it exists.
struct VpssEvents {
  explicit VpssEvents(CaptureBench& bench) : bench_(bench) {
    bench_.top.on_event = [this](unsigned n) {
      if (n >= 1 && n <= 4) rises[n - 1].push_back(kernel_time());
    };
  }
  ~VpssEvents() {
    bench_.top.on_event = nullptr;
    bench_.top_regs.write(0x1C, 0);
  }
  std::array<std::vector<Picoseconds>, 4> rises;

 private:
  CaptureBench& bench_;
};

TEST_F(CaptureTest, EdmaEventsFollowTheSourceThatEvtselNames) {
  constexpr std::uint32_t kVenc = 21, kNone = 0x1F;
  VpssEvents events(b);
  b.top_regs.write(0x1C, 0 << 24 | kVenc << 16 | kNone << 8 | 1);
  b.regs.write(VDINT0, 0);
  b.regs.write(VDINT1, 5);
  capture_frame();
  const std::vector<Picoseconds> first{line_time(3), line_time(15)}, second{line_time(7), line_time(19)};
  EXPECT_EQ(events.rises[0], second);
  EXPECT_TRUE(events.rises[1].empty());
  EXPECT_TRUE(events.rises[2].empty());
  EXPECT_EQ(events.rises[3], first);
  b.no_venc.write(true);
  run_for(kPsPerNs);
  EXPECT_EQ(events.rises[2].size(), 1u);
  EXPECT_EQ(events.rises[0].size(), 2u);
  b.top_regs.write(0x1C, 0x1F1F1F00 | kVenc);  // VPSS_EVT1's source is high by now
  run_for(kPsPerNs);
  EXPECT_EQ(events.rises[0].size(), 3u);
  b.top_regs.write(0x1C, 0x1F1F0000 | kVenc);
  run_for(kPsPerNs);
  EXPECT_EQ(events.rises[0].size(), 3u) << "its source has not changed";
  b.no_venc.write(false);
  run_for(kPsPerNs);
  EXPECT_EQ(events.rises[0].size(), 3u) << "rising edges only";
}

TEST_F(CaptureTest, SilentSourcesOfEdmaEventsAreNamed) {
  VpssEvents events(b);
  auto& notes = b.diagnostics;
  notes.clear();
  b.top_regs.write(0x1C, 0x1F021500);  // 31, 2, 21, 0
  EXPECT_TRUE(notes.counts().empty());
  b.top_regs.write(0x1C, 0x1F1F031F);
  ASSERT_EQ(notes.counts().size(), 1u);
  EXPECT_EQ(notes.counts().begin()->first.second,
            "VPSS EVTSEL gives VPSS_EVT2 to source 3, which is silent here");
  notes.clear();
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

/// Every register, written in the middle of the first field with VDLC = 0: this field goes on as it was, and the next
/// one has the new settings. Only SYNCEN acts at once, as it ends the capture. Which registers wait: family, SPRUF71
/// (DM355), where the settings of the picture are latched by VD; all of them are taken to be (assumed).
TEST_F(CaptureTest, EachSettingWaitsForTheNextVd) {
  const std::set<std::string> taken{"MODESET", "SPH",  "LNH",  "SLV0",     "SLV1",   "LNV",
                                    "HSIZE",   "CADU", "CADL", "REC656IF", "CCDCFG", "SDOFST"};
  // Two swaps of all, or two inversions, would be none, and VDLC ends the waiting.
  const std::uint32_t ycinswp = 1u << 4;
  const auto bursts = [&](const Reg* written) {
    SetUp();
    enable();
    run_until(line_time(6) + kPsPerUs);
    const std::size_t before = b.memory.log.size();
    if (written) {
      const std::uint32_t flip = written->writable() & (written->name() == "CCDCFG" ? ycinswp : ~0u);
      b.regs.write(written->offset(), b.regs.read(written->offset()) ^ flip);
    }
    run_until(line_time(13));  // past the last row of the first field
    const std::size_t field = b.memory.log.size();
    EXPECT_EQ(before, 3u * 2) << "three rows of two bursts";
    const std::vector<std::uint8_t> first(b.memory.at(kBuffer), b.memory.at(kBuffer) + kRows * kRowBytes);
    run_until(line_time(24));
    std::vector<std::uint32_t> now, next;
    for (std::size_t n = 0; n < b.memory.log.size(); ++n)
      (n < field ? now : next).push_back(b.memory.log[n].address << 4 | b.memory.log[n].bytes);
    for (std::uint8_t byte : first) now.push_back(byte);
    for (unsigned n = 0; n < kRows * kRowBytes; ++n) next.push_back(b.memory.at(kBuffer)[n]);
    if (written) b.regs.write(written->offset(), written->reset_value());
    return std::pair(now, next);
  };
  const auto usual = bursts(nullptr);
  unsigned checked = 0;
  for (const Reg* r : b.isif.bank().regs()) {
    if (r->name() == "SYNCEN" || !r->writable()) continue;
    const auto [now, next] = bursts(r);
    EXPECT_EQ(now, usual.first) << r->name() << " acts in the middle of a field";
    // The first line of a first field is no matter of the second one.
    EXPECT_EQ(next != usual.second, taken.contains(r->name()) && r->name() != "SLV0") << r->name();
    ++checked;
  }
  EXPECT_EQ(checked, b.isif.bank().regs().size() - 1);
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
  Diagnostics& d = b.diagnostics;
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
