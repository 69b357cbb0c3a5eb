// A picture source that is drawn on another thread, one field ahead.
#pragma once
#include <array>
#include <cstdint>
#include <future>

#include "model/video/core/picture.h"

namespace fovea::video {

/// The pictures of another source, byte for byte: while field k is on the wire a second thread draws
/// k + 1. Nobody else may use that source meanwhile. An error while drawing comes out of the call
/// that wants the field.
class AheadSource : public PictureSource {
 public:
  explicit AheadSource(PictureSource& source) : source_(source) {}
  ~AheadSource() override {
    if (next_.valid()) next_.wait();
  }
  unsigned width() const override { return source_.width(); }
  unsigned height() const override { return source_.height(); }
  const Picture& field(std::uint64_t k) override {
    if (next_.valid()) {
      const bool wanted = next_field_ == k;
      if (wanted)
        next_.get();
      else
        next_.wait();  // never shown: its error, if any, is not asked for
      if (!wanted) pictures_[next_place_] = source_.field(k);
    } else {
      pictures_[next_place_] = source_.field(k);
    }
    const Picture& shown = pictures_[next_place_];
    next_place_ ^= 1u;
    next_field_ = k + 1;
    next_ = std::async(std::launch::async, [this, place = next_place_, field = k + 1] {
      pictures_[place] = source_.field(field);
    });
    return shown;
  }

 private:
  PictureSource& source_;
  std::array<Picture, 2> pictures_;
  unsigned next_place_ = 0;
  std::uint64_t next_field_ = 0;
  std::future<void> next_;
};

}  // namespace fovea::video
