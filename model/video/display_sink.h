// The monitor on the board's video output.
#pragma once
#include <array>
#include <functional>
#include <systemc>

#include "model/common/block.h"
#include "model/common/stats.h"
#include "model/video/core/frame_assembler.h"
#include "model/video/osd.h"
#include "model/video/wire.h"

namespace fovea::video {

struct DisplayStats : StatGroup {
  Counter frames{*this, "frames", "1", "complete frames displayed"};
  Counter repeated{*this, "repeated", "1",
                   "frames with the same buffer address and the same pixels as the one before"};
  Counter underflows{*this, "underflows", "1",
                     "bursts of picture data that came after their first pixel was due"};
  Counter broken_frames{*this, "broken_frames", "1", "frames that ended early"};
  Counter violations{*this, "violations", "1",
                     "lines at a wrong time, out of order or of wrong length"};
  DisplayStats() : StatGroup("display") {}
};

/// Receives the lines of the video encoder, checks them and delivers complete frames. What no display sees on its wire,
/// the frames' buffers and the bursts that came too late, it is told for its statistics (latched(), late()).
class DisplaySink : public sc_core::sc_module, public Block, public DisplayLineIf {
 public:
  sc_core::sc_export<DisplayLineIf> lines{"lines"};
  DisplayStats stats;
  FrameAssembler assembler;
  /// Called for each displayed frame, which its receiver may complete.
  std::function<void(Frame&)> on_frame;

  explicit DisplaySink(sc_core::sc_module_name name) : sc_module(name) {
    lines.bind(*this);
    add_statistics(stats);
    assembler.on_frame = [this](Frame& frame) { shown(frame); };
  }
  void line(const DisplayLine& l) override {
    assembler.line(l);
    count();
  }
  void raster_off() override {
    assembler.raster_off();
    count();
  }
  /// For Osd::on_latch: a field begins and shows this buffer.
  void latched(const Osd::Latch& latch) {
    buffers_[latch.f] = {latch.window, latch.address};
    if (!latch.f) late_ = 0;
  }
  /// For Osd::on_late: so many bursts of the line that is handed over next came too late.
  void late(unsigned bursts) {
    late_ += bursts;
    stats.underflows += bursts;
  }

 private:
  struct Buffer {
    bool window = false;
    std::uint32_t address = 0;
    bool operator==(const Buffer&) const = default;
  };
  using Buffers = std::array<Buffer, 2>;  // of a frame's fields

  void shown(Frame& frame) {
    frame.underflows = late_;
    const bool window = buffers_[0].window && buffers_[1].window;
    if (window && buffers_ == previous_ && assembler.unchanged()) ++stats.repeated;
    previous_ = buffers_;
    if (on_frame) on_frame(frame);
  }
  // The assembler counts over the whole run, the statistics only over the measurement window.
  void count() {
    const Totals now{assembler.frames(), assembler.broken_frames(), assembler.violations()};
    stats.frames += now.frames - counted_.frames;
    stats.broken_frames += now.broken - counted_.broken;
    stats.violations += now.violations - counted_.violations;
    counted_ = now;
  }
  struct Totals {
    std::uint64_t frames = 0, broken = 0, violations = 0;
  } counted_;
  Buffers buffers_{}, previous_{};
  unsigned late_ = 0;  // bursts, since the frame's first field began
};

}  // namespace fovea::video
