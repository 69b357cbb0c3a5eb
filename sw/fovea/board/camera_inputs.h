// The pictures of the board's cameras, prepared for a run.
#pragma once
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/board/board.h"
#include "model/video/scene/ahead.h"
#include "model/video/scene/quad.h"
#include "model/video/scene/sources.h"
#include "sw/fovea/board/camera_pictures.h"

namespace fovea::app {

/// Makes the source of each camera, lets it render a field ahead on a thread of its own and, if wanted,
/// remembers what it sent. Must outlive the board.
class CameraInputs {
 public:
  /// @param keep_pictures for sent()
  /// @param stop set by a signal: decoding of footage ends
  /// @param notes receives how the footage was adapted
  /// @throws UserError for footage that cannot be used, Stopped
  CameraInputs(const board::BoardParams& params, bool keep_pictures, const std::atomic<bool>& stop,
               std::vector<std::string>& notes);

  /// For the board, one for each input of the decoder: a camera, or a quad processor with the four cameras behind it.
  const std::vector<video::PictureSource*>& sources() const { return sources_; }
  /// What the cameras see, one for each camera.
  const std::vector<const video::StampedSource*>& views() const { return views_; }
  /// The field that a source sent for a frame, with its picture.
  struct Sent {
    const video::Picture* picture;  ///< null if it is unknown or not kept any more
    std::uint64_t field;            ///< of its source; the first one of a frame of two
  };
  /// What a displayed frame shows.
  Sent sent(board::Board& board, const video::FrameTimes& shown) const;

 private:
  std::vector<std::unique_ptr<video::StampedSource>> own_;
  std::vector<std::unique_ptr<video::AheadSource>> ahead_;
  std::vector<std::unique_ptr<CameraPictures>> pictures_;  // only if they are wanted
  std::optional<video::QuadSource> quad_;
  std::vector<const video::StampedSource*> views_;
  std::vector<video::PictureSource*> sources_;
};

}  // namespace fovea::app
