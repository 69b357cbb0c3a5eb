// Camera and TVP5146 video decoder: takes pictures from a source, sends BT.656, has I2C registers.
#pragma once
#include <array>
#include <optional>
#include <systemc>
#include <vector>

#include "model/common/check.h"
#include "model/common/sc_ports.h"
#include "model/common/timer.h"
#include "model/video/camera_signal.h"
#include "model/video/core/picture.h"
#include "model/video/params.h"
#include "model/video/wire.h"

namespace fovea::video {

/// Rows and lines of a standard as the parameters place them.
Placement placement_of(const Tvp5146Params& params, bool is_625);

/// The cameras and the decoder behind them, as one block. Each camera runs from power-up (time 0
/// plus its phase): its field k begins k field periods later, whatever the decoder does. While its
/// outputs are enabled, the decoder announces every line at its first sample.
///
/// Registers: a subset of TI SLES084C. Register 00 selects an input; where no camera is, there is no
/// signal (STATUS2 bit 7 = 0). STATUS1 bit 4 (lost lock) stays set until a 1 is written to bit 0 of
/// CLEAR_LOST_LOCK. While the decoder is not locked (after power-up, after a change of register 00
/// or 02, without a signal, or with the wrong standard in 02), it sends black pictures or noise in the raster
/// of the selected camera or, without a signal, in that of the last one (assumed). Bits 3 and 2 of register 34
/// (black screen; place and codes assumed) decide: 0 what `unlocked_output` says, 1 black, and 2 or 3 black also while
/// it is locked. The raster changes between two lines: the line on the wire is completed, and the new raster goes on
/// with its next whole line. A 1 in bit 0 of STATUS_REQUEST (97) captures the number of lines of the frame before
/// into 9A and 9B (low and high part), and the bit is 0 again when that is done. What is counted are the lines that
/// are sent, from one start of a first field to the next, also across a change of the input. Not modelled, with a
/// warning (tvp5146_settings.h): picture controls, other output formats than BT.656, square pixels. Not modelled: the
/// two low bits of the 10-bit output, VBI data, the time that the I2C patch takes.
class Tvp5146 : public sc_core::sc_module, public I2cTargetIf {
 public:
  ClockIn clock{"clock"};  ///< byte clock, nominally 27 MHz
  sc_core::sc_port<Bt656If> video{"video"};
  sc_core::sc_export<I2cTargetIf> i2c{"i2c"};

  SC_HAS_PROCESS(Tvp5146);
  /// @param cameras at least one; the first one's raster is sent until another one is selected
  Tvp5146(sc_core::sc_module_name name, const Tvp5146Params& params,
          const std::vector<CameraWiring>& cameras);
  /// One camera on the input that is selected at reset (00).
  Tvp5146(sc_core::sc_module_name name, const Tvp5146Params& params, PictureSource& source);

  bool i2c_start(std::uint8_t address7, bool read) override;
  bool i2c_write(std::uint8_t byte) override;
  std::uint8_t i2c_read() override;
  void i2c_stop() override {}

  /// Plugs or unplugs the cable of a camera, now.
  void connect(std::size_t camera, bool connected);
  /// An external multiplexer leads this camera to its input from now on, and no other one; none, if there is no such
  /// camera. What the decoder sees is what it would see after a change of register 00.
  void route(std::size_t camera);
  /// From its next line on the camera sends another standard, which has to be locked to.
  void set_standard(std::size_t camera, bool is_625);
  /// From its next line on the camera's clock is so many parts per million off; the line-locked decoder
  /// follows, and its lock holds.
  void set_clock_offset(std::size_t camera, double ppm);
  /// From its next line on the camera's lines are faulty in this way. The lock holds (assumed): the ISIF,
  /// and with it the firmware, gets what comes.
  void disturb(std::size_t camera, const SignalFault& fault) { cameras_.at(camera).fault = fault; }

  const Standard& standard() const { return raster().standard(); }
  const Placement& placement() const { return raster().placement(); }
  const std::vector<CameraSignal>& cameras() const { return cameras_; }
  /// Start of field k (its first line) of the camera whose raster is sent. k must not be before the
  /// last change of the clock, and the simulation must have started.
  Picoseconds field_time(std::uint64_t k) const { return raster().field_time(k); }
  /// First field of the selected camera from which the decoder is locked, provided that register 02
  /// holds the right standard; kNever without a signal.
  std::uint64_t locked_from_field() const { return locked_from_; }
  /// When it had found the present syncs: now, if it is not locked. Another camera's syncs have to be found too, in no
  /// time with relock_fields = 0, unless they are in step with those before. 0: it has been locked from the start.
  Picoseconds synced_at() const { return lock() ? synced_at_ : kernel_time(); }
  std::uint64_t lines_sent() const { return lines_sent_; }
  /// What the line shows that is on the wire. The wire does not say it: for observers.
  struct OnWire {
    unsigned camera = kNoCamera;  ///< kNoCamera: black or noise
    std::uint64_t field = 0;      ///< of the camera in whose raster it is
  };
  const OnWire& on_wire() const { return on_wire_; }

 private:
  void clock_changed();
  void send_line();
  void schedule();
  bool enabled() const;
  bool standard_ok() const;
  /// Lock state as in the status registers: powered up and locked.
  bool lock() const { return started_ && (regs_[3] & 1) == 0 && locked(present_field()); }
  bool locked(std::uint64_t field) const {
    return signal_ && standard_ok() && field >= locked_from_;
  }
  std::uint64_t present_field() const;
  void write_register(std::uint8_t index, std::uint8_t value);
  std::uint8_t read_register(std::uint8_t index) const;
  void warn(std::uint8_t index, std::uint8_t value) const;
  void relock(bool other_syncs = false);
  bool in_step(std::size_t camera, std::size_t other) const;
  void count_line(unsigned number);
  void finish_capture();

  const CameraSignal& raster() const { return cameras_[raster_]; }
  /// The camera on the selected input, if its cable is plugged in and it is led there.
  std::optional<std::size_t> selected() const;
  void change_input();
  bool sending() const { return started_ && !nominal_.stopped() && enabled(); }
  void leave_lines_out();
  const Tvp5146Params& params_;
  DiagnosticsRef diagnostics_ = DiagnosticsRef::current();
  std::vector<CameraSignal> cameras_;
  std::size_t raster_ = 0;   // the camera whose raster is sent
  bool signal_ = false;      // there is a camera on the selected input; its raster is sent
  bool lost_lock_ = false;   // a lock was lost since the bit was last cleared
  bool started_ = false;
  Frequency nominal_;
  std::uint64_t next_line_ = 0;  // index of the next line to announce
  Picoseconds line_end_ = 0;     // of the line that was announced last
  std::uint64_t locked_from_ = kNever;
  Picoseconds synced_at_ = 0;  // start of that field, if its syncs had to be found
  std::uint64_t lines_sent_ = 0;
  Timer line_timer_;

  std::optional<double> new_offset_;  // of the raster's camera, from the next line on, or when another camera follows
  std::uint64_t damaged_ = 0;         // timing codes

  unsigned lines_in_frame_ = 0;                 // sent since the last start of a first field
  std::array<unsigned, 3> counted_{};           // frames before: whole now, whole last, the one before that
  Picoseconds counted_at_ = 0;                  // when counted_[1] could be captured first
  std::optional<Picoseconds> capture_at_;       // requested, and not in registers 9A and 9B yet

  std::array<std::uint8_t, 256> regs_;
  std::uint8_t pointer_ = 0;
  bool expect_pointer_ = false;

  enum class Shows : std::uint8_t { kBlack, kNoise, kPicture };
  Shows shows(bool locked) const;
  void fill_with_noise();

  /// A line that is sent.
  struct Line {
    CameraSignal& camera;  // whose raster it is in
    LinePosition at;
    Standard::Lines fv;
    Shows shows;
    std::uint8_t wrong_bits;  // of its codes
    unsigned missing;         // samples at its end
    std::uint8_t code(bool h) const { return static_cast<std::uint8_t>(encode_xy(fv.f, fv.v, h) ^ wrong_bits); }
  };
  const std::uint8_t* active_part(const Line& line);
  std::span<const std::uint8_t> compose(const Line& line);

  OnWire on_wire_;
  std::array<std::uint8_t, kActiveBytes> row_{};
  std::array<std::uint8_t, kMaxLineBytes> bytes_{};
};

}  // namespace fovea::video
