// Image sensor interface: BT.656 capture to memory.
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
#include "model/video/pulse.h"
#include "model/video/wire.h"

namespace fovea::video {

struct CaptureStats : StatGroup {
  Counter frames{*this, "frames", "count", "frames captured: both fields, first one first"};
  Counter fields{*this, "fields", "count", "fields captured"};
  Counter bursts{*this, "bursts", "count", "bursts of captured data handed to memory"};
  Counter overflows{*this, "overflows", "count",
                    "bursts lost because the write buffer had no free place"};
  Counter corrected_codes{*this, "corrected_codes", "count",
                          "timing codes with one wrong bit, corrected"};
  Counter bad_codes{*this, "bad_codes", "count", "timing codes beyond correction"};
  CaptureStats() : StatGroup("capture") {}
};

/// A captured frame, for the board's bookkeeping.
struct CaptureFrame {
  std::uint64_t index = 0;  ///< complete frames before it since SYNCEN.VDHDEN was set
  bool complete = false;    ///< false: only the second field was captured
  Picoseconds start = 0;    ///< first captured sample is on the wire
  Picoseconds end = 0;      ///< last sample's data are in memory (write acknowledged)
  std::array<std::uint32_t, 2> address{};       ///< buffer address by field
  std::array<std::uint64_t, 2> source_field{};  ///< the camera's field number by field
  std::uint64_t overflows = 0;                  ///< bursts lost in it
};

/// ISIF with 8-bit BT.656 input. Line counting: VD is the EAV where V falls; that line is line 1
/// (Linux starts capture of a full picture at line 1), lines count on through the blanking.
/// VDINTn fires at the EAV of line n, and with VD for 0. Settings latch at VD when VDLC = 0.
/// Data goes out in bursts when their last byte has arrived, i.e. one byte clock after it came on
/// the wire. At most `vpss.write_buffer_bursts` bursts wait for memory; a place freed at a time
/// serves bursts strictly later. On overflow the burst is lost, a sticky flag (model only: no
/// public register) is set and capture goes on. Not modelled: raw and 16-bit input, culling,
/// filters, formatter, own HD/VD.
class Isif : public BusTarget, public Bt656If {
 public:
  using Params = VpssParams;
  sc_core::sc_export<Bt656If> video{"video"};
  BurstMaster memory;                           ///< bind memory.socket
  sc_core::sc_vector<Pulse> vdint{"vdint", 3};  ///< bind vdint[i].out
  sc_core::sc_in<bool> psc_enabled{"psc_enabled"}, gate{"gate"};
  sc_core::sc_in<bool> owns_write_buffer{"owns_write_buffer"};  ///< BCR.SRC_SEL_WB; taken with WEN
  IsifRegs regs;
  CaptureStats stats;
  /// Called at the first line of a frame (its start is the first sample's time, a little later).
  std::function<void(const CaptureFrame&)> on_frame_start;
  /// Called when the last data of a frame are in memory.
  std::function<void(const CaptureFrame&)> on_frame_end;

  SC_HAS_PROCESS(Isif);
  Isif(sc_core::sc_module_name name, const VpssParams& params);

  void line(const Bt656Line& line) override;
  bool overflowed() const { return overflow_sticky_; }
  /// Row-start address of the row captured last; for tests.
  std::uint32_t row_address() const { return row_address_; }

 protected:
  bool clocked() const override { return psc_enabled.read() && gate.read(); }

 private:
  struct Setup {
    bool write = false, interlaced = false, fiinv = false, swap = false, invert_chroma = false;
    unsigned sph = 0, bytes = 0, first_line[2] = {}, lines = 0;
    std::uint32_t address = 0, pitch = 0;
  };
  struct FieldEnd {
    std::uint64_t last_tag;
    Picoseconds due;  // its last burst leaves, or is lost
    Picoseconds at;   // all its data are in memory; kNever: not known
    bool second;
    CaptureFrame frame;
  };

  void write_syncen();
  void latch();
  void begin_field(const Bt656Line& line);
  void begin_row(const Bt656Line& line, unsigned index);
  void issue(Picoseconds now);
  void end_field(Picoseconds due);
  void arm_end();
  void close_fields();
  void done(const BurstMaster::Completion& c);

  const VpssParams& params_;
  bool synced_ = false;  // an EAV was seen
  bool f_ = false, v_ = true;
  unsigned line_ = 0;   // 0: no VD yet
  bool field_ = false;  // second field, after FIPOL
  Setup setup_;

  std::array<std::uint8_t, kActiveBytes> row_{};
  unsigned row_bytes_ = 0, row_pos_ = 0;
  std::uint32_t row_address_ = 0;
  int row_offset_ = 0;  // rows from the buffer's start
  std::uint64_t row_first_sample_ = 0;
  const Clock* row_clock_ = nullptr;
  bool last_row_ = false;
  Timer end_timer_;

  std::uint64_t tag_ = 0, done_tag_ = 0;
  Picoseconds done_at_ = 0;
  bool overflow_sticky_ = false;

  std::uint64_t frame_index_ = 0;
  bool frame_open_ = false;
  CaptureFrame frame_;
  std::deque<FieldEnd> ends_;
};

}  // namespace fovea::video
