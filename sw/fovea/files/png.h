// PNG files, and a thread that writes displayed frames as PNG during the simulation.
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
#include "sw/fovea/files/child_process.h"
#include "sw/fovea/files/rgb_image.h"

namespace fovea::app {

/// Reads a PNG of any colour type and depth as 8-bit RGB (alpha is dropped, 16 bits are cut to 8).
/// @throws UserError that names the file: missing, not a PNG, damaged, truncated, larger than
/// kMaxPictureSide
RgbImage read_png(const std::filesystem::path& file);

/// @param level zlib compression level 0 to 9. Equal pictures give equal bytes.
/// @param pixel is written (pHYs) unless it is square
std::vector<std::uint8_t> encode_png(const RgbImage& image, int level, PixelShape pixel = {});

class Mp4Writer;

struct FrameWriterOptions {
  std::filesystem::path folder = {};  ///< for PNG files `frame_000000.png`, which must not exist; empty: none
  int folder_fd = -1;  ///< descriptor of that folder, in which the files are created; -1: use the
                       ///< name
  int png_level = 1;                  ///< 0 to 9; level 1 is fast, and its files are about a tenth
                                      ///< larger than with 6
  std::size_t queue_frames = 8;       ///< push() waits while so many frames wait for the encoder
  std::filesystem::path mp4 = {};     ///< also writes a video; empty: none
  Patience patience = {};             ///< with the encoder of the video
  Frequency mp4_rate{25};             ///< frames per second of the video
};

/// Encodes displayed frames in order on a thread of its own. The files do not depend on the host's
/// timing. An error of the thread is thrown by the next push() or by close(). A video that cannot be written is no
/// such error: it is given up and removed, and the pictures go on.
class FrameWriter {
 public:
  explicit FrameWriter(FrameWriterOptions options);
  /// Stops without reporting errors; call close() first to have them reported.
  ~FrameWriter();
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  /// Copies `uyvy`; `index` is the number in the file's name. @throws the encoder's error
  void push(std::uint64_t index, unsigned width, unsigned height,
            std::span<const std::uint8_t> uyvy, PixelShape pixel = {});
  /// Waits until all frames are written. @throws the encoder's error
  void close();
  /// Why there is no video, though one was asked for; to be called after close(). Empty: it is whole.
  const std::string& lost_video() const { return lost_video_; }
  /// Name of the file of frame `index`, without folder.
  static std::string file_name(std::uint64_t index);

 private:
  struct Job {
    std::uint64_t index;
    unsigned width, height;
    std::vector<std::uint8_t> uyvy;
    PixelShape pixel;
  };
  void run();
  void encode(const Job& job);
  void encode_video(const RgbImage& image, PixelShape pixel);
  void lose_video(const std::string& why);
  void stop();

  FrameWriterOptions options_;
  std::unique_ptr<Mp4Writer> mp4_;  // used by the thread, and by close() after the thread has ended
  std::string lost_video_;          // the same
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> queue_;
  std::exception_ptr error_;
  bool closing_ = false;
  std::thread thread_;
};

}  // namespace fovea::app
