// Records a board's run for Perfetto: requests of the masters, DMA transfers, interrupts, phases of the
// firmware, frames, and counters of the SDRAM.
#pragma once
#include <array>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/board/board.h"
#include "model/common/mem_observer.h"
#include "sw/fovea/probes/perfetto_file.h"
#include "sw/fovea/probes/perfetto_functions.h"

namespace fovea::app {

/// What `--perfetto` and its companions ask for.
struct PerfettoRequest {
  std::filesystem::path file = {};
  std::string tracks = ".";  ///< regular expression (RE2); part of GROUP/TRACK
  /// When the recording begins: a time since power-up, or with the window.
  std::string from = "window";
  Picoseconds duration = kNever;  ///< and for how long
  /// "": records until the duration is over. Otherwise the recording ends `duration` after the first
  /// displayed frame that was dropped before, repeated, or had an underflow: the file then holds what led
  /// there.
  std::string trigger = "";
  std::uint64_t megabytes = 64;  ///< of events that are kept: the first ones, with a trigger the newest
};

class PerfettoRun final : private MemObserver {
 public:
  /// To be constructed before the simulation starts. The file is opened, and the expression checked.
  /// @throws UserError
  PerfettoRun(const PerfettoRequest& request, board::Board& board);
  PerfettoRun(const PerfettoRun&) = delete;
  PerfettoRun& operator=(const PerfettoRun&) = delete;

  /// The window opens, or closes, now. Nothing is recorded behind it.
  void window_opened();
  void window_closed();
  /// Whether functions of the firmware are among the wanted tracks.
  bool wants_functions() const;
  /// Records them, too; before the simulation starts. @param name of the function at an address
  void watch_functions(cpu::ClockProfile& profile, PerfettoFunctions::Name name);
  /// A frame was shown.
  void frame(const video::Frame& shown);
  /// Writes the file. @throws UserError @return a sentence if events were dropped, or "" if the file holds
  /// all that was asked for
  std::string finish();

 private:
  void submitted(const MemRequest&, bool) override {}
  void responded(const MemRequest& r) override;
  void register_done(const MemRequest& r) override;

  void begin(Picoseconds at);
  void end();
  void begin_at(Picoseconds at);
  void end_at(Picoseconds at);
  void sample();
  void pins(std::uint32_t levels, Picoseconds at);
  void close_phase(Picoseconds at);
  void watch_interrupts();
  void watch_transfers();
  /// The line of an interrupt. An input of the interrupt controller has the name of what it is connected to when it
  /// rises, and a track from then on.
  struct Line {
    std::string name;               ///< of the line; empty: an input
    unsigned input = 0;
    std::optional<Picoseconds> since;
    std::string what = {};          ///< the name of the slice that began then
    PerfettoFile::Track track = PerfettoFile::kNone;
  };
  void line_slice(const Line& line, Picoseconds end);
  void line_changed(Line& line, bool level);
  void request(const MemRequest& r, const char* what);

  PerfettoRequest request_;
  board::Board& board_;
  std::unique_ptr<PerfettoFile> file_;
  bool on_ = false, over_ = false;
  Picoseconds from_ = 0, until_ = kNever;
  Subscription requests_, outputs_;
  std::array<std::unique_ptr<PerfettoLanes>, kMasterCount> masters_;
  PerfettoFile::Track phases_, capture_, remap_, display_;
  std::optional<std::pair<std::string, Picoseconds>> phase_;
  std::deque<Line> lines_;
  std::map<std::string, PerfettoFile::Track> line_tracks_;
  std::unique_ptr<PerfettoFunctions> functions_;
  Subscription watching_;
  struct Transfer {
    TransferRequest request;
    Picoseconds at;
  };
  std::array<std::deque<Transfer>, 4> transfers_;
  std::array<std::unique_ptr<PerfettoLanes>, 4> controllers_;
  // Counters, and the values that they were computed from.
  PerfettoFile::Track queue_, owed_, hits_;
  std::array<std::array<PerfettoFile::Track, 2>, kStatCount> bandwidth_{};
  std::array<std::array<std::uint64_t, 2>, kStatCount> bytes_{};
  Picoseconds sampled_ = 0;  // when
  std::uint64_t activates_ = 0, bursts_ = 0;
};

}  // namespace fovea::app
