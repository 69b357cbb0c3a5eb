// OSD, VENC and display in full size, over a memory whose latency a test chooses.
#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "model/video/display_sink.h"
#include "model/video/osd.h"
#include "model/video/venc.h"
#include "tb/own_diagnostics.h"
#include "tb/video/bench.h"
#include "tb/video/setting.h"

namespace fovea::video {

// Standard, lines read ahead and bursts outstanding: CMakeLists.txt lists what is tried.
inline const bool kIs625 = setting("FOVEA_625", 1u) != 0;
inline const unsigned kAhead = setting("FOVEA_AHEAD", 1u), kOutstanding = setting("FOVEA_OUTSTANDING", 4u);
inline const Standard& kStd = standard_of(kIs625);
inline const unsigned kRows = kStd.rows, kPitch = 1440;
inline constexpr std::uint32_t kBuffer = 0x8010'0000, kOther = 0x8020'0000;

inline std::uint8_t pattern(unsigned row, unsigned i) {
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
  OwnDiagnostics diagnostics;
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
  std::vector<Frame> frames;
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
    sink.on_frame = [this](const Frame& f) { frames.push_back(f); };
    osd.on_latch = [this](const Osd::Latch& l) {
      sink.latched(l);
      latches.push_back(l);
    };
    osd.on_late = [this](unsigned bursts) { sink.late(bursts); };
  }
};
inline Bench* bench = nullptr;

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
inline const std::uint32_t kOn = kIs625 ? 0x43 : 0x03;
inline const Picoseconds kField = kPsPerSecond / (kIs625 ? 50 : 59);

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
    b.osd_regs.write(BASEPX, kIs625 ? 0x7E : 0x79);
    b.osd_regs.write(BASEPY, kIs625 ? 0x16 : 0x10);
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
    repeated_ = b.sink.stats.repeated.count();
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
  std::uint64_t repeated() const { return b.sink.stats.repeated.count() - repeated_; }
  std::uint64_t violations_ = 0, underflows_ = 0, repeated_ = 0;
};

}  // namespace fovea::video
