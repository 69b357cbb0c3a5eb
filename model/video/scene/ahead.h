// A picture source that renders one field ahead on another thread.
#pragma once
#include <array>
#include <cstdint>
#include <future>

#include "model/video/core/picture.h"

namespace fovea::video {

/// Delivers the pictures of another source unchanged: while field k is sent, a second thread
/// renders field k + `step`. That source must not be used by other code meanwhile. An error during
/// rendering is thrown by the call of field() for that picture.
class AheadSource : public PictureSource {
 public:
  explicit AheadSource(PictureSource& source, unsigned step = 1) : source_(source), step_(step) {}
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
        next_.wait();  // this picture is not used, and neither is its error
      if (!wanted) pictures_[next_index_] = source_.field(k);
    } else {
      pictures_[next_index_] = source_.field(k);
    }
    const Picture& shown = pictures_[next_index_];
    next_index_ ^= 1u;
    next_field_ = k + step_;
    next_ = std::async(std::launch::async, [this, index = next_index_, field = next_field_] {
      pictures_[index] = source_.field(field);
    });
    return shown;
  }

 private:
  PictureSource& source_;
  const unsigned step_;
  std::array<Picture, 2> pictures_;
  unsigned next_index_ = 0;
  std::uint64_t next_field_ = 0;
  std::future<void> next_;
};

}  // namespace fovea::video
