#include "model/board/frame_log.h"

#include <iterator>

namespace fovea::board {

using video::kNoCamera;

void FrameLog::capture(std::uint64_t index, Picoseconds start, Picoseconds end, unsigned camera) {
  index += first_capture_;
  captured_[index] = {start, end, camera};
  next_capture_ = index + 1;
  capture_ends_.push_back(end);
  // Only the recent past can still be shown; the history is in records_.
  while (captured_.size() > 128) {
    const auto oldest = captured_.begin();
    if (settled_ && oldest->first > *settled_) settle_unshown(oldest->first, oldest->second);
    captured_.erase(oldest);
  }
  while (remapped_.size() > 128) remapped_.erase(remapped_.begin());
}

/// The firmware may be a frame ahead of the record of the capture (its interrupt comes with the
/// last line, the record with the last write), never more than half the range behind.
std::optional<std::uint64_t> FrameLog::unroll(unsigned sequence) const {
  const std::uint64_t next = next_capture_ - first_capture_;
  const std::uint64_t base = next & ~std::uint64_t{PHASE_SEQUENCES - 1};
  std::uint64_t value = base + sequence;
  if (value > next) {
    if (value < PHASE_SEQUENCES) return std::nullopt;  // ahead of all captures: not a frame of ours
    value -= PHASE_SEQUENCES;
  }
  return first_capture_ + value;
}

void FrameLog::restart() {
  first_capture_ = next_capture_;
  running_.reset();
  flipped_.reset();
  showing_.reset();
  last_shown_.reset();
  settled_.reset();
  never_shown_ = 0;
  address_.reset();
}

void FrameLog::pins(std::uint32_t levels, Picoseconds at) {
  const Phase phase = phase_of(levels);
  const unsigned sequence = PHASE_SEQUENCE(levels);
  phase_ = phase;
  auto& first = first_[PHASE_OF(levels)];
  if (!first) first = at;
  switch (phase) {
    case Phase::kRemapStart:
      running_ = unroll(sequence);
      remap_start_ = at;
      break;
    case Phase::kRemapEnd:
      if (running_) {
        const Remap r{*running_, remap_start_, at};
        remapped_[*running_] = r;
        remaps_.push_back(r);
        running_.reset();
      }
      break;
    case Phase::kFlip:
      flipped_ = unroll(sequence);
      break;
    default:
      break;
  }
}

bool FrameLog::latch(std::uint32_t address, Picoseconds) {
  if (flipped_ && address_ != address) {
    // The address changed since the last field: what was flipped last is on show now.
    showing_ = flipped_;
    address_ = address;
  }
  return showing_.has_value();
}

/// A newer frame is on show: those captured since the one before it will not be shown any more.
void FrameLog::settle_fates(std::uint64_t shown) {
  for (std::uint64_t n = settled_ ? *settled_ + 1 : shown; n < shown; ++n)
    if (const auto c = captured_.find(n); c != captured_.end()) settle_unshown(n, c->second);
  if (const auto c = captured_.find(shown); c != captured_.end())
    if (Fates* of = fates_of(c->second)) {
      ++of->captured;
      ++of->displayed;
    }
  settled_ = shown;
  never_shown_ = 0;
}

FrameLog::Fates* FrameLog::fates_of(const Capture& capture) {
  if (capture.camera == kNoCamera) return nullptr;
  if (fates_.size() <= capture.camera) fates_.resize(capture.camera + 1);
  return &fates_[capture.camera];
}

void FrameLog::settle_unshown(std::uint64_t number, const Capture& capture) {
  settled_ = number;
  ++never_shown_;
  Fates* of = fates_of(capture);
  if (!of) return;
  ++of->captured;
  ++(remapped_.contains(number) ? of->superseded : of->dropped);
}

void FrameLog::finish(Picoseconds at, Picoseconds age) {
  if (!settled_) return;
  for (auto c = captured_.upper_bound(*settled_); c != captured_.end(); ++c) {
    const auto& [number, capture] = *c;
    const auto remap = remapped_.find(number);
    const Picoseconds since = remap == remapped_.end() ? capture.end : remap->second.end;
    if (running_ != number && since + age < at) {
      settle_unshown(number, capture);
    } else if (Fates* of = fates_of(capture)) {
      ++of->pending;
    }
  }
}

/// Whether the decoder's search for the syncs is the reason that the display frame from `start` on shows a frame again.
/// After it the next whole frame begins within one frame period and takes another one. Until it is on show, there
/// is one newer frame; a second one means that the chip is late.
bool FrameLog::awaits_syncs(Picoseconds start) const {
  const auto showing = captured_.find(*showing_);
  if (records_.empty() || showing == captured_.end() || synced_ <= showing->second.start) return false;
  unsigned newer = 0;
  for (auto c = std::next(showing); c != captured_.end(); ++c)
    newer += c->second.end <= start && c->second.camera != kNoCamera;
  const Picoseconds period = start - records_.back().display_start;
  return newer == 1 || (newer == 0 && start <= synced_ + 2 * period);
}

const video::FrameTimes& FrameLog::shown(Picoseconds start, Picoseconds end) {
  video::FrameTimes r;
  r.index = shown_++;
  r.captured = showing_;
  r.display_start = start;
  r.display_end = end;
  if (showing_) {
    if (auto c = captured_.find(*showing_); c != captured_.end()) {
      r.capture_start = c->second.start;
      r.capture_end = c->second.end;
      r.camera = c->second.camera;
    }
    if (auto m = remapped_.find(*showing_); m != remapped_.end()) {
      r.remap_start = m->second.start;
      r.remap_end = m->second.end;
    }
    r.repeated = last_shown_ == showing_;
    r.relock = r.repeated && awaits_syncs(start);
    if (last_shown_ && *showing_ > *last_shown_ + 1) r.dropped = *showing_ - *last_shown_ - 1;
    if (!r.repeated) settle_fates(*showing_);
    last_shown_ = showing_;
  }
  records_.push_back(r);
  return records_.back();
}

}  // namespace fovea::board
