#include "model/video/tvp5146.h"

#include <cstring>

#include "model/common/burst_master.h"
#include "model/common/check.h"

namespace fovea::video {
namespace {

constexpr std::uint8_t kInputSelect = 0x00, kVideoStandard = 0x02, kOperationMode = 0x03,
                       kFormatter2 = 0x34, kClearLostLock = 0x39, kStatus1 = 0x3A, kStatus2 = 0x3B,
                       kDetected = 0x3F, kRomVersion = 0x70, kIdHigh = 0x80, kIdLow = 0x81;
constexpr std::uint8_t kFormatter2Enables = 0x11;  // enables the data and clock outputs

}  // namespace

Tvp5146::Tvp5146(sc_core::sc_module_name name, const Tvp5146Params& params, PictureSource& source)
    : sc_module(name),
      params_(params),
      source_(source),
      standard_(standard_of(params.standard.is("625/50"))),
      placement_(params.standard.is("625/50")        ? kPlacement625
                 : params.crop_525.is("first_lines") ? kPlacement525
                                                     : kPlacement525Studio),
      locked_from_(params.relock_fields()) {
  if (source.width() > kActivePixels || source.width() % 4 || source.height() > standard_.rows ||
      source.height() % 2)
    throw UserError("camera picture of " + std::to_string(source.width()) + "x" +
                    std::to_string(source.height()) + " does not fit " +
                    std::string(standard_.name) + ": at most 720x" +
                    std::to_string(standard_.rows) + ", width in steps of 4, height even");
  regs_[0x01] = 0x0F;
  regs_[0x09] = regs_[0x0A] = regs_[0x0B] = 0x80;
  if (params.output_at_reset()) regs_[kFormatter2] = kFormatter2Enables;
  i2c.bind(*this);
  SC_METHOD(clock_changed);
  sensitive << clock;
  SC_METHOD(send_line);
  sensitive << line_timer_.event();
  dont_initialize();
}

void Tvp5146::clock_changed() {
  if (clock.read() == clock_.frequency()) return;
  stopped_field_ = present_field();
  clock_.restart(clock.read(), kernel_time());
  if (!clock_.running()) return line_timer_.cancel();
  if (!started_) {
    started_ = true;
    origin_ = clock_.edge_at_or_after(kernel_time() + params_.phase());
  }
  schedule();
}

bool Tvp5146::enabled() const {
  return (regs_[kFormatter2] & kFormatter2Enables) == kFormatter2Enables &&
         (regs_[kOperationMode] & 1) == 0;
}

bool Tvp5146::standard_ok() const {
  const std::uint8_t want = regs_[kVideoStandard];
  return want == 0 || want == (&standard_ == &k625 ? 2 : 1);
}

std::uint64_t Tvp5146::present_field() const {
  if (!started_ || !clock_.running()) return stopped_field_;
  const std::uint64_t edge =
      clock_.edge_after(kernel_time());  // the sample on the wire began at edge - 1
  return edge <= origin_ ? 0 : locate(standard_, (edge - 1 - origin_) / standard_.line_bytes).field;
}

Picoseconds Tvp5146::field_time(std::uint64_t k) const {
  FOVEA_CHECK(started_, "the camera's clock has not started");
  return clock_.edge(origin_ + first_line_of_field(standard_, k) * standard_.line_bytes);
}

void Tvp5146::schedule() {
  line_timer_.cancel();
  if (!started_ || !clock_.running() || !enabled()) return;
  const Picoseconds now = kernel_time();
  // If the outputs are enabled in the middle of a line, they start with the next whole line after
  // `now`.
  const std::uint64_t edge = clock_.edge_after(now);
  const std::uint64_t line = standard_.line_bytes;
  next_line_ = edge <= origin_ ? 0 : (edge - origin_ + line - 1) / line;
  line_timer_.at(clock_.edge(origin_ + next_line_ * standard_.line_bytes));
}

void Tvp5146::send_line() {
  const std::uint64_t first = origin_ + next_line_ * standard_.line_bytes;
  position_ = locate(standard_, next_line_);
  fv_ = standard_.at(position_.line);
  const Bt656Line line{&standard_,
                       &clock_,
                       clock_.edge(first),
                       first,
                       position_.field,
                       position_.line,
                       encode_xy(fv_.f, fv_.v, true),
                       encode_xy(fv_.f, fv_.v, false),
                       this};
  ++lines_sent_;
  ++next_line_;
  line_timer_.at(clock_.edge(origin_ + next_line_ * standard_.line_bytes));
  video->line(line);
}

std::span<const std::uint8_t> Tvp5146::render() {
  const std::uint8_t* active = nullptr;
  if (!fv_.v) {
    static constexpr std::uint8_t kBlack[4] = {0x80, 0x10, 0x80, 0x10};
    for (unsigned i = 0; i < kActiveBytes; i += 4) std::memcpy(row_.data() + i, kBlack, 4);
    // A smaller picture is centred, on lines of the same field and on whole pixel pairs.
    const unsigned top = (placement_.rows - source_.height()) / 2 & ~1u;
    const int row = placement_.row(fv_.f, position_.line) - static_cast<int>(top);
    if (row >= 0 && row < static_cast<int>(source_.height()) && locked(position_.field)) {
      if (!picture_ || picture_field_ != position_.field) {
        picture_ = &source_.field(position_.field);
        picture_field_ = position_.field;
      }
      const Picture& picture = *picture_;
      FOVEA_CHECK(picture.width == source_.width() && picture.height == source_.height(),
                  "picture source changed its size");
      std::memcpy(row_.data() + (kActivePixels - picture.width) / 2 * 2,
                  picture.row(static_cast<unsigned>(row)), picture.row_bytes());
    }
    active = row_.data();
  }
  const std::span<std::uint8_t> out(bytes_.data(), standard_.line_bytes);
  compose_line(standard_, encode_xy(fv_.f, fv_.v, true), encode_xy(fv_.f, fv_.v, false), active,
               out);
  return out;
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

std::uint8_t Tvp5146::i2c_read() { return read_register(pointer_++); }

void Tvp5146::relock() { locked_from_ = present_field() + params_.relock_fields(); }

void Tvp5146::write_register(std::uint8_t index, std::uint8_t value) {
  const bool was_enabled = enabled(), was_locked = lock();
  const std::uint8_t old = regs_[index];
  regs_[index] = value;
  if ((index == kInputSelect || index == kVideoStandard) && old != value) relock();
  if (index == kOperationMode && (old & 1) && !(value & 1)) relock();
  if (was_locked && !lock()) lost_lock_ = true;
  if (index == kClearLostLock && (value & 1)) lost_lock_ = false;
  if (enabled() != was_enabled) schedule();
}

std::uint8_t Tvp5146::read_register(std::uint8_t index) const {
  const bool is_625 = &standard_ == &k625;
  switch (index) {
    case kStatus1:  // bit 1 H lock, 2 V lock, 3 colour lock, 4 lost lock, 5 50 Hz fields
      return static_cast<std::uint8_t>((lock() ? 0x0E | (is_625 ? 0x20 : 0) : 0) |
                                       (lost_lock_ ? 0x10 : 0));
    case kStatus2:
      return 0x80;  // signal present
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
