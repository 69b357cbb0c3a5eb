#include "model/video/digital_camera.h"

#include <string>

#include "model/common/check.h"

namespace fovea::video {

DigitalCamera::DigitalCamera(sc_core::sc_module_name name, const Standard& standard, PictureSource& source,
                             Picoseconds phase)
    : sc_module(name), standard_(standard), source_(source), phase_(phase) {
  FOVEA_CHECK(standard.progressive, "a digital camera is progressive");
  if (source.width() != standard.active_pixels || source.height() != standard.rows)
    throw UserError("camera picture of " + std::to_string(source.width()) + "x" + std::to_string(source.height()) +
                    " does not fit " + std::string(standard.name));
  SC_METHOD(clock_changed);
  sensitive << clock;
  SC_METHOD(send_line);
  sensitive << line_timer_.event();
  dont_initialize();
}

void DigitalCamera::clock_changed() {
  if (started_ && clock.read() == edges_.frequency()) return;
  edges_.restart(clock.read(), kernel_time());
  if (!edges_.running()) return line_timer_.cancel();
  if (!started_) origin_ = edges_.edge_at_or_after(kernel_time() + phase_);
  started_ = true;
  line_timer_.at(edges_.edge(origin_ + next_line_ * standard_.line_bytes));
}

void DigitalCamera::send_line() {
  const std::uint64_t first = origin_ + next_line_ * standard_.line_bytes;
  const LinePosition at = locate(standard_, next_line_);
  const Standard::Lines& fv = standard_.at(at.line);
  ++next_line_;
  line_timer_.at(edges_.edge(first + standard_.line_bytes));
  if (video->begin_line({&standard_, &edges_, first, encode_xy(fv.f, fv.v, true)})) video->take_line(compose(at));
}

std::uint64_t DigitalCamera::source_field(Picoseconds now) const {
  if (!started_ || edges_.edge_after(now) <= origin_) return 0;
  return 2 * locate(standard_, (edges_.edge_after(now) - 1 - origin_) / standard_.line_bytes).field;
}

std::span<const std::uint8_t> DigitalCamera::compose(LinePosition at) {
  const Standard::Lines& fv = standard_.at(at.line);
  const std::uint8_t* row = nullptr;
  if (!fv.v) {
    if (!picture_ || picture_frame_ != at.field) picture_ = &source_.field(2 * at.field);
    picture_frame_ = at.field;
    row = picture_->row(at.line - standard_.active_first[0]);
  }
  const std::span<std::uint8_t> out(bytes_.data(), standard_.line_bytes);
  compose_line(standard_, encode_xy(fv.f, fv.v, true), encode_xy(fv.f, fv.v, false), row, out);
  return out;
}

}  // namespace fovea::video
