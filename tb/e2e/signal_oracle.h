// What becomes of each frame that one camera sends while something is wrong with its signal: worked out line by line
// from the numbers of ITU-R BT.656, the time of the fault and the rules of sw/firmware/README.md. Uses nothing of the
// model, of its records or of the firmware.
#pragma once
#include <cstdint>
#include <vector>

namespace fovea::e2e {

/// A camera of 625/50 that is alone, and what is wrong with its signal from `start_ms` to `end_ms`.
struct SignalStory {
  enum class Kind { kNone, kUnplugged, kOtherStandard, kNoise, kMissingLines, kShortLines, kDrift };
  Kind kind = Kind::kNone;
  double start_ms = 0, end_ms = 0;
  unsigned wrong_bits = 0, every = 1;  ///< kNoise: in the codes of one of so many lines
  unsigned lines = 0, samples = 0;     ///< of each field, from its middle on, and what each of them lacks
  double drift_ppm = 0;
  unsigned relock_fields = 0;
  unsigned rows = 0;        ///< height of the captured region
  double display_ms = 0;    ///< the start of any frame of the display
  double sent_until_ms = 0;
};

/// A frame whose last row was captured.
struct CapturedFrame {
  unsigned number = 0;     ///< of the camera's frame
  double captured_ms = 0;  ///< its last row is in
  bool good = false;       ///< all lines of its fields came, and both pictures began at their line
  double handed_on_ms = 0; ///< the firmware knows that; 0: never
};

struct SignalFates {
  std::vector<CapturedFrame> captured;
  unsigned bad_codes = 0;        ///< EAV codes that cannot be corrected
  unsigned corrected_codes = 0;  ///< and that can be
};
SignalFates fates_of(const SignalStory& story);

}  // namespace fovea::e2e
