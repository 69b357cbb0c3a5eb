#include "model/video/core/frame_assembler.h"

#include <cstring>

namespace fovea::video {
namespace {

constexpr std::size_t kMessages = 8;
constexpr Picoseconds kTolerance = 2;

/// Duration of `samples` of the byte clock, rounded down.
Picoseconds byte_time(std::uint64_t samples) {
  return samples * (kPsPerSecond / 1'000'000) / (kByteClock.num / 1'000'000);
}
bool near(Picoseconds a, Picoseconds b) { return (a > b ? a - b : b - a) <= kTolerance; }

unsigned next_active(const Standard& s, unsigned number) {
  do {
    number = number % s.lines + 1;
  } while (s.at(number).v);
  return number;
}

}  // namespace

void FrameAssembler::violation(const DisplayLine& line, const std::string& what) {
  ++violations_;
  if (messages_.size() < kMessages)
    messages_.push_back("line " + std::to_string(line.number) + " at " +
                        std::to_string(line.start) + " ps: " + what);
}

void FrameAssembler::check(const DisplayLine& line) {
  const Standard& s = *line.standard;
  const Standard::Lines& fv = s.at(line.number);
  if (fv.v) violation(line, "is a blanking line");
  if (fv.f != line.f) violation(line, "wrong field bit");
  if (!near(line.end - line.start, byte_time(kActiveBytes)))
    violation(line, "active part of " + std::to_string(line.end - line.start) + " ps");

  if (standard_ == &s) {
    const unsigned expected = next_active(s, last_number_);
    if (line.number != expected) {
      violation(line, "out of order, expected line " + std::to_string(expected));
    } else {
      lines_since_anchor_ += (line.number + s.lines - last_number_) % s.lines;
      const Picoseconds due = anchor_ + byte_time(lines_since_anchor_ * s.line_bytes);
      if (near(line.start, due)) {
        last_number_ = line.number;
        return;
      }
      violation(line, "expected at " + std::to_string(due) + " ps");
    }
  }
  // The first line, or the first one after a violation: start the line count here.
  standard_ = &s;
  last_number_ = line.number;
  anchor_ = line.start;
  lines_since_anchor_ = 0;
}

void FrameAssembler::line(const DisplayLine& line) {
  check(line);
  const Standard& s = *line.standard;
  Placement place = &s == &k625 ? kPlacement625 : kPlacement525All;
  if (&s != &k625) place.rows = rows_525;

  if (!line.f && line.number == place.first_line[0]) {
    if (open_) ++broken_;
    open_ = true;
    rows_ = 0;
    if (frame_.picture.width != kActivePixels || frame_.picture.height != place.rows)
      frame_.picture = Picture(kActivePixels, place.rows);
    frame_.times = {};
    frame_.times.display_start = line.start;
  }
  if (!open_) return;
  const int row = place.row(line.f, line.number);
  if (row < 0) return;
  std::uint8_t* to = frame_.picture.row(static_cast<unsigned>(row));
  if (line.uyvy) {
    std::memcpy(to, line.uyvy, kActiveBytes);
  } else {
    for (unsigned i = 0; i < kActiveBytes; ++i) to[i] = i & 1 ? 16 : 128;
  }
  ++rows_;
  if (!line.f || line.number != place.first_line[1] + place.rows / 2 - 1) return;

  open_ = false;
  if (rows_ != place.rows) {
    ++broken_;
    return;
  }
  frame_.times.index = frames_++;
  frame_.times.display_end = line.end;
  if (on_frame) on_frame(frame_);
  std::swap(previous_, frame_.picture);
}

void FrameAssembler::raster_off() {
  broken_ += open_;
  open_ = false;
  standard_ = nullptr;
}

}  // namespace fovea::video
