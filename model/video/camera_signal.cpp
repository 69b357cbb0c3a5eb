#include "model/video/camera_signal.h"

#include <cmath>
#include <string>

#include "model/common/check.h"

namespace fovea::video {
namespace {

/// Offsets are kept to a thousandth of a part per million.
Frequency with_offset(Frequency nominal, double ppm) {
  if (ppm == 0 || nominal.stopped()) return nominal;
  constexpr std::uint64_t kParts = 1'000'000'000;
  const auto parts = static_cast<std::uint64_t>(std::llround(kParts + ppm * 1000));
  return Frequency(nominal.num * parts, nominal.den * kParts);
}

}  // namespace

CameraSignal::CameraSignal(const CameraWiring& wiring)
    : connected(wiring.connected), wiring_(wiring), standard_(&standard_of(wiring.is_625)) {
  const PictureSource& source = *wiring.source;
  const unsigned rows = wiring.placement.rows;
  if (source.width() > kActivePixels || source.width() % 4 || source.height() > rows ||
      source.height() % 2)
    throw UserError("camera picture of " + std::to_string(source.width()) + "x" +
                    std::to_string(source.height()) + " does not fit " +
                    std::string(standard_->name) + ": at most 720x" +
                    std::to_string(rows) + ", width in steps of 4, height even");
}

void CameraSignal::clock_changed(Frequency nominal, Picoseconds now) {
  stopped_field_ = field_at(now);
  nominal_ = nominal;
  clock_.restart(with_offset(nominal, wiring_.clock_offset), now);
  if (!clock_.running() || started_) return;
  started_ = true;
  first_edge_ = clock_.edge_at_or_after(now + wiring_.phase);
  origin_ = static_cast<std::int64_t>(first_edge_);
}

void CameraSignal::set_clock_offset(double ppm, Picoseconds now) {
  wiring_.clock_offset = ppm;
  clock_changed(nominal_, now);
}

void CameraSignal::set_standard(bool is_625, const Placement& placement, std::uint64_t edge,
                                Picoseconds now) {
  first_field_ = stopped_field_ = (field_at(now) + 2) & ~std::uint64_t{1};
  standard_ = &standard_of(is_625);
  wiring_.placement = placement;
  if (wiring_.genlocked && is_625 == wiring_.is_625 && started_ && edge > first_edge_) {
    const std::uint64_t frame = standard_->frame_bytes();
    edge = first_edge_ + (edge - first_edge_ + frame - 1) / frame * frame;
  }
  origin_ = static_cast<std::int64_t>(edge);
  left_out_ = 0;
}

std::uint64_t CameraSignal::field_at(Picoseconds now) const {
  if (!started_ || !clock_.running()) return stopped_field_;
  // The sample on the wire began at the edge before.
  const std::int64_t since = static_cast<std::int64_t>(clock_.edge_after(now)) - 1 - origin_;
  return since < 0 ? first_field_
                   : position(static_cast<std::uint64_t>(since) / standard_->line_bytes).field;
}

Picoseconds CameraSignal::field_time(std::uint64_t k) const {
  FOVEA_CHECK(started_, "the camera's clock has not started");
  return clock_.edge(line_edge(first_line_of_field(*standard_, k - first_field_)));
}

std::uint64_t CameraSignal::line_from(std::uint64_t edge) const {
  const std::uint64_t line = standard_->line_bytes;
  const std::int64_t since = static_cast<std::int64_t>(edge) - origin_;
  return since <= 0 ? 0 : (static_cast<std::uint64_t>(since) + line - 1) / line;
}

const Picture& CameraSignal::picture(std::uint64_t field) {
  if (!picture_ || picture_field_ != field) {
    picture_ = &wiring_.source->field(field);
    picture_field_ = field;
    FOVEA_CHECK(picture_->width == width() && picture_->height == height(),
                "picture source changed its size");
  }
  return *picture_;
}

}  // namespace fovea::video
