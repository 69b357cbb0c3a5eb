// The scores of a run's corrected picture: what it costs that pairs of pixels move as a whole and, where the scene is
// known, how well it is corrected.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "model/board/board.h"
#include "model/video/scene/film_score.h"
#include "model/video/scene/line_score.h"
#include "model/video/scene/pixel_remap.h"
#include "sw/fovea/board/camera_inputs.h"
#include "sw/fovea/machine/machine.h"

namespace fovea::app {

class PictureScore {
 public:
  /// Whether what the cameras send is needed for a score: there is one camera's picture at a time on the display,
  /// without an overlay.
  static bool possible(const board::BoardParams& params);
  /// Null where no picture can be scored. A score against the scene needs the chart of lines or a film that is bent,
  /// without stamps, and for the chart the optical axis in the view.
  /// @param cameras what each one sees; to live as long as the score
  static std::unique_ptr<PictureScore> of(const board::BoardParams& params,
                                          const std::vector<const video::StampedSource*>& cameras);

  /// Remembers the picture in the middle of a displayed frame and what the camera sent of it. If the scene of any
  /// camera is known, only pictures of such cameras.
  void displayed(const video::Frame& frame, const CameraInputs::Sent& sent);
  /// Adds quality.*: the scores of the last such picture. Nothing if there was none.
  void add(std::vector<StatRow>& rows) const;

 private:
  struct Camera {
    video::PinholeView view;
    std::optional<video::TakingLens> lens;
    std::unique_ptr<video::LineScore> lines;  ///< null: not the chart, or it cannot be scored
    std::optional<video::FilmScore> film;
    const video::VideoSource* video = nullptr;  ///< with `film`
    bool known() const { return lines || film; }
  };
  explicit PictureScore(const board::BoardParams& params);
  void take_sent(const CameraInputs::Sent& sent);
  const video::RgbImage* flat_frame() const;
  void add_of_scene(std::vector<StatRow>& rows) const;
  void add_of_pixels(std::vector<StatRow>& rows) const;

  std::vector<Camera> cameras_;
  bool any_known_ = false;
  bool pairs_;    ///< pictures are remapped, all by the table of the keys
  bool digital_;  ///< all of what is sent is captured
  video::Picture picture_, sent_;
  std::optional<std::uint64_t> field_;  ///< of sent_; nothing: it is not known what was sent
  const Camera* last_ = nullptr;
};

}  // namespace fovea::app
