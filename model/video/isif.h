// ISIF (image sensor interface): BT.656 capture to memory.
#pragma once
#include <array>
#include <deque>
#include <functional>
#include <systemc>

#include "model/common/burst_master.h"
#include "model/common/bus_target.h"
#include "model/common/stats.h"
#include "model/common/timer.h"
#include "model/video/isif_regs.h"
#include "model/video/params.h"
#include "model/common/pulse.h"
#include "model/video/wire.h"

namespace fovea::video {

struct CaptureStats : StatGroup {
  Counter frames{*this, "frames", "1", "frames captured: both fields, first one first; without CCDMD, fields"};
  Counter fields{*this, "fields", "1", "fields captured"};
  Counter bursts{*this, "bursts", "1", "bursts of captured data handed to memory"};
  Counter overflows{*this, "overflows", "1",
                    "bursts lost because the write buffer was full"};
  Counter corrected_codes{*this, "corrected_codes", "1",
                          "timing codes with one wrong bit, corrected"};
  Counter bad_codes{*this, "bad_codes", "1", "timing codes beyond correction"};
  CaptureStats() : StatGroup("capture") {}
};

/// A captured frame, as reported to the board.
struct CaptureFrame {
  std::uint64_t index = 0;  ///< number of complete frames since SYNCEN.VDHDEN was set
  bool complete = false;    ///< false if only the second field was captured
  Picoseconds start = 0;    ///< time at which the first captured sample is on the wire
  Picoseconds end = 0;      ///< time at which all data are in memory (last write acknowledged)
  std::array<std::uint32_t, 2> address{};  ///< buffer address of each field
  std::uint64_t overflows = 0;             ///< bursts lost from this frame
};

/// ISIF with 8-bit BT.656 input.
///
/// Counting of lines: VD is the EAV at which V falls. That line is line 1 (Linux starts the capture
/// of a full picture at line 1), and counting continues through the blanking. VDINTn fires at the
/// EAV of line n, or at VD for n = 0. Settings are latched at VD if VDLC = 0.
///
/// With CCDMD = 0 (progressive) each field is a frame, from the first row of its buffer on.
///
/// Data are written in bursts. A burst is issued when its last byte has arrived, i.e. one byte
/// clock after that byte appeared on the wire. At most `vpss.write_buffer_bursts` bursts wait for
/// memory; a buffer slot that is freed at time t can be used by bursts strictly after t. On
/// overflow the burst is lost, a sticky flag is set (it exists only in the model: no register is
/// documented) and capture continues. Not modelled: raw and 16-bit input, culling, filters,
/// formatter, HD/VD as outputs.
class Isif : public WithRegs<IsifRegs>, public BusTarget, public Bt656If {
 public:
  using Params = VpssParams;
  sc_core::sc_export<Bt656If> video{"video"};
  BurstMaster memory;                           ///< bind memory.socket
  sc_core::sc_vector<Pulse> vdint{"vdint", 3};  ///< bind vdint[i].out
  sc_core::sc_in<bool> psc_enabled{"psc_enabled"}, gate{"gate"};
  sc_core::sc_in<bool> owns_write_buffer{"owns_write_buffer"};  ///< BCR.SRC_SEL_WB; latched
                                                                ///< together with WEN
  CaptureStats stats;
  /// Called at the first captured line of a frame, which is on the wire from now on: a little before its first
  /// captured sample.
  std::function<void(const CaptureFrame&)> on_frame_start;
  /// Called when all data of a frame are in memory.
  std::function<void(const CaptureFrame&)> on_frame_end;

  SC_HAS_PROCESS(Isif);
  Isif(sc_core::sc_module_name name, const VpssParams& params);

  bool begin_line(const Bt656Line& line) override;
  void take_line(std::span<const std::uint8_t> bytes) override;
  bool overflowed() const { return overflow_sticky_; }
  /// Address of the start of the last captured row; for tests.
  std::uint32_t row_address() const { return row_address_; }
  bool idle() const override { return memory.idle(); }

 protected:
  bool clocked() const override { return psc_enabled.read() && gate.read(); }

 private:
  struct Setup {
    bool write = false, interlaced = false, fiinv = false, swap = false, invert_chroma = false;
    unsigned sph = 0, bytes = 0, first_line[2] = {}, lines = 0;
    std::uint32_t address = 0, pitch = 0, sdofst = 0;
  };
  struct FieldEnd {
    std::uint64_t last_tag;
    Picoseconds due;  // time at which its last burst is issued or lost
    Picoseconds at;   // time at which all its data are in memory; kNever: unknown
    bool last;  // of its frame
    CaptureFrame frame;
  };

  void on_reset(ResetKind) override;
  void write_syncen();
  void latch(const Standard& standard);
  void begin_field(const Bt656Line& line);
  bool begin_row(const Bt656Line& line, unsigned index);
  void begin_frame();
  void issue(Picoseconds now);
  void end_field(Picoseconds due);
  void arm_end();
  void close_fields();
  void done(const BurstMaster::Completion& c);

  const VpssParams& params_;
  bool synced_ = false;  // an EAV was received
  bool f_ = false, v_ = true;
  unsigned line_ = 0;   // 0: no VD so far
  bool field_ = false;  // true: second field (FIPOL applied)
  Setup setup_;

  std::array<std::uint8_t, kMaxActiveBytes> row_{};
  unsigned row_bytes_ = 0, row_pos_ = 0;
  unsigned row_skipped_ = 0;  // bytes of its line before its first one
  std::uint32_t row_address_ = 0;
  int row_offset_ = 0;  // in rows from the start of the buffer
  std::uint64_t row_first_sample_ = 0;
  const Clock* row_clock_ = nullptr;
  bool first_row_ = false, last_row_ = false;  // of its field
  Timer end_timer_;

  std::uint64_t tag_ = 0, done_tag_ = 0;
  std::uint64_t reset_tag_ = 0;  // bursts up to this one were issued before the last reset
  Picoseconds done_at_ = 0;
  bool overflow_sticky_ = false;

  std::uint64_t frame_index_ = 0;
  bool frame_open_ = false;
  CaptureFrame frame_;
  std::deque<FieldEnd> ends_;
};

}  // namespace fovea::video
