// A board with several cameras: run it, and read from the displayed pixels which camera's frame they show.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/board/board.h"
#include "model/common/host_time_slicer.h"
#include "sw/fovea/program/elf_image.h"
#include "tb/e2e/stamp_reader.h"
#include "tb/oracle/frame_compare.h"
#include "tb/oracle/lens_oracle.h"

namespace fovea::e2e {

class CamerasRig {
 public:
  /// A displayed frame, and the frame number and camera in its pixels; nothing if they cannot be read.
  struct Shown {
    oracle::Frame frame;
    video::FrameTimes record;
    struct Stamp {
      unsigned camera, number;
    };
    std::optional<Stamp> stamp;
    unsigned underflows = 0;
  };

  CamerasRig();
  ~CamerasRig();
  CamerasRig& set(const std::string& key, const std::string& value);
  /// Sets all keys of a shipped experiment, with its footage and calibrations.
  CamerasRig& load(const std::string& experiment);
  /// Builds the board, once.
  board::Board& build();
  /// Runs until the window is closed or the core fails; builds the board if that was not done.
  void run(Picoseconds limit);
  void advance(Picoseconds duration) { slicer_.run(duration); }

  board::Board& board() { return *board_; }
  /// Displayed frames for which it returns false are not in shown(). Empty: all are.
  std::function<bool(const video::FrameTimes&)> keep;
  const std::vector<Shown>& shown() const { return shown_; }
  /// What is wrong with the first displayed frame that is not, byte for byte, the host's remap of the
  /// frame that its pixels name by that camera's table; empty: nothing.
  std::string wrong_picture();
  /// Which view's table, byte for byte, made the displayed frame; ~0: none.
  unsigned shown_by(const Shown& shown);
  /// What the marks of a frame say that is corrected by the table of `camera`, whose frame it may not be.
  ShownFields read_stamp(const oracle::Frame& frame, unsigned camera) const;
  /// A further view that the camera has, later in the run: frames are looked for in it too.
  void add_view(unsigned camera, const oracle::Geometry& geometry);
  const oracle::Geometry& geometry(unsigned camera) const { return views_.at(camera).front().geometry; }
  /// Reads the camera's table from target memory now; wrong_picture() uses it for its view `table`. What was
  /// not kept is read at the end.
  void keep_table(unsigned camera, unsigned table);
  /// Where the camera's table lies now.
  std::uint32_t table_address(unsigned camera);
  /// Entries of the camera's table in target memory that the oracle's do not confirm.
  oracle::LutCheck table_check(unsigned camera, unsigned table = 0);
  /// The lines that the firmware has printed about its cameras.
  std::vector<std::string> said() const;
  board::BoardParams params;

 private:
  struct View {
    oracle::Geometry geometry;
    std::vector<std::uint32_t> table;  // empty: not read yet
  };
  std::vector<std::uint32_t> table(unsigned camera);
  void keep_tables();
  oracle::Frame sent(unsigned camera, std::uint64_t number);
  std::optional<Shown::Stamp> read_stamp(const oracle::Frame& frame) const;

  ParamSet set_;
  app::ElfImage elf_;
  std::vector<std::unique_ptr<video::StampedSource>> sources_, references_;
  std::vector<std::vector<View>> views_;  // of each camera
  std::unique_ptr<board::Board> board_;
  Subscription frames_;
  std::vector<Shown> shown_;
  HostTimeSlicer slicer_;
};

/// `cameras` of them, with a region that is large enough for the marks and a lens of its own for each.
void small(CamerasRig& rig, unsigned cameras);

/// The displayed frames without repetitions.
std::vector<CamerasRig::Shown::Stamp> sequence(const CamerasRig& rig);

/// Runs. Times at which the firmware has said something of a camera first, by what it said.
std::map<std::string, Picoseconds> listen(CamerasRig& rig, Picoseconds limit);

}  // namespace fovea::e2e
