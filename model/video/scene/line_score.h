// How straight a displayed picture of the line chart shows its lines, and how near it is to a pin-hole camera's.
#pragma once
#include "model/video/scene/line_chart.h"

namespace fovea::video {

/// Knows the chart and the view that is meant to be displayed, and nothing of lenses or of how the picture was made.
/// The lines of the picture are found outwards from the optical axis in the axis' row and column, in the order of their
/// squares, and are followed from there in both directions for as long as they can be seen, wherever they lead.
class LineScore {
 public:
  /// @throws UserError if the optical axis is not in the view
  explicit LineScore(const PinholeView& view);
  /// Whether the optical axis is in the view.
  static bool can_score(const PinholeView& view);

  struct Result {
    double psnr_y = 0;        ///< dB, against the pin-hole camera's picture; infinite if they are equal
    double ssim_y = 0;        ///< likewise, 1 if they are equal
    double straightness = 0;  ///< px, root mean square of the distances of all points from the straight line that fits
                              ///< those of their line best
    unsigned places = 0;      ///< rows and columns of lines that were found; 0: no straightness
    unsigned missed = 0;      ///< those that the pin-hole camera sees, and the picture does not show
  };
  /// @throws UserError if the picture is not of the size of the view
  Result operator()(const Picture& shown) const;

 private:
  PinholeView view_;
  Picture ideal_;
};

}  // namespace fovea::video
