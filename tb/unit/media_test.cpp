// sw/fovea/files/png.h and ffmpeg.h: round trips of pictures, and one-line errors for damaged files.
#include <signal.h>
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/ffmpeg.h"
#include "sw/fovea/files/png.h"
#include "tb/own_diagnostics.h"
#include "tb/unit/png_file.h"
#include "tb/unit/support.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;
using test::read_text;
using test::TempDir;
using test::user_error;
using test::write_png;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

RgbImage pattern(unsigned width, unsigned height) {
  RgbImage image{width, height, {}};
  for (unsigned y = 0; y < height; ++y)
    for (unsigned x = 0; x < width; ++x)
      for (const unsigned v : {x * 7 + y, x * y, x ^ (y * 3)})
        image.rgb.push_back(static_cast<std::uint8_t>(v));
  return image;
}

std::string as_text(const std::vector<std::uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

TEST(PngTest, PicturesSurviveAtEveryLevel) {
  TempDir dir;
  const RgbImage image = pattern(33, 17);
  for (const int level : {0, 1, 3, 6, 9}) {
    write_png(dir / "p.png", image, level);
    const RgbImage back = read_png(dir / "p.png");
    EXPECT_EQ(back.width, 33u);
    EXPECT_EQ(back.height, 17u);
    EXPECT_EQ(back.rgb, image.rgb) << level;
  }
}

TEST(PngTest, EqualPicturesGiveEqualBytes) {
  EXPECT_EQ(encode_png(pattern(64, 48), 1), encode_png(pattern(64, 48), 1));
}

TEST(PngTest, ThePixelsShapeIsInTheFile) {
  using namespace std::string_literals;
  const std::string square = as_text(encode_png(pattern(4, 4), 1));
  EXPECT_EQ(square.find("pHYs"), std::string::npos);
  // PNG specification 11.3.5.3: pixels per unit along x, along y, no unit. A pixel 16 wide and 15 high.
  const std::string pal = as_text(encode_png(pattern(4, 4), 1, {16, 15}));
  EXPECT_NE(pal.find("\0\0\0\x09pHYs\0\0\0\x0f\0\0\0\x10\0"s), std::string::npos);
  EXPECT_EQ(as_text(encode_png(pattern(4, 4), 1, {2, 2})), square);
}

/// The 1x1 PNGs below are written out by hand: signature, IHDR, IDAT with one zlib block, IEND.
std::string png_1x1(char depth, char colour, const std::string& idat, const std::string& idat_crc,
                    const std::string& ihdr_crc) {
  using namespace std::string_literals;
  return "\x89PNG\r\n\x1a\n"s + "\0\0\0\x0dIHDR\0\0\0\x01\0\0\0\x01"s + depth + colour + "\0\0\0"s +
         ihdr_crc + std::string("\0\0\0"s) + static_cast<char>(idat.size()) + "IDAT" + idat +
         idat_crc + "\0\0\0\0IEND\xae\x42\x60\x82"s;
}

/// Of PNG, bit by bit (ISO 3309).
std::uint32_t crc_of(const std::string& bytes) {
  std::uint32_t crc = ~0u;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int k = 0; k < 8; ++k) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0);
  }
  return ~crc;
}

TEST(PngTest, AnOrientationThatIsNotFollowedIsSaid) {
  using namespace std::string_literals;
  const TempDir dir;
  const auto big = [](std::uint32_t n) {
    return std::string{static_cast<char>(n >> 24), static_cast<char>(n >> 16), static_cast<char>(n >> 8),
                       static_cast<char>(n)};
  };
  const auto warnings = [&](const std::string& exif) {
    std::string bytes = as_text(encode_png(pattern(4, 3), 1));
    bytes.insert(bytes.find("IDAT") - 4, big(static_cast<std::uint32_t>(exif.size())) + "eXIf" + exif +
                                             big(crc_of("eXIf" + exif)));
    const OwnDiagnostics diagnostics;
    EXPECT_EQ(read_png(dir.write("p.png", bytes)).rgb, pattern(4, 3).rgb);
    std::string out;
    for (const auto& [what, count] : diagnostics.counts()) out += what.second;
    return out;
  };
  // TIFF 6.0: byte order, 42, place of the directory; entries of tag, type, count and value.
  const std::string little = "II*\0\x08\0\0\0\x01\0"s, tag = "\x12\x01\x03\0\x01\0\0\0"s;
  EXPECT_THAT(warnings(little + tag + "\x06\0\0\0\0\0\0\0"s),
              HasSubstr("p.png' is taken as it is stored: its EXIF orientation, 6,"));
  EXPECT_THAT(warnings("MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x03\0\0"s), HasSubstr("orientation, 3,"));
  EXPECT_EQ(warnings(little + tag + "\x01\0\0\0\0\0\0\0"s), "") << "as it is";
  EXPECT_EQ(warnings(little + "\x0f"s + tag.substr(1) + "\x06\0\0\0"s), "") << "another tag";
  EXPECT_EQ(warnings("II*\0\xff\xff\xff\xff"s), "") << "a directory that is not there";
}

TEST(PngTest, GreyAndAlphaBecomeRgb) {
  using namespace std::string_literals;
  TempDir dir;
  // zlib: 78 01, one stored block (01 len nlen), the row (filter 0 and the samples), Adler-32.
  // 8-bit grey 0x50: row 00 50, Adler-32 = (0x52 << 16 | 0x51).
  const std::string grey = png_1x1(8, 0, "\x78\x01\x01\x02\x00\xfd\xff\x00\x50\x00\x52\x00\x51"s,
                                   "\x8c\x04\x9c\xda"s, "\x3a\x7e\x9b\x55"s);
  const auto file = dir.write("grey.png", grey);
  // The checksums come from the reader's view of the file: patch them with the true CRCs.
  const auto crc = [](std::string_view data) {
    std::uint32_t c = ~0u;
    for (const char ch : data) {
      c ^= static_cast<std::uint8_t>(ch);
      for (int k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320u ^ (c >> 1) : c >> 1;
    }
    c = ~c;
    return std::string{static_cast<char>(c >> 24), static_cast<char>(c >> 16),
                       static_cast<char>(c >> 8), static_cast<char>(c)};
  };
  const auto sealed = [&](std::string png) {
    png.replace(8 + 8 + 13, 4, crc(std::string_view(png).substr(12, 17)));
    const std::size_t size = static_cast<std::uint8_t>(png[8 + 25 + 3]);
    png.replace(8 + 25 + 8 + size, 4, crc(std::string_view(png).substr(8 + 25 + 4, 4 + size)));
    return png;
  };
  dir.write("grey.png", sealed(grey));
  EXPECT_EQ(read_png(file).rgb, (std::vector<std::uint8_t>{0x50, 0x50, 0x50}));
  // RGBA 10 20 30 40: row 00 10 20 30 40; Adler a = 1+0xa0 = 0xa1, b = 1+0x11+0x31+0x61+0xa1 =
  // 0x145.
  dir.write(
      "rgba.png",
      sealed(png_1x1(8, 6, "\x78\x01\x01\x05\x00\xfa\xff\x00\x10\x20\x30\x40\x01\x45\x00\xa1"s,
                     "\0\0\0\0"s, "\0\0\0\0"s)));
  EXPECT_EQ(read_png(dir / "rgba.png").rgb, (std::vector<std::uint8_t>{0x10, 0x20, 0x30}));
}

TEST(PngTest, EveryCutOfAFileIsAnErrorThatNamesIt) {
  TempDir dir;
  const std::string whole = as_text(encode_png(pattern(16, 16), 1));
  for (std::size_t size = 0; size < whole.size(); size += size < 64 ? 1 : 37) {
    const auto file = dir.write("cut.png", whole.substr(0, size));
    EXPECT_THAT(user_error([&] { read_png(file); }), HasSubstr("cut.png")) << size;
  }
  const auto file = dir.write("cut.png", whole.substr(0, whole.size() - 1));
  EXPECT_THAT(user_error([&] { read_png(file); }), HasSubstr("cut short"));
}

TEST(PngTest, OneFlippedBitInThePixelsIsFound) {
  TempDir dir;
  std::string bytes = as_text(encode_png(pattern(16, 16), 1));
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  const auto file = dir.write("flip.png", bytes);
  EXPECT_THAT(user_error([&] { read_png(file); }), HasSubstr("flip.png"));
}

TEST(PngTest, MissingFileGarbageAndFolderAreOneLine) {
  TempDir dir;
  EXPECT_THAT(user_error([&] { read_png(dir / "no.png"); }),
              AllOf(HasSubstr("no.png"), HasSubstr("No such file")));
  const auto garbage = dir.write("g.png", "this is a text, not a picture");
  EXPECT_THAT(user_error([&] { read_png(garbage); }),
              AllOf(HasSubstr("g.png"), HasSubstr("not a PNG")));
  EXPECT_THAT(user_error([&] { read_png(dir.path()); }), HasSubstr("folder"));
}

TEST(PngTest, HeaderThatClaimsAHugePictureIsRefused) {
  TempDir dir;
  RgbImage wide{kMaxPictureSide + 1, 1, {}};
  wide.rgb.resize(std::size_t{3} * wide.width);
  write_png(dir / "wide.png", wide);
  EXPECT_THAT(user_error([&] { read_png(dir / "wide.png"); }), HasSubstr("too large; allowed: up to 8192 pixels"));
}

TEST(UyvyToRgbTest, ReferenceColoursOfBt601) {
  // EBU 75 % bars, 8-bit limited range (Y Cb Cr) and their R'G'B' (0 or 0.75 * 255 = 191), +-1 for
  // the rounding of the tabulated bars.
  struct Bar {
    int y, cb, cr, r, g, b;
  };
  constexpr Bar kBars[] = {
      {180, 128, 128, 191, 191, 191}, {162, 44, 142, 191, 191, 0}, {131, 156, 44, 0, 191, 191},
      {112, 72, 58, 0, 191, 0},       {84, 184, 198, 191, 0, 191}, {65, 100, 212, 191, 0, 0},
      {35, 212, 114, 0, 0, 191},      {16, 128, 128, 0, 0, 0},     {235, 128, 128, 255, 255, 255}};
  for (const auto& bar : kBars) {
    const std::vector<std::uint8_t> uyvy{
        static_cast<std::uint8_t>(bar.cb), static_cast<std::uint8_t>(bar.y),
        static_cast<std::uint8_t>(bar.cr), static_cast<std::uint8_t>(bar.y)};
    const auto rgb = uyvy_to_rgb(2, 1, uyvy).rgb;
    EXPECT_NEAR(rgb[0], bar.r, 1) << bar.y;
    EXPECT_NEAR(rgb[1], bar.g, 1) << bar.y;
    EXPECT_NEAR(rgb[2], bar.b, 1) << bar.y;
    EXPECT_EQ(rgb[0], rgb[3]);
  }
}

TEST(UyvyToRgbTest, EveryValueIsWithinOneOfTheRealFormula) {
  for (int y = 0; y < 256; y += 5)
    for (int cb = 0; cb < 256; cb += 15)
      for (int cr = 0; cr < 256; cr += 15) {
        const std::vector<std::uint8_t> in{
            static_cast<std::uint8_t>(cb), static_cast<std::uint8_t>(y),
            static_cast<std::uint8_t>(cr), static_cast<std::uint8_t>(y)};
        const auto rgb = uyvy_to_rgb(2, 1, in).rgb;
        const double l = (y - 16) / 219.0, b = (cb - 128) / 224.0, r = (cr - 128) / 224.0;
        const double expected[3] = {
            l + 1.402 * r, l - (0.114 * 1.772 * b + 0.299 * 1.402 * r) / 0.587, l + 1.772 * b};
        for (int i = 0; i < 3; ++i)
          ASSERT_NEAR(rgb[static_cast<std::size_t>(i)],
                      std::min(255.0, std::max(0.0, 255 * expected[i])), 0.51)
              << y << " " << cb << " " << cr;
      }
}

std::vector<std::uint8_t> grey_frame(unsigned width, unsigned height, std::uint8_t y) {
  std::vector<std::uint8_t> uyvy;
  for (unsigned i = 0; i < width * height / 2; ++i) uyvy.insert(uyvy.end(), {128, y, 128, y});
  return uyvy;
}

TEST(FrameWriterTest, WritesEveryFrameUnderItsNumber) {
  TempDir dir;
  FrameWriter writer({.folder = dir.path(), .queue_frames = 2});
  for (std::uint64_t i = 0; i < 20; ++i)
    writer.push(i, 32, 16, grey_frame(32, 16, static_cast<std::uint8_t>(16 + 10 * i)));
  writer.close();
  for (std::uint64_t i = 0; i < 20; ++i) {
    const auto image = read_png(dir / FrameWriter::file_name(i));
    // Y = 16 + 10 i is grey 255 * 10 i / 219.
    EXPECT_NEAR(image.rgb[0], 2550.0 * static_cast<double>(i) / 219, 0.51) << i;
  }
  EXPECT_EQ(FrameWriter::file_name(7), "frame_000007.png");
}

TEST(FrameWriterTest, ErrorOfTheThreadReachesTheCaller) {
  TempDir dir;
  FrameWriter writer({.folder = dir / "missing", .queue_frames = 1});
  const std::string error = user_error([&] {
    for (std::uint64_t i = 0; i < 1000; ++i) writer.push(i, 2, 2, grey_frame(2, 2, 16));
  });
  EXPECT_THAT(error, HasSubstr("missing/frame_000000.png"));
  EXPECT_THAT(user_error([&] { writer.close(); }), HasSubstr("frame_000000.png"));
}

TEST(FrameWriterTest, ErrorOfTheLastFrameShowsAtClose) {
  TempDir dir;
  FrameWriter writer({.folder = dir / "missing"});
  writer.push(0, 2, 2, grey_frame(2, 2, 16));
  EXPECT_THAT(user_error([&] { writer.close(); }), HasSubstr("missing"));
}

/// Decodes and encodes for real: the program is part of the documented set-up.
class FfmpegTest : public testing::Test {
 protected:
  /// An MP4 of `count` frames of 64x48, frame i grey of luma 40 + 20 i.
  fs::path clip(unsigned count) {
    const fs::path file = dir / "clip.mp4";
    FrameWriter writer({.folder = "", .mp4 = file, .mp4_rate = {25}});
    for (unsigned i = 0; i < count; ++i)
      writer.push(i, 64, 48, grey_frame(64, 48, static_cast<std::uint8_t>(40 + 20 * i)));
    writer.close();
    return file;
  }
  TempDir dir;
};

TEST_F(FfmpegTest, FilmGivesItsFramesInOrder) {
  const auto file = clip(8);
  const auto frames = decode_frames(file, {.max_frames = 5});
  ASSERT_EQ(frames.size(), 5u);
  for (unsigned i = 0; i < 5; ++i) {
    EXPECT_EQ(frames[i].width, 64u);
    EXPECT_EQ(frames[i].height, 48u);
    EXPECT_NEAR(frames[i].rgb[3 * (64 * 24 + 32)], 255.0 * (24 + 20 * i) / 219, 4) << i;
  }
  EXPECT_EQ(decode_frames(file, {.max_frames = 100}).size(), 8u);
}

TEST_F(FfmpegTest, AFilmHasThePixelsShape) {
  EXPECT_EQ(film_info(clip(1)).pixel_aspect, 1);
  FrameWriter writer({.folder = "", .mp4 = dir / "pal.mp4", .mp4_rate = {25}});
  writer.push(0, 64, 48, grey_frame(64, 48, 100), {16, 15});
  writer.close();
  EXPECT_DOUBLE_EQ(film_info(dir / "pal.mp4").pixel_aspect, 16.0 / 15);
}

TEST_F(FfmpegTest, FramesAreScaledToTheSizeAskedFor) {
  const auto frames = decode_frames(clip(1), {.width = 720, .height = 576, .max_frames = 1});
  EXPECT_EQ(frames[0].width, 720u);
  EXPECT_EQ(frames[0].height, 576u);
  EXPECT_EQ(frames[0].rgb.size(), 720u * 576 * 3);
}

TEST_F(FfmpegTest, LargeFramesAreScaledDownInTheirProportions) {
  const auto file = clip(3);  // 64x48
  const auto size = [&](unsigned most_width, unsigned most_height) {
    const auto frames =
        decode_frames(file, {.most_width = most_width, .most_height = most_height, .max_frames = 9});
    EXPECT_EQ(frames.size(), 3u);
    return std::pair(frames.back().width, frames.back().height);
  };
  EXPECT_EQ(size(64, 48), std::pair(64u, 48u));
  EXPECT_EQ(size(63, 48), std::pair(63u, 47u));
  EXPECT_EQ(size(640, 24), std::pair(32u, 24u));
  EXPECT_EQ(size(16, 16), std::pair(16u, 12u));
  EXPECT_EQ(decode_frames(file, {.most_width = 64, .most_height = 48})[0].rgb,
            decode_frames(file, {})[0].rgb);
}

TEST_F(FfmpegTest, GarbageIsAnErrorThatNamesTheFile) {
  const auto file = dir.write("garbage.mp4", std::string(5000, 'z'));
  EXPECT_THAT(user_error([&] { decode_frames(file, {}); }),
              AllOf(HasSubstr("garbage.mp4"), HasSubstr("ffmpeg")));
}

TEST_F(FfmpegTest, CutFilmIsAnError) {
  const std::string whole = read_text(clip(20));
  for (const double part : {0.3, 0.6, 0.9}) {
    const auto file = dir.write(
        "cut.mp4",
        whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
    EXPECT_THAT(user_error([&] { decode_frames(file, {.max_frames = 100}); }),
                HasSubstr("cut.mp4"));
  }
}

TEST_F(FfmpegTest, CutJpegIsAnErrorAndAWholeOneIsRead) {
  write_png(dir / "p.png", pattern(320, 240));
  const std::string jpg = (dir / "p.jpg").string();
  ASSERT_EQ(
      std::system(("ffmpeg -v error -i '" + (dir / "p.png").string() + "' '" + jpg + "'").c_str()),
      0);
  EXPECT_EQ(load_still(jpg).width, 320u);
  const std::string whole = read_text(jpg);
  const auto cut = dir.write("cut.jpg", whole.substr(0, whole.size() / 2));
  EXPECT_THAT(user_error([&] { load_still(cut); }), HasSubstr("cut.jpg"));
}

/// Makes a file with ffmpeg.
void make(const std::string& arguments) {
  ASSERT_EQ(std::system(("ffmpeg -v error " + arguments).c_str()), 0) << arguments;
}

TEST_F(FfmpegTest, SoundWithoutPicturesIsAnErrorOfOurOwn) {
  const auto refuses = [this](const char* name, const char* message) {
    make("-f lavfi -i sine=d=0.1 '" + (dir / name).string() + "'");
    EXPECT_THAT(user_error([&] { decode_frames(dir / name, {}); }), AllOf(HasSubstr(name), HasSubstr(message)));
  };
  refuses("tone.mp4", "has no pictures (only sound?)");
  refuses("tone.wav", "its format is not allowed");
}

TEST_F(FfmpegTest, TenBitFilmsAndSixteenBitPicturesAreReadAsEight) {
  write_png(dir / "p.png", pattern(64, 48));
  const std::string in = "-i '" + (dir / "p.png").string() + "' ";
  make(in + "-c:v libx264 -pix_fmt yuv420p10le '" + (dir / "ten.mp4").string() + "'");
  make(in + "-pix_fmt rgb48le '" + (dir / "deep.tif").string() + "'");
  make(in + "-pix_fmt gray16be '" + (dir / "grey.tif").string() + "'");
  make(in + "-pix_fmt rgb48be '" + (dir / "deep.png").string() + "'");
  const auto film = decode_frames(dir / "ten.mp4", {});
  ASSERT_EQ(film.size(), 1u);
  EXPECT_EQ(film[0].rgb.size(), 64u * 48 * 3);
  // The upper byte of 16 bits is the 8-bit value itself, give or take the converter's rounding.
  for (const char* name : {"deep.tif", "deep.png"}) {
    const RgbImage still = load_still(dir / name);
    ASSERT_EQ(still.rgb.size(), pattern(64, 48).rgb.size()) << name;
    for (std::size_t i = 0; i < still.rgb.size(); ++i)
      ASSERT_NEAR(still.rgb[i], pattern(64, 48).rgb[i], 1) << name << " " << i;
  }
  const RgbImage grey = load_still(dir / "grey.tif");
  EXPECT_EQ(grey.rgb[0], grey.rgb[2]);
}

TEST_F(FfmpegTest, PicturesUpToTheLimitAreReadAndAboveItNamed) {
  const auto bmp = [&](unsigned width) {
    const std::string file = (dir / ("w" + std::to_string(width) + ".bmp")).string();
    make("-f lavfi -i color=red:s=8192x2:d=0.04 -vf format=rgb24,pad=" + std::to_string(width) +
         ":2 -frames:v 1 '" + file + "'");
    return file;
  };
  EXPECT_EQ(load_still(bmp(8192)).width, 8192u);
  EXPECT_THAT(user_error([&] { load_still(bmp(8193)); }),
              HasSubstr("8193x2 pixels are too large; allowed: up to 8192 pixels a side"));
}

TEST_F(FfmpegTest, AFilmTellsItsRateAndThePixelsShape) {
  make("-f lavfi -i testsrc=s=64x48:r=60000/1001:d=0.2 -vf setsar=16/15 -c:v libx264 '" +
       (dir / "f.mp4").string() + "'");
  const FilmInfo info = film_info(dir / "f.mp4");
  EXPECT_EQ(info.rate, Frequency(60000, 1001));
  EXPECT_NEAR(info.pixel_aspect, 16.0 / 15, 1e-9);
  EXPECT_EQ(info.width, 64u);
  EXPECT_EQ(info.height, 48u);
  EXPECT_TRUE(film_info(dir / "f.mp4", {}, "no-such-ffprobe").rate.stopped());
  EXPECT_TRUE(film_info(dir.write("x.mp4", "x")).rate.stopped());
}

TEST_F(FfmpegTest, AFilmTellsItsFieldOrderAndTransfer) {
  const auto info = [&](const std::string& how, const char* name) {
    make("-f lavfi -i testsrc=s=720x576:r=25:d=0.04 -pix_fmt yuv420p " + how + " '" + (dir / name).string() + "'");
    return film_info(dir / name);
  };
  using Fields = FilmInfo::Fields;
  EXPECT_EQ(info("-vf setfield=prog -c:v libx264", "p.mp4").fields, Fields::kNone);
  EXPECT_EQ(info("-c:v dvvideo", "b.avi").fields, Fields::kBottomFirst) << "DV does not say it of the stream";
  EXPECT_EQ(info("-vf setfield=tff -flags +ilme+ildct -c:v mpeg2video", "t.mpg").fields, Fields::kTopFirst);
  EXPECT_EQ(info("-c:v libx264 -color_trc smpte2084", "q.mp4").transfer, "smpte2084");
  EXPECT_EQ(info("-c:v libx264", "u.mp4").transfer, "unknown");
}

TEST_F(FfmpegTest, AnEmptyPictureIsTheFilesFault) {
  const auto program = dir.write("ffmpeg", "#!/bin/sh\nprintf 'P6\\n0 0\\n255\\n'\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  const auto file = clip(1);
  EXPECT_THAT(user_error([&] { decode_frames(file, {.program = program.string()}); }),
              HasSubstr("its picture of 0x0 pixels is empty"));
}

TEST_F(FfmpegTest, MissingFileAndMissingProgramSayWhat) {
  EXPECT_THAT(user_error([&] { decode_frames(dir / "no.mp4", {}); }),
              AllOf(HasSubstr("no.mp4"), HasSubstr("no such file")));
  const auto file = dir.write("x.mp4", "x");
  EXPECT_THAT(user_error([&] { decode_frames(file, {.program = "no-such-ffmpeg"}); }),
              AllOf(HasSubstr("x.mp4"), HasSubstr("no-such-ffmpeg"), HasSubstr("install")));
}

TEST_F(FfmpegTest, ProgramThatWritesNothingOrHalfAFrameIsNotedAsSuch) {
  const auto file = dir.write("x.mp4", "x");
  const auto fake = [&](const std::string& body) {
    const auto program = dir.write("fake", "#!/bin/sh\n" + body + "\n");
    fs::permissions(program, fs::perms::owner_all);
    return user_error([&] { decode_frames(file, {.program = program.string()}); });
  };
  EXPECT_THAT(fake("exit 0"), HasSubstr("no frames"));
  EXPECT_THAT(fake("printf 'P6\\n2 2\\n255\\nabc'"), HasSubstr("within a frame"));
  EXPECT_THAT(fake("printf 'hello'"), HasSubstr("no pixmap"));
  EXPECT_THAT(fake("echo first >&2; echo the reason >&2; exit 7"),
              AllOf(HasSubstr("status 7"), HasSubstr("the reason")));
  EXPECT_THAT(fake("kill -9 $$"), HasSubstr("status 137"));
  // More messages than a pipe holds must not block the child.
  EXPECT_THAT(fake("head -c 300000 /dev/zero | tr '\\0' e >&2; exit 3"), HasSubstr("status 3"));
}

TEST_F(FfmpegTest, NamesThatLookLikeOptionsOrProtocolsAreFiles) {
  const auto file = clip(1);
  const auto old = fs::current_path();
  fs::current_path(dir.path());
  for (const char* name : {"-i", "http:x", "concat:a|b", "a 'b' $(c).mp4"}) {
    fs::copy_file(file, name);
    EXPECT_EQ(decode_frames(name, {}).size(), 1u) << name;
  }
  fs::current_path(old);
}

/// Files that would make ffmpeg open others, under names that promise a film or a picture.
TEST_F(FfmpegTest, OnlyTheFileItselfIsRead) {
  const std::string film = clip(1).string();
  const std::string hls = "#EXTM3U\n#EXT-X-TARGETDURATION:10\n#EXTINF:10,\n" + film +
                          "\n#EXT-X-ENDLIST\n";
  const std::string concat = "ffconcat version 1.0\nfile clip.mp4\n";
  const std::string dash =
      "<?xml version=\"1.0\"?><MPD xmlns=\"urn:mpeg:dash:schema:mpd:2011\" type=\"static\">"
      "<Period><AdaptationSet mimeType=\"video/mp4\"><Representation id=\"0\" bandwidth=\"1\">"
      "<BaseURL>" + film + "</BaseURL></Representation></AdaptationSet></Period></MPD>";
  const std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9\" height=\"9\"><image href=\"p.png\"/></svg>";
  for (const std::string& text : {hls, concat, dash, svg})
    for (const char* name : {"x.mp4", "x.jpg", "x.m3u8", "x.txt"}) {
      const auto file = dir.write(name, text);
      EXPECT_THAT(user_error([&] { decode_frames(file, {}); }), HasSubstr(name)) << text;
    }
  EXPECT_THAT(user_error([&] { decode_frames(dir.write("pl.mp4", hls), {}); }),
              HasSubstr("format is not allowed"));
  // ffmpeg draws text as a terminal would, judging by the name.
  for (const char* name : {"x.nfo", "x.ans", "x.diz"})
    EXPECT_THAT(user_error([&] { decode_frames(dir.write(name, "hello, world\n"), {}); }),
                HasSubstr(name));
}

TEST_F(FfmpegTest, ANameWithAPatternIsOneFile) {
  write_png(dir / "p.png", pattern(32, 16));
  write_png(dir / "q.png", pattern(48, 16));
  for (const char* step : {"p.png a%03d.jpg", "q.png a001.jpg"}) {
    const std::string text = step;
    const auto space = text.find(' ');
    ASSERT_EQ(std::system(("cd '" + dir.path().string() + "' && ffmpeg -v error -i " +
                           text.substr(0, space) + " -update 1 -f image2 b.jpg && mv b.jpg '" +
                           text.substr(space + 1) + "'")
                              .c_str()),
              0);
  }
  EXPECT_EQ(load_still(dir / "a%03d.jpg").width, 32u) << "and not a001.jpg, which the pattern fits";
}

/// A decoder that hangs, in a process that it has started itself.
TEST_F(FfmpegTest, AStopEndsTheDecodingAndLeavesNoProcess) {
  const auto file = dir.write("x.mp4", "x");
  for (const char* body : {"sleep 1000 & echo $! >\"$0.pid\"; wait",
                           "exec >&-; sleep 1000 & echo $! >\"$0.pid\"; wait"}) {
    const auto program = dir.write("fake", std::string("#!/bin/sh\n") + body + "\n");
    fs::permissions(program, fs::perms::owner_all);
    const auto pid_file = dir / "fake.pid";
    fs::remove(pid_file);
    std::atomic<bool> stop{false};
    std::thread signal([&] {
      for (int i = 0; i < 1000 && read_text(pid_file).find('\n') == std::string::npos; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      stop = true;
    });
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_THROW(decode_frames(file, {.program = program.string(), .stop = &stop}), Stopped);
    signal.join();
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
    const pid_t pid = std::stoi(read_text(pid_file));
    // A zombie until the process that inherits it waits for it: gone, or about to go.
    bool gone = false;
    for (int i = 0; i < 500 && !gone; ++i) {
      const std::string state = read_text("/proc/" + std::to_string(pid) + "/stat");
      gone = state.empty() || state.find(") Z ") != std::string::npos;
      if (!gone) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_TRUE(gone);
  }
}

class HangingTest : public FfmpegTest {
 protected:
  using Clock = std::chrono::steady_clock;
  /// A program that neither reads, writes nor ends.
  HangingTest() {
    program = dir.write("hangs", "#!/bin/sh\nexec sleep 1000\n").string();
    fs::permissions(program, fs::perms::owner_all);
  }
  /// How long `f` takes, in seconds.
  template <class F>
  static double seconds(const F& f) {
    const auto begin = Clock::now();
    f();
    return std::chrono::duration<double>(Clock::now() - begin).count();
  }
  /// Sets `stop` after a while.
  std::thread signal() {
    return std::thread([this] {
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      stop = true;
    });
  }
  std::string program;
  std::atomic<bool> stop{false};
  const std::chrono::milliseconds soon{300};
};

TEST_F(HangingTest, EveryWaitEndsWithTheFirstSignal) {
  std::thread killer = signal();
  EXPECT_LT(seconds([&] { EXPECT_THROW(film_info(clip(1), {.stop = &stop}, program), Stopped); }), 20);
  killer.join();
  stop = false;
  killer = signal();
  Mp4Writer writer(dir / "f.mp4", 640, 480, {25}, {}, {.stop = &stop, .silence_after_stop = soon}, program);
  const RgbImage image = pattern(640, 480);
  EXPECT_LT(seconds([&] {
              EXPECT_THROW(
                  {
                    for (int i = 0; i < 1000; ++i) writer.write(image);
                  },
                  Stopped);
            }),
            20);
  killer.join();
  EXPECT_LT(seconds([&] { EXPECT_THROW(writer.close(), Stopped); }), 20);
}

TEST_F(HangingTest, EveryWaitHasALimitOfTime) {
  EXPECT_THAT(user_error([&] { film_info(clip(1), {.silence = soon}, program); }),
              AllOf(HasSubstr("clip.mp4"), HasSubstr("has not gone on for")));
  Mp4Writer writer(dir / "f.mp4", 640, 480, {25}, {}, {.silence = soon}, program);
  const RgbImage image = pattern(640, 480);
  EXPECT_THAT(user_error([&] {
                for (int i = 0; i < 1000; ++i) writer.write(image);
              }),
              AllOf(HasSubstr("f.mp4"), HasSubstr("has not gone on for")));
  EXPECT_THAT(user_error([&] { writer.close(); }), HasSubstr("has not gone on for"));
}

// An encoder that ends or hangs takes its film along, and nothing else.
TEST_F(HangingTest, AFilmThatFailsLeavesThePictures) {
  const std::string path = std::getenv("PATH");
  for (const char* body : {"exec sleep 1000", "touch \"$0.film\"; echo full >&2; exit 1"}) {
    fs::create_directories(dir / "bin");
    fs::remove_all(dir / "frames");
    fs::create_directory(dir / "frames");
    dir.write("bin/ffmpeg", std::string("#!/bin/sh\n") + body + "\n");
    fs::permissions(dir / "bin/ffmpeg", fs::perms::owner_all);
    ::setenv("PATH", ((dir / "bin").string() + ":" + path).c_str(), 1);
    FrameWriter writer({.folder = dir / "frames", .mp4 = dir.write("f.mp4", "begun"), .patience = {.silence = soon}});
    for (std::uint64_t i = 0; i < 3; ++i) writer.push(i, 640, 480, grey_frame(640, 480, 100));
    writer.close();
    ::setenv("PATH", path.c_str(), 1);
    EXPECT_THAT(writer.lost_video(), AllOf(HasSubstr("f.mp4"), AnyOf(HasSubstr("gone on"), HasSubstr("full"))));
    EXPECT_FALSE(fs::exists(dir / "f.mp4")) << "a film that is cut off is none";
    for (std::uint64_t i = 0; i < 3; ++i) EXPECT_EQ(read_png(dir / "frames" / FrameWriter::file_name(i)).width, 640u);
  }
}

// The child has ended; what it has started keeps its streams open.
TEST_F(HangingTest, AGrandchildThatKeepsTheStreamsIsNotWaitedFor) {
  ChildProcess child({"/bin/sh", "-c", "echo said >&2; sleep 5 & exit 3"}, ChildProcess::Stream::kInput, "test", {});
  EXPECT_LT(seconds([&] { EXPECT_EQ(child.finish(), 3); }), 4);
  EXPECT_EQ(child.messages(), "said\n");
}

TEST_F(FfmpegTest, FilmThatCannotBeWrittenIsAnErrorNotASignal) {
  Mp4Writer writer(dir / "missing/f.mp4", 64, 48, {25});
  const RgbImage image = pattern(64, 48);
  EXPECT_THAT(user_error([&] {
                for (int i = 0; i < 1000; ++i) writer.write(image);
                writer.close();
              }),
              AllOf(HasSubstr("missing/f.mp4"), HasSubstr("No such file")));
}

TEST_F(FfmpegTest, StillIsReadByItsSignatureNotItsName) {
  write_png(dir / "p.dat", pattern(5, 4));
  EXPECT_EQ(load_still(dir / "p.dat").rgb, pattern(5, 4).rgb);
  const auto text = dir.write("p.png", "no picture");
  EXPECT_THAT(user_error([&] { load_still(text); }), HasSubstr("not a PNG"));
}

}  // namespace
}  // namespace fovea::app
