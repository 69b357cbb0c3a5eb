#include "sw/fovea/board/camera_inputs.h"

#include "sw/fovea/board/loader.h"

namespace fovea::app {

CameraInputs::CameraInputs(const board::BoardParams& params, bool keep_pictures,
                           const std::atomic<bool>& stop, std::vector<std::string>& notes) {
  const unsigned step = params.video.format().digital ? 2 : 1;
  for (unsigned n = 0; n < params.camera_count(); ++n) {
    own_.push_back(camera_source(params, n, &stop, &notes));
    ahead_.push_back(std::make_unique<video::AheadSource>(*own_.back(), step));
    views_.push_back(own_.back().get());
    sources_.push_back(ahead_.back().get());
  }
  if (params.cameras.quad()) {
    quad_.emplace(std::array<video::PictureSource*, 4>{sources_.at(0), sources_.at(1), sources_.at(2), sources_.at(3)});
    sources_ = {&*quad_};
  }
  if (!keep_pictures) return;
  for (video::PictureSource*& source : sources_) {
    pictures_.push_back(std::make_unique<CameraPictures>(*source));
    source = pictures_.back().get();
  }
}

CameraInputs::Sent CameraInputs::sent(board::Board& board, const video::FrameTimes& shown) const {
  if (!shown.capture_start || shown.camera >= pictures_.size()) return {nullptr, 0};
  if (board.digital) {
    const std::uint64_t field = board.digital->source_field(*shown.capture_start);
    return {pictures_[0]->kept(field), field};
  }
  CameraPictures& pictures = *pictures_[shown.camera];
  const video::Picture* frame = pictures.frame(board.decoder.cameras()[shown.camera], *shown.capture_start);
  return {frame, pictures.first_field()};
}

}  // namespace fovea::app
