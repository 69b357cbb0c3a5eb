// The board: DM365, SDRAM, decoder and cameras, monitor, DIP switches, and what a loader puts into
// memory before the core starts.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <systemc>
#include <vector>

#include "model/board/analogue_multiplexer.h"
#include "model/board/board_params.h"
#include "model/board/evm_cpld.h"
#include "model/board/frame_log.h"
#include "model/common/observers.h"
#include "model/soc/dm365.h"
#include "model/video/digital_camera.h"
#include "model/video/display_sink.h"
#include "model/video/tvp5146.h"

namespace fovea::board {

/// A piece of memory to be filled before the start, and again when the chip boots after a reset.
struct LoadImage {
  std::uint32_t address = 0;
  std::vector<std::uint8_t> bytes;
  /// Bytes behind them that are 0 at the start. A boot loader reads them from no medium: after a reset
  /// they are as the program left them.
  std::size_t zeros = 0;
};

/// Statistics of the measured window that come from the frame log.
struct FrameStats {
  /// New frames of the whole display frames from the window's start, over their time; nothing if no
  /// display frame was out. A complete window holds whole frames only.
  std::optional<double> rate;
  double window = 0;
  std::uint64_t captured = 0, remapped = 0, displayed = 0, dropped = 0, repeated = 0;
  std::uint64_t repeated_relock = 0;  ///< of the repeated ones, those for which the decoder had to find the syncs
  Picoseconds latency_min = 0, latency_max = 0, remap_min = 0, remap_max = 0;
  double latency_mean = 0, remap_mean = 0;  // ps
  double remap_rate = 0;  ///< 1/s; remaps that ended in the window / `window`
  std::uint64_t latencies = 0, remaps = 0;
};

/// The frames of one camera, from the first one that is shown in the window on: each captured frame was shown, or
/// replaced on its way to the display by a newer one, or dropped. Those younger than two frame periods at the window's
/// end have no fate yet: they are pending.
struct CameraFrameStats {
  std::uint64_t captured = 0, displayed = 0;
  std::uint64_t superseded = 0;  ///< corrected, but a newer frame was shown instead
  std::uint64_t dropped = 0;     ///< not corrected
  std::uint64_t pending = 0;     ///< captured shortly before the window's end, and not shown by then; not in `captured`
  std::optional<double> rate;    ///< 1/s; of frames shown
  Picoseconds latency_min = 0, latency_max = 0;
  double latency_mean = 0;  // ps
};

/// A request of the chip to be reset.
struct ChipReset {
  std::string cause;  ///< for people
  Picoseconds at = 0;
  std::uint32_t pc = 0;  ///< of the core at that instant
};

/// What the records of shown frames say of one camera.
struct CameraSums {
  std::uint64_t fresh = 0, latencies = 0;
  Picoseconds latency_min = 0, latency_max = 0;
  double latency = 0;
  void add(const video::FrameTimes& frame, bool whole);
};

/// FrameStats in the making: the sums over the entries of the frame log.
struct FrameSums {
  FrameStats stats;
  std::uint64_t fresh = 0;
  double latency = 0, remap = 0;
  std::vector<CameraSums> cameras;
  /// `whole`: its display frame was out before the window's end.
  void add(const video::FrameTimes& frame, bool whole);
  void add(const FrameLog::Remap& remap);
};

class Board : public sc_core::sc_module {
 public:
  /// @param sources what each camera sees, input_count() of them
  /// @param entry first instruction; stands in for the ROM boot loader
  Board(sc_core::sc_module_name name, const BoardParams& params,
        const std::vector<video::PictureSource*>& sources, std::uint32_t entry, bool strict);
  Board(sc_core::sc_module_name name, const BoardParams& params, video::PictureSource& source,
        std::uint32_t entry, bool strict)
      : Board(name, params, std::vector<video::PictureSource*>{&source}, entry, strict) {}

  /// Puts bytes into internal RAM (0 or 0x10000) or SDRAM, now and at every boot after a reset. The
  /// caller has checked the address.
  void load(LoadImage image);
  /// Reads memory as the bus sees it now (not through the caches).
  std::vector<std::uint8_t> peek(std::uint32_t address, std::size_t bytes);

  /// Called for each frame shown inside the window, in order. Its index counts those frames.
  using FrameObserver = std::function<void(const video::Frame&)>;
  Subscription observe_frames(FrameObserver observer) { return frame_observers_.add(std::move(observer)); }
  /// Called at each change of the pins that show the phase, also if the phase stays.
  using PhaseObserver = std::function<void(Phase, Picoseconds at)>;
  Subscription observe_phases(PhaseObserver observer) { return phase_observers_.add(std::move(observer)); }
  /// Called for each byte that UART0 has sent, at its last stop bit.
  using UartObserver = std::function<void(std::uint8_t)>;
  Subscription observe_uart(UartObserver observer) { return uart_observers_.add(std::move(observer)); }
  /// Called when the window opens and when it closes (end-of-instant phase: everything of that instant has
  /// happened).
  using WindowObserver = std::function<void(bool open)>;
  Subscription observe_window(WindowObserver observer) { return window_observers_.add(std::move(observer)); }

  /// The chip's first request to be reset that is not carried out (`run.resets`). The simulation pauses
  /// at its instant, and the program around it ends the run there.
  const std::optional<ChipReset>& chip_reset() const { return chip_reset_; }
  /// Called at that instant, before the pause.
  using ResetObserver = std::function<void(const ChipReset&)>;
  Subscription observe_chip_reset(ResetObserver observer) { return reset_observers_.add(std::move(observer)); }
  /// The requests that were carried out: the chip has booted again.
  const std::vector<ChipReset>& resets() const { return resets_; }
  /// Resets the chip from outside.
  void reset(ResetKind kind);

  bool window_open() const { return window_start_.has_value() && !window_end_; }
  std::optional<Picoseconds> window_start() const { return window_start_; }
  std::optional<Picoseconds> window_end() const { return window_end_; }
  /// The window is the whole run: open from power-up, closed by close_window() only. Before the
  /// simulation starts.
  void measure_whole_run();
  /// Ends the window at `at` instead of at its last frame (a run that is stopped). A window that
  /// was not yet open is the whole run so far. Masters may have
  /// worked ahead of the present time, so `at` must lie beyond the next kernel event.
  void close_window(Picoseconds at);
  /// Ends the window here, with the simulation over: without an end-of-instant phase.
  void close_window_now();
  FrameStats frame_stats() const;
  /// Of each camera, in order; `rate` and latencies are those of its own frames.
  std::vector<CameraFrameStats> camera_stats() const;
  std::uint64_t frames_in_window() const { return frames_in_window_; }
  const std::string& uart_text() const { return uart_; }

  FrameLog log;
  soc::Dm365 dm365;
  video::Tvp5146 decoder;  ///< with a camera at the digital port: without cameras, and its output is not connected
  std::unique_ptr<video::DigitalCamera> digital;  ///< null: the cameras are the decoder's
  std::unique_ptr<AnalogueMultiplexer> multiplexer;  ///< null: the decoder's inputs are the cameras' multiplexer
  video::DisplaySink sink{"sink"};
  Platform platform;              ///< all blocks of the board, those of the chip included

 private:
  std::unique_ptr<CameraFault> fault_;  // none: no fault is wanted
  void reset_asked(const std::string& cause);
  void put(const LoadImage& image, bool zeros);
  static std::vector<video::CameraWiring> wiring(const BoardParams& params,
                                                 const std::vector<video::PictureSource*>& sources);
  void place_multiplexer();
  void set_switches();
  void latched(const video::Osd::Latch& latch);
  void capture_begins(const video::CaptureFrame& frame);
  void capture_ends(const video::CaptureFrame& frame);
  void frame_shown(video::Frame& frame);
  void forget_old_frames();
  bool in_window(Picoseconds t) const {
    return t > *window_start_ && (!window_end_ || t <= *window_end_);
  }

  const BoardParams& params_;
  ClockSignal osc_{"osc", Frequency(24'000'000)};
  ClockSignal decoder_clk_{"decoder_clk", Frequency(27'000'000)};
  ClockSignal digital_clk_{"digital_clk"};
  struct NoReceiver : video::Bt656If {
    bool begin_line(const video::Bt656Line&) override { return false; }
    void take_line(std::span<const std::uint8_t>) override {}
  } no_receiver_;
  std::string uart_;
  Observers<UartObserver> uart_observers_;
  Observers<FrameObserver> frame_observers_;
  Observers<PhaseObserver> phase_observers_;
  Observers<WindowObserver> window_observers_;
  Observers<ResetObserver> reset_observers_;
  std::uint64_t wanted_;  // frames; 0: the window does not end with a frame
  std::uint64_t frames_in_window_ = 0;
  bool opening_ = false;
  struct Begun {
    Picoseconds start;
    unsigned camera;
  };
  std::vector<Begun> begun_;  ///< the latest captures whose end has not come
  std::optional<ChipReset> chip_reset_;
  std::vector<ChipReset> resets_;
  std::vector<LoadImage> boot_images_;
  std::optional<Picoseconds> window_start_, window_end_;
  Subscription pins_, boot_;
  Picoseconds whole_until_ = 0;  ///< start of the latest display frame in the window
  FrameSums old_;            ///< of what the log has forgotten
};

}  // namespace fovea::board
