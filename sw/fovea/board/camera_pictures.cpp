#include "sw/fovea/board/camera_pictures.h"

#include <algorithm>

#include "model/video/core/bt656.h"

namespace fovea::app {

const video::Picture& CameraPictures::field(std::uint64_t k) {
  const video::Picture& picture = source_.field(k);
  Kept& kept = place(k);
  kept.field = k;
  kept.picture = picture;
  return picture;
}

const video::Picture* CameraPictures::frame(const video::CameraSignal& signal, Picoseconds start) {
  if (woven_start_ == start) return &woven_;
  const auto first = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) {
    return kept.field && signal.field_time(*kept.field) <= start &&
           start < signal.field_time(*kept.field + 1);
  });
  if (first == kept_.end()) return nullptr;
  const Kept& second = place(*first->field + 1);
  if (second.field != *first->field + 1) return nullptr;
  woven_ = first->picture;
  // Of the rows of the picture, the second field has every other one.
  const unsigned row = signal.placement().first_row[*second.field % 2] % 2;
  for (unsigned y = row; y < woven_.height; y += 2)
    std::copy_n(second.picture.row(y), woven_.row_bytes(), woven_.row(y));
  woven_start_ = start;
  woven_first_ = *first->field;
  return &woven_;
}

}  // namespace fovea::app
