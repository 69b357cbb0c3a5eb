// ISIF and VPSS top behind a small raster of 8 active lines a field, and a memory whose bytes can be
// compared.
#pragma once
#include <gtest/gtest.h>

#include <functional>
#include <span>
#include <vector>

#include "model/video/camera_signal.h"
#include "model/video/isif.h"
#include "model/video/vpss_top.h"
#include "tb/own_diagnostics.h"
#include "tb/video/bench.h"

namespace fovea::video {

inline constexpr Standard kSmall{"small",
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

inline std::uint8_t pattern(unsigned row, unsigned i) {
  return static_cast<std::uint8_t>(row * 37 + i * 5 + (row * i >> 3));
}

/// Sends the small raster without end; codes may be damaged.
class CaptureWire : public sc_core::sc_module {
 public:
  sc_core::sc_port<Bt656If> video{"video"};
  Clock clock{kByteClock};
  std::function<std::uint8_t(unsigned line, std::uint8_t xy)> damage;
  std::function<unsigned(unsigned line)> missing;  ///< samples at a line's end
  std::vector<unsigned> taken;  ///< the lines whose bytes were taken
  SC_HAS_PROCESS(CaptureWire);
  explicit CaptureWire(sc_core::sc_module_name name) : sc_module(name) { SC_METHOD(tick); }
  /// Start of the next line 1 strictly after now.
  Picoseconds next_frame() const {
    return clock.edge((kernel_time() / kFrame + 1) * kSmall.frame_bytes());
  }

 private:
  void tick() {
    const unsigned line = locate(kSmall, n_).line;
    const auto fv = kSmall.at(line);
    std::uint8_t xy = encode_xy(fv.f, fv.v, true);
    if (damage) xy = damage(line, xy);
    const std::uint64_t first = n_ * kSmall.line_bytes;
    ++n_;
    next_trigger(ps_time(clock.edge(n_ * kSmall.line_bytes) - kernel_time()));
    if (!video->begin_line({&kSmall, &clock, first, xy})) return;
    taken.push_back(line);
    video->take_line(compose(line).first(kSmall.line_bytes - (missing ? missing(line) : 0)));
  }
  std::span<const std::uint8_t> compose(unsigned line) {
    const auto fv = kSmall.at(line);
    std::array<std::uint8_t, kActiveBytes> active{};
    if (!fv.v) {
      const unsigned row = 2 * (line - kSmall.active_first[fv.f]) + fv.f;
      for (unsigned i = 0; i < kActiveBytes; ++i) active[i] = pattern(row, i);
    }
    compose_line(kSmall, encode_xy(fv.f, fv.v, true), encode_xy(fv.f, fv.v, false),
                 fv.v ? nullptr : active.data(), {bytes_.data(), kSmall.line_bytes});
    return {bytes_.data(), kSmall.line_bytes};
  }
  std::uint64_t n_ = 0;
  std::array<std::uint8_t, kMaxLineBytes> bytes_{};
};

struct CaptureBench {
  OwnDiagnostics diagnostics;
  VpssParams params;
  sc_core::sc_signal<bool> psc{"psc", true}, no_venc{"no_venc"};
  sc_core::sc_signal<bool> isif_gate{"isif_gate", true}, vpbe_gate{"vpbe_gate"},
      venc_clk_sel{"venc_clk_sel"}, owns_write_buffer{"owns_write_buffer"};
  sc_core::sc_signal<std::uint32_t> read_priority{"read_priority"},
      write_priority{"write_priority"};
  sc_core::sc_vector<sc_core::sc_signal<bool>> event{"event", 3}, vpssint{"vpssint", 9};
  CaptureWire wire{"wire"};
  Isif isif{"isif", params};
  VpssTop top{"top"};
  FakeMemory memory{"memory"};
  RegisterPort regs{"regs"}, top_regs{"top_regs"};
  sc_core::sc_vector<EdgeLog> edges{"edges", 9};
  std::vector<CaptureFrame> started, ended;

  CaptureBench() {
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
inline CaptureBench* capture_bench = nullptr;

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
  CaptureBench& b = *capture_bench;
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
    b.wire.taken.clear();
    b.started.clear();
    b.ended.clear();
    for (std::size_t i = 0; i < b.edges.size(); ++i) b.edges[i].rises.clear();
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

}  // namespace fovea::video
