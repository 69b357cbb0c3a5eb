// One board in one process: set keys, run, look at frames and memory.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "model/board/board.h"
#include "model/common/slices.h"
#include "sw/fovea/elf_image.h"
#include "tb/oracle/frame_compare.h"
#include "tb/oracle/lens_oracle.h"

namespace fovea::e2e {

/// A displayed frame of the window with what the board knows of it.
struct Shown {
  oracle::Frame frame;   ///< the region that the firmware shows, without the border around it
  board::FrameRecord record;
  unsigned underflows = 0;
};

/// `fw_state` of the firmware, by position (sw/firmware/README.md).
struct FwState {
  std::uint32_t magic, version, width, height, pitch_bytes, lut_entries, in_count, out_count,
      lut_time_ticks, captured, remapped, flipped, dropped, patched_value, dip, torn, spurious;
};

class Rig {
 public:
  /// `elf`: a file of the firmware's build folder, or an absolute name.
  explicit Rig(std::string elf = "fovea_firmware.elf");
  ~Rig();
  /// As `-s key=value`; before run() only.
  Rig& set(const std::string& key, const std::string& value);
  /// Takes all keys of a shipped experiment ("default.yaml"), its footage included.
  Rig& load(const std::string& experiment);
  Rig& strict() { strict_ = true; return *this; }
  /// Builds the board without running it, for tests that turn something by hand.
  board::Board& build();
  /// Runs until the window is closed, the core fails, or `limit` of simulated time is over.
  void run(Picoseconds limit);
  /// Only lets time pass.
  void advance(Picoseconds duration);

  board::Board& board() { return *board_; }
  const std::vector<Shown>& shown() const { return shown_; }
  /// Where the marks are in the pictures that the camera sends; nothing when they are off.
  const std::optional<video::StampLayout>& stamps() const { return source_->stamps(); }
  /// What the camera sent in frame n: rows of fields 2n and 2n + 1, the region that is captured.
  oracle::Frame sent(std::uint64_t n);
  std::vector<std::uint32_t> lut();
  FwState state();
  oracle::Geometry geometry() const;
  const app::ElfImage& elf() const { return elf_; }
  board::BoardParams params;

 private:
  ParamSet set_;
  app::ElfImage elf_;
  bool strict_ = false;
  std::unique_ptr<video::StampedSource> source_;
  std::unique_ptr<video::StampedSource> reference_;  // for sent(): a source of its own
  std::unique_ptr<board::Board> board_;
  std::vector<Shown> shown_;
  Slices slices_;
};

/// Bytes of a rectangle of a picture.
oracle::Frame crop(const video::Picture& p, unsigned x, unsigned y, unsigned width,
                   unsigned height);

}  // namespace fovea::e2e
