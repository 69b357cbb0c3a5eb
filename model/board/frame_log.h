// Which captured frame was remapped when and shown when: put together from what the pins show.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "model/common/units.h"
#include "model/contract/phases.h"
#include "model/video/core/frame.h"

namespace fovea::board {

/// Phases that firmware shows on GPIO pins, as one would for a scope (model/contract/phases.h).
enum class Phase : std::uint8_t {
  kReset = PHASE_RESET, kBoot = PHASE_BOOT, kLut = PHASE_LUT, kIdle = PHASE_IDLE,
  kRemapStart = PHASE_REMAP_START, kRemapEnd = PHASE_REMAP_END, kFlip = PHASE_FLIP,
  kFailed = PHASE_FAILED
};
constexpr Phase phase_of(std::uint32_t pins) { return static_cast<Phase>(PHASE_OF(pins)); }

/// A sequence number is the count of complete captures since the last reset, modulo 256; it is unrolled
/// against the captures that the model has seen. The log numbers the captures of the whole run.
class FrameLog {
 public:
  /// @param index number of the capture since the last reset
  /// @param camera whose picture it began with
  void capture(std::uint64_t index, Picoseconds start, Picoseconds end, unsigned camera = 0);
  void pins(std::uint32_t levels, Picoseconds at);
  /// The display begins a frame and will show this buffer. True if it shows a frame that the
  /// firmware has flipped to.
  bool latch(std::uint32_t address, Picoseconds at);
  /// The display begins a frame; the decoder had found the present syncs at that time (Tvp5146::synced_at()).
  void decoder(Picoseconds synced_at) { synced_ = synced_at; }
  /// The chip is reset: capture and firmware count from 0 again. What is in the log stays.
  void restart();
  /// The frame whose latch was the last one is out. Its index counts from the first one on.
  const video::FrameTimes& shown(Picoseconds start, Picoseconds end);

  Phase phase() const { return phase_; }
  /// When a phase was entered first; nothing if it was not.
  std::optional<Picoseconds> first(Phase phase) const {
    return first_[static_cast<std::size_t>(phase)];
  }
  /// Frames shown, in order, but for those that were forgotten.
  const std::vector<video::FrameTimes>& records() const { return records_; }
  /// Remaps that ended, and how long each took, in order; the same.
  struct Remap {
    std::uint64_t captured;
    Picoseconds start, end;
  };
  const std::vector<Remap>& remaps() const { return remaps_; }
  /// What became of a camera's frames, from the first to the last frame that was shown. Each captured
  /// one was displayed, or corrected and superseded by a newer frame on its way to the display, or not
  /// corrected: dropped.
  struct Fates {
    std::uint64_t captured = 0, displayed = 0, superseded = 0, dropped = 0;
    std::uint64_t pending = 0;  ///< captured so shortly before finish() that its fate is open; not in `captured`
  };
  const Fates& fates(std::size_t camera) const {
    static const Fates kNone;
    return camera < fates_.size() ? fates_[camera] : kNone;
  }
  /// Nothing will be displayed any more from `at` on. Of the frames that were captured since the one that was shown
  /// last, those older than `age` have their fate: corrected ones are superseded, others dropped. The frame that is
  /// being corrected and younger ones are pending. Without a frame that was shown, nothing is decided.
  void finish(Picoseconds at, Picoseconds age);
  /// Frames that were captured and will not be shown, since the frame that was shown last.
  std::uint64_t never_shown() const { return never_shown_; }
  /// Ends of complete captures, in order; the same.
  const std::vector<Picoseconds>& captures() const { return capture_ends_; }
  /// Forgets the oldest entries of each list, all but `kept` of it, once there are twice as many.
  /// Calls old(entry) for each one that goes.
  template <class Old>
  void forget(std::size_t kept, Old old) {
    const auto trim = [&](auto& list) {
      if (list.size() < 2 * kept) return;
      const auto end = list.end() - static_cast<std::ptrdiff_t>(kept);
      for (auto i = list.begin(); i != end; ++i) old(*i);
      list.erase(list.begin(), end);
    };
    trim(records_);
    trim(remaps_);
    trim(capture_ends_);
  }

 private:
  struct Capture {
    Picoseconds start, end;
    unsigned camera;
  };
  bool awaits_syncs(Picoseconds start) const;
  void settle_fates(std::uint64_t shown);
  Fates* fates_of(const Capture& capture);
  void settle_unshown(std::uint64_t number, const Capture& capture);
  std::optional<std::uint64_t> unroll(unsigned sequence) const;

  Phase phase_ = Phase::kReset;
  std::array<std::optional<Picoseconds>, PHASE_COUNT> first_{};
  std::map<std::uint64_t, Capture> captured_;
  std::map<std::uint64_t, Remap> remapped_;
  std::vector<Fates> fates_;  // by camera
  std::vector<Remap> remaps_;
  std::vector<Picoseconds> capture_ends_;
  std::optional<std::uint64_t> settled_;  // captures up to this one have their fate
  std::uint64_t never_shown_ = 0;
  std::uint64_t first_capture_ = 0;  // since the last reset
  std::uint64_t next_capture_ = 0;
  std::optional<std::uint64_t> running_, flipped_, showing_, last_shown_;
  std::optional<std::uint32_t> address_;
  Picoseconds remap_start_ = 0, synced_ = 0;
  std::vector<video::FrameTimes> records_;
  std::uint64_t shown_ = 0;
};

}  // namespace fovea::board
