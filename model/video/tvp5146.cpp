#include "model/video/tvp5146.h"

#include <algorithm>
#include <cstring>

#include "model/common/burst_master.h"
#include "model/common/check.h"
#include "model/video/tvp5146_settings.h"

namespace fovea::video {
namespace {

constexpr std::uint8_t kInputSelect = 0x00, kVideoStandard = 0x02, kOperationMode = 0x03,
                       kFormatter1 = 0x33, kFormatter2 = 0x34, kClearLostLock = 0x39, kStatus1 = 0x3A, kStatus2 = 0x3B,
                       kDetected = 0x3F, kRomVersion = 0x70, kIdHigh = 0x80, kIdLow = 0x81, kStatusRequest = 0x97,
                       kLineCountLow = 0x9A, kLineCountHigh = 0x9B;
constexpr std::uint8_t kFormatter2Enables = 0x11;  // enables the data and clock outputs
// Bits 3 and 2 of the same register.
constexpr unsigned kBlackScreenOff = 0, kBlackScreenUnlocked = 1;

}  // namespace

Tvp5146::Tvp5146(sc_core::sc_module_name name, const Tvp5146Params& params,
                 const std::vector<CameraWiring>& cameras)
    : sc_module(name),
      params_(params),
      cameras_(cameras.begin(), cameras.end()),
      regs_(decoder_reset_values()) {
  FOVEA_CHECK(!cameras.empty(), "a decoder needs the raster of a camera");
  if (params.output_at_reset()) regs_[kFormatter2] = kFormatter2Enables;
  change_input();
  i2c.bind(*this);
  SC_METHOD(clock_changed);
  sensitive << clock;
  SC_METHOD(send_line);
  sensitive << line_timer_.event();
  dont_initialize();
}

Tvp5146::Tvp5146(sc_core::sc_module_name name, const Tvp5146Params& params, PictureSource& source)
    : Tvp5146(name, params,
              std::vector<CameraWiring>{{.source = &source,
                                         .is_625 = params.standard.is("625/50"),
                                         .placement = placement_of(params, params.standard.is("625/50")),
                                         .phase = params.phase()}}) {}

Placement placement_of(const Tvp5146Params& params, bool is_625) {
  return is_625                              ? kPlacement625
         : params.crop_525.is("studio")    ? kPlacement525Studio
         : params.crop_525.is("486_lines") ? kPlacement525All
                                             : kPlacement525;
}

void Tvp5146::clock_changed() {
  if (started_ && clock.read() == nominal_) return;
  nominal_ = clock.read();
  for (CameraSignal& c : cameras_) c.clock_changed(nominal_, kernel_time());
  if (nominal_.stopped()) return line_timer_.cancel();
  started_ = true;
  schedule();
}

bool Tvp5146::enabled() const {
  return (regs_[kFormatter2] & kFormatter2Enables) == kFormatter2Enables &&
         (regs_[kOperationMode] & 1) == 0;
}

bool Tvp5146::standard_ok() const {
  const std::uint8_t want = regs_[kVideoStandard];
  return want == 0 || want == (&standard() == &k625 ? 2 : 1);
}

std::optional<std::size_t> Tvp5146::selected() const {
  for (std::size_t n = 0; n < cameras_.size(); ++n)
    if (cameras_[n].connected && cameras_[n].led && cameras_[n].input() == regs_[kInputSelect]) return n;
  return std::nullopt;
}

/// The signal on the selected input is another one, or there is one, or none any more.
void Tvp5146::change_input() {
  const auto now = selected();
  const bool other_raster = now && *now != raster_;
  const bool other_syncs = other_raster && started_ && !in_step(*now, raster_);
  signal_ = now.has_value();
  if (other_raster && new_offset_) cameras_[raster_].set_clock_offset(*new_offset_, kernel_time());
  if (other_raster) new_offset_.reset();
  if (other_raster) cameras_[raster_].follow_again();
  if (now) raster_ = *now;
  relock(other_syncs);
  if (!other_raster || !enabled() || !started_ || nominal_.stopped()) return;
  // What is on the wire goes on to the end of its line.
  const Clock& of = raster().clock();
  next_line_ = raster().line_from(of.edge_at_or_after(std::max(line_end_, kernel_time())));
  line_timer_.at(of.edge(raster().line_edge(next_line_)));
}

void Tvp5146::connect(std::size_t camera, bool connected) {
  const bool was_locked = lock();
  cameras_.at(camera).connected = connected;
  if (cameras_[camera].input() != regs_[kInputSelect]) return;
  change_input();
  if (was_locked && !lock()) lost_lock_ = true;
}

void Tvp5146::route(std::size_t camera) {
  const bool was_locked = lock();
  const auto before = selected();
  for (std::size_t n = 0; n < cameras_.size(); ++n) cameras_[n].led = n == camera;
  if (selected() == before) return;
  change_input();
  if (was_locked && !lock()) lost_lock_ = true;
}

void Tvp5146::set_standard(std::size_t camera, bool is_625) {
  CameraSignal& c = cameras_.at(camera);
  const bool was_locked = lock();
  const bool on_wire = camera == raster_;
  const Picoseconds from = on_wire ? std::max(line_end_, kernel_time()) : kernel_time();
  c.set_standard(is_625, placement_of(params_, is_625), c.clock().edge_at_or_after(from),
                 kernel_time());
  if (!on_wire) return;
  relock();
  if (was_locked && !lock()) lost_lock_ = true;
  if (!sending()) return;
  next_line_ = 0;
  line_timer_.at(c.clock().edge(c.line_edge(0)));
}

void Tvp5146::set_clock_offset(std::size_t camera, double ppm) {
  if (camera == raster_ && sending())
    new_offset_ = ppm;
  else
    cameras_.at(camera).set_clock_offset(ppm, kernel_time());
}

std::uint64_t Tvp5146::present_field() const { return raster().field_at(kernel_time()); }

void Tvp5146::schedule() {
  line_timer_.cancel();
  if (!started_ || nominal_.stopped() || !enabled()) return;
  // If the outputs are enabled in the middle of a line, they start with the next whole line after
  // the present time.
  const Clock& of = raster().clock();
  next_line_ = raster().line_from(of.edge_after(kernel_time()));
  line_timer_.at(of.edge(raster().line_edge(next_line_)));
}

/// The line that would be sent now is the first one that is missing: the one behind them is sent instead.
void Tvp5146::leave_lines_out() {
  CameraSignal& camera = cameras_[raster_];
  const SignalFault& fault = camera.fault;
  const LinePosition at = camera.position(next_line_);
  const Standard& s = camera.standard();
  if (!fault.lines || fault.samples || at.line != s.middle(at.field % 2)) return;
  next_line_ += fault.lines;
  camera.leave_out(std::uint64_t{fault.lines} * s.line_bytes);
}

void Tvp5146::send_line() {
  CameraSignal& camera = cameras_[raster_];
  if (new_offset_) camera.set_clock_offset(*new_offset_, kernel_time());
  new_offset_.reset();
  const Clock& of = camera.clock();
  // Its next frame would begin too early: nothing comes until the syncs that it follows do.
  if (next_line_ % camera.standard().lines == 0 && camera.follow_again())
    return line_timer_.at(of.edge(camera.line_edge(next_line_)));
  leave_lines_out();
  const SignalFault& fault = camera.fault;
  const std::uint64_t first = camera.line_edge(next_line_);
  const LinePosition at = camera.position(next_line_);
  const unsigned middle = camera.standard().middle(at.field % 2);
  const bool is_short = at.line >= middle && at.line - middle < fault.lines;
  const Line line{camera,
                  at,
                  camera.standard().at(at.line),
                  shows(locked(at.field)),
                  fault.wrong_bits && next_line_ % fault.every == 0 ? wrong_bits(fault.wrong_bits, damaged_++)
                                                                    : std::uint8_t{0},
                  is_short ? fault.samples : 0};
  if (line.missing) camera.leave_out(line.missing);
  count_line(at.line);
  on_wire_ = {line.shows == Shows::kPicture ? static_cast<unsigned>(raster_) : kNoCamera, at.field};
  ++lines_sent_;
  ++next_line_;
  line_end_ = of.edge(camera.line_edge(next_line_));
  line_timer_.at(line_end_);
  if (video->begin_line({&camera.standard(), &of, first, line.code(true)})) video->take_line(compose(line));
}

/// A line is sent. The number of lines of a frame is known some lines after its end.
void Tvp5146::count_line(unsigned number) {
  const Standard& s = raster().standard();
  if (number == s.field_start[0]) {
    counted_[0] = lines_in_frame_;
    lines_in_frame_ = 0;
  }
  if (lines_in_frame_++ != static_cast<unsigned>(params_.count_lines())) return;
  finish_capture();
  counted_[2] = counted_[1];
  counted_[1] = counted_[0];
  counted_at_ = kernel_time();
}

/// A capture that is due gets what was there before it was: no order of events at one time matters.
void Tvp5146::finish_capture() {
  if (!capture_at_ || kernel_time() <= *capture_at_) return;
  const unsigned lines = counted_at_ < *capture_at_ ? counted_[1] : counted_[2];
  regs_[kLineCountLow] = static_cast<std::uint8_t>(lines);
  regs_[kLineCountHigh] = static_cast<std::uint8_t>(lines >> 8 & 3);
  regs_[kStatusRequest] = 0;
  capture_at_.reset();
}

Tvp5146::Shows Tvp5146::shows(bool is_locked) const {
  const unsigned black = regs_[kFormatter2] >> 2 & 3;
  if (black > kBlackScreenUnlocked) return Shows::kBlack;
  if (is_locked) return Shows::kPicture;
  return black == kBlackScreenOff && params_.unlocked_output.is("noise") ? Shows::kNoise : Shows::kBlack;
}

/// Luma of the whole range, and no colour: a function of the number of lines sent.
void Tvp5146::fill_with_noise() {
  auto state = static_cast<std::uint32_t>(lines_sent_) * 0x9e37'79b1u + 1;
  for (unsigned i = 1; i < kActiveBytes; i += 2) {
    state = state * 1'664'525u + 1'013'904'223u;
    row_[i] = static_cast<std::uint8_t>(16 + (state >> 16) * 220 / 65536);
  }
}

/// Its kActiveBytes samples; null: the line is blanked.
const std::uint8_t* Tvp5146::active_part(const Line& line) {
  if (line.fv.v) return nullptr;
  static constexpr std::uint8_t kBlack[4] = {0x80, 0x10, 0x80, 0x10};
  for (unsigned i = 0; i < kActiveBytes; i += 4) std::memcpy(row_.data() + i, kBlack, 4);
  if (line.shows == Shows::kNoise) fill_with_noise();
  // A smaller picture is centred, on lines of the same field and on whole pixel pairs.
  CameraSignal& camera = line.camera;
  const int shown = camera.placement().row(line.fv.f, line.at.line);
  const int above = static_cast<int>(camera.placement().rows) - static_cast<int>(camera.height());
  const int row = shown - above / 4 * 2;  // above < 0: after a change of the standard
  if (shown >= 0 && row >= 0 && row < static_cast<int>(camera.height()) && line.shows == Shows::kPicture) {
    const Picture& picture = camera.picture(line.at.field);
    std::memcpy(row_.data() + (kActivePixels - picture.width) / 2 * 2, picture.row(static_cast<unsigned>(row)),
                picture.row_bytes());
  }
  return row_.data();
}

std::span<const std::uint8_t> Tvp5146::compose(const Line& line) {
  const Standard& s = line.camera.standard();
  const std::span<std::uint8_t> out(bytes_.data(), s.line_bytes);
  compose_line(s, line.code(true), line.code(false), active_part(line), out);
  return out.first(s.line_bytes - std::min(line.missing, s.line_bytes));
}

bool Tvp5146::i2c_start(std::uint8_t address7, bool read) {
  if (address7 != params_.i2c_address()) return false;
  expect_pointer_ = !read;
  return true;
}

bool Tvp5146::i2c_write(std::uint8_t byte) {
  if (expect_pointer_) {
    pointer_ = byte;
    expect_pointer_ = false;
  } else {
    write_register(pointer_++, byte);
  }
  return true;
}

std::uint8_t Tvp5146::i2c_read() {
  finish_capture();
  return read_register(pointer_++);
}

/// Whether both cameras' present fields end at the same time, and are both first or both second ones.
bool Tvp5146::in_step(std::size_t camera, std::size_t other) const {
  const CameraSignal &a = cameras_[camera], &b = cameras_[other];
  const std::uint64_t of_a = a.field_at(kernel_time()) + 1, of_b = b.field_at(kernel_time()) + 1;
  return of_a % 2 == of_b % 2 && a.field_time(of_a) == b.field_time(of_b);
}

void Tvp5146::relock(bool other_syncs) {
  locked_from_ = signal_ ? present_field() + params_.relock_fields() : kNever;
  // A later change of the clock would move the start of a field that is over.
  if (signal_ && started_ && (other_syncs || params_.relock_fields() > 0))
    synced_at_ = std::max(kernel_time(), field_time(locked_from_));
}

void Tvp5146::warn(std::uint8_t index, std::uint8_t value) const {
  for (const std::string& what : decoder_not_modelled(index, value)) diagnostics_.not_modelled(what);
}

void Tvp5146::write_register(std::uint8_t index, std::uint8_t value) {
  const bool was_enabled = enabled(), was_locked = lock();
  const std::uint8_t old = regs_[index];
  if (index == kLineCountLow || index == kLineCountHigh) return;
  finish_capture();
  regs_[index] = value;
  if (index == kStatusRequest) {
    regs_[index] = value & 1;
    capture_at_.reset();
    if (value & 1) capture_at_ = kernel_time() + params_.count_capture();
  }
  if (index == kInputSelect && old != value) change_input();
  if (index == kVideoStandard && old != value) relock();
  if (index == kOperationMode && (old & 1) && !(value & 1)) relock();
  if (was_locked && !lock()) lost_lock_ = true;
  if (index == kClearLostLock && (value & 1)) lost_lock_ = false;
  if (enabled() != was_enabled) schedule();
  warn(index, value);
  if (enabled() && !was_enabled) warn(kFormatter1, regs_[kFormatter1]);  // a program may have left it as it was
}

std::uint8_t Tvp5146::read_register(std::uint8_t index) const {
  const bool is_625 = &standard() == &k625;
  switch (index) {
    case kStatus1:  // bit 1 H lock, 2 V lock, 3 colour lock, 4 lost lock, 5 50 Hz fields
      return static_cast<std::uint8_t>((lock() ? 0x0E | (is_625 ? 0x20 : 0) : 0) |
                                       (lost_lock_ ? 0x10 : 0));
    case kStatus2:
      return signal_ ? 0x80 : 0;  // signal present
    case kDetected:
      return lock() ? (is_625 ? 2 : 1) : 0;
    case kRomVersion:
      return static_cast<std::uint8_t>(params_.rom_version());
    case kIdHigh:
      return 0x51;
    case kIdLow:
      return 0x46;
    default:
      return regs_[index];
  }
}

}  // namespace fovea::video
