// A progressive camera at the digital port: times of lines and frames, codes, every byte of a line.
#include <gtest/gtest.h>

#include "model/common/check.h"
#include "model/video/digital_camera.h"
#include "tb/video/bench.h"

namespace fovea::video {
namespace {

constexpr Picoseconds kPhase = 3 * kPsPerMs;

std::uint8_t pattern(std::uint64_t k, unsigned row, unsigned i) {
  return static_cast<std::uint8_t>(1 + (k * 91 + row * 37 + i * 5) % 254);
}

class Chart : public PictureSource {
 public:
  explicit Chart(const Standard& s) : picture_{s.active_pixels, s.rows} {}
  unsigned width() const override { return picture_.width; }
  unsigned height() const override { return picture_.height; }
  const Picture& field(std::uint64_t k) override {
    asked.push_back(k);
    for (unsigned y = 0; y < picture_.height; ++y)
      for (unsigned i = 0; i < picture_.row_bytes(); ++i) picture_.row(y)[i] = pattern(k, y, i);
    return picture_;
  }
  std::vector<std::uint64_t> asked;

 private:
  Picture picture_;
};

/// Takes each line, and counts them as a receiver does.
struct Wire : Bt656If {
  struct Seen {
    Picoseconds start;
    std::uint8_t eav, sav = 0;
  };
  explicit Wire(const Standard& s) : standard(s) {}
  bool begin_line(const Bt656Line& l) override {
    EXPECT_EQ(l.clock->edge(l.first_sample), kernel_time());
    lines.push_back({kernel_time(), l.eav_xy});
    return true;
  }
  void take_line(std::span<const std::uint8_t> bytes) override {
    ASSERT_EQ(bytes.size(), standard.line_bytes);
    Seen& seen = lines.back();
    const unsigned first = standard.line_bytes - 2 * standard.active_pixels;
    seen.sav = bytes[first - 1];
    for (const unsigned at : {0u, first - 4}) EXPECT_TRUE(bytes[at] == 0xFF && !bytes[at + 1] && !bytes[at + 2]);
    EXPECT_EQ(bytes[3], seen.eav);
    if (seen.eav & 0x20) return;
    const std::uint64_t frame = (lines.size() - 1) / standard.lines;
    const unsigned number = static_cast<unsigned>((lines.size() - 1) % standard.lines) + 1;
    for (unsigned i = 0; i < 2 * standard.active_pixels; ++i)
      wrong += bytes[first + i] != pattern(2 * frame, number - standard.active_first[0], i);
  }
  const Standard& standard;
  std::vector<Seen> lines;
  unsigned wrong = 0;
};

struct Bench {
  const Standard& standard;
  Chart chart{standard};
  Wire wire{standard};
  ClockSignal clock;
  DigitalCamera camera;
  Bench(const char* name, const Standard& s)
      : standard(s),
        clock((std::string(name) + "_clock").c_str(), s.clock),
        camera(name, s, chart, kPhase) {
    camera.clock(clock);
    camera.video.bind(wire);
  }
};
Bench* bench[2] = {};

// Lines of 2112 bytes at 33.1584 MHz, 628 of them; 1716 at 27 MHz, 525 of them.
TEST(DigitalCameraTest, LinesAndFramesComeAtTheTimesOfTheirRaster) {
  run_for(kPhase + 130 * kPsPerMs);
  const struct {
    double line_us, frame_ms;
    unsigned lines, first, last;
  } want[2] = {{1716 / 27.0, 1001 / 30.0, 525, 46, 525}, {2112 / 33.1584, 40, 628, 28, 627}};
  for (unsigned b = 0; b < 2; ++b) {
    const auto& lines = bench[b]->wire.lines;
    ASSERT_GT(lines.size(), 3u * want[b].lines);
    for (std::size_t n = 0; n < lines.size(); ++n) {
      const Wire::Seen& l = lines[n];
      EXPECT_NEAR(static_cast<double>(l.start - kPhase) / kPsPerUs, static_cast<double>(n) * want[b].line_us, 0.0381);
      const unsigned number = static_cast<unsigned>(n % want[b].lines) + 1;
      const bool picture = number >= want[b].first && number <= want[b].last;
      ASSERT_EQ(l.eav, picture ? 0x9D : 0xB6) << "F = 0; V; protection bits as in BT.656";
      ASSERT_EQ(l.sav, picture ? 0x80 : 0xAB);
    }
    const Picoseconds frames = lines[3 * want[b].lines].start - lines[0].start;
    EXPECT_NEAR(static_cast<double>(frames) / kPsPerMs, 3 * want[b].frame_ms, 1e-7);
    EXPECT_EQ(bench[b]->wire.wrong, 0u);
    EXPECT_EQ((std::vector<std::uint64_t>{0, 2, 4, 6}),
              std::vector<std::uint64_t>(bench[b]->chart.asked.begin(), bench[b]->chart.asked.begin() + 4));
    const DigitalCamera& camera = bench[b]->camera;
    const Picoseconds second = lines[want[b].lines].start;
    EXPECT_EQ(camera.source_field(0), 0u);
    EXPECT_EQ(camera.source_field(second - 1), 0u);
    EXPECT_EQ(camera.source_field(second), 2u);
  }
}

TEST(DigitalCameraTest, AStoppedClockStopsTheLinesAndTheyGoOnWithTheNextOne) {
  Bench& b = *bench[1];
  const std::size_t before = b.wire.lines.size();
  b.clock.write(Frequency{});
  run_for(5 * kPsPerMs);
  EXPECT_EQ(b.wire.lines.size(), before);
  b.clock.write(b.standard.clock);
  run_for(45 * kPsPerMs);
  EXPECT_GT(b.wire.lines.size(), before + b.standard.lines);
  EXPECT_EQ(b.wire.wrong, 0u) << "none is left out, and none comes twice";
}

bool refused_other_size = false;  // tried before the simulation starts
TEST(DigitalCameraTest, APictureOfAnotherSizeIsRefused) { EXPECT_TRUE(refused_other_size); }

}  // namespace
}  // namespace fovea::video

int sc_main(int argc, char** argv) {
  using namespace fovea::video;
  testing::InitGoogleTest(&argc, argv);
  Chart other(k480p);
  try {
    DigitalCamera wrong("wrong", k600p, other, 0);
  } catch (const fovea::UserError&) {
    refused_other_size = true;
  }
  bench[0] = new Bench("vga", k480p);
  bench[1] = new Bench("svga", k600p);
  return RUN_ALL_TESTS();
}
