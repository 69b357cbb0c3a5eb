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
  position_ = locate(standard_, next_line_);
  const Standard::Lines& fv = standard_.at(position_.line);
  ++next_line_;
  line_timer_.at(edges_.edge(first + standard_.line_bytes));
  video->line({&standard_, &edges_, edges_.edge(first), first, position_.field, position_.line,
               encode_xy(fv.f, fv.v, true), encode_xy(fv.f, fv.v, false), this, 0});
}

std::uint64_t DigitalCamera::source_field(Picoseconds now) const {
  if (!started_ || edges_.edge_after(now) <= origin_) return 0;
  return 2 * locate(standard_, (edges_.edge_after(now) - 1 - origin_) / standard_.line_bytes).field;
}

std::span<const std::uint8_t> DigitalCamera::render() {
  const Standard::Lines& fv = standard_.at(position_.line);
  const std::uint8_t* row = nullptr;
  if (!fv.v) {
    if (!picture_ || picture_frame_ != position_.field) picture_ = &source_.field(2 * position_.field);
    picture_frame_ = position_.field;
    row = picture_->row(position_.line - standard_.active_first[0]);
  }
  const std::span<std::uint8_t> out(bytes_.data(), standard_.line_bytes);
  compose_line(standard_, encode_xy(fv.f, fv.v, true), encode_xy(fv.f, fv.v, false), row, out);
  return out;
}

}  // namespace fovea::video
