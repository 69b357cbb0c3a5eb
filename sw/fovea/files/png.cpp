#include "sw/fovea/files/png.h"

#include <fmt/format.h>
#include <spng.h>

#include <algorithm>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/ffmpeg.h"

namespace fovea::app {
namespace {

constexpr std::size_t kMaxPngBytes = 256u << 20;
constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);
constexpr std::string_view kLastChunk("\0\0\0\0IEND\xae\x42\x60\x82", 12);

struct ContextDeleter {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};
using Context = std::unique_ptr<spng_ctx, ContextDeleter>;

/// How EXIF data ask for the picture to be turned (TIFF 6.0, tag 274); 1 is not at all, which is also taken for data
/// that do not say it or are damaged.
unsigned orientation_of(std::string_view exif) {
  const bool little = exif.starts_with("II");
  const auto number = [&](std::size_t at, std::size_t bytes) {
    std::uint32_t out = 0;
    if (at > exif.size() || bytes > exif.size() - at) return out;
    for (std::size_t k = 0; k < bytes; ++k)
      out = out << 8 | static_cast<unsigned char>(exif[at + (little ? bytes - 1 - k : k)]);
    return out;
  };
  const std::size_t directory = number(4, 4);
  const std::uint32_t entries = number(directory, 2);
  for (std::uint32_t n = 0; n < entries; ++n) {
    const std::size_t entry = directory + 2 + std::size_t{12} * n;
    if (entry >= exif.size()) break;
    if (number(entry, 2) == 274) return number(entry + 8, 2);
  }
  return 1;
}

constexpr std::int32_t fixed(double v) {
  return static_cast<std::int32_t>(v * 65536 + (v < 0 ? -0.5 : 0.5));
}
// Factors of BT.601 (Kr 0.299, Kb 0.114) times 255/219 and 255/224.
constexpr std::int32_t kY = fixed(255.0 / 219), kCrR = fixed(1.402 * 255 / 224),
                       kCbG = fixed(0.114 * 1.772 / 0.587 * 255 / 224),
                       kCrG = fixed(0.299 * 1.402 / 0.587 * 255 / 224),
                       kCbB = fixed(1.772 * 255 / 224);

std::uint8_t to_byte(std::int32_t v) {
  return static_cast<std::uint8_t>(std::clamp((v + 32768) >> 16, 0, 255));
}

}  // namespace

RgbImage uyvy_to_rgb(unsigned width, unsigned height, std::span<const std::uint8_t> uyvy) {
  FOVEA_CHECK(width % 2 == 0 && uyvy.size() == std::size_t{2} * width * height,
              "a 4:2:2 picture of even width without padding");
  RgbImage out{width, height, std::vector<std::uint8_t>(std::size_t{3} * width * height)};
  const std::uint8_t* in = uyvy.data();
  std::uint8_t* rgb = out.rgb.data();
  for (std::size_t pair = 0; pair < uyvy.size() / 4; ++pair, in += 4, rgb += 6) {
    const std::int32_t cb = in[0] - 128, cr = in[2] - 128;
    const std::int32_t r = kCrR * cr, g = -kCbG * cb - kCrG * cr, b = kCbB * cb;
    for (int i = 0; i < 2; ++i) {
      const std::int32_t y = kY * (in[1 + 2 * i] - 16);
      rgb[3 * i] = to_byte(y + r);
      rgb[3 * i + 1] = to_byte(y + g);
      rgb[3 * i + 2] = to_byte(y + b);
    }
  }
  return out;
}

RgbImage read_png(const std::filesystem::path& file) {
  const std::string bytes = read_file(file, kMaxPngBytes);
  const auto fail = [&](const char* why) {
    throw UserError(fmt::format("cannot read the picture '{}': {}", one_line(file.string()), why));
  };
  const auto check = [&](int result) {
    if (result == SPNG_OK) return;
    if (result == SPNG_IO_EOF || result == SPNG_EOF || result == SPNG_EIDAT_TOO_SHORT)
      fail("the PNG file is cut short");
    static const std::string too_large =
        fmt::format("the picture is too large; allowed: up to {} pixels a side", kMaxPictureSide);
    if (result == SPNG_EUSER_WIDTH || result == SPNG_EUSER_HEIGHT) 
      fail(too_large.c_str());
    fail(spng_strerror(result));
  };
  if (!bytes.starts_with(kSignature)) fail("it is not a PNG file");
  const Context context(spng_ctx_new(0));
  FOVEA_CHECK(context != nullptr, "no memory for a PNG decoder");
  // Refuse files with hundreds of megabytes in text chunks.
  check(spng_set_chunk_limits(context.get(), 16u << 20, 32u << 20));
  check(spng_set_image_limits(context.get(), kMaxPictureSide, kMaxPictureSide));
  check(spng_set_crc_action(context.get(), SPNG_CRC_ERROR, SPNG_CRC_DISCARD));
  check(spng_set_png_buffer(context.get(), bytes.data(), bytes.size()));
  spng_ihdr header{};
  check(spng_get_ihdr(context.get(), &header));
  std::size_t size = 0;
  check(spng_decoded_image_size(context.get(), SPNG_FMT_RGB8, &size));
  RgbImage image{header.width, header.height, std::vector<std::uint8_t>(size)};
  check(spng_decode_image(context.get(), image.rgb.data(), size, SPNG_FMT_RGB8, 0));
  check(spng_decode_chunks(context.get()));
  if (spng_exif exif{}; spng_get_exif(context.get(), &exif) == SPNG_OK)
    if (const unsigned turned = orientation_of({exif.data, exif.length}); turned > 1 && turned <= 8)
      DiagnosticsRef::current().configuration(
          fmt::format("picture '{}' is taken as it is stored: its EXIF orientation, {}, is not followed",
                      one_line(file.string()), turned));
  // The decoder does not require the end marker, but a file that is truncated after the pixels is
  // damaged.
  if (bytes.find(kLastChunk) == std::string::npos) fail("the PNG file is cut short");
  return image;
}

std::vector<std::uint8_t> encode_png(const RgbImage& image, int level, PixelShape pixel) {
  FOVEA_CHECK(image.rgb.size() == std::size_t{3} * image.width * image.height,
              "picture and size differ");
  const Context context(spng_ctx_new(SPNG_CTX_ENCODER));
  const auto check = [](int result) {
    FOVEA_CHECK(result == SPNG_OK, std::string("PNG encoder: ") + spng_strerror(result));
  };
  spng_ihdr header{};
  header.width = image.width;
  header.height = image.height;
  header.bit_depth = 8;
  header.color_type = SPNG_COLOR_TYPE_TRUECOLOR;
  check(spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1));
  check(spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, level));
  // Use one filter for all rows: choosing it for each row takes more time than it saves bytes.
  if (level <= 3) check(spng_set_option(context.get(), SPNG_FILTER_CHOICE, SPNG_FILTER_CHOICE_SUB));
  check(spng_set_ihdr(context.get(), &header));
  if (pixel.width != pixel.height) {
    spng_phys shape{};  // pixels per unit; without a unit only their ratio counts
    shape.ppu_x = pixel.height;
    shape.ppu_y = pixel.width;
    check(spng_set_phys(context.get(), &shape));
  }
  check(spng_encode_image(context.get(), image.rgb.data(), image.rgb.size(), SPNG_FMT_PNG,
                          SPNG_ENCODE_FINALIZE));
  std::size_t size = 0;
  int error = 0;
  const std::unique_ptr<void, decltype(&std::free)> png(
      spng_get_png_buffer(context.get(), &size, &error), &std::free);
  check(error);
  const auto* data = static_cast<const std::uint8_t*>(png.get());
  return {data, data + size};
}

FrameWriter::FrameWriter(FrameWriterOptions options) : options_(std::move(options)) {
  FOVEA_CHECK(options_.queue_frames > 0, "the queue holds at least one frame");
  thread_ = std::thread([this] { run(); });
}

FrameWriter::~FrameWriter() { stop(); }

std::string FrameWriter::file_name(std::uint64_t index) {
  return fmt::format("frame_{:06}.png", index);
}

void FrameWriter::push(std::uint64_t index, unsigned width, unsigned height,
                       std::span<const std::uint8_t> uyvy, PixelShape pixel) {
  Job job{index, width, height, {uyvy.begin(), uyvy.end()}, pixel};
  std::unique_lock lock(mutex_);
  FOVEA_CHECK(!closing_, "frame pushed after close");
  changed_.wait(lock, [this] { return queue_.size() < options_.queue_frames || error_; });
  if (error_) std::rethrow_exception(error_);
  queue_.push_back(std::move(job));
  changed_.notify_all();
}

void FrameWriter::stop() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

void FrameWriter::close() {
  stop();
  if (error_) std::rethrow_exception(error_);
  if (!mp4_) return;
  try {
    mp4_->close();
  } catch (const UserError& e) {
    lose_video(e.what());
  } catch (const Stopped&) {
    lose_video("");
  }
}

void FrameWriter::lose_video(const std::string& why) {
  mp4_.reset();
  lost_video_ = why.empty() ? fmt::format("cannot write '{}': its encoder hung when the run was stopped",
                                          one_line(options_.mp4.string()))
                            : why;
  std::error_code ignored;
  std::filesystem::remove(options_.mp4, ignored);
}

void FrameWriter::run() {
  for (;;) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !queue_.empty() || closing_; });
    if (queue_.empty()) return;
    const Job job = std::move(queue_.front());
    queue_.pop_front();
    changed_.notify_all();
    lock.unlock();
    try {
      encode(job);
    } catch (...) {
      lock.lock();
      error_ = std::current_exception();
      queue_.clear();
      changed_.notify_all();
      return;
    }
  }
}

void FrameWriter::encode(const Job& job) {
  const RgbImage image = uyvy_to_rgb(job.width, job.height, job.uyvy);
  if (!options_.folder.empty()) {
    const auto file = options_.folder / file_name(job.index);
    auto out = options_.folder_fd < 0 ? CheckedFile(file, CheckedFile::New{}) : CheckedFile(file, options_.folder_fd);
    out.write(encode_png(image, options_.png_level, job.pixel));
    out.close();
  }
  if (!options_.mp4.empty() && lost_video_.empty()) encode_video(image, job.pixel);
}

void FrameWriter::encode_video(const RgbImage& image, PixelShape pixel) {
  try {
    if (!mp4_)
      mp4_ = std::make_unique<Mp4Writer>(options_.mp4, image.width, image.height, options_.mp4_rate, pixel,
                                         options_.patience);
    mp4_->write(image);
  } catch (const UserError& e) {
    lose_video(e.what());
  } catch (const Stopped&) {
    lose_video("");
  }
}

}  // namespace fovea::app
