#include "model/board/board.h"

#include <algorithm>

namespace fovea::board {
namespace {

/// A black picture, for a decoder to which no camera is connected.
class NoPicture : public video::PictureSource {
 public:
  unsigned width() const override { return black_.width; }
  unsigned height() const override { return black_.height; }
  const video::Picture& field(std::uint64_t) override { return black_; }

 private:
  const video::Picture black_{720, 480};
};

/// What lies on the asynchronous memory interface.
soc::Placements external_devices(const DevicesParams& devices) {
  if (!devices.cpld()) return {};
  return {soc::place<EvmCpld>({"cpld", "CPLD of the EVM", 0x0400'0000, EvmCpld::kBytes,
                               bus::ConfigBus::Speed::kSlow},
                              std::cref(devices))};
}

}  // namespace

std::vector<video::CameraWiring> Board::wiring(const BoardParams& params,
                                               const std::vector<video::PictureSource*>& sources) {
  FOVEA_CHECK(sources.size() == params.input_count(), "a source for each signal");
  std::vector<video::CameraWiring> out;
  for (unsigned n = 0; n < sources.size(); ++n) {
    out.push_back(params.camera_setup(n).wiring);
    out.back().source = sources[n];
    if (!params.video.format().digital) continue;
    static NoPicture none;
    out.back().source = &none;
    out.back().connected = false;
  }
  return out;
}

Board::Board(sc_core::sc_module_name name, const BoardParams& params,
             const std::vector<video::PictureSource*>& sources, std::uint32_t entry, bool strict)
    : sc_module(name),
      dm365("dm365", params.soc, entry, strict, external_devices(params.devices)),
      decoder("tvp5146", params.decoder, wiring(params, sources)),
      params_(params),
      wanted_(params.run.frames()) {
  dm365.osc(osc_);
  if (params.clocks.crossbar() != 0) dm365.clocks.set_crossbar(Frequency(params.clocks.crossbar()));
  dm365.display.bind(sink.lines);
  decoder.clock(decoder_clk_);
  if (const video::Standard* raster = params.video.format().digital) {
    digital = std::make_unique<video::DigitalCamera>("digital_camera", *raster, *sources.front(),
                                                     params.decoder.phase());
    digital_clk_.write(params.video.digital_clock());
    digital->clock(digital_clk_);
    digital->video.bind(dm365.isif.video);
    decoder.video.bind(no_receiver_);
  } else {
    decoder.video.bind(dm365.isif.video);
  }
  dm365.i2c.targets.bind(decoder.i2c);
  if (params.multiplexed()) place_multiplexer();
  if (!params.fault.kind.is("none"))
    fault_ = std::make_unique<CameraFault>(
        "camera_fault", params.fault,
        params.camera_setup(static_cast<unsigned>(params.fault.camera())).wiring, decoder, multiplexer.get());
  set_switches();
  platform.add(dm365.platform);
  platform.add("display", sink);

  dm365.on_reset_request = [this](const std::string& cause) { reset_asked(cause); };
  boot_ = dm365.observe_boot([this](ResetKind) {
    for (const LoadImage& image : boot_images_) put(image, false);
  });
  dm365.uart0.sink = [this](std::uint8_t byte, Picoseconds) {
    uart_.push_back(static_cast<char>(byte));
    uart_observers_.each([byte](const UartObserver& f) { f(byte); });
  };
  pins_ = dm365.gpio.observe_outputs([this](unsigned bank, std::uint32_t out, Picoseconds at) {
    if (bank == MULTIPLEXER_BANK && multiplexer) multiplexer->select(MULTIPLEXER_CHANNEL(out));
    if (bank != PHASE_BANK) return;
    log.pins(out, at);
    phase_observers_.each([&](const PhaseObserver& f) { f(log.phase(), at); });
  });
  dm365.isif.on_frame_start = [this](const video::CaptureFrame& f) { capture_begins(f); };
  dm365.isif.on_frame_end = [this](const video::CaptureFrame& f) { capture_ends(f); };
  dm365.osd.on_latch = [this](const video::Osd::Latch& l) {
    sink.latched(l);
    latched(l);
  };
  dm365.osd.on_late = [this](unsigned bursts) { sink.late(bursts); };
  if (!params.video.format().is_625) sink.assembler.rows_525 = params.raster_height();
  sink.on_frame = [this](video::Frame& f) { frame_shown(f); };
}

void Board::reset_asked(const std::string& cause) {
  if (chip_reset_) return;
  const ChipReset request{cause, kernel_time(), dm365.arm.core().current_pc()};
  if (resets_.size() < params_.run.resets()) {
    resets_.push_back(request);
    return reset(ResetKind::kWatchdog);
  }
  chip_reset_ = request;
  reset_observers_.each([this](const ResetObserver& f) { f(*chip_reset_); });
  sc_core::sc_pause();
}

void Board::reset(ResetKind kind) {
  log.restart();
  dm365.reset_chip(kind);
}

/// All cameras are on the same input of the decoder, but the multiplexer leads only one of them there.
void Board::place_multiplexer() {
  multiplexer = std::make_unique<AnalogueMultiplexer>([this](unsigned channel) { decoder.route(channel); });
  decoder.route(multiplexer->channel());
}

void Board::set_switches() {
  const VideoParams& v = params_.video;
  const std::uint32_t standard = v.format().is_625 ? SWITCH_PAL : SWITCH_NTSC;
  const bool of_page = v.width() || v.height();
  const std::uint32_t shown = of_page ? std::uint32_t{SWITCH_SIZE_OF_PAGE} : v.format().size_code;
  const std::uint32_t captured = v.format().digital ? v.format().camera_size_code : shown;
  // One switch cannot tell the lenses of several cameras: then the page does.
  const std::uint32_t mapping =
      params_.camera_count() > 1
          ? 0
          : contract::code_of(contract::kMappings, params_.camera_setup(0).lens->mapping()) + 1;
  const std::uint32_t pins =
      SWITCH_PUT(SWITCH_STANDARD_IN, standard) | SWITCH_PUT(SWITCH_STANDARD_OUT, standard) |
      SWITCH_PUT(SWITCH_SIZE_IN, captured) | SWITCH_PUT(SWITCH_SIZE_OUT, shown) |
      SWITCH_PUT(SWITCH_MAPPING, mapping) |
      SWITCH_PUT(SWITCH_SHIFT_X, SwitchParams::code(params_.switches.shift_x)) |
      SWITCH_PUT(SWITCH_SHIFT_Y, SwitchParams::code(params_.switches.shift_y));
  for (unsigned pin = 0; pin < SWITCH_COUNT; ++pin) dm365.gpio.set_pin(pin, (pins >> pin & 1u) != 0);
}

void Board::load(LoadImage image) {
  put(image, true);
  boot_images_.push_back(std::move(image));
}

void Board::put(const LoadImage& image, bool zeros) {
  std::uint8_t* const to = image.address >= DDR_BASE
                               ? dm365.ddr.store().at(image.address - DDR_BASE)
                               : dm365.internal_ram.data() + (image.address & (INTERNAL_RAM_BYTES - 1));
  std::copy(image.bytes.begin(), image.bytes.end(), to);
  if (zeros) std::fill_n(to + image.bytes.size(), image.zeros, std::uint8_t{0});
}

std::vector<std::uint8_t> Board::peek(std::uint32_t address, std::size_t bytes) {
  dm365.scr.settle();
  const std::uint8_t* p = address >= DDR_BASE
                              ? dm365.ddr.store().at(address - DDR_BASE)
                              : dm365.internal_ram.data() + (address & (INTERNAL_RAM_BYTES - 1));
  return {p, p + bytes};
}

/// The window opens with the first displayed frame that the firmware has flipped to, and closes
/// when the last wanted one is out, which is the instant the next one begins.
void Board::latched(const video::Osd::Latch& latch) {
  const bool shows = latch.window && log.latch(latch.address, latch.time);
  if (latch.f) return;  // frames begin with the first field
  if (!digital) log.decoder(decoder.synced_at());
  if (shows && !window_start_ && !opening_) {
    opening_ = true;
    dm365.end_of_instant.at(kernel_time(), InstantRank::kObservers, [this] {
      dm365.scr.settle();
      dm365.ddr.settle(kernel_time());
      window_start_ = whole_until_ = kernel_time();
      window_observers_.each([](const WindowObserver& f) { f(true); });
    });
  } else if (window_open()) {
    whole_until_ = kernel_time();
    if (wanted_ && frames_in_window_ >= wanted_) close_window(kernel_time());
  }
}

void Board::measure_whole_run() {
  window_start_ = whole_until_ = 0;
  opening_ = true;
  wanted_ = 0;
}

void Board::close_window(Picoseconds at) {
  if (window_end_) return;
  dm365.end_of_instant.at(at, InstantRank::kObservers, [this] { close_window_now(); });
}

void Board::close_window_now() {
  if (window_end_) return;
  dm365.scr.settle();
  dm365.ddr.settle(kernel_time());
  if (!window_start_) window_start_ = whole_until_ = 0;
  window_end_ = kernel_time();
  const video::Standard& display = video::standard_of(params_.video.format().is_625);
  log.finish(kernel_time(), 2 * Clock(display.clock).periods(display.frame_bytes()));
  window_observers_.each([](const WindowObserver& f) { f(false); });
}

/// The capture knows no cameras: whose picture a frame begins with is asked of the decoder when it begins.
void Board::capture_begins(const video::CaptureFrame& frame) {
  constexpr std::size_t kMost = 8;  // those that begin and never end do not pile up
  if (begun_.size() == kMost) begun_.erase(begun_.begin());
  begun_.push_back({frame.start, digital ? 0 : decoder.on_wire().camera});
}

void Board::capture_ends(const video::CaptureFrame& frame) {
  std::erase_if(begun_, [&](const Begun& b) { return b.start < frame.start; });
  const bool known = !begun_.empty() && begun_.front().start == frame.start;
  if (frame.complete)
    log.capture(frame.index, frame.start, frame.end, known ? begun_.front().camera : video::kNoCamera);
}

void Board::frame_shown(video::Frame& frame) {
  if (!window_open() || frame.times.display_start < *window_start_) return;
  frame.times = log.shown(frame.times.display_start, frame.times.display_end);
  ++frames_in_window_;
  frame_observers_.each([&frame](const FrameObserver& f) { f(frame); });
  forget_old_frames();
}

/// A long run keeps its latest frames one by one and of all others their sums.
void Board::forget_old_frames() {
  constexpr std::size_t kKept = 256;
  struct Old {
    Board& board;
    void operator()(const video::FrameTimes& r) { board.old_.add(r, true); }
    void operator()(const FrameLog::Remap& m) {
      if (board.in_window(m.end)) board.old_.add(m);
    }
    void operator()(Picoseconds captured) { board.old_.stats.captured += board.in_window(captured); }
  };
  log.forget(kKept, Old{*this});
}

void FrameSums::add(const video::FrameTimes& r, bool whole) {
  ++stats.displayed;
  if (r.repeated || !r.captured) {
    ++stats.repeated;
    stats.repeated_relock += r.relock;
    return;
  }
  fresh += whole;
  if (r.camera != video::kNoCamera) {
    if (cameras.size() <= r.camera) cameras.resize(r.camera + 1);
    cameras[r.camera].add(r, whole);
  }
  stats.dropped += r.dropped;
  if (!r.capture_start) return;
  const Picoseconds t = r.display_start - *r.capture_start;
  stats.latency_min = stats.latencies ? std::min(stats.latency_min, t) : t;
  stats.latency_max = std::max(stats.latency_max, t);
  latency += static_cast<double>(t);
  ++stats.latencies;
}

void CameraSums::add(const video::FrameTimes& r, bool whole) {
  fresh += whole;
  if (!r.capture_start) return;
  const Picoseconds t = r.display_start - *r.capture_start;
  latency_min = latencies ? std::min(latency_min, t) : t;
  latency_max = std::max(latency_max, t);
  latency += static_cast<double>(t);
  ++latencies;
}

void FrameSums::add(const FrameLog::Remap& m) {
  const Picoseconds t = m.end - m.start;
  stats.remap_min = stats.remaps ? std::min(stats.remap_min, t) : t;
  stats.remap_max = std::max(stats.remap_max, t);
  remap += static_cast<double>(t);
  ++stats.remaps;
}

std::vector<CameraFrameStats> Board::camera_stats() const {
  FrameSums sums = old_;
  for (const video::FrameTimes& r : log.records()) sums.add(r, r.display_start < whole_until_);
  sums.cameras.resize(params_.input_count());
  std::vector<CameraFrameStats> out(params_.input_count());
  for (std::size_t n = 0; n < out.size(); ++n) {
    const CameraSums& of = sums.cameras[n];
    const FrameLog::Fates& fates = log.fates(n);
    CameraFrameStats& s = out[n];
    s.displayed = fates.displayed;
    s.superseded = fates.superseded;
    s.dropped = fates.dropped;
    s.captured = fates.captured;
    s.pending = fates.pending;
    if (window_start_ && whole_until_ > *window_start_)
      s.rate = static_cast<double>(of.fresh) /
               (static_cast<double>(whole_until_ - *window_start_) * 1e-12);
    s.latency_min = of.latency_min;
    s.latency_max = of.latency_max;
    s.latency_mean = of.latencies ? of.latency / static_cast<double>(of.latencies) : 0;
  }
  return out;
}

FrameStats Board::frame_stats() const {
  if (!window_start_) return {};
  const Picoseconds from = *window_start_;
  const Picoseconds to = window_end_ ? *window_end_ : kernel_time();
  FrameSums sums = old_;
  for (const video::FrameTimes& r : log.records()) sums.add(r, r.display_start < whole_until_);
  for (const auto& m : log.remaps())
    if (m.end > from && m.end <= to) sums.add(m);
  FrameStats& s = sums.stats;
  for (Picoseconds t : log.captures()) s.captured += t > from && t <= to;
  s.remapped = s.remaps;
  s.dropped += log.never_shown();
  s.window = static_cast<double>(to - from) * 1e-12;
  if (to > from) s.remap_rate = static_cast<double>(s.remaps) / s.window;
  if (whole_until_ > from)
    s.rate = static_cast<double>(sums.fresh) / (static_cast<double>(whole_until_ - from) * 1e-12);
  s.latency_mean = s.latencies ? sums.latency / static_cast<double>(s.latencies) : 0;
  s.remap_mean = s.remaps ? sums.remap / static_cast<double>(s.remaps) : 0;
  return s;
}

}  // namespace fovea::board
