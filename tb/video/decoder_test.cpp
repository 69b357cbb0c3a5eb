// Decoder and ISIF in full size: I2C, lock, rates, every byte of captured frames.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <span>
#include <vector>

#include "model/video/isif.h"
#include "model/video/tvp5146.h"
#include "tb/video/bench.h"
#include "tb/video/setting.h"

namespace fovea::video {
namespace {

// The story is the same for each standard, size and placement of the rows: CMakeLists.txt lists them.
const std::string kStandard = setting("FOVEA_STANDARD", "625/50");
const std::string kCrop = setting("FOVEA_CROP", "first_lines");
const bool k625Here = kStandard == "625/50";
const bool kStudio = kCrop == "studio";
const Standard& kStd = standard_of(k625Here);
const unsigned kWidth = setting("FOVEA_WIDTH", 720u), kHeight = setting("FOVEA_HEIGHT", kStd.rows);
const unsigned kRelock = setting("FOVEA_RELOCK", 10u);
const std::string kUnlocked = setting("FOVEA_UNLOCKED", "black");
constexpr std::uint32_t kBuffer = 0x8010'0000;
const unsigned kPitch = (kWidth * 2 + 31) / 32 * 32;
const int kLocked = k625Here ? 0x2E : 0x0E;  // STATUS1 without the lost-lock bit

std::uint8_t pattern(std::uint64_t k, unsigned row, unsigned i) {
  return static_cast<std::uint8_t>(1 + (k * 91 + row * 37 + i * 5 + (row * i >> 4)) % 254);
}

class Chart : public PictureSource {
 public:
  unsigned width() const override { return kWidth; }
  unsigned height() const override { return kHeight; }
  const Picture& field(std::uint64_t k) override {
    ++asked;
    for (unsigned y = 0; y < kHeight; ++y)
      for (unsigned i = 0; i < picture_.row_bytes(); ++i) picture_.row(y)[i] = pattern(k, y, i);
    return picture_;
  }
  unsigned asked = 0;

 private:
  Picture picture_{kWidth, kHeight};
};

/// A wire without a receiver.
struct Wire : Bt656If {
  bool begin_line(const Bt656Line&) override { return false; }
  void take_line(std::span<const std::uint8_t>) override {}
};

struct Bench {
  VpssParams vpss;
  Tvp5146Params tvp_params;
  Chart chart;
  sc_core::sc_signal<bool> on{"on", true};
  ClockSignal clock{"clock", kByteClock};
  sc_core::sc_vector<sc_core::sc_signal<bool>> event{"event", 3};
  std::unique_ptr<Tvp5146> tvp;
  Tvp5146Params two_params;
  std::unique_ptr<Tvp5146> two;  ///< with a camera on each of its inputs 0 and 1
  /// Two cameras whose syncs are apart: on two inputs, and on one behind a multiplexer.
  Tvp5146Params apart_params;
  std::unique_ptr<Tvp5146> by_input, by_multiplexer;
  Wire wire;
  Isif isif{"isif", vpss};
  FakeMemory memory{"memory"};
  RegisterPort regs{"regs"};
  sc_core::sc_vector<EdgeLog> edges{"edges", 3};
  std::vector<CaptureFrame> ended;
  std::map<Picoseconds, Tvp5146::OnWire> began;  ///< what was sent at the start of each captured frame

  Bench() {
    tvp_params.standard.set(kStandard);
    tvp_params.crop_525.set(kCrop);
    tvp_params.relock_fields.set(std::to_string(kRelock));
    tvp_params.phase.set(setting("FOVEA_PHASE", "0s"));
    tvp_params.rom_version.set("35");
    tvp_params.unlocked_output.set(kUnlocked);
    tvp = std::make_unique<Tvp5146>("tvp", tvp_params, chart);
    tvp->clock(clock);
    two_params.output_at_reset.set("true");
    two_params.relock_fields.set("0");
    const CameraWiring camera{.source = &chart, .is_625 = k625Here, .placement = placement_of(tvp_params, k625Here)};
    std::vector<CameraWiring> cameras(2, camera);
    cameras[1].input = 1;
    two = std::make_unique<Tvp5146>("two", two_params, cameras);
    two->clock(clock);
    two->video.bind(wire);
    apart_params.output_at_reset.set("true");
    apart_params.relock_fields.set(std::to_string(kRelock));
    cameras[1].phase = 7 * kPsPerMs;
    by_input = std::make_unique<Tvp5146>("by_input", apart_params, cameras);
    cameras[1].input = 0;
    by_multiplexer = std::make_unique<Tvp5146>("by_multiplexer", apart_params, cameras);
    by_multiplexer->route(0);
    for (Tvp5146* decoder : {by_input.get(), by_multiplexer.get()}) {
      decoder->clock(clock);
      decoder->video.bind(wire);
    }
    tvp->video.bind(isif.video);
    isif.memory.socket.bind(memory.socket);
    regs.socket.bind(isif.reg_socket);
    isif.psc_enabled(on);
    isif.gate(on);
    isif.owns_write_buffer(on);
    for (unsigned i = 0; i < 3; ++i) {
      isif.vdint[i].out(event[i]);
      edges[i].in(event[i]);
    }
    isif.on_frame_start = [this](const CaptureFrame& f) { began[f.start] = tvp->on_wire(); };
    isif.on_frame_end = [this](const CaptureFrame& f) { ended.push_back(f); };
  }
  static void i2c_write(Tvp5146& to, std::uint8_t reg, std::uint8_t value) {
    ASSERT_TRUE(to.i2c_start(0x5D, false));
    to.i2c_write(reg);
    to.i2c_write(value);
    to.i2c_stop();
  }
  static std::uint8_t i2c_read(Tvp5146& from, std::uint8_t reg) {
    EXPECT_TRUE(from.i2c_start(0x5D, false));
    from.i2c_write(reg);
    EXPECT_TRUE(from.i2c_start(0x5D, true));
    const std::uint8_t v = from.i2c_read();
    from.i2c_stop();
    return v;
  }
  void i2c_write(std::uint8_t reg, std::uint8_t value) { i2c_write(*tvp, reg, value); }
  std::uint8_t i2c_read(std::uint8_t reg) { return i2c_read(*tvp, reg); }
};
Bench* bench = nullptr;

/// Bytes of a captured frame that are not those of the camera's two fields.
unsigned wrong_bytes(const CaptureFrame& f) {
  const std::uint64_t first = bench->began.at(f.start).field;
  unsigned wrong = 0;
  for (unsigned r = 0; r < kHeight; ++r) {
    const bool second = (r % 2 != 0) != kStudio;
    for (unsigned i = 0; i < kWidth * 2; ++i)
      wrong += bench->memory.at(kBuffer + r * kPitch)[i] != pattern(first + second, r, i);
  }
  return wrong;
}

/// What a frame that is captured from now on shows.
std::string captured() {
  bench->ended.clear();
  while (bench->ended.size() < 3) run_for(kPsPerMs);
  std::array<unsigned, 256> luma{};
  unsigned colour = 0;
  for (unsigned r = 0; r < kHeight; ++r)
    for (unsigned i = 0; i < kWidth * 2; i += 2) {
      colour += bench->memory.at(kBuffer + r * kPitch)[i] != 0x80;
      ++luma[bench->memory.at(kBuffer + r * kPitch)[i + 1]];
    }
  if (!colour && luma[16] == kWidth * kHeight) return "black";
  if (wrong_bytes(bench->ended[2]) == 0) return "picture";
  // Each of the 220 levels of BT.601 has its share, to within a half, and no other one comes.
  const double share = kWidth * kHeight / 220.0;
  for (unsigned level = 0; level < luma.size(); ++level)
    if (level < 16 || level > 235 ? luma[level] != 0 : std::abs(luma[level] - share) > share / 2) return "other";
  return colour ? "colour" : "noise";
}

TEST(DecoderTest, PictureThatDoesNotFitIsAUserError) {
  struct Wide : Chart {
    unsigned width() const override { return 800; }
  } wide;
  EXPECT_THROW(Tvp5146("wide", bench->tvp_params, wide), UserError);
}

// One story in one process: the cases build on each other and run in this order.
TEST(DecoderTest, NoOtherAddressAnswersOnI2cAndIdsAreRight) {
  run_for(kPsPerNs);
  EXPECT_FALSE(bench->tvp->i2c_start(0x5C, false));
  EXPECT_EQ(bench->i2c_read(0x80), 0x51);
  EXPECT_EQ(bench->i2c_read(0x81), 0x46);
}

TEST(DecoderTest, RomVersionIsTheParametersAndIsNotWritten) {
  EXPECT_EQ(bench->i2c_read(0x70), 0x23);
  bench->i2c_write(0x70, 7);
  EXPECT_EQ(bench->i2c_read(0x70), 0x23);
}

TEST(DecoderTest, CameraRunsFromPowerUpPlusItsPhase) {
  const Clock clock(kByteClock);
  const std::uint64_t first = clock.edge_at_or_after(bench->tvp_params.phase());
  EXPECT_EQ(bench->tvp->field_time(0), clock.edge(first));
  EXPECT_EQ(bench->tvp->field_time(2), clock.edge(first + kStd.frame_bytes()));
}

TEST(DecoderTest, NothingIsSentBeforeTheOutputsAreEnabled) {
  run_until(bench->tvp->field_time(4));
  EXPECT_EQ(bench->tvp->lines_sent(), 0u);
  EXPECT_EQ(bench->chart.asked, 0u);
  bench->i2c_write(0x34, 0x10);  // data without clock
  run_until(bench->tvp->field_time(6));
  EXPECT_EQ(bench->tvp->lines_sent(), 0u);
  bench->i2c_write(0x34, 0x11);
  run_until(bench->tvp->field_time(8));
  // Two fields hold all lines of a frame, less the line that began at the very time of the write.
  run_for(kPsPerUs);
  EXPECT_EQ(bench->tvp->lines_sent(), kStd.lines) << "the first line of field 8 is out already";
}

TEST(DecoderTest, LocksAfterTheConfiguredFields) {
  Bench& b = *bench;
  const std::uint64_t from = b.tvp->locked_from_field();
  EXPECT_EQ(from, std::uint64_t{kRelock});
  run_until(b.tvp->field_time(from) - kPsPerUs);
  EXPECT_EQ(b.i2c_read(0x3A) & 0x0E, 0);
  EXPECT_EQ(b.i2c_read(0x3F), 0);
  run_until(b.tvp->field_time(from) + kPsPerUs);
  EXPECT_EQ(b.i2c_read(0x3A), kLocked);
  EXPECT_EQ(b.i2c_read(0x3F), k625Here ? 2 : 1);
}

TEST(DecoderTest, CapturedFrameIsByteExactAndFieldsCarryTheirInstants) {
  Bench& b = *bench;
  b.regs.write(0x84, 3);
  b.regs.write(0x04, 2u << 12 | 1u << 7 | 1u << 2);
  b.regs.write(0x88, 0x812);
  b.regs.write(0x18, (720 - kWidth) / 2 * 2);
  b.regs.write(0x1C, kWidth * 2 - 1);
  // Studio crop: row 1 is on line 23, three lines below the first active one; row 0 on line 285.
  // A picture of fewer lines is in the middle.
  const unsigned top = k625Here ? (kStd.rows - kHeight) / 4 : 0;
  b.regs.write(0x20, kStudio ? 4 : 1 + top);
  b.regs.write(0x24, kStudio ? 3 : 1 + top);
  b.regs.write(0x28, kHeight / 2 - 1);
  b.regs.write(0x34, (kWidth * 2 + 31) / 32);
  b.regs.write(0x38, 0x249 | (kStudio ? 1u << 14 : 0u));
  b.regs.write(0x3C, kBuffer >> 21);
  b.regs.write(0x40, kBuffer >> 5 & 0xFFFF);
  b.regs.write(0x00, 3);
  const unsigned asked = b.chart.asked;
  while (b.ended.size() < 3) run_for(kPsPerMs);
  const CaptureFrame& f = b.ended[2];
  ASSERT_TRUE(f.complete);
  EXPECT_EQ(f.overflows, 0u);
  EXPECT_EQ(wrong_bytes(f), 0u);
  EXPECT_LE(b.chart.asked - asked, 2 * b.ended.size() + 4) << "the source is asked once per field";
}

TEST(DecoderTest, FrameRateIsExact) {
  Bench& b = *bench;
  b.regs.write(0x00, 0);
  b.regs.write(0x00, 3);
  b.ended.clear();
  while (b.ended.size() < 31) run_for(kPsPerMs);
  // 30 frames of 30000/1001 Hz last 1.001 s, 25 frames of 25 Hz one second; edges round down.
  const unsigned n = k625Here ? 25 : 30;
  const Picoseconds expected = k625Here ? kPsPerSecond : 1'001'000'000'000;
  const Picoseconds measured =
      b.ended[n + (b.ended[0].complete ? 0 : 1)].start - b.ended[b.ended[0].complete ? 0 : 1].start;
  EXPECT_LE(measured > expected ? measured - expected : expected - measured, 1u);
}

TEST(DecoderTest, ChangeOfStandardLosesLockAndBlackens) {
  Bench& b = *bench;
  b.i2c_write(0x02, k625Here ? 1 : 2);  // the other standard: never locks
  EXPECT_EQ(b.i2c_read(0x3A), 0x10) << "not locked, lock lost";
  b.ended.clear();
  while (b.ended.size() < 2) run_for(kPsPerMs);
  EXPECT_EQ(b.i2c_read(0x3A) & 0x0E, 0);
  EXPECT_EQ(b.memory.at(kBuffer)[0], 0x80);
  EXPECT_EQ(captured(), kUnlocked);
  b.i2c_write(0x02, 0);
  const std::uint64_t from = b.tvp->locked_from_field();
  run_until(b.tvp->field_time(from) - kPsPerUs);
  EXPECT_EQ(b.i2c_read(0x3A) & 0x0E, 0);
  run_until(b.tvp->field_time(from) + kPsPerUs);
  EXPECT_EQ(b.i2c_read(0x3A), kLocked | 0x10) << "lost once stays until it is cleared";
  b.i2c_write(0x39, 0);
  EXPECT_EQ(b.i2c_read(0x3A), kLocked | 0x10);
  b.i2c_write(0x39, 1);
  EXPECT_EQ(b.i2c_read(0x3A), kLocked);
}

TEST(DecoderTest, ClearingWhileNotLockedForgetsTheLoss) {
  Bench& b = *bench;
  EXPECT_EQ(b.i2c_read(0x3B), 0x80);
  b.i2c_write(0x00, 1);  // another input, with nothing on it
  EXPECT_EQ(b.i2c_read(0x3A), 0x10);
  EXPECT_EQ(b.i2c_read(0x3B), 0) << "no signal";
  EXPECT_EQ(b.i2c_read(0x3F), 0);
  b.i2c_write(0x39, 1);
  EXPECT_EQ(b.i2c_read(0x3A), 0) << "cleared; not locked since, so nothing was lost since";
  const std::uint64_t sent = b.tvp->lines_sent();
  run_for(kRelock * 20 * kPsPerMs);
  EXPECT_EQ(b.i2c_read(0x3A), 0) << "there is nothing to lock to";
  EXPECT_GT(b.tvp->lines_sent(), sent) << "lines go on";
  EXPECT_EQ(captured(), kUnlocked);
  b.i2c_write(0x00, 0);
  EXPECT_EQ(b.i2c_read(0x3A), 0);
  EXPECT_EQ(b.i2c_read(0x3B), 0x80);
  run_until(b.tvp->field_time(b.tvp->locked_from_field()) + kPsPerUs);
  EXPECT_EQ(b.i2c_read(0x3A), kLocked);
}

TEST(DecoderTest, AnUnpluggedCableLosesTheLockAndAPluggedOneIsLockedToAnew) {
  Bench& b = *bench;
  b.tvp->connect(0, false);
  EXPECT_EQ(b.i2c_read(0x3A), 0x10);
  EXPECT_EQ(b.i2c_read(0x3B), 0);
  b.i2c_write(0x39, 1);
  run_for(30 * kPsPerMs);
  EXPECT_EQ(b.i2c_read(0x3A), 0);
  std::uint64_t field = 0;
  while (b.tvp->field_time(field + 1) <= kernel_time()) ++field;
  b.tvp->connect(0, true);
  EXPECT_EQ(b.tvp->locked_from_field(), field + kRelock);
  run_until(b.tvp->field_time(field + kRelock) - kPsPerUs);
  EXPECT_EQ(b.i2c_read(0x3A), 0);
  run_until(b.tvp->field_time(field + kRelock) + kPsPerUs);
  EXPECT_EQ(b.i2c_read(0x3A), kLocked);
}

TEST(DecoderTest, TheBlackScreenBitsDecideWhatIsSent) {
  Bench& b = *bench;
  const auto with = [&](std::uint8_t formatter2) {
    b.i2c_write(0x34, formatter2);
    return captured();
  };
  EXPECT_EQ(with(0x11), "picture");
  EXPECT_EQ(with(0x15), "picture") << "black only without a lock";
  EXPECT_EQ(with(0x19), "black");
  EXPECT_EQ(b.began.at(b.ended[2].start).camera, kNoCamera) << "nothing of the camera is shown";
  EXPECT_EQ(b.i2c_read(0x3A), kLocked) << "and the lock holds";
  EXPECT_EQ(with(0x1D), "black");
  b.tvp->connect(0, false);
  EXPECT_EQ(with(0x11), kUnlocked);
  EXPECT_EQ(with(0x15), "black");
  EXPECT_EQ(with(0x19), "black");
  EXPECT_EQ(with(0x11), kUnlocked) << "again";
  b.tvp->connect(0, true);
  run_until(b.tvp->field_time(b.tvp->locked_from_field()) + kPsPerUs);
  EXPECT_EQ(with(0x11), "picture");
  b.i2c_write(0x39, 1);
}

TEST(DecoderTest, PowerDownStopsTheStreamAndLosesTheLock) {
  Bench& b = *bench;
  b.i2c_write(0x03, 1);
  EXPECT_EQ(b.i2c_read(0x3A), 0x10);
  EXPECT_EQ(b.i2c_read(0x3F), 0);
  const std::uint64_t sent = b.tvp->lines_sent();
  run_for(50 * kPsPerMs);
  EXPECT_EQ(b.tvp->lines_sent(), sent);
  EXPECT_EQ(b.i2c_read(0x3A), 0x10);
}

TEST(DecoderTest, PowerUpLocksAnewAfterTheConfiguredFields) {
  Bench& b = *bench;
  std::uint64_t field = b.tvp->locked_from_field();  // find the camera's field now
  while (b.tvp->field_time(field + 1) <= kernel_time()) ++field;
  b.i2c_write(0x03, 0);
  EXPECT_EQ(b.tvp->locked_from_field(), field + kRelock);
  run_until(b.tvp->field_time(field + kRelock) - kPsPerUs);
  EXPECT_EQ(b.i2c_read(0x3A), 0x10);
  run_until(b.tvp->field_time(field + kRelock) + kPsPerUs);
  EXPECT_EQ(b.i2c_read(0x3A), kLocked | 0x10);
}

/// Samples of 27 MHz from one captured frame to the next, after so many frames with a fault.
std::uint64_t frame_length(const SignalFault& fault) {
  Bench& b = *bench;
  b.tvp->disturb(0, fault);
  b.ended.clear();
  while (b.ended.size() < 4) run_for(kPsPerMs);
  const double apart = static_cast<double>(b.ended[3].start - b.ended[2].start);
  b.tvp->disturb(0, {});
  return static_cast<std::uint64_t>(apart * 27e-6 + 0.5);
}

TEST(DecoderTest, MissingAndShortLinesMakeFieldsShorterAndTheLockHolds) {
  Bench& b = *bench;
  b.i2c_write(0x39, 1);
  const std::uint64_t whole = kStd.frame_bytes();
  EXPECT_EQ(frame_length({}), whole);
  EXPECT_EQ(frame_length({.lines = 1}), whole - 2 * kStd.line_bytes);
  EXPECT_EQ(frame_length({.lines = 5}), whole - 2 * 5 * kStd.line_bytes);
  EXPECT_EQ(frame_length({.lines = 5, .samples = 4}), whole - 2 * 5 * 4);
  EXPECT_EQ(frame_length({.wrong_bits = 1}), whole);
  EXPECT_EQ(frame_length({}), whole);
  EXPECT_EQ(b.i2c_read(0x3A), kLocked) << "locked, and no lock was lost";
}

/// The number of lines in registers 9A and 9B.
unsigned count_in(const Bench& b, Tvp5146& tvp) { return b.i2c_read(tvp, 0x9A) + 256u * b.i2c_read(tvp, 0x9B); }
/// Asks at `at`; the parameters' default says when the decoder has it.
unsigned count_at(Bench& b, Tvp5146& tvp, Picoseconds at) {
  run_until(at);
  b.i2c_write(tvp, 0x97, 0xFF);
  EXPECT_EQ(b.i2c_read(tvp, 0x97), 1);
  run_for(100 * kPsPerUs + kPsPerNs);
  EXPECT_EQ(b.i2c_read(tvp, 0x97), 0);
  return count_in(b, tvp);
}
Picoseconds lines_time(double lines) { return static_cast<Picoseconds>(lines * kStd.line_bytes / 27e6 * 1e12); }
/// The start of the next first field.
Picoseconds next_frame(const Tvp5146& tvp, unsigned camera = 0) {
  std::uint64_t k = tvp.cameras()[camera].field_at(kernel_time()) / 2 * 2;
  while (tvp.field_time(k) <= kernel_time()) k += 2;
  return tvp.field_time(k);
}

TEST(DecoderTest, TheLinesOfTheFrameBeforeAreCountedAndKeptOnRequest) {
  Bench& b = *bench;
  Tvp5146& tvp = *b.tvp;
  EXPECT_EQ(count_in(b, tvp), 0u) << "nothing was asked for yet";
  const Picoseconds whole = next_frame(tvp);
  EXPECT_EQ(count_at(b, tvp, whole + lines_time(5)), kStd.lines);
  b.i2c_write(tvp, 0x9A, 9);
  EXPECT_EQ(count_in(b, tvp), kStd.lines) << "read only";
  tvp.disturb(0, {.lines = 3});
  run_until(whole + lines_time(kStd.lines / 2.0));  // the first field's are gone by then, the second one's are not
  tvp.disturb(0, {});
  Picoseconds next = next_frame(tvp);
  EXPECT_NEAR(static_cast<double>(next - whole), static_cast<double>(lines_time(kStd.lines - 3)), 2);
  // Known three lines after the field's start, and then for a frame.
  EXPECT_EQ(count_at(b, tvp, next + lines_time(3) - 101 * kPsPerUs), kStd.lines) << "not yet";
  EXPECT_EQ(count_at(b, tvp, next + lines_time(3) - 99 * kPsPerUs), kStd.lines - 3);
  run_until(next + lines_time(kStd.lines + 10));
  EXPECT_EQ(count_in(b, tvp), kStd.lines - 3) << "until the next request";
  b.i2c_write(tvp, 0x97, 0);
  run_for(kPsPerMs);
  EXPECT_EQ(count_in(b, tvp), kStd.lines - 3) << "no request";
  EXPECT_EQ(count_at(b, tvp, kernel_time()), kStd.lines);
  // Asked for in one frame and read in the third one after.
  b.i2c_write(tvp, 0x97, 1);
  tvp.disturb(0, {.lines = 2});
  for (unsigned n = 0; n < 3; ++n) run_until(next_frame(tvp) + lines_time(10));
  tvp.disturb(0, {});
  EXPECT_EQ(count_in(b, tvp), kStd.lines);
  EXPECT_EQ(count_at(b, tvp, kernel_time()), kStd.lines - 4);
}

TEST(DecoderTest, ShortLinesAreLinesToo) {
  Bench& b = *bench;
  run_until(next_frame(*b.tvp));
  b.tvp->disturb(0, {.lines = 4, .samples = 200});
  run_for(80 * kPsPerMs);
  EXPECT_EQ(count_at(b, *b.tvp, kernel_time()), kStd.lines);
  b.tvp->disturb(0, {});
}

TEST(DecoderTest, ACameraThatIsEarlyMakesTheNextOnesFrameLonger) {
  Bench& b = *bench;
  Tvp5146& two = *b.two;
  Picoseconds next = next_frame(two);
  run_until(next + kPsPerUs);
  two.disturb(0, {.lines = 4});
  run_until(next + lines_time(kStd.lines / 2.0));
  two.disturb(0, {});
  next = next_frame(two);
  EXPECT_EQ(count_at(b, two, next + lines_time(4)), kStd.lines - 4);
  b.i2c_write(two, 0x00, 1);  // whose frame has begun four lines behind that of camera 0
  EXPECT_EQ(count_at(b, two, next_frame(two, 1) + lines_time(4)), kStd.lines + 4);
  EXPECT_EQ(count_at(b, two, next_frame(two, 1) + lines_time(4)), kStd.lines);
  b.i2c_write(two, 0x00, 0);
}

TEST(DecoderTest, AClockThatIsOffStretchesTheFrames) {
  Bench& b = *bench;
  const double nominal = static_cast<double>(kStd.frame_bytes()) / 27e6 * 1e12;
  for (const double ppm : {1000.0, -300.0, 0.0}) {
    b.tvp->set_clock_offset(0, ppm);
    b.ended.clear();
    while (b.ended.size() < 4) run_for(kPsPerMs);
    const double apart = static_cast<double>(b.ended[3].start - b.ended[2].start);
    EXPECT_NEAR(apart, nominal / (1 + ppm * 1e-6), 2) << ppm;
  }
  EXPECT_EQ(b.i2c_read(0x3A), kLocked);
}

// A new offset is due with that camera's next line, which is not sent any more.
TEST(DecoderTest, AClockOffsetIsOfItsCameraEvenIfTheInputChangesBeforeTheNextLine) {
  Tvp5146& tvp = *bench->two;
  const auto second = [&](unsigned camera) {
    const Clock& clock = tvp.cameras()[camera].clock();
    const std::uint64_t n = clock.edge_after(kernel_time());
    return static_cast<double>(clock.edge(n + 27'000'000) - clock.edge(n));
  };
  run_for(kPsPerMs);
  tvp.set_clock_offset(1, 200);
  EXPECT_NEAR(second(1), 1e12 / 1.0002, 2) << "at once: that camera is not sent";
  run_for(kPsPerMs);
  EXPECT_EQ(second(0), 1e12);
  tvp.set_clock_offset(1, 0);
  tvp.set_clock_offset(0, 500);
  EXPECT_EQ(second(0), 1e12) << "with the next line";
  ASSERT_TRUE(tvp.i2c_start(0x5D, false));
  tvp.i2c_write(0x00);
  tvp.i2c_write(1);
  tvp.i2c_stop();
  run_for(kPsPerMs);
  EXPECT_NEAR(second(0), 1e12 / 1.0005, 2);
  EXPECT_EQ(second(1), 1e12);
  tvp.set_clock_offset(1, -300);
  run_for(kPsPerMs);
  EXPECT_NEAR(second(1), 1e12 / 0.9997, 2);
  EXPECT_NEAR(second(0), 1e12 / 1.0005, 2);
}

TEST(DecoderTest, TheOtherStandardIsLockedToAnewAndSoIsTheFirstOne) {
  Bench& b = *bench;
  for (const bool other : {true, false}) {
    const std::uint64_t before = b.tvp->locked_from_field();
    b.tvp->set_standard(0, k625Here != other);
    EXPECT_EQ(b.i2c_read(0x3A), 0x10) << "lost";
    const std::uint64_t from = b.tvp->locked_from_field();
    EXPECT_EQ(from % 2, kRelock % 2) << "counted from an even field";
    EXPECT_GT(from, before) << "fields go on being counted";
    run_until(b.tvp->field_time(from) - kPsPerUs);
    EXPECT_EQ(b.i2c_read(0x3A), 0x10);
    EXPECT_EQ(b.i2c_read(0x3F), 0);
    run_until(b.tvp->field_time(from) + kPsPerUs);
    EXPECT_EQ(b.i2c_read(0x3A), 0x1E | (k625Here != other ? 0x20 : 0));
    EXPECT_EQ(b.i2c_read(0x3F), k625Here != other ? 2 : 1);
    run_for(100 * kPsPerMs);
    b.i2c_write(0x39, 1);
  }
  b.ended.clear();
  while (b.ended.size() < 3) run_for(kPsPerMs);
  EXPECT_TRUE(b.ended[2].complete);
  EXPECT_EQ(b.began.at(b.ended[2].start).field % 2, 0u);
  EXPECT_EQ(b.began.at(b.ended[2].start).camera, 0u);
  b.i2c_write(0x02, k625Here ? 1 : 2);  // the lock is lost, and comes back
  b.i2c_write(0x02, 0);
  run_until(b.tvp->field_time(b.tvp->locked_from_field()) + kPsPerUs);
}

// A frame of either standard is a whole number of 27 MHz periods: 625 lines of 1728, 525 of 1716.
TEST(CameraSignalTest, AGenlockedCameraReturnsToItsStandardWithAFrameOfTheOthers) {
  const std::uint64_t kFrame = k625Here ? 625 * 1728 : 525 * 1716, kFirst = 27'000 * 7;
  Chart chart;
  for (const bool genlocked : {true, false})
    // Edges at which it returns, from the start of one of the others' frames on, and where it begins.
    for (const auto& [late, then] :
         {std::pair<std::uint64_t, std::uint64_t>{0, 0}, {1, kFrame}, {kFrame - 1, kFrame}, {kFrame, kFrame}}) {
      CameraSignal camera({.source = &chart, .is_625 = k625Here, .placement = placement_of(bench->tvp_params, k625Here),
                           .phase = 7 * kPsPerMs, .genlocked = genlocked});
      camera.clock_changed(Frequency(27'000'000), 0);
      const Clock& clock = camera.clock();
      EXPECT_EQ(camera.line_edge(0), kFirst);
      camera.set_standard(!k625Here, placement_of(bench->tvp_params, !k625Here), kFirst + 5 * kFrame / 2,
                          clock.edge(kFirst + 2 * kFrame));
      EXPECT_EQ(camera.line_edge(0), kFirst + 5 * kFrame / 2) << "a camera of another standard follows no other camera";
      const std::uint64_t edge = kFirst + 9 * kFrame + late;
      camera.set_standard(k625Here, placement_of(bench->tvp_params, k625Here), edge, clock.edge(edge));
      EXPECT_EQ(camera.line_edge(0), genlocked ? kFirst + 9 * kFrame + then : edge) << genlocked << ", " << late;
      EXPECT_EQ(camera.field_at(clock.edge(edge)) % 2, 0u);
    }
}

/// What can be read of a decoder's state.
std::vector<std::uint64_t> state_of(Tvp5146& decoder) {
  std::vector<std::uint64_t> out{decoder.lines_sent(), decoder.locked_from_field()};
  for (const std::uint8_t reg : {0x3A, 0x3B, 0x3F}) out.push_back(bench->i2c_read(decoder, reg));
  return out;
}

TEST(DecoderTest, AMultiplexerInFrontOfAnInputIsLikeAChangeOfTheInput) {
  Tvp5146 &input = *bench->by_input, &multiplexer = *bench->by_multiplexer;
  const auto change = [&](std::uint8_t to) {
    bench->i2c_write(input, 0x00, to);
    multiplexer.route(to);
  };
  const auto expect_same = [&](const char* when) { EXPECT_EQ(state_of(multiplexer), state_of(input)) << when; };
  EXPECT_EQ(bench->i2c_read(multiplexer, 0x3A), kLocked) << "the first camera, long ago";
  expect_same("locked");
  for (const std::uint8_t camera : {1, 0, 1}) {
    change(camera);
    EXPECT_EQ(bench->i2c_read(multiplexer, 0x3A), 0x10) << "another camera: the lock is lost";
    expect_same("another camera");
    const std::uint64_t from = multiplexer.locked_from_field();
    run_until(multiplexer.field_time(from) - kPsPerUs);
    EXPECT_EQ(bench->i2c_read(multiplexer, 0x3A), 0x10);
    expect_same("not yet locked");
    run_until(multiplexer.field_time(from) + kPsPerUs);
    EXPECT_EQ(bench->i2c_read(multiplexer, 0x3A), kLocked | 0x10);
    expect_same("locked again");
    for (Tvp5146* decoder : {&input, &multiplexer}) bench->i2c_write(*decoder, 0x39, 1);
  }
  change(1);
  EXPECT_EQ(bench->i2c_read(multiplexer, 0x3A), kLocked) << "the same camera is no change";
  change(2);  // nothing is there
  EXPECT_EQ(bench->i2c_read(multiplexer, 0x3A), 0x10);
  EXPECT_EQ(bench->i2c_read(multiplexer, 0x3B), 0);
  run_for(100 * kPsPerMs);
  expect_same("no signal");
}

TEST(DecoderTest, StoppedClockKeepsTheFieldAndTheLock) {
  Bench& b = *bench;
  b.clock.write(Frequency{});
  run_for(kPsPerMs);
  EXPECT_EQ(b.i2c_read(0x3A), kLocked | 0x10);
  EXPECT_EQ(b.i2c_read(0x3F), k625Here ? 2 : 1);
}

}  // namespace
}  // namespace fovea::video

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  fovea::video::Bench bench;
  fovea::video::bench = &bench;
  return RUN_ALL_TESTS();
}
