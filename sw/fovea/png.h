// PNG files, and a thread that writes displayed frames as PNG while the simulation goes on.
#pragma once
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "model/common/units.h"
#include "sw/fovea/rgb_image.h"

namespace fovea::app {

/// Reads a PNG of any colour type and depth as 8-bit RGB (alpha is dropped, 16 bits are cut to 8).
/// @throws UserError naming the file: missing, not a PNG, damaged, cut short, larger than
///   kMaxPictureSide
RgbImage read_png(const std::filesystem::path& file);

/// `level`: zlib level 0..9. Equal pictures give equal bytes.
std::vector<std::uint8_t> encode_png(const RgbImage& image, int level);
/// @throws UserError if the file cannot be written
void write_png(const std::filesystem::path& file, const RgbImage& image, int level = 1);

class Mp4Writer;

struct FrameWriterOptions {
  std::filesystem::path folder = {};  ///< PNG files `frame_000000.png`; empty: none
  int folder_fd = -1;  ///< the same folder, open: files are new ones in it; -1: by its name
  int png_level = 1;                  ///< 0..9; 1 is fast and about a tenth larger than 6
  std::size_t queue_frames = 8;       ///< push() waits when so many wait for the encoder
  std::filesystem::path mp4 = {};     ///< also a film; empty: none
  Frequency mp4_rate{25};             ///< frames per second of the film
};

/// Encodes displayed frames on a thread of its own, in order. The pictures do not depend on the
/// host's timing. An error of the thread is thrown by the next push() or by close().
class FrameWriter {
 public:
  explicit FrameWriter(FrameWriterOptions options);
  /// Stops without reporting errors: a caller that cares has called close().
  ~FrameWriter();
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  /// `uyvy` is copied; `index` numbers the file. @throws the encoder's error
  void push(std::uint64_t index, unsigned width, unsigned height,
            std::span<const std::uint8_t> uyvy);
  /// Waits until everything is written. @throws the encoder's error
  void close();
  /// Name of the file of frame `index`, without folder.
  static std::string file_name(std::uint64_t index);

 private:
  struct Job {
    std::uint64_t index;
    unsigned width, height;
    std::vector<std::uint8_t> uyvy;
  };
  void run();
  void encode(const Job& job);
  void stop();

  FrameWriterOptions options_;
  std::unique_ptr<Mp4Writer> mp4_;  // used by the thread; by close() after the join
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> queue_;
  std::exception_ptr error_;
  bool closing_ = false;
  std::thread thread_;
};

}  // namespace fovea::app
