#include "model/video/osd.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "model/video/core/burst_split.h"

namespace fovea::video {
namespace {

constexpr unsigned kBurstIndexBits = 8;  // of the tag; the other bits are the number of the line

constexpr auto kBlackLine = [] {
  std::array<std::uint8_t, kActiveBytes> line{};
  for (unsigned i = 0; i < kActiveBytes; ++i) line[i] = i & 1u ? 0x10 : 0x80;
  return line;
}();

}  // namespace

Osd::Osd(sc_core::sc_module_name name, const VpssParams& params)
    : BusTarget(name, regs),
      memory("memory", Master::kVpbe, static_cast<unsigned>(params.read_outstanding()),
             BurstMaster::Report::kWhenDecided),
      params_(params),
      ring_(params.read_ahead_lines() + 2) {
  add_power_gate(psc_enabled);
  add_master(Master::kVpbe, memory.socket, static_cast<unsigned>(params.read_outstanding()));
  lines.bind(*this);
  for (Line& l : ring_) l.bursts.reserve(kActiveBytes / 32 + 8);
  regs.miscctl.on_write([this](std::uint32_t value) {
    if (value >> 6 & 1u && params_.miscctl_6.is("rgbwin")) diagnostics().not_modelled("OSD MISCCTL.RGBWIN");
  });
  memory.on_done = [this](const BurstMaster::Completion& c) { done(c); };
}

void Osd::field_start(const Standard& standard, bool f) {
  const bool upper = f == ((regs.mode.fsinv.get() ^ regs.vidwinmd.vfinv.get()) != 0);
  if (params_.osd_latch.is("frame") && f) {
    window_.upper = upper;
  } else {
    const bool is_625 = &standard == &k625;
    const auto value = [](const auto& r) { return static_cast<int>(r.value.get()); };
    Window w;
    w.on = clocked() && regs.vidwinmd.act0;
    w.field_mode = regs.vidwinmd.vff0.get();
    w.upper = upper;
    w.swap_chroma = regs.mode.cs.get();
    w.address = regs.address();
    w.pitch = regs.pitch();
    w.x = value(regs.basepx) + value(regs.vidwin0xp) -
          static_cast<int>(is_625 ? params_.base_px_625() : params_.base_px_525());
    w.y = value(regs.basepy) + value(regs.vidwin0yp) -
          static_cast<int>(is_625 ? params_.base_py_625() : params_.base_py_525());
    w.width = value(regs.vidwin0xl);
    w.height = value(regs.vidwin0yl);
    const DiagnosticsRef& d = diagnostics();
    if (w.on) {
      if (regs.vidwinmd.vvz0 || regs.vidwinmd.vhz0) d.not_modelled("OSD zoom");
      if (!(regs.vidwin0ofst.ah.get() & 8)) d.guest("VIDWIN0OFST bit 12 must be 1");
      if (w.x % 2 || w.width % 2) {
        d.guest("video window not on whole pixel pairs; rounded down");
        w.x &= ~1;
        w.width &= ~1;
      }
      if (w.x < 0 || w.y < 0 || w.x + w.width > static_cast<int>(kActivePixels) ||
          w.y + w.height > static_cast<int>(standard.active_count[0]))
        d.guest("video window leaves the active picture; cut");
    }
    if (regs.vidwinmd.act1) d.not_modelled("OSD video window 1");
    if (regs.mode.cabg) d.not_modelled("OSD background colour other than index 0");
    window_ = w;
  }
  if (on_latch) on_latch({kernel_time(), f, window_.on, window_.address});
}

void Osd::fetch(const Timing& timing) {
  FOVEA_CHECK(fetched_ - finished_ < ring_.size(), "more display lines under way than buffers");
  Line& line = at(fetched_++);
  line.timing = timing;
  line.start = timing.clock->edge(timing.first_active);
  line.end = timing.clock->edge(timing.first_active + kActiveBytes);
  line.fetched = kernel_time();
  line.swap_chroma = window_.swap_chroma;
  line.bursts.clear();
  line.next = 0;
  if (window_.on) plan(line);
  issue();
}

void Osd::plan(Line& line) {
  const Timing& t = line.timing;
  const int y = static_cast<int>(t.number - t.standard->active_first[t.f]) - window_.y;
  if (y < 0 || y >= window_.height) return;
  const int left = std::max(window_.x, 0);
  const int right = std::min(window_.x + window_.width, static_cast<int>(kActivePixels));
  if (left >= right) return;
  const int row = window_.field_mode ? 2 * y + (window_.upper ? 0 : 1) : y;
  std::uint32_t address = window_.address + static_cast<std::uint32_t>(row) * window_.pitch +
                          static_cast<std::uint32_t>(left - window_.x) * 2;
  unsigned at = static_cast<unsigned>(left) * 2;
  unsigned remaining = static_cast<unsigned>(right - left) * 2;
  while (remaining) {
    const unsigned bytes = first_burst(address, remaining, static_cast<unsigned>(params_.burst()));
    line.bursts.push_back({address, static_cast<std::uint16_t>(at),
                           static_cast<std::uint16_t>(bytes), t.clock->edge(t.first_active + at),
                           kNever});
    address += bytes;
    at += bytes;
    remaining -= bytes;
  }
}

/// Issues the bursts that are certain to get a slot. A burst is issued after the last beat of the
/// burst whose slot it takes.
void Osd::issue() {
  for (std::uint64_t n = finished_; n < fetched_; ++n) {
    Line& line = at(n);
    while (line.next < line.bursts.size()) {
      const Picoseconds place = memory.free_from();
      if (place == kNever) return;
      const Picoseconds when = std::max(line.fetched, place);
      const unsigned i = line.next++;
      const Burst& b = line.bursts[i];
      // A burst that is already late is not read. For this reason it also does not matter whether a
      // completion
      // or the end of a line at the same time is handled first.
      if (b.due > when) memory.read(b.address, b.bytes, n << kBurstIndexBits | i, when, true);
    }
  }
}

/// Called ahead of time c.last: must not use or change anything that others can observe before
/// then.
void Osd::done(const BurstMaster::Completion& c) {
  const std::uint64_t n = c.tag >> kBurstIndexBits;
  if (c.error && n >= reset_line_) diagnostics().guest("display reads an address without memory");
  if (n >= finished_ && n < fetched_) {  // otherwise the line was displayed already
    Line& line = at(n);
    Burst& b = line.bursts[c.tag & ((1u << kBurstIndexBits) - 1)];
    b.arrived = c.last;
    std::memcpy(line.bytes.data() + b.at, c.data.data(), b.bytes);
  }
  issue();
}

DisplayLine Osd::finish() {
  FOVEA_CHECK(finished_ < fetched_, "display line finished before it was fetched");
  Line& line = at(finished_++);
  const Timing& t = line.timing;
  unsigned underflows = 0;
  std::memcpy(out_.data(), kBlackLine.data(), kActiveBytes);
  for (const Burst& b : line.bursts) {
    if (b.arrived < b.due)
      std::memcpy(out_.data() + b.at, line.bytes.data() + b.at, b.bytes);
    else
      ++underflows;
  }
  if (underflows && params_.miscctl_6.is("dmang")) regs.miscctl.dmang.set(1);
  if (underflows && on_late) on_late(underflows);
  if (line.swap_chroma)
    for (unsigned i = 0; i < kActiveBytes; i += 4) std::swap(out_[i], out_[i + 2]);
  return {t.standard, t.number, t.f, line.start, line.end, out_.data()};
}

void Osd::stop() { finished_ = fetched_; }

}  // namespace fovea::video
