// The monitor on the board's video output.
#pragma once
#include <systemc>

#include "model/common/block.h"
#include "model/common/stats.h"
#include "model/video/core/frame_assembler.h"
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

/// Receives the lines of the video encoder, checks them and delivers complete frames.
class DisplaySink : public sc_core::sc_module, public Block, public DisplayLineIf {
 public:
  sc_core::sc_export<DisplayLineIf> lines{"lines"};
  DisplayStats stats;
  FrameAssembler assembler;  ///< assembler.on_frame is called for each displayed frame

  explicit DisplaySink(sc_core::sc_module_name name) : sc_module(name) {
    lines.bind(*this);
    add_statistics(stats);
  }
  void line(const DisplayLine& l) override {
    assembler.line(l);
    count();
  }
  void raster_off() override {
    assembler.raster_off();
    count();
  }

 private:
  // The assembler counts over the whole run, the statistics only over the measurement window.
  void count() {
    const Totals now{assembler.frames(), assembler.repeated(), assembler.underflows(),
                     assembler.broken_frames(), assembler.violations()};
    stats.frames += now.frames - counted_.frames;
    stats.repeated += now.repeated - counted_.repeated;
    stats.underflows += now.underflows - counted_.underflows;
    stats.broken_frames += now.broken - counted_.broken;
    stats.violations += now.violations - counted_.violations;
    counted_ = now;
  }
  struct Totals {
    std::uint64_t frames = 0, repeated = 0, underflows = 0, broken = 0, violations = 0;
  } counted_;
};

}  // namespace fovea::video
