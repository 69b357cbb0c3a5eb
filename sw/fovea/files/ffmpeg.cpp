#include "sw/fovea/files/ffmpeg.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>
#include <utility>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/png.h"

namespace fovea::app {
namespace {

constexpr std::size_t kMaxMessageBytes = 4096;

/// Demuxers of ffmpeg that read one video or picture from the given file only. Excluded on purpose:
/// hls, dash, concat, imf (lists of files), image2 (patterns of names), tty and the like (text),
/// svg_pipe (may refer to other files), lavfi and devices.
constexpr const char* kFormats =
    "mov,matroska,avi,mpegts,mpeg,mpegvideo,m4v,h264,hevc,mjpeg,gif,apng,flv,asf,ogg,ivf,nut,dv,"
    "mxf,yuv4mpegpipe,bmp_pipe,dpx_pipe,exr_pipe,gif_pipe,j2k_pipe,jpeg_pipe,jpegls_pipe,"
    "jpegxl_pipe,pam_pipe,pbm_pipe,pcx_pipe,pgm_pipe,png_pipe,ppm_pipe,psd_pipe,qoi_pipe,"
    "sgi_pipe,sunrast_pipe,tiff_pipe,webp_pipe,xwd_pipe";
/// The footage as the child sees it: with the real name, ffmpeg would guess the format from the
/// suffix.
constexpr const char* kFootage = "file:/dev/stdin";

/// A descriptor that is closed at the end of its scope or earlier.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  void close() {
    if (fd_ >= 0) ::close(std::exchange(fd_, -1));
  }

 private:
  int fd_;
};

/// ffmpeg's message for a one-line error: its last line, which names the cause.
std::string last_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  const std::size_t newline = text.find_last_of("\r\n");
  return one_line(newline == std::string::npos ? text : text.substr(newline + 1), 200);
}

/// Removes a frame of the portable pixmap format ("P6\nW H\n255\n" and the pixels) from the front
/// of `buffer`; nullopt if it is not complete yet. @throws std::runtime_error for anything else
std::optional<RgbImage> take_frame(std::string& buffer) {
  std::array<unsigned, 3> header{};  // width, height, largest value
  const std::string_view text(buffer);
  if (text.size() < 2) return std::nullopt;
  if (text.substr(0, 2) != "P6") throw std::runtime_error("ffmpeg wrote no pixmap");
  std::size_t at = 2;
  for (auto& number : header) {
    while (at < text.size() && (text[at] == '\n' || text[at] == ' ')) ++at;
    const auto [end, ec] = std::from_chars(text.data() + at, text.data() + text.size(), number);
    if (end == text.data() + text.size()) return std::nullopt;
    if (ec != std::errc()) throw std::runtime_error("ffmpeg wrote a damaged pixmap");
    at = static_cast<std::size_t>(end - text.data());
  }
  const auto [width, height, largest] = header;
  if (largest != 255)
    throw std::runtime_error("its pictures have more than 8 bits a channel, and ffmpeg does not "
                             "convert them; convert the file with '-pix_fmt yuv420p'");
  if (width == 0 || height == 0)
    throw std::runtime_error(fmt::format("its picture of {}x{} pixels is empty", width, height));
  if (width > kMaxPictureSide || height > kMaxPictureSide)
    throw std::runtime_error(
        fmt::format("its pictures of {}x{} pixels are too large; allowed: up to {} "
                    "pixels a side",
                    width, height, kMaxPictureSide));
  const std::size_t size = std::size_t{3} * width * height;
  const std::size_t begin = at + 1;  // one separator follows the last number
  if (text.size() < begin + size) {
    buffer.reserve(begin + size);
    return std::nullopt;
  }
  RgbImage image{width, height, {}};
  const auto* pixels = reinterpret_cast<const std::uint8_t*>(text.data()) + begin;
  image.rgb.assign(pixels, pixels + size);
  buffer.erase(0, begin + size);
  return image;
}

}  // namespace

/// Options that scale frames of this size down to the largest allowed one and keep the aspect
/// ratio.
static DecodeOptions reduced(DecodeOptions options, unsigned width, unsigned height) {
  const double scale = std::min(static_cast<double>(options.most_width) / width,
                                static_cast<double>(options.most_height) / height);
  options.width = std::max(1u, static_cast<unsigned>(width * scale));
  options.height = std::max(1u, static_cast<unsigned>(height * scale));
  options.most_width = options.most_height = 0;
  return options;
}

[[noreturn]] static void refuse_footage(const std::filesystem::path& file, const std::string& why) {
  throw UserError(fmt::format("cannot read the footage '{}': {}", one_line(file.string()), why));
}

/// ffmpeg's own message for a missing file is long; this one is the same for all readers.
static int open_footage(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) refuse_footage(file, "no such file");
  if (!std::filesystem::is_regular_file(file, error)) refuse_footage(file, "it is not a regular file");
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) refuse_footage(file, std::strerror(errno));
  return fd;
}

/// Errors in the data end the decoding (-xerror) instead of being concealed.
static std::vector<std::string> decode_command(const DecodeOptions& options) {
  std::vector<std::string> command = {options.program,
                                      "-nostdin",
                                      "-hide_banner",
                                      "-v",
                                      "error",
                                      "-xerror",
                                      "-protocol_whitelist",
                                      "file,pipe",
                                      "-format_whitelist",
                                      kFormats,
                                      "-threads",
                                      "1",
                                      "-i",
                                      kFootage,
                                      "-map",
                                      "0:v:0",
                                      "-frames:v",
                                      std::to_string(options.max_frames)};
  if (options.width != 0) {
    command.push_back("-vf");
    command.push_back(fmt::format("scale={}:{}:flags=bicubic+accurate_rnd+full_chroma_int+bitexact",
                                  options.width, options.height));
  }
  // Without -pix_fmt, a source with more than 8 bits would become a 16-bit pixmap.
  for (const char* word : {"-vsync", "passthrough", "-f", "image2pipe", "-c:v", "ppm", "-pix_fmt",
                           "rgb24", "pipe:1"})
    command.push_back(word);
  return command;
}

/// Refuses what ffmpeg has complained of, and an end within a frame.
static void check_decoded(const std::filesystem::path& file, int status, const std::string& messages,
                          bool ends_within_frame) {
  std::string words = last_line(messages);
  if (messages.find("ormat not on whitelist") != std::string::npos)
    refuse_footage(file,
                   "its format is not allowed; allowed: one film or picture, and no playlist, list of files "
                   "or text");
  if (const auto at = words.find(kFootage); at != std::string::npos)
    words.replace(at, std::string_view(kFootage).size(), "the file");
  if (messages.find("matches no streams") != std::string::npos)
    refuse_footage(file, "it has no pictures (only sound?); allowed: a picture or a film");
  if (status != 0)
    refuse_footage(file, fmt::format("ffmpeg ended with status {}{}", status, words.empty() ? "" : ": " + words));
  if (ends_within_frame) refuse_footage(file, "ffmpeg's output ends within a frame");
  if (!messages.empty()) refuse_footage(file, "it is damaged or cut short: " + words);
}

std::vector<RgbImage> decode_frames(const std::filesystem::path& file,
                                    const DecodeOptions& options) {
  Descriptor footage(open_footage(file));
  ChildProcess child(decode_command(options), ChildProcess::Stream::kOutput,
                     fmt::format("cannot read the footage '{}'", one_line(file.string())), {.stop = options.stop},
                     footage.get());
  footage.close();
  std::vector<RgbImage> frames;
  std::string buffer;
  try {
    while (child.read_some(buffer))
      while (auto frame = take_frame(buffer)) {
        if (options.most_width != 0 &&
            (frame->width > options.most_width || frame->height > options.most_height))
          return decode_frames(file, reduced(options, frame->width, frame->height));
        frames.push_back(std::move(*frame));
      }
  } catch (const Stopped&) {
    throw;
  } catch (const UserError&) {
    throw;
  } catch (const std::runtime_error& e) {
    refuse_footage(file, e.what());
  }
  const int status = child.finish();
  check_decoded(file, status, child.messages(), !buffer.empty());
  if (frames.empty()) refuse_footage(file, "it has no frames");
  for (const auto& f : frames)
    if (f.width != frames[0].width || f.height != frames[0].height)
      refuse_footage(file, "its frames differ in size");
  return frames;
}

FilmInfo film_info(const std::filesystem::path& file, const Patience& patience, const std::string& program) {
  FilmInfo out;
  std::string text;
  Descriptor film(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (film.get() < 0) return out;
  std::optional<ChildProcess> child;
  try {
    child.emplace(std::vector<std::string>{program, "-v", "error", "-protocol_whitelist", "file,pipe",
                                           "-format_whitelist", kFormats, "-select_streams", "v:0", "-show_entries",
                                           "stream=width,height,sample_aspect_ratio,avg_frame_rate:"
                                           "frame=interlaced_frame,top_field_first,color_transfer",
                                           "-read_intervals", "%+#1", "-of", "default=noprint_wrappers=1", "-i",
                                           kFootage},
                  ChildProcess::Stream::kOutput, fmt::format("cannot ask about '{}'", one_line(file.string())),
                  patience, film.get());
  } catch (const UserError&) {
    return out;  // decoding the video will report that there is no ffmpeg
  }
  while (text.size() < kMaxMessageBytes && child->read_some(text)) {
  }
  child.reset();  // what it says beyond is not needed
  const auto pair = [&](std::string_view key, char separator, std::uint64_t& a, std::uint64_t& b) {
    const std::size_t at = text.find(key);
    if (at == std::string::npos) return false;
    const char* const end = text.data() + text.size();
    const auto first = std::from_chars(text.data() + at + key.size(), end, a);
    if (first.ec != std::errc() || first.ptr == end || *first.ptr != separator) return false;
    const auto second = std::from_chars(first.ptr + 1, end, b);
    return second.ec == std::errc() && a > 0 && b > 0 && a < 1'000'000'000 && b < 1'000'000'000;
  };
  const auto number = [&](std::string_view key) {
    unsigned n = 0;
    if (const std::size_t at = text.find(key); at != std::string::npos)
      std::from_chars(text.data() + at + key.size(), text.data() + text.size(), n);
    return n;
  };
  out.width = number("width=");
  out.height = number("height=");
  // Of the first frame, as the decoder sees it: some containers do not say it of the stream.
  if (number("interlaced_frame=") != 0)
    out.fields = number("top_field_first=") != 0 ? FilmInfo::Fields::kTopFirst : FilmInfo::Fields::kBottomFirst;
  constexpr std::string_view kTransfer = "color_transfer=";
  if (const std::size_t at = text.find(kTransfer); at != std::string::npos) {
    const std::size_t from = at + kTransfer.size();
    out.transfer = one_line(text.substr(from, text.find_first_of("\r\n", from) - from), 40);
  }
  std::uint64_t a = 0, b = 0;
  if (pair("avg_frame_rate=", '/', a, b)) out.rate = Frequency(a, b);
  if (pair("sample_aspect_ratio=", ':', a, b))
    out.pixel_aspect = static_cast<double>(a) / static_cast<double>(b);
  return out;
}

RgbImage load_still(const std::filesystem::path& file, const std::atomic<bool>* stop) {
  static constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";
  constexpr std::size_t kMaxStillBytes = 256u << 20;
  // A file named *.png also goes to the PNG reader, whose message is the right one.
  if (file.extension() == ".png" || read_file(file, kMaxStillBytes).starts_with(kPngSignature))
    return read_png(file);
  return std::move(decode_frames(file, {.stop = stop}).front());
}

Mp4Writer::Mp4Writer(std::filesystem::path file, unsigned width, unsigned height, Frequency rate,
                     PixelShape pixel, const Patience& patience, const std::string& program)
    : file_(std::move(file)),
      width_(width),
      height_(height),
      child_({program,        "-nostdin",
              "-hide_banner", "-v",
              "error",        "-y",
              "-f",           "rawvideo",
              "-pix_fmt",     "rgb24",
              "-s",           fmt::format("{}x{}", width, height),
              "-r",           fmt::format("{}/{}", rate.num, rate.den),
              "-i",           "pipe:0",
              "-vf",          fmt::format("setsar={}/{}", pixel.width, pixel.height),
              "-c:v",         "libx264",
              "-preset",      "veryfast",
              "-crf",         "18",
              "-pix_fmt",     "yuv420p",
              "-threads",     "1",
              "-bitexact",    "-f",
              "mp4",          "file:" + file_.string()},
             ChildProcess::Stream::kInput,
             fmt::format("cannot write '{}'", one_line(file_.string())), patience) {}

void Mp4Writer::write(const RgbImage& image) {
  FOVEA_CHECK(image.width == width_ && image.height == height_, "a film's frames are of one size");
  if (!child_.write_all(image.rgb.data(), image.rgb.size())) fail(child_.finish());
}

void Mp4Writer::close() {
  if (const int status = child_.finish(); status != 0) fail(status);
}

void Mp4Writer::fail(int status) {
  const std::string words = last_line(child_.messages());
  throw UserError(fmt::format("cannot write '{}': ffmpeg ended with status {}{}",
                              one_line(file_.string()), status, words.empty() ? "" : ": " + words));
}

}  // namespace fovea::app
