// OSD (on-screen display block): fetches video window 0 from memory and composes display lines.
#pragma once
#include <array>
#include <functional>
#include <systemc>
#include <vector>

#include "model/common/burst_master.h"
#include "model/common/bus_target.h"
#include "model/video/osd_regs.h"
#include "model/video/params.h"
#include "model/video/wire.h"

namespace fovea::video {

/// What the encoder's raster needs from the OSD. All calls are made at the start of a line, in
/// order of time.
class OsdLineIf : public virtual sc_core::sc_interface {
 public:
  struct Timing {
    const Standard* standard;
    const Clock* clock;
    std::uint64_t first_active;  ///< clock edge of the line's first active sample
    unsigned number;             ///< line number in the standard
    bool f;
  };
  /// The window registers are latched for the field that starts now.
  virtual void field_start(const Standard& standard, bool f) = 0;
  /// Starts to fetch the line that will be displayed with this timing.
  virtual void fetch(const Timing& timing) = 0;
  /// Returns the oldest line that was fetched and not yet finished, at the end of its display.
  virtual DisplayLine finish() = 0;
  /// Discards all lines that were fetched and not finished.
  virtual void stop() = 0;
};

/// OSD with video window 0 in 4:2:2 (Cb Y Cr Y in memory; Cr first with MODE.CS). The window
/// registers are latched at each field start (`vpss.osd_latch`), so a frame shows two buffers if
/// the address changes between its fields. A line is fetched `vpss.read_ahead_lines` lines before
/// it is displayed, in bursts of at most `vpss.burst` bytes. A burst whose data do not arrive
/// strictly before its first pixel is due is displayed as black and counts as an underflow; at the
/// end of that line MISCCTL.DMANG is set, if the chip has it (`vpss.miscctl_6`). Not
/// modelled: window 1, bitmap windows, cursor, zoom, 4:2:0, any background but black.
class Osd : public WithRegs<OsdRegs>, public BusTarget, public OsdLineIf {
 public:
  using Params = VpssParams;
  struct Latch {
    Picoseconds time;
    bool f;
    bool window;  ///< window 0 is on
    std::uint32_t address;
  };
  sc_core::sc_export<OsdLineIf> lines{"lines"};
  BurstMaster memory;  ///< bind memory.socket
  sc_core::sc_in<bool> psc_enabled{"psc_enabled"}, gate{"gate"};
  /// Called at each field start with the latched settings of window 0.
  std::function<void(const Latch&)> on_latch;
  /// Called at the end of a displayed line with the number of its bursts that arrived too late; not if none did.
  std::function<void(unsigned)> on_late;

  Osd(sc_core::sc_module_name name, const VpssParams& params);

  void field_start(const Standard& standard, bool f) override;
  void fetch(const Timing& timing) override;
  DisplayLine finish() override;
  void stop() override;
  bool idle() const override { return memory.idle(); }

 protected:
  bool clocked() const override { return psc_enabled.read() && gate.read(); }

 private:
  struct Window {
    bool on = false, field_mode = false, upper = true, swap_chroma = false;
    std::uint32_t address = 0, pitch = 0;
    int x = 0, y = 0;  // in pixels, and in lines of a field from the first active line
    int width = 0, height = 0;
  };
  struct Burst {
    std::uint32_t address;
    std::uint16_t at, bytes;  // position in the active line, in bytes
    Picoseconds due, arrived;
  };
  struct Line {
    Timing timing{};
    Picoseconds fetched = 0;         // time at which its reads begin
    Picoseconds start = 0, end = 0;  // start and end of its active part, by the clock at the time
                                     // of the fetch
    bool swap_chroma = false;
    std::vector<Burst> bursts;
    unsigned next = 0;  // first burst that was not issued yet
    std::array<std::uint8_t, kActiveBytes> bytes{};
  };

  void on_reset(ResetKind) override {
    stop();
    window_ = {};
    reset_line_ = fetched_;
  }
  Line& at(std::uint64_t n) { return ring_[n % ring_.size()]; }
  void plan(Line& line);
  void issue();
  void done(const BurstMaster::Completion& c);

  const VpssParams& params_;
  Window window_;
  std::vector<Line> ring_;
  std::uint64_t fetched_ = 0, finished_ = 0;  // number of lines fetched and displayed
  std::uint64_t reset_line_ = 0;  // lines before this one were fetched before the last reset
  std::array<std::uint8_t, kActiveBytes> out_{};
};

}  // namespace fovea::video
