// One board in one process: set keys, run, inspect frames and memory.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "model/board/board.h"
#include "model/common/host_time_slicer.h"
#include "sw/fovea/program/elf_image.h"
#include "tb/oracle/frame_compare.h"
#include "tb/oracle/lens_oracle.h"
#include "tb/own_diagnostics.h"

namespace fovea::e2e {

/// Simulated time by which a run with pictures is over.
inline constexpr Picoseconds kLimit = 20 * kPsPerSecond;

/// A frame displayed in the window, with the board's record of it.
struct Shown {
  oracle::Frame frame;   ///< the region that the firmware displays, without the surrounding border
  video::FrameTimes record;
  unsigned underflows = 0;
};

/// The members of the firmware's `fw_state` by position (sw/firmware/README.md).
struct FwState {
  std::uint32_t magic, version, width, height, pitch_bytes, lut_entries, in_count, out_count,
      lut_time_ticks, captured, remapped, flipped, dropped, patched_value, dip, torn, spurious,
      tables, table_address[4];
};

class Rig {
 public:
  OwnDiagnostics diagnostics;  ///< of the board and of reading its parameters
  /// @param elf a file in the firmware's build folder, or a path with a slash in it
  explicit Rig(std::string elf = "fovea_firmware.elf");
  ~Rig();
  /// Like `-s key=value`; only before run().
  Rig& set(const std::string& key, const std::string& value);
  /// Sets all keys of a shipped experiment ("default.yaml"), including its footage.
  Rig& load(const std::string& experiment);
  Rig& strict() { strict_ = true; return *this; }
  /// Builds the board without running it, for tests that modify something themselves.
  board::Board& build();
  /// Runs until the window is closed, the core fails, or the simulated time has reached `limit`.
  void run(Picoseconds limit);
  /// Runs for a simulated duration.
  void advance(Picoseconds duration);

  board::Board& board() { return *board_; }
  const std::vector<Shown>& shown() const { return shown_; }
  /// Positions of the marks in the camera's pictures; empty if they are disabled.
  const std::optional<video::StampLayout>& stamps() const { return source_->stamps(); }
  /// What the camera sent as frame n (rows of fields 2n and 2n + 1), limited to the captured
  /// region.
  oracle::Frame sent(std::uint64_t n);
  /// The table of view `k`, one of `firmware.tables`.
  std::vector<std::uint32_t> lut(unsigned k = 0);
  FwState state();
  /// The geometry of view `k`: 7 pixels further right for each (model/contract/README.md).
  oracle::Geometry geometry(unsigned k = 0) const;
  const app::ElfImage& elf() const { return elf_; }
  board::BoardParams params;

 private:
  ParamSet set_;
  app::ElfImage elf_;
  bool strict_ = false;
  std::unique_ptr<video::StampedSource> source_;
  std::unique_ptr<video::StampedSource> reference_;  // a separate source for sent()
  std::unique_ptr<board::Board> board_;
  Subscription frames_;
  std::vector<Shown> shown_;
  HostTimeSlicer slicer_;
};

/// The bytes of a rectangle of a picture.
oracle::Frame crop(const video::Picture& p, unsigned x, unsigned y, unsigned width,
                   unsigned height);

}  // namespace fovea::e2e
