// Where the core's clocks went: by instruction, cause, region and culprit (decision 0021).
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "model/common/observers.h"
#include "model/common/units.h"
#include "model/cpu/core/call_stacks.h"
#include "model/cpu/core/decoded_line.h"
#include "model/cpu/core/mask_watch.h"
#include "model/cpu/core/stats.h"

namespace fovea::cpu {

struct BusAccess;

/// The clocks of one instruction that have one cause, region and culprit.
struct ProfileRow {
  std::uint32_t address = 0;
  /// kIssue, kIdle or kWait + index of a WakeEvent, or kStall + index of a Cause. kWait: a sleep while
  /// the program waits for work that it has given away (mark_given_away()).
  std::uint8_t cause = 0;
  std::uint8_t region = 0, culprit = 0;  ///< of a stall; otherwise 0
  std::uint64_t clocks = 0;
  std::uint64_t instructions = 0;  ///< only with kIssue

  static constexpr std::uint8_t kIssue = 0, kIdle = 1, kWait = kIdle + kWakeEvents,
                                kStall = kWait + kWakeEvents;
  bool stalled() const { return cause >= kStall; }
  Cause stall_cause() const { return static_cast<Cause>(cause - kStall); }
};

/// Attributes every clock of the core to an instruction. In a chain of records, the handlers count in
/// the tallies of the line only where the flow leaves its straight course; collect() works out from
/// them how often each record was executed, and multiplies by its clocks. Everything else is noted
/// when it happens. Clocks are divided among *sections* of the run, of which one is current.
class ClockProfile {
 public:
  /// @param pc the register; while the core is stalled, the instruction that it stalls for
  ClockProfile(const std::uint32_t& pc, const Counts& counts) : pc_(pc), counts_(counts) {
    enter(0);
  }
  ClockProfile(const ClockProfile&) = delete;
  ClockProfile& operator=(const ClockProfile&) = delete;

  // From the ledger, for the instruction at the pc.
  void stalled(Cause cause, std::size_t region, std::size_t culprit, std::uint64_t clocks);
  void stalled(Cause cause, std::size_t region, const BusAccess& access, std::uint64_t clocks,
               std::uint64_t span, std::uint64_t own);
  void slept(WakeEvent by, std::uint64_t clocks);

  /// The clocks that are issued and the instructions that complete until end() belong to one
  /// instruction. Without effect if that is so already.
  void begin() {
    if (open_) return;
    open_ = true;
    issue_seen_ = counts_.issue;
    instructions_seen_ = counts_.instructions;
  }
  void end(std::uint32_t pc) {
    if (!open_) return;
    open_ = false;
    issued(pc, counts_.issue - issue_seen_, counts_.instructions - instructions_seen_);
  }
  bool open() const { return open_; }
  /// Takes the tallies of a line into the current section and clears them. No chain may be running.
  void collect(DecodedLine& line);

  /// The clocks from here on belong to a section. The caller has collected all lines.
  void enter(std::size_t section);
  std::size_t section() const { return section_; }
  /// The sections whose calls are counted; before the first instruction.
  void count_stacks_of(std::vector<std::size_t> sections) {
    stacked_ = std::move(sections);
    stacks.count(0, counts_stacks());
    mask.count(counts_stacks(), 0, 0);
  }
  bool counts_stacks() const { return std::find(stacked_.begin(), stacked_.end(), section_) != stacked_.end(); }
  CallStacks stacks;
  MaskWatch mask;  ///< in the same sections

  /// The core's counters at some instants of the run.
  struct Snapshot {
    Picoseconds at = 0;
    std::uint64_t issue = 0, idle = 0;
    std::array<std::uint64_t, kCauses> stall{};
  };
  /// Keeps the counters at the first instruction boundary after t.
  void snapshot(Picoseconds t) { marks_.push_back({t, kSnapshot}); }
  const std::vector<Snapshot>& snapshots() const { return snapshots_; }
  /// Called when an IRQ or FIQ is taken: its vector's instruction begins at the clock.
  using InterruptObserver = std::function<void(bool fiq, std::uint64_t cycle)>;
  Subscription observe_interrupts(InterruptObserver observer) { return interrupts_.add(std::move(observer)); }
  void interrupted(bool fiq, std::uint64_t cycle) {
    interrupts_.each([=](const InterruptObserver& f) { f(fiq, cycle); });
  }
  /// From time t on, sleeps are waits for work that the program has given away, or no longer.
  void mark_given_away(Picoseconds t, bool begins) {
    marks_.push_back({t, begins ? kGivenAway : kTakenBack});
  }
  /// The last sleep of a run, which nothing ends. `edge`: the clock that a time falls on.
  template <class F>
  void sleep_out(std::uint64_t from, std::uint64_t to, F edge) {
    for (const Mark& m : marks_) {
      if (m.section != kGivenAway && m.section != kTakenBack) continue;
      const std::uint64_t split = std::max(from, edge(m.at));
      if (split >= to) break;
      slept(WakeEvent::kOther, split - from);
      given_away_ = m.section == kGivenAway;
      from = split;
    }
    slept(WakeEvent::kOther, to - from);
  }
  /// A change of section at time t, which takes effect as a mark of the measurement window does.
  void mark(Picoseconds t, std::size_t section) { marks_.push_back({t, section}); }
  bool pending() const { return !marks_.empty(); }
  Picoseconds next_mark() const { return marks_.front().at; }
  bool due(Picoseconds boundary) const { return !marks_.empty() && boundary > marks_.front().at; }
  /// @return the section that begins; nothing if none does
  std::optional<std::size_t> take_mark() {
    const Mark m = marks_.front();
    marks_.pop_front();
    if (m.section == kGivenAway || m.section == kTakenBack) {
      given_away_ = m.section == kGivenAway;
      return std::nullopt;
    }
    if (m.section != kSnapshot) return m.section;
    snapshots_.push_back({m.at, counts_.issue, counts_.idle, counts_.stall});
    return std::nullopt;
  }

  /// The rows of a section with clocks, by address, cause, region and culprit; sections without
  /// clocks have none. The stalls of one instruction, cause and region add up exactly; their shares
  /// by culprit are rounded so that they do.
  std::vector<ProfileRow> rows(std::size_t section) const;
  /// Sum of all clocks of a section.
  std::uint64_t clocks(std::size_t section) const;

 private:
  struct Cell {
    std::uint64_t issue = 0, instructions = 0, interlock = 0;
    std::array<std::uint64_t, kWakeEvents> idle{}, wait{};
  };
  using Shares = StallTable::Shares;
  struct Section {
    std::unordered_map<std::uint32_t, Cell> cells;   // by address
    std::unordered_map<std::uint64_t, Shares> stalls;  // by stall_key()
  };
  struct Mark {
    Picoseconds at;
    std::size_t section;
  };
  static constexpr std::size_t kSnapshot = ~std::size_t{0}, kGivenAway = kSnapshot - 1, kTakenBack = kSnapshot - 2;
  static constexpr std::uint64_t stall_key(std::uint32_t pc, Cause cause, std::size_t region) {
    return std::uint64_t{pc} << 16 | index(cause) << 8 | region;
  }
  Cell& cell(std::uint32_t pc);
  Shares& shares(Cause cause, std::size_t region);
  void issued(std::uint32_t pc, std::uint64_t clocks, std::uint64_t instructions);

  const std::uint32_t& pc_;
  const Counts& counts_;
  bool open_ = false, given_away_ = false;
  std::uint64_t issue_seen_ = 0, instructions_seen_ = 0;
  std::size_t section_ = 0;
  std::vector<std::size_t> stacked_ = {0};
  std::vector<Section> sections_;
  std::deque<Mark> marks_;
  std::vector<Snapshot> snapshots_;
  Observers<InterruptObserver> interrupts_;
  // What was found last in the current section, by address. The maps never move their elements.
  static constexpr std::size_t kFound = 1024;
  struct FoundCell {
    std::uint32_t pc = 0;
    Cell* cell = nullptr;
  };
  struct FoundShares {
    std::uint64_t key = 0;
    Shares* shares = nullptr;
  };
  std::array<FoundCell, kFound> found_cells_;
  std::array<FoundShares, kFound> found_shares_;
};

/// Issue clocks of a prepared record that has a fast handler and whose condition is met. A branch
/// counts as taken. Sources: as the handlers.
unsigned issue_clocks(const Instruction& record);

}  // namespace fovea::cpu
