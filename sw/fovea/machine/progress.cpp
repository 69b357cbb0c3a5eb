#include "sw/fovea/machine/progress.h"

#include <fmt/format.h>

#include <ostream>

#include "sw/fovea/results/figures.h"

namespace fovea::app {
namespace {

using Seconds = std::chrono::duration<double>;

double seconds(Picoseconds ps) { return static_cast<double>(ps) / kPsPerSecond; }

std::string duration_text(double s) {
  if (s < 60) return fmt::format("{:.0f} s", s);
  const auto whole = static_cast<std::uint64_t>(s);
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace

ProgressMeter::ProgressMeter(std::ostream& out, bool terminal, Now now)
    : out_(out), terminal_(terminal), now_(std::move(now)) {
  begin_ = last_ = last_printed_ = {{}, now_()};
}

void ProgressMeter::update(const Progress& progress) {
  last_ = {progress, now_()};
  if (!steady_ && progress.frames_shown > 0) steady_ = last_;
  const auto pause = terminal_ ? std::chrono::milliseconds(200) : std::chrono::seconds(10);
  if (last_.wall - last_printed_.wall < pause) return;
  if (terminal_)
    out_ << "\r\x1b[K" << line(last_) << std::flush;
  else
    out_ << line(last_) << std::endl;
  line_open_ = terminal_;
  last_printed_ = last_;
}

void ProgressMeter::finish() {
  if (line_open_) out_ << "\r\x1b[K" << line(last_) << std::endl;
  line_open_ = false;
}

std::string ProgressMeter::line(const Sample& now) const {
  const Progress& p = now.progress;
  const double wall = Seconds(now.wall - last_printed_.wall).count();
  const double simulated = seconds(p.simulated) - seconds(last_printed_.progress.simulated);
  std::string text = fmt::format("simulated {:.3f} s", seconds(p.simulated));
  const bool starting = !p.frames_shown && !p.phase.empty() && p.phase != "frames";
  if (starting)
    text += fmt::format(", {}", p.phase);
  else if (p.frames_wanted)
    text += fmt::format(", frame {}/{}", p.frames_shown, p.frames_wanted);
  else if (p.frames_shown)
    text += fmt::format(", frame {}", p.frames_shown);
  else if (p.instructions)
    text +=
        fmt::format(", {:.1f} million instructions", static_cast<double>(p.instructions) * 1e-6);
  if (wall > 0 && simulated > 0) text += fmt::format(", {:.2f}x real time", simulated / wall);
  // Estimated from the steady state, because start-up has another speed and displays no frames.
  if (steady_ && p.frames_wanted > p.frames_shown &&
      p.frames_shown > steady_->progress.frames_shown) {
    const double per_frame = Seconds(now.wall - steady_->wall).count() /
                             static_cast<double>(p.frames_shown - steady_->progress.frames_shown);
    text +=
        ", ETA " + duration_text(per_frame * static_cast<double>(p.frames_wanted - p.frames_shown));
  }
  return text;
}

void ProgressMeter::add_host_rows(std::vector<StatRow>& rows) const {
  const auto add = [&](StatRow row) {
    if (!find(rows, row.name)) rows.push_back(std::move(row));
  };
  add(wall_time(Seconds(now_() - begin_.wall).count(), "the run"));
  add(peak_rss());
  if (!steady_ || last_.progress.simulated <= steady_->progress.simulated) return;
  const double wall = Seconds(last_.wall - steady_->wall).count();
  if (wall <= 0) return;
  constexpr const char* kWhen = "from the first displayed frame on";
  add(realtime_factor(seconds(last_.progress.simulated - steady_->progress.simulated), wall, kWhen));
  add(mips(last_.progress.instructions - steady_->progress.instructions, wall, kWhen));
}

}  // namespace fovea::app
