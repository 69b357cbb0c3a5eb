// A board that composes the pictures of four cameras: run it, and find from the displayed bytes which sent frame each
// part of a displayed picture shows.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/board/board.h"
#include "model/common/host_time_slicer.h"
#include "model/video/scene/quad.h"
#include "sw/fovea/program/elf_image.h"
#include "tb/e2e/stamp_reader.h"
#include "tb/oracle/view_oracle.h"

namespace fovea::e2e {

class ViewsRig {
 public:
  /// A displayed picture, and which frame of each camera it shows; nothing: that part is black.
  struct Composed {
    oracle::Frame frame;
    std::uint64_t index = 0;
    Picoseconds start = 0;
    std::array<std::optional<std::uint64_t>, 4> number;
  };

  ViewsRig();
  ~ViewsRig();
  ViewsRig& set(const std::string& key, const std::string& value);
  ViewsRig& load(const std::string& experiment);
  board::Board& build();
  /// Runs until the window is closed or the core fails; builds the board if that was not done.
  void run(Picoseconds limit);
  void advance(Picoseconds duration) { slicer_.run(duration); }

  board::Board& board() { return *board_; }
  /// Displayed frames for which it returns false are not in shown(). Empty: all are.
  std::function<bool(const video::FrameTimes&)> keep;
  std::vector<Composed>& shown() { return shown_; }
  /// The program's runs, and for each camera the number of the first one that it believes to be that camera's.
  struct Runs {
    std::vector<unsigned> camera;
    std::array<std::uint32_t, 4> first{};
  };
  Runs runs() const;
  /// The look-up table in target memory.
  std::vector<std::uint32_t> table() const;
  oracle::LutCheck table_check() const { return oracle::check_view(table(), views_, 0.02); }
  const oracle::Views& views() const { return views_; }
  /// Fills `number` of each displayed picture and returns what is wrong with the first one that is not, byte for byte,
  /// the host's composition of sent frames; empty: nothing. In each part, exactly one of the frames that the camera
  /// sent shortly before must fit.
  /// @param oldest a part may be of a frame that began so many frames before the picture was displayed: more than a
  ///        round of four cameras and the display's buffers
  std::string wrong_picture(const std::vector<std::uint32_t>& lut, std::uint64_t oldest = 12);
  /// The same, where the marks of each part name the frame that it shows, and nothing else does.
  std::string wrong_by_stamps(const std::vector<std::uint32_t>& lut);
  /// The camera's frame number in the marks of its part of a displayed picture; nothing if they cannot be read.
  std::optional<std::uint64_t> stamp(const Composed& shown, unsigned camera) const;
  board::BoardParams params;

 private:
  const oracle::Frame& sent(unsigned camera, std::uint64_t number);
  /// The camera's pixel that a displayed one shows, from the oracle's geometry; nothing if it shows another camera.
  std::optional<SourcePixel> source_pixel(unsigned camera, unsigned u, unsigned v) const;
  std::string wrong_composition(const Composed& shown, const std::vector<std::uint32_t>& lut);
  std::string find_frames(Composed& shown, const std::vector<std::uint32_t>& lut, std::uint64_t oldest);

  ParamSet set_;
  app::ElfImage elf_;
  std::vector<std::unique_ptr<video::StampedSource>> sources_, references_;
  std::unique_ptr<video::QuadSource> quad_, quad_reference_;
  std::unique_ptr<board::Board> board_;
  Subscription frames_;
  oracle::Views views_;
  std::vector<int> cameras_;
  std::vector<Composed> shown_;
  std::map<std::pair<unsigned, std::uint64_t>, oracle::Frame> sent_;
  HostTimeSlicer slicer_;
};

}  // namespace fovea::e2e
