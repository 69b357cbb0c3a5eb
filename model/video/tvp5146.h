// Camera and TVP5146 video decoder: takes pictures from a source, sends BT.656, has I2C registers.
#pragma once
#include <array>
#include <systemc>

#include "model/common/sc_ports.h"
#include "model/common/timer.h"
#include "model/video/core/picture.h"
#include "model/video/params.h"
#include "model/video/wire.h"

namespace fovea::video {

/// The analogue camera and the decoder behind it, as one block. The camera runs from power-up (time
/// 0 plus `phase`): field k begins k field periods later, whatever the decoder does. While its
/// outputs are enabled, the decoder announces every line at its first sample.
///
/// Registers: a subset of TI SLES084C. STATUS1 bit 4 (lost lock) stays set until a 1 is written to
/// bit 0 of CLEAR_LOST_LOCK. While the decoder is not locked (after power-up, after a change of
/// register 00 or 02, or with the wrong standard in 02), it sends the same raster with black
/// pictures (assumed). Not modelled: picture controls (kept, without effect), the two low bits of
/// the 10-bit output, square pixels, VBI data, the time that the I2C patch takes.
class Tvp5146 : public sc_core::sc_module, public I2cTargetIf, private Bt656Renderer {
 public:
  ClockIn clock{"clock"};  ///< byte clock, nominally 27 MHz
  sc_core::sc_port<Bt656If> video{"video"};
  sc_core::sc_export<I2cTargetIf> i2c{"i2c"};

  SC_HAS_PROCESS(Tvp5146);
  Tvp5146(sc_core::sc_module_name name, const Tvp5146Params& params, PictureSource& source);

  bool i2c_start(std::uint8_t address7, bool read) override;
  bool i2c_write(std::uint8_t byte) override;
  std::uint8_t i2c_read() override;
  void i2c_stop() override {}

  const Standard& standard() const { return standard_; }
  const Placement& placement() const { return placement_; }
  /// Start of the camera's field k (its first line). k must not be before the last change of the
  /// clock, and the simulation must have started.
  Picoseconds field_time(std::uint64_t k) const;
  /// First field from which the decoder is locked, provided that register 02 holds the right
  /// standard.
  std::uint64_t locked_from_field() const { return locked_from_; }
  std::uint64_t lines_sent() const { return lines_sent_; }

 private:
  std::span<const std::uint8_t> render() override;
  void clock_changed();
  void send_line();
  void schedule();
  bool enabled() const;
  bool standard_ok() const;
  /// Lock state as in the status registers: powered up and locked.
  bool lock() const { return started_ && (regs_[3] & 1) == 0 && locked(present_field()); }
  bool locked(std::uint64_t field) const { return standard_ok() && field >= locked_from_; }
  std::uint64_t present_field() const;
  void write_register(std::uint8_t index, std::uint8_t value);
  std::uint8_t read_register(std::uint8_t index) const;
  void relock();

  const Tvp5146Params& params_;
  PictureSource& source_;
  const Standard& standard_;
  const Placement& placement_;
  Clock clock_;
  std::uint64_t origin_ = 0;  // clock edge at which line 0 begins
  bool started_ = false;
  bool lost_lock_ = false;           // a lock was lost since the bit was last cleared
  std::uint64_t next_line_ = 0;      // index of the next line to announce
  std::uint64_t stopped_field_ = 0;  // the camera's field at the time the clock stopped
  std::uint64_t locked_from_;
  std::uint64_t lines_sent_ = 0;
  Timer line_timer_;

  std::array<std::uint8_t, 256> regs_{};
  std::uint8_t pointer_ = 0;
  bool expect_pointer_ = false;

  const Picture* picture_ = nullptr;  // picture of field picture_field_; requested from the source
                                      // once per field
  std::uint64_t picture_field_ = 0;
  LinePosition position_{};
  Standard::Lines fv_{};
  std::array<std::uint8_t, kActiveBytes> row_{};
  std::array<std::uint8_t, kMaxLineBytes> bytes_{};
};

}  // namespace fovea::video
