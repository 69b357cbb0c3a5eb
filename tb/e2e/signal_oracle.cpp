#include "tb/e2e/signal_oracle.h"

#include <cmath>
#include <utility>

namespace fovea::e2e {
namespace {

constexpr double kSamplesPerMs = 27'000;
constexpr unsigned kQuietFields = 6;   // of the display, without a field start: the firmware stops the capture
constexpr unsigned kFieldStart = 291;  // line of a field, from its first active one, at which the next one begins

/// Numbers of BT.656. Fields and frames begin with line 1; F is 1 from `second` on.
struct Raster {
  unsigned lines, second, samples;
  unsigned first[2], last[2];  // active lines
};
constexpr Raster k625Lines{625, 313, 1728, {23, 336}, {310, 623}};
constexpr Raster k525Lines{525, 263, 1716, {17, 280}, {260, 522}};  // counted from the standard's line 4

/// The camera: which line comes when.
class Camera {
 public:
  explicit Camera(const SignalStory& story) : story_(story) {}
  struct Line {
    double at_ms;
    unsigned frame, number, index;  // index: since the beginning of its standard
    bool second, active;
  };
  bool faulty(double ms) const { return ms >= story_.start_ms && ms < story_.end_ms; }
  bool is_625() const { return raster_ == &k625Lines; }
  /// The next line. What lacks is skipped before it.
  Line next() {
    using Kind = SignalStory::Kind;
    if (story_.kind == Kind::kOtherStandard && faulty(ms()) == is_625()) {
      raster_ = is_625() ? &k525Lines : &k625Lines;
      ++frame_;  // a whole new frame begins
      number_ = 1;
      index_ = 0;
    }
    const bool second = number_ >= raster_->second;
    const unsigned middle = (raster_->first[second] + raster_->last[second] + 1) / 2;
    if (story_.kind == Kind::kMissingLines && number_ == middle && faulty(ms())) {
      number_ += story_.lines;
      index_ += story_.lines;
      lacks_ = true;
    }
    const bool active = number_ >= raster_->first[second] && number_ <= raster_->last[second];
    const Line line{ms(), frame_, number_, index_, second, active};
    const bool is_short =
        story_.kind == Kind::kShortLines && number_ >= middle && number_ < middle + story_.lines && faulty(ms());
    const double period = faulty(ms()) ? 1 / (1 + story_.drift_ppm * 1e-6) : 1;
    at_ += (raster_->samples - (is_short ? story_.samples : 0)) * period;
    lacks_ |= is_short;
    ++index_;
    if (++number_ > raster_->lines) {
      number_ = 1;
      ++frame_;
    }
    return line;
  }
  /// Whether something of the lines up to now lacked, since it was asked last.
  bool take_lacks() { return std::exchange(lacks_, false); }

 private:
  double ms() const { return at_ / kSamplesPerMs; }
  const SignalStory& story_;
  const Raster* raster_ = &k625Lines;
  double at_ = 0;
  unsigned frame_ = 0, number_ = 1, index_ = 0;
  bool lacks_ = false;
};

/// Decoder, capture and the firmware's looks at field starts.
class Receiver {
 public:
  Receiver(const SignalStory& story, SignalFates& out) : story_(story), out_(out) {}

  void line(const Camera::Line& l, bool is_625, bool lacked) {
    look_at_display(l.at_ms);
    lock(l, is_625);
    open_good_ &= !lacked;
    const bool damaged = story_.kind == SignalStory::Kind::kNoise && l.at_ms >= story_.start_ms &&
                         l.at_ms < story_.end_ms && l.index % story_.every == 0;
    if (damaged) ++(story_.wrong_bits == 1 ? out_.corrected_codes : out_.bad_codes);
    const bool was_active = active_;
    if (!damaged || story_.wrong_bits == 1) {
      active_ = l.active;
      second_ = l.second;
    }
    if (active_ && !was_active)
      picture_begins(l, is_625);
    else if (count_)
      ++count_;
    if (count_ == row(0) && on_ && !in_second_) visible_ = locked_;
    if (count_ == row(story_.rows / 2 - 1) && on_ && in_second_ && open_) frame_captured(l);
    if (count_ == kFieldStart) field_begins(l, is_625);
  }

 private:
  /// Line of a field, from its first active one, with that row of the region in the middle.
  unsigned row(unsigned n) const { return 1 + (288 - story_.rows / 2) / 2 + n; }

  void lock(const Camera::Line& l, bool is_625) {
    using Kind = SignalStory::Kind;
    const bool fault = l.at_ms >= story_.start_ms && l.at_ms < story_.end_ms;
    const unsigned field = 2 * l.frame + l.second;
    if (is_625 != was_625_ || (story_.kind == Kind::kUnplugged && !fault && was_fault_))
      locked_from_ = field + story_.relock_fields;
    was_625_ = is_625;
    was_fault_ = fault;
    locked_ = field >= locked_from_ && !(story_.kind == Kind::kUnplugged && fault);
  }

  void picture_begins(const Camera::Line& l, bool is_625) {
    const Raster& raster = is_625 ? k625Lines : k525Lines;
    count_ = 1;
    in_second_ = second_;
    on_ = wanted_;
    if (!on_) open_ = false;
    const bool late = l.number != raster.first[l.second];
    if (!in_second_) {
      open_ = on_;
      open_good_ = true;
      frame_ = l.frame;
    }
    open_good_ &= !late;
  }

  void frame_captured(const Camera::Line& l) {
    open_ = false;
    if (!visible_) return;  // no camera's picture
    out_.captured.push_back({frame_, l.at_ms, false, 0});
    candidate_ = wanted_;
  }

  /// The firmware knows of a field's start; between two frames it takes the frame, and begins the next one.
  void field_begins(const Camera::Line& l, bool is_625) {
    quiet_from_ = l.at_ms;
    if (!in_second_) return;
    if (candidate_ && open_good_ && locked_ && is_625) {
      out_.captured.back().good = true;
      out_.captured.back().handed_on_ms = l.at_ms;
    }
    candidate_ = false;
    wanted_ = locked_ && is_625;
  }

  /// Interrupts of the display at the starts of its fields.
  void look_at_display(double ms) {
    const double since = (quiet_from_ - story_.display_ms) / 20;
    if (ms < story_.display_ms + 20 * (std::floor(since) + kQuietFields)) return;
    quiet_from_ = ms;
    wanted_ = candidate_ = false;
  }

  const SignalStory& story_;
  SignalFates& out_;
  bool active_ = true, second_ = true;  // V and F as the capture has them
  unsigned count_ = 0;                  // lines of the field; 0: before the first one
  bool in_second_ = false, wanted_ = true, on_ = false, open_ = false, open_good_ = true, visible_ = false;
  bool candidate_ = false;  // a captured frame waits for its end
  unsigned frame_ = 0, locked_from_ = 0;
  bool locked_ = true, was_625_ = true, was_fault_ = false;
  double quiet_from_ = 0;
};

}  // namespace

SignalFates fates_of(const SignalStory& story) {
  SignalFates out;
  Camera camera(story);
  Receiver receiver(story, out);
  for (double at = 0; at < story.sent_until_ms;) {
    const Camera::Line line = camera.next();
    receiver.line(line, camera.is_625(), camera.take_lacks());
    at = line.at_ms;
  }
  return out;
}

}  // namespace fovea::e2e
