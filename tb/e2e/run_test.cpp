// Statistics of a run as `fovea run` reports them: conservation, and arithmetic of the video
// streams.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <map>
#include <systemc>

#include "model/common/masters.h"
#include "model/video/core/picture.h"
#include "model/video/scene/bars.h"
#include "model/video/scene/film_score.h"
#include "model/video/scene/line_score.h"
#include "model/video/scene/picture_quality.h"
#include "model/video/scene/plan_score.h"
#include "sw/fovea/files/ffmpeg.h"
#include "sw/fovea/machine/machine.h"
#include "sw/fovea/results/outputs.h"
#include "tb/own_diagnostics.h"

namespace fovea::e2e {
namespace {

using Keys = std::vector<std::pair<std::string, std::string>>;

/// Asks for the end of the run as Ctrl-C does, but at a given simulated time.
class StopAt : public app::ProgressSink {
 public:
  explicit StopAt(Picoseconds at) : at_(at) {}
  void update(const app::Progress& p) override { stop = p.simulated >= at_; }
  std::atomic<bool> stop{false};

 private:
  Picoseconds at_;
};

using Pictures = std::map<std::uint64_t, video::Picture>;

/// What a run displays and what the camera sent, by the displayed frame's number.
struct Seen : app::FrameSink {
  std::vector<video::FrameTimes> times;
  Pictures shown, cameras;
  void displayed(const video::Frame& frame, app::PixelShape) override {
    times.push_back(frame.times);
    shown[frame.times.index] = frame.picture;
  }
  bool wants_sent() const override { return true; }
  void sent(std::uint64_t index, const video::Picture& picture, app::PixelShape) override { cameras[index] = picture; }
};

app::Result run(const Keys& keys, bool strict = false, Picoseconds stop_at = kNever,
                   Seen* seen = nullptr) {
  static auto machine = app::make_machine(app::MachineKind::kBoard);
  static ParamSet set;
  machine->declare(set);
  set.set("camera.kind", "chart");
  set.set("camera.stamp", "false");
  set.set("ddr.check", "commands");
  set.set("firmware.elf", std::string(FOVEA_FIRMWARE_DIR) + "/fovea_firmware.elf");
  for (const auto& [key, value] : keys) set.set(key, value);
  StopAt progress(stop_at);
  app::Request request{.params = set,
                       .stop = progress.stop,
                       .progress = progress,
                       .strict_sync = strict};
  if (seen) request.frames = {seen};
  return machine->run(request);
}

std::uint64_t count(const app::Result& r, const std::string& name) {
  const app::StatRow* row = app::find(r.stats, name);
  EXPECT_TRUE(row) << name;
  return row ? std::get<std::uint64_t>(row->value) : 0;
}
double real(const app::Result& r, const std::string& name) {
  const app::StatRow* row = app::find(r.stats, name);
  EXPECT_TRUE(row) << name;
  return row ? std::get<double>(row->value) : 0;
}

/// Every cycle has one cause and that one's cycles their culprits; every byte on the SDRAM has one
/// master. No figure went below zero.
void expect_conservation(const app::Result& r) {
  std::map<std::string, std::uint64_t> by_culprit;
  for (const app::StatRow& row : r.stats) {
    const auto* n = std::get_if<std::uint64_t>(&row.value);
    if (!n) continue;
    EXPECT_LT(*n, std::uint64_t{1} << 63) << row.name;
    const auto by = row.name.find(".by.");
    if (row.name.starts_with("cpu.stall.") && by != std::string::npos)
      by_culprit[row.name.substr(0, by)] += *n;
  }
  EXPECT_GE(by_culprit.size(), 5u);
  for (const auto& [cause, cycles] : by_culprit) EXPECT_EQ(count(r, cause), cycles) << cause;

  std::uint64_t causes = count(r, "cpu.issue") + count(r, "cpu.idle");
  for (const char* cause : {"interlock", "icache", "dcache", "write_buffer", "uncached", "tlb",
                            "tcm", "cache_op", "drain", "bus_sync"})
    causes += count(r, std::string("cpu.stall.") + cause);
  EXPECT_EQ(count(r, "cpu.cycles"), causes);
  std::uint64_t read = 0, write = 0;
  for (auto name : kStatNames) {
    read += count(r, "bus." + std::string(name) + ".read_bytes");
    write += count(r, "bus." + std::string(name) + ".write_bytes");
  }
  // Register accesses go over the same crossbar but not to the SDRAM; they are counted apart.
  EXPECT_EQ(count(r, "ddr.read_bytes"), read - count(r, "bus.config.read_bytes"));
  EXPECT_EQ(count(r, "ddr.write_bytes"), write - count(r, "bus.config.write_bytes"));
}

TEST(RunTest, SmallPalRegionConservesCyclesAndBytes) {
  const auto r = run({{"video.width", "320"}, {"video.height", "64"}, {"run.frames", "10"}});
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  expect_conservation(r);
  EXPECT_EQ(count(r, "frame.displayed"), 10u);
  EXPECT_EQ(count(r, "frame.dropped"), 0u);
  EXPECT_DOUBLE_EQ(real(r, "frame.rate"), 25.0);
  EXPECT_DOUBLE_EQ(real(r, "frame.window"), 0.4);
  // 320 x 64 pairs of bytes, ten frames in and ten out.
  EXPECT_EQ(count(r, "bus.vpfe.write_bytes"), 320u * 64 * 2 * 10);
  EXPECT_EQ(count(r, "bus.vpbe.read_bytes"), 320u * 64 * 2 * 10);
  // The window is 0.4 s of a 297 MHz clock, to the instruction at each end.
  EXPECT_NEAR(static_cast<double>(count(r, "cpu.cycles")), 0.4 * 297e6, 200);
  // The clocks within the ten remaps: all of one kind each, and as many as the pins' times make.
  std::uint64_t of_remaps = count(r, "cpu.remap.issue") + count(r, "cpu.remap.idle"), asleep = 0;
  for (const char* event : {"dma", "engine", "capture", "display", "timer", "other"}) {
    const std::string name = std::string("idle.") + event;
    asleep += count(r, "cpu.remap." + name);
    EXPECT_LE(count(r, "cpu.remap." + name), count(r, "cpu." + name)) << event;
  }
  EXPECT_EQ(asleep, count(r, "cpu.remap.idle"));
  for (const app::StatRow& row : r.stats)
    if (row.name.starts_with("cpu.remap.stall.")) {
      of_remaps += std::get<std::uint64_t>(row.value);
      EXPECT_LE(std::get<std::uint64_t>(row.value), count(r, "cpu." + row.name.substr(10))) << row.name;
    }
  EXPECT_EQ(count(r, "cpu.remap.cycles"), of_remaps);
  EXPECT_EQ(count(r, "frame.remapped"), 10u);
  EXPECT_NEAR(static_cast<double>(count(r, "cpu.remap.cycles")),
              real(r, "frame.remap_time.mean") * 10 * 297e6, 10 * 100.0);
  EXPECT_GT(count(r, "cpu.idle"), count(r, "cpu.remap.idle"));
  // Every burst of the camera has one first beat and one last, but for those under way at an edge.
  std::map<std::string, std::uint64_t> beats;
  for (const app::LatencyRow& row : r.latency) beats[row.master + " " + row.direction + " " + row.beat] += row.count;
  EXPECT_EQ(beats.at("vpfe write first"), beats.at("vpfe write last"));
  EXPECT_NEAR(static_cast<double>(beats.at("vpfe write last")),
              static_cast<double>(count(r, "bus.vpfe.transactions")), 4);
  EXPECT_NEAR(static_cast<double>(beats.at("vpbe read last")),
              static_cast<double>(count(r, "bus.vpbe.transactions")), 4);
  EXPECT_EQ(beats.count("vpfe read first"), 0u);
  EXPECT_GE(real(r, "ddr.vpbe.latency.read_last.mean"), real(r, "ddr.vpbe.latency.mean"));
  EXPECT_GT(real(r, "ddr.vpfe.latency.write_last.mean"), real(r, "ddr.vpfe.latency.write_first.mean"));
  // Each access of the SDRAM in the window was decided in one of two ways. Those of registers are words.
  const auto decided = [&](const char* name) {
    return static_cast<double>(std::get<std::uint64_t>(app::find(r.host, name)->value));
  };
  double accesses = 0;
  for (auto name : kStatNames)
    accesses += static_cast<double>(count(r, "bus." + std::string(name) + ".transactions"));
  accesses -= static_cast<double>(count(r, "bus.config.read_bytes") + count(r, "bus.config.write_bytes")) / 4;
  EXPECT_EQ(decided("sync.direct") + decided("sync.queued"), accesses);
  EXPECT_DOUBLE_EQ(std::get<double>(app::find(r.host, "sync.direct_share")->value),
                   decided("sync.direct") / (decided("sync.direct") + decided("sync.queued")));
  // One word out for each pair, and no other uncached or missing stores of that size class.
  EXPECT_GE(count(r, "cpu.dcache.write_misses"), 320u / 2 * 64 * 10);
}

// A sentence that leans on the line before is the sentence of other figures too; masters that do
// nothing have no latency.
TEST(RunTest, SentencesStandAloneAndFiguresOfNothingAreNull) {
  const auto r = run({{"video.width", "64"}, {"video.height", "16"}, {"run.frames", "2"}});
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  std::map<std::string, std::string> seen;
  for (const app::StatRow& row : r.stats) {
    const auto [first, fresh] = seen.emplace(row.description, row.name);
    EXPECT_TRUE(fresh) << row.name << " and " << first->second << ": " << row.description;
    for (const char* part : {"of them", "of those", "as above", "this master", "this bank"})
      EXPECT_EQ(row.description.find(part), std::string::npos) << row.name;
  }
  for (const char* figure : {"mean", "p50", "p95", "p99", "max"}) {
    EXPECT_EQ(app::number_text(app::find(r.stats, std::string("ddr.edma_tc0.latency.") + figure)->value),
              "null");
    EXPECT_GT(real(r, std::string("ddr.vpbe.latency.") + figure), 0.0);
  }
}

/// With a kernel that only copies, the display shows the camera's own rows; the chart's bytes differ from
/// field to field.
void expect_camera_pictures(const Keys& keys, std::uint64_t frames, unsigned width, unsigned height) {
  Keys all{{"firmware.kernel", "copy"}, {"video.width", std::to_string(width)},
           {"video.height", std::to_string(height)}, {"run.frames", std::to_string(frames)}};
  all.insert(all.end(), keys.begin(), keys.end());
  Seen seen;
  const auto r = run(all, false, kNever, &seen);
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  ASSERT_EQ(seen.shown.size(), frames);
  ASSERT_EQ(seen.cameras.size(), frames);
  for (const video::FrameTimes& t : seen.times) {
    EXPECT_EQ(t.camera, 0u);
    ASSERT_TRUE(t.captured && t.capture_start && t.capture_end && t.remap_start && t.remap_end);
    const std::array way{*t.capture_start, *t.capture_end, *t.remap_start,
                         *t.remap_end,     t.display_start, t.display_end};
    EXPECT_TRUE(std::ranges::is_sorted(way)) << "frame " << t.index;
    const std::uint64_t period = seen.times[1].display_start - seen.times[0].display_start;
    EXPECT_NEAR(static_cast<double>(t.display_end - t.display_start), 0.96 * static_cast<double>(period),
                0.01 * static_cast<double>(period)) << "two fields and the blanking between them, not that behind them";
  }
  for (const auto& [index, shown] : seen.shown) {
    const video::Picture& sent = seen.cameras.at(index);
    ASSERT_EQ(sent.width, shown.width);
    ASSERT_EQ(sent.height, shown.height);
    const unsigned x = (shown.width - width) / 2, y = (shown.height - height) / 2;
    for (unsigned row = y; row < y + height; ++row)
      EXPECT_TRUE(std::equal(shown.row(row) + x * 2, shown.row(row) + (x + width) * 2, sent.row(row) + x * 2))
          << "frame " << index << ", row " << row;
    if (index > 0) {
      EXPECT_NE(sent, seen.cameras.at(index - 1)) << "the chart moves";
    }
  }
}
TEST(RunTest, CameraPicturesAreThoseThatTheDisplayedFramesShow) {
  expect_camera_pictures({}, 3, 64, 16);
}
TEST(RunTest, CameraPicturesOfTheOtherStandard) {
  expect_camera_pictures({{"video.standard", "ntsc"}}, 4, 64, 16);
}

TEST(RunTest, NtscWindowHasTheTelevisionRate) {
  const auto r = run({{"video.standard", "ntsc"}, {"video.width", "160"},
                      {"video.height", "48"}, {"run.frames", "10"}});
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  expect_conservation(r);
  EXPECT_NEAR(real(r, "frame.rate"), 30000.0 / 1001, 1e-6);
  EXPECT_EQ(count(r, "bus.vpfe.write_bytes"), 160u * 48 * 2 * 10);
}

// The firmware that is built here does nothing that the data sheet or the model objects to. 340 MHz
// needs a part of the grade that has such a clock.
class EveryPreset : public testing::TestWithParam<const char*> {};
TEST_P(EveryPreset, RunsWithoutWarnings) {
  const OwnDiagnostics diagnostics;
  const std::string preset = GetParam();
  const auto r = run({{"clocks.preset", preset}, {"video.width", "64"}, {"video.height", "16"},
                      {"run.frames", "2"},
                      {"ddr.grade", preset == "432/340" ? "25e" : "3"}});
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  for (const auto& [what, times] : diagnostics.counts()) ADD_FAILURE() << what.second << ", " << times << " times";
}
INSTANTIATE_TEST_SUITE_P(RunTest, EveryPreset,
                         testing::Values("297/243", "297/270", "270/216", "216/172", "432/340"),
                         [](const auto& preset) {
                           std::string name = preset.param;
                           std::replace(name.begin(), name.end(), '/', '_');
                           return name;
                         });

// Clocks between the presets, in the ranges of their PLLs: exact in the core's count of clocks and in the SDRAM's.
class FreeClocks : public testing::TestWithParam<std::pair<int, int>> {};
TEST_P(FreeClocks, RunWithoutWarnings) {
  const OwnDiagnostics diagnostics;
  const auto [core, ddr] = GetParam();
  const auto r = run({{"clocks.arm", std::to_string(core) + "MHz"}, {"clocks.ddr", std::to_string(ddr) + "MHz"},
                      {"video.width", "64"}, {"video.height", "16"}, {"run.frames", "2"}});
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  EXPECT_NEAR(static_cast<double>(count(r, "cpu.cycles")), 0.08 * core * 1e6, 200);
  for (const auto& [what, times] : diagnostics.counts()) ADD_FAILURE() << what.second << ", " << times << " times";
}
INSTANTIATE_TEST_SUITE_P(RunTest, FreeClocks,
                         testing::Values(std::pair{27, 333}, std::pair{135, 162}, std::pair{300, 135},
                                         std::pair{378, 125}, std::pair{432, 200}),
                         [](const auto& p) {
                           return std::to_string(p.param.first) + "_" + std::to_string(p.param.second);
                         });

// A stopped run. Each of the two is a process of its own: a simulation elaborates once.

/// What a run stopped at `stop_at` leaves in its files, from a child process.
std::string stopped(const Keys& keys, bool strict, Picoseconds stop_at) {
  int ends[2];
  EXPECT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    Seen seen;
    const auto r = run(keys, strict, stop_at, &seen);
    const std::string text = app::stats_json(r.stats, r.complete, {}) + app::frames_csv(seen.times) +
                             app::timeline_csv(r.timeline_masters, r.timeline) +
                             app::stalls_csv(r.stalls) + app::latency_csv(r.latency) + r.uart;
    for (std::size_t done = 0; done < text.size();) {
      const auto n = ::write(ends[1], text.data() + done, text.size() - done);
      if (n <= 0) ::_exit(1);
      done += static_cast<std::size_t>(n);
    }
    ::_exit(0);
  }
  ::close(ends[1]);
  std::string text;
  char chunk[4096];
  for (ssize_t n; (n = ::read(ends[0], chunk, sizeof chunk)) > 0;)
    text.append(chunk, static_cast<std::size_t>(n));
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  return text;
}

class StoppedRunTest : public testing::TestWithParam<int> {};
TEST_P(StoppedRunTest, StrictAndDefaultLeaveTheSame) {
  const Picoseconds at = static_cast<Picoseconds>(GetParam()) * kPsPerMs;
  // The synthetic master is under way at every instant.
  const Keys keys{{"video.width", "320"},     {"video.height", "64"}, {"run.frames", "1000"},
                  {"load.outstanding", "2"}, {"load.pattern", "random"},
                  {"load.start", "395ms"}};
  const std::string strict = stopped(keys, true, at), ahead = stopped(keys, false, at);
  EXPECT_NE(strict.find("\"complete\": false"), std::string::npos);
  EXPECT_NE(strict.find("\"bus.load.read_bytes\""), std::string::npos);
  const auto differ = std::mismatch(strict.begin(), strict.end(), ahead.begin(), ahead.end());
  const auto from = static_cast<std::size_t>(differ.first - strict.begin());
  const std::size_t begin = from - std::min<std::size_t>(from, 60);
  EXPECT_TRUE(strict == ahead) << "strict: ..." << strict.substr(begin, 120) << "\ndefault: ..."
                               << ahead.substr(begin, 120);
}
// Frames are shown every 40 ms from about 0.35 s.
INSTANTIATE_TEST_SUITE_P(AtMs, StoppedRunTest, testing::Values(400, 405, 410, 415));

/// A small mosaic of the car park, by cameras whose lenses are those of the tables.
app::Result run_mosaic(unsigned frames, Seen* seen) {
  return run({{"firmware.elf", std::string(FOVEA_FIRMWARE_DIR) + "/fovea_views.elf"},
              {"cameras.count", "4"},
              {"camera.kind", "car_park"},
              {"camera.lens", "equisolid"},
              {"camera.fov", "180deg"},
              {"lens.mapping", "equisolid"},
              {"lens.fov", "180deg"},
              {"tvp5146.relock_fields", "0"},
              {"firmware.view", "birds_eye"},
              {"firmware.lut", "fixed_point"},
              {"run.frames", std::to_string(frames)}},
             false, kNever, seen);
}

// The mosaic fills 720x576 of the raster; the ground and the car are those of the keys' defaults.
TEST(RunTest, TheLastMosaicOfACarParkIsScoredAgainstItsPlan) {
  Seen seen;
  const app::Result r = run_mosaic(6, &seen);
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  const video::PlanScore score({720, 576, 16, 12}, 4.8, 2);
  const auto last = score(seen.shown.at(5));
  EXPECT_EQ(real(r, "quality.psnr_y"), last.psnr_y);
  EXPECT_EQ(real(r, "quality.ssim_y"), last.ssim_y);
  EXPECT_EQ(real(r, "quality.line_error"), last.line_error);
  EXPECT_EQ(count(r, "quality.lines"), last.lines);
  EXPECT_EQ(count(r, "quality.lines_missed"), last.missed);
  // The first mosaic has one camera's part, so another mosaic's score would be another one.
  const auto first = score(seen.shown.at(0));
  EXPECT_LT(first.lines, last.lines / 2);
  EXPECT_LT(first.psnr_y, last.psnr_y - 3);
  // Lines of the car park are where they are in the plan: pairs move as a whole, by up to a pixel.
  EXPECT_GT(last.lines, 100u);
  EXPECT_LT(last.line_error, 1.5);
}

TEST(RunTest, AMosaicWithABlackPartHasNoScore) {
  Seen seen;
  const app::Result r = run_mosaic(3, &seen);
  EXPECT_EQ(seen.shown.size(), 3u);
  for (const char* name : {"psnr_y", "ssim_y", "line_error", "lines", "lines_missed"})
    EXPECT_FALSE(app::find(r.stats, std::string("quality.") + name)) << name;
}

/// A picture of the chart of lines, seen by an equisolid lens of 180 degrees, which is also the one that is corrected
/// if `keys` do not say otherwise.
app::Result run_lines(Keys keys, Seen* seen = nullptr) {
  const Keys lens{{"camera.kind", "lines"},     {"camera.lens", "equisolid"}, {"camera.fov", "180deg"},
                  {"lens.mapping", "equisolid"}, {"lens.fov", "180deg"},       {"firmware.lut", "fixed_point"},
                  {"run.frames", "2"}};
  keys.insert(keys.begin(), lens.begin(), lens.end());
  return run(keys, false, kNever, seen);
}

/// Focal length of an equisolid lens of 180 degrees across 720 pixels, by its definition.
const double kLinesFocal = 720 / (4 * std::sin(M_PI / 4));

// The root mean square of a pair's rounding, 1/√3 px, magnified by the farthest corner of the view (unit.scene,
// LineChart, has the derivation).
double lines_bound() {
  const double theta = std::atan(std::hypot(360, 288) / kLinesFocal);
  return std::sqrt(1 / 3.0) / (std::cos(theta / 2) * std::cos(theta) * std::cos(theta));
}

TEST(RunTest, TheLastPictureOfTheChartOfLinesIsScored) {
  Seen seen;
  const app::Result r = run_lines({}, &seen);
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  const auto last = video::LineScore({720, 576, kLinesFocal, 1, 0, 0})(seen.shown.at(1));
  EXPECT_EQ(real(r, "quality.straightness"), last.straightness);
  EXPECT_NEAR(real(r, "quality.psnr_y"), last.psnr_y, 1e-9);
  EXPECT_NEAR(real(r, "quality.ssim_y"), last.ssim_y, 1e-9);
  EXPECT_EQ(count(r, "quality.places"), last.places);
  EXPECT_EQ(count(r, "quality.places_missed"), last.missed);
  EXPECT_LT(last.straightness, lines_bound());
  EXPECT_GT(last.places, 6500u);
  EXPECT_GT(last.psnr_y, 20);
  // Beside it, what a remap of each pixel by itself would have shown: by the definition of the lens.
  const video::Picture& sent = seen.cameras.at(1);
  video::Picture pixels(720, 576);
  for (unsigned v = 0; v < 576; ++v)
    for (unsigned u = 0; u < 720; ++u) {
      const double x = u - 359.5, y = v - 287.5, across = std::hypot(x, y);
      const double stretch = 2 * kLinesFocal * std::sin(std::atan(across / kLinesFocal) / 2) / across;
      const auto column = static_cast<unsigned>(std::lround(359.5 + stretch * x));
      pixels.row(v)[2 * u + 1] = sent.row(static_cast<unsigned>(std::lround(287.5 + stretch * y)))[2 * column + 1];
    }
  EXPECT_NEAR(real(r, "quality.pair_psnr_y"), video::psnr_y(seen.shown.at(1), pixels), 1e-9);
  EXPECT_NEAR(real(r, "quality.pair_ssim_y"), video::ssim_y(seen.shown.at(1), pixels), 1e-9);
  const auto by_pixels = video::LineScore({720, 576, kLinesFocal, 1, 0, 0})(pixels);
  EXPECT_NEAR(real(r, "quality.pixel_psnr_y"), by_pixels.psnr_y, 1e-9);
  EXPECT_NEAR(real(r, "quality.pixel_ssim_y"), by_pixels.ssim_y, 1e-9);
  EXPECT_NEAR(real(r, "quality.pixel_straightness"), by_pixels.straightness, 1e-9);
  EXPECT_GT(by_pixels.psnr_y, last.psnr_y + 2);
  EXPECT_LT(by_pixels.straightness, last.straightness);
}

// The firmware believes in another lens than the camera has; the view that is displayed is the same.
TEST(RunTest, WithAWrongLensTheLinesAreBent) {
  const app::Result r = run_lines({{"lens.fov", "150deg"}, {"lens.out_focal", std::to_string(kLinesFocal) + "px"}});
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  EXPECT_GT(real(r, "quality.straightness"), 1.5 * lines_bound());
  EXPECT_LT(real(r, "quality.psnr_y"), 15);
}

TEST(RunTest, WithoutACorrectionTheLinesAreBentMost) {
  const app::Result r = run_lines({{"firmware.kernel", "copy"}});
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  EXPECT_GT(real(r, "quality.straightness"), 2.5 * lines_bound());
}

// Where the meant view is wrong, the picture is no more like the pin-hole camera's than a wrong lens's: below 15 dB.
struct LinesView {
  const char* name;
  Keys keys;
};
class LinesViewTest : public testing::TestWithParam<LinesView> {};
TEST_P(LinesViewTest, IsTheOneThatTheKeysMean) {
  const app::Result r = run_lines(GetParam().keys);
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  EXPECT_GT(real(r, "quality.psnr_y"), 18);
  EXPECT_LT(real(r, "quality.straightness"), lines_bound());
}
INSTANTIATE_TEST_SUITE_P(
    Run, LinesViewTest,
    testing::Values(LinesView{"Shifted",
                              {{"lens.shift_x", "41px"}, {"switches.shift_y", "down"}, {"lens.shift_y", "-9px"}}},
                    LinesView{"OfAnotherScale", {{"lens.out_focal", "200px"}, {"lens.out_aspect", "1.2"}}},
                    LinesView{"ByTheFocalLength",
                              {{"lens.focal", std::to_string(kLinesFocal) + "px"}, {"lens.fov", "100deg"}}},
                    LinesView{"OfAPart",
                              {{"video.width", "480"},
                               {"video.height", "384"},
                               {"lens.focal", std::to_string(kLinesFocal) + "px"}}},
                    LinesView{"OfARegion", {{"lens.roi", "[200, 150, 432, 300]"}, {"lens.shift_x", "9px"}}},
                    LinesView{"OfADigitalCamera", {{"video.standard", "svga_progressive"}}}),
    [](const auto& param) { return param.param.name; });

// Pixel for pixel nothing is lost by moving pairs.
TEST(RunTest, WithoutALensPairsAndPixelsAreTheSame) {
  const auto r = run({{"lens.mapping", "none"}, {"lens.shift_x", "4px"}, {"video.width", "64"}, {"video.height", "16"},
                      {"run.frames", "2"}});
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  EXPECT_EQ(app::number_text(app::find(r.stats, "quality.pair_psnr_y")->value), "null") << "an infinite ratio";
  EXPECT_NEAR(real(r, "quality.pair_ssim_y"), 1, 1e-12);
  EXPECT_FALSE(app::find(r.stats, "quality.pixel_psnr_y")) << "the chart's scene has no truth";
}

// A copy corrects nothing; with several tables the last one is not that of the keys.
class NoPairsTest : public testing::TestWithParam<std::pair<const char*, Keys>> {};
TEST_P(NoPairsTest, PicturesThatAreNotRemappedByTheKeysHaveNoScoreOfPairs) {
  Keys keys{{"video.width", "64"}, {"video.height", "16"}, {"run.frames", "2"}};
  keys.insert(keys.end(), GetParam().second.begin(), GetParam().second.end());
  const auto r = run(keys);
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  for (const app::StatRow& row : r.stats) EXPECT_FALSE(row.name.starts_with("quality.")) << row.name;
}
INSTANTIATE_TEST_SUITE_P(RunTest, NoPairsTest,
                         testing::Values(std::pair<const char*, Keys>{"Copy", {{"firmware.kernel", "copy"}}},
                                         std::pair<const char*, Keys>{"Tables", {{"firmware.tables", "2"}}},
                                         std::pair<const char*, Keys>{"Overlay", {{"firmware.overlay", "true"}}},
                                         std::pair<const char*, Keys>{"LowerThanAWindow", {{"video.height", "8"}}}),
                         [](const auto& param) { return std::string(param.param.first); });

// The series of the equisolid lens, as a calibration, and a region of interest: the reference is of the same view, or
// it would be as far from the picture as a wrong lens's.
TEST(RunTest, ThePixelsOfACalibratedLensAreThoseOfItsPairs) {
  const auto r = run_lines({{"lens.mapping", "kannala_brandt"},
                            {"lens.kb", "[254.558, 254.558, 359.5, 287.5, -0.0416667, 0.000520833, 0, 0]"},
                            {"lens.kb_width", "720px"},
                            {"lens.kb_height", "576px"},
                            {"lens.theta_max", "89deg"},
                            {"lens.roi", "[100, 130, 400, 300]"}});
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  EXPECT_GT(real(r, "quality.pair_psnr_y"), 18);
  EXPECT_GT(real(r, "quality.pixel_psnr_y"), real(r, "quality.psnr_y") + 1);
  EXPECT_GT(real(r, "quality.psnr_y"), 15);
}

// A flat film, bent into the lens that is corrected. Of all frames around, the one that the score is made with is the
// one that fits best.
TEST(RunTest, ARoadFilmIsScoredAgainstItsFlatFrame) {
  Seen seen;
  const app::Result r = run_lines(
      {{"camera.kind", "video"}, {"camera.file", FOVEA_ROAD_FILM}, {"camera.video_fov", "130deg"}}, &seen);
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  app::DecodeOptions options;
  options.max_frames = 16;  // the first frames are shown in the first half second
  options.most_width = 1440;
  options.most_height = 1152;
  const video::FilmScore score(130, {720, 576, kLinesFocal, 1, 0, 0});
  video::FilmScore::Result best{};
  const auto film = app::decode_frames(FOVEA_ROAD_FILM, options);
  std::size_t which = 0;
  for (std::size_t n = 5; n < film.size(); ++n) {
    const auto s = score(seen.shown.at(1), film[n]);
    if (s.psnr_y > best.psnr_y) best = s, which = n;
  }
  EXPECT_TRUE(which > 5 && which < 15) << "frames on both sides were looked at: " << which;
  EXPECT_EQ(real(r, "quality.psnr_y"), best.psnr_y);
  EXPECT_EQ(real(r, "quality.ssim_y"), best.ssim_y);
  EXPECT_GT(best.psnr_y, 20);
  EXPECT_GT(real(r, "quality.pixel_psnr_y"), best.psnr_y + 1);
  EXPECT_GT(real(r, "quality.pixel_ssim_y"), best.ssim_y);
  EXPECT_GT(real(r, "quality.pair_psnr_y"), 20);
  EXPECT_FALSE(app::find(r.stats, "quality.straightness"));
}

void expect_no_score(const app::Result& r) {
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  for (const char* name : {"psnr_y", "ssim_y", "straightness", "places", "places_missed"})
    EXPECT_FALSE(app::find(r.stats, std::string("quality.") + name)) << name;
}
TEST(RunTest, PicturesWithMarksHaveNoScore) { expect_no_score(run_lines({{"camera.stamp", "true"}})); }
TEST(RunTest, PicturesWithAnOverlayHaveNoScore) { expect_no_score(run_lines({{"firmware.overlay", "true"}})); }

TEST(RunTest, TheChartOfLinesIsSeenThroughALensThatIsAFormula) {
  EXPECT_THROW(run_lines({{"camera.lens", "kannala_brandt"}}), UserError);
}

TEST(RunTest, ColourBarsComeToTheDisplayAsTheyAreSent) {
  Seen seen;
  const app::Result r = run({{"camera.kind", "bars"}, {"firmware.kernel", "copy"}, {"run.frames", "2"}}, false,
                               kNever, &seen);
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  EXPECT_EQ(seen.shown.at(1), video::BarsSource({720, 576, false, 0}).field(0));
}

// A load that begins at power-up by default waits until boot software has brought up the SDRAM, and the
// guest is not blamed for it.
TEST(RunTest, LoadWithTheDefaultStartWaitsForTheSdram) {
  const OwnDiagnostics diagnostics;
  const auto r = run({{"video.width", "64"}, {"video.height", "16"}, {"run.frames", "2"},
                      {"load.outstanding", "1"}});
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  EXPECT_GT(count(r, "bus.load.read_bytes"), 1'000'000u);
  for (const auto& [what, n] : diagnostics.counts()) {
    EXPECT_EQ(what.second.find("before its controller runs"), std::string::npos) << what.second;
    EXPECT_EQ(what.second.find("SDBCR CL: 4"), std::string::npos)
        << "the loader's passing CL is not reported: " << what.second;
  }
}

// A run that ends by something else than frames is measured from its start on, the firmware's own start included.
TEST(RunTest, ARunUntilATimeIsMeasuredAsAWhole) {
  const auto r = run({{"video.width", "64"}, {"video.height", "16"}, {"run.until", "time:400ms"}});
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  EXPECT_NEAR(real(r, "frame.window"), 0.4, 1e-9);
  // All of it at 297 MHz, but for some milliseconds of 24 MHz at the beginning.
  EXPECT_GT(count(r, "cpu.cycles"), 115'800'000u);
  EXPECT_LE(count(r, "cpu.cycles"), 118'800'100u);
}

TEST(RunTest, StoppedRunHasTheRateOfItsWholeFrames) {
  const auto r = run({{"video.width", "64"}, {"video.height", "16"}, {"run.frames", "1000"}}, false,
                     510 * kPsPerMs);
  ASSERT_FALSE(r.complete);
  expect_conservation(r);
  const std::uint64_t shown = count(r, "frame.displayed");
  EXPECT_GE(shown, 2u);
  // The window ends in the middle of a frame, so frames / window would be less than the rate.
  const double frames = real(r, "frame.window") / 0.04;
  EXPECT_GT(frames - static_cast<double>(shown), 0.05);
  EXPECT_LT(frames - static_cast<double>(shown), 1.0);
  EXPECT_DOUBLE_EQ(real(r, "frame.rate"), 25.0);
}

TEST(RunTest, StoppedRunWithoutAWholeFrameHasNoRate) {
  const Keys keys{{"video.width", "64"}, {"video.height", "16"}, {"run.frames", "1000"}};
  const std::string before = stopped(keys, false, 600 * kPsPerMs);
  const std::string name = "\"startup.first_frame\": {\"value\": ";
  ASSERT_NE(before.find(name), std::string::npos);
  const double start = std::stod(before.substr(before.find(name) + name.size()));
  const auto r = run(keys, false, static_cast<Picoseconds>(start * 1e12));
  ASSERT_FALSE(r.complete);
  EXPECT_GT(real(r, "frame.window"), 0.0);
  EXPECT_LT(real(r, "frame.window"), 0.04);
  EXPECT_EQ(count(r, "frame.displayed"), 0u);
  EXPECT_EQ(app::find(r.stats, "frame.rate"), nullptr);
}

}  // namespace
}  // namespace fovea::e2e

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
