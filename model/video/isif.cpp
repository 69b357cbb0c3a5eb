#include "model/video/isif.h"

#include <algorithm>
#include <cstring>

#include "model/video/core/burst_split.h"

namespace fovea::video {

Isif::Isif(sc_core::sc_module_name name, const VpssParams& params)
    : BusTarget(name, regs),
      memory("memory", Master::kVpfe, static_cast<unsigned>(params.write_buffer_bursts()),
             BurstMaster::Report::kWhenDecided),
      params_(params) {
  add_power_gate(psc_enabled);
  if (params.burst() & (params.burst() - 1)) throw UserError("vpss.burst must be 32B or 64B");
  add_statistics(stats);
  add_master(Master::kVpfe, memory.socket, static_cast<unsigned>(params.write_buffer_bursts()));
  video.bind(*this);
  memory.on_done = [this](const BurstMaster::Completion& c) { done(c); };
  regs.syncen.on_write([this](std::uint32_t) { write_syncen(); });
  SC_METHOD(close_fields);
  sensitive << end_timer_.event();
  dont_initialize();
}

void Isif::write_syncen() {
  if (!regs.syncen.vdhden) {
    synced_ = false;
    line_ = 0;
    frame_open_ = false;
    // A row that is being captured is still written, but no longer ends a field or a frame.
    last_row_ = false;
    while (!ends_.empty() && ends_.back().due > kernel_time()) ends_.pop_back();
    frame_index_ = 0;
    setup_.write = false;
    return;
  }
  const DiagnosticsRef& d = diagnostics();
  if (!regs.rec656if.r656on) d.not_modelled("ISIF without BT.656 embedded syncs");
  if (regs.modeset.inpmod.get() != 2) d.not_modelled("ISIF input other than 8-bit YC");
  if (regs.ccdcfg.sdrpack.get() != 2) d.not_modelled("ISIF packing other than 8 bit");
  if (regs.culh.get() != 0xFFFF || regs.culv.get() != 0xFF) d.not_modelled("ISIF culling");
  if (regs.hsize.adcr) d.not_modelled("ISIF addresses going down");
  if (regs.modeset.hdvdd) d.not_modelled("ISIF as HD/VD master");
}

/// Bursts under way are not waited for: the frame is lost, and what of it reaches memory is of no
/// account.
void Isif::on_reset(ResetKind) {
  write_syncen();
  f_ = field_ = overflow_sticky_ = false;
  v_ = true;
  setup_ = {};
  row_bytes_ = row_pos_ = 0;
  reset_tag_ = tag_;
  ends_.clear();
  end_timer_.cancel();
}

void Isif::latch(const Standard& standard) {
  setup_.write = regs.syncen.wen && regs.rec656if.r656on && regs.modeset.inpmod.get() == 2 &&
                 owns_write_buffer.read();
  setup_.interlaced = regs.modeset.ccdmd.get();
  setup_.fiinv = regs.sdofst.fiinv.get();
  setup_.sdofst = regs.sdofst.get();
  // On the wire the order is Cb Y Cr Y. Linux's UYVY settings (YCINSWP = Y8POS = 1) keep it; each
  // of the
  // four swap bits reverses it.
  setup_.swap = ((regs.ccdcfg.y8pos.get() ^ regs.ccdcfg.ycinswp.get() ^ regs.ccdcfg.ycoutswp.get() ^
                  regs.ccdcfg.bswd.get()) &
                 1) != 0;
  setup_.invert_chroma = regs.ccdcfg.msbinvi.get() != regs.ccdcfg.msbinvo.get();
  setup_.sph = regs.sph.value.get();
  setup_.bytes = regs.lnh.value.get() + 1;
  const unsigned active = standard.active_bytes();
  if (setup_.sph >= active || setup_.sph + setup_.bytes > active) {
    diagnostics().guest("ISIF window leaves the active part of the line; cut");
    setup_.sph = std::min(setup_.sph, active);
    setup_.bytes = std::min(setup_.bytes, active - setup_.sph);
  }
  setup_.bytes &= ~3u;
  setup_.first_line[0] = regs.slv0.value.get();
  setup_.first_line[1] = regs.slv1.value.get();
  setup_.lines = regs.lnv.value.get() + 1;
  setup_.address = regs.address();
  setup_.pitch = regs.hsize.lofst.get() * 32;
}

bool Isif::begin_line(const Bt656Line& l) {
  if (!clocked() || !regs.syncen.vdhden) {
    synced_ = false;
    line_ = 0;
    return false;
  }
  issue(kernel_time());  // the last burst of the previous line may be due at this very time

  const XyCode code = decode_xy(l.eav_xy);
  bool f = (l.eav_xy & 0x40) != 0, v = (l.eav_xy & 0x20) != 0;
  if (code.quality != XyCode::Quality::kGood && regs.rec656if.eccfvh) {
    const bool corrected = code.quality == XyCode::Quality::kCorrected;
    ++(corrected ? stats.corrected_codes : stats.bad_codes);
    f = corrected ? code.f : f_;
    v = corrected ? code.v : v_;
  }
  const bool vd = synced_ && v_ && !v;
  synced_ = true;
  f_ = f;
  v_ = v;
  if (vd) {
    line_ = 1;
    begin_field(l);
  } else if (line_ != 0) {
    ++line_;
  }
  if (line_ == 0) return false;

  const IsifRegs::Number15* const lines[] = {&regs.vdint0, &regs.vdint1, &regs.vdint2};
  for (unsigned i = 0; i < 3; ++i)
    if (lines[i]->value.get() == line_ || (vd && lines[i]->value.get() == 0)) vdint[i].raise();

  if (regs.ccdcfg.vdlc) latch(*l.standard);
  const unsigned first = setup_.first_line[field_];
  return setup_.write && line_ >= first && line_ - first < setup_.lines && begin_row(l, line_ - first);
}

void Isif::begin_field(const Bt656Line& l) {
  field_ = f_ != (regs.modeset.fipol.get() != 0);
  regs.modeset.mdfs.set(field_);
  latch(*l.standard);
  if (!setup_.write) frame_open_ = false;  // the second field of this frame will not be captured
}

/// False if nothing of the line is captured.
bool Isif::begin_row(const Bt656Line& l, unsigned index) {
  if (setup_.bytes == 0) return false;
  const bool place = field_ != setup_.fiinv;
  if (index == 0)
    row_offset_ = setup_.interlaced && place ? regs.sdofst.start(setup_.sdofst) : 0;
  else
    row_offset_ += regs.sdofst.step(setup_.sdofst, place, index - 1);
  row_address_ = setup_.address + static_cast<std::uint32_t>(row_offset_) * setup_.pitch;
  row_skipped_ = l.standard->active_offset() + setup_.sph;
  row_first_sample_ = l.first_sample + row_skipped_;
  row_clock_ = l.clock;
  row_bytes_ = row_pos_ = 0;  // until they come
  first_row_ = index == 0;
  last_row_ = index + 1 == setup_.lines;
  return true;
}

void Isif::take_line(std::span<const std::uint8_t> bytes) {
  // Of a short line only what came is written; memory keeps what it had of the rest.
  const auto size = static_cast<unsigned>(bytes.size());
  const unsigned came = size > row_skipped_ ? size - row_skipped_ : 0;
  row_bytes_ = std::min(setup_.bytes, came & ~3u);
  const std::uint8_t* from = bytes.data() + row_skipped_;
  if (setup_.swap) {
    for (unsigned i = 0; i < row_bytes_; i += 2) {
      row_[i] = from[i + 1];
      row_[i + 1] = from[i];
    }
  } else {
    std::memcpy(row_.data(), from, row_bytes_);
  }
  if (setup_.invert_chroma)
    for (unsigned i = setup_.swap ? 1 : 0; i < row_bytes_; i += 2) row_[i] ^= 0x80;

  if (first_row_) begin_frame();
  if (row_bytes_ == 0 && last_row_) end_field(kernel_time());
  issue(kernel_time());
}

/// The first row of a field begins, which is a frame's second one if its first one was captured.
void Isif::begin_frame() {
  const bool begins = !field_ || !setup_.interlaced;
  if (begins || !frame_open_) {
    frame_ = CaptureFrame{};
    frame_.index = frame_index_;
    frame_.start = row_clock_->edge(row_first_sample_);
    frame_.complete = begins;
    frame_open_ = true;
  }
  frame_.address[field_] = setup_.address;
  if ((begins || !frame_.complete) && on_frame_start) on_frame_start(frame_);
}

/// Issues the bursts of the row for which a buffer slot is certainly free when their last byte
/// arrives, ahead of that time, and counts those as lost for which certainly none is free. A slot
/// freed at time t can be used strictly after t. If neither is certain, the answer depends on a
/// burst whose outcome is not decided, and done() calls again. At `now`, everything is certain that
/// was due by then.
void Isif::issue(Picoseconds now) {
  while (row_pos_ < row_bytes_) {
    const unsigned bytes = first_burst(row_address_ + row_pos_, row_bytes_ - row_pos_,
                                       static_cast<unsigned>(params_.burst()));
    const Picoseconds due = row_clock_->edge(row_first_sample_ + row_pos_ + bytes);
    const bool last = row_pos_ + bytes == row_bytes_ && last_row_;
    if (memory.taken_at(due) < params_.write_buffer_bursts()) {
      const unsigned at = row_pos_;
      row_pos_ += bytes;
      ++stats.bursts;
      ++tag_;
      if (last) end_field(due);
      // The last burst of a field is followed by a kernel event of this block, so it has side
      // effects.
      memory.write(row_address_ + at, {row_.data() + at, bytes}, tag_, due, !last);
    } else if (due <= now || memory.outstanding() == 0) {
      overflow_sticky_ = true;
      ++stats.overflows;
      ++frame_.overflows;
      row_pos_ += bytes;
      if (last) end_field(due);
    } else {
      return;
    }
  }
}

/// @param due time at which the last burst of the field is issued or lost
void Isif::end_field(Picoseconds due) {
  const Picoseconds at = tag_ <= done_tag_ ? std::max(due, done_at_) : kNever;
  const bool last = field_ || !setup_.interlaced;
  ends_.push_back({tag_, due, at, last, frame_});
  if (last) {
    if (frame_.complete) ++frame_index_;
    frame_open_ = false;
  }
  arm_end();
}

void Isif::arm_end() {
  if (!ends_.empty()) end_timer_.at(ends_.front().at);
}

void Isif::close_fields() {
  while (!ends_.empty() && ends_.front().at <= kernel_time()) {
    FieldEnd e = ends_.front();
    ends_.pop_front();
    ++stats.fields;
    if (!e.last) continue;
    e.frame.end = e.at;
    if (e.frame.complete) ++stats.frames;
    if (on_frame_end) on_frame_end(e.frame);
  }
  arm_end();
}

/// Called ahead of time c.last: must not use or change anything that others can observe before
/// then.
void Isif::done(const BurstMaster::Completion& c) {
  if (c.error && c.tag > reset_tag_) diagnostics().guest("capture writes to an address without memory");
  done_tag_ = c.tag;
  done_at_ = c.last;
  for (FieldEnd& e : ends_)
    if (e.at == kNever && e.last_tag <= c.tag) e.at = c.last;
  arm_end();
  issue(0);
}

}  // namespace fovea::video
