// Finds places where the core and a DMA master do not see the same memory.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <set>
#include <tuple>
#include <vector>

#include "model/common/arrival_observer.h"
#include "model/common/observers.h"
#include "model/cpu/check/hazard.h"
#include "model/cpu/check/stale_code.h"
#include "model/cpu/core/core.h"

namespace fovea::cpu {

/// Knows only what core and memory announce. The memory's order is that of arrivals at the controller; the times of a
/// master's accesses and of line fills are those of their arrival. A fill may pass another master's write that waits in
/// the controller: after follow_moves() that is seen, and the line is stale from its fill on. Loads are judged by
/// bytes, dirty halves as a whole, as the hardware writes them back.
class HazardChecker final : public ArrivalObserver, public LineWatch {
 public:
  /// @param core outlives the checker, which observes its lines from now on
  explicit HazardChecker(Core& core);
  ~HazardChecker() override;
  HazardChecker(const HazardChecker&) = delete;
  HazardChecker& operator=(const HazardChecker&) = delete;

  /// Called by settle() for the first hazard of each place: one kind, program address and master.
  std::function<void(const Hazard&)> on_place;
  /// Counts the hazards up to `t`, in the order of their times. The core and the memory may have worked
  /// ahead of the kernel; what they found beyond `t` waits for a later call.
  void settle(Picoseconds t);
  /// Hazards up to the last settle(), places repeated.
  std::uint64_t count(HazardKind k) const { return counts_[static_cast<std::size_t>(k)]; }
  std::uint64_t total() const;
  std::size_t places() const { return places_.size(); }

  void arrived(const MemRequest& r, Picoseconds at) override;
  /// From now on moved() is called for each request that arrives: its data have been read or written in memory.
  void follow_moves() { follows_ = true; }
  void moved(Master master, bool write, std::uint32_t address, unsigned bytes);
  void filled(unsigned line) override;
  void loaded(unsigned line, unsigned offset, unsigned bytes) override;
  void stored(unsigned line, unsigned offset, unsigned bytes) override;
  void written_back(unsigned line, unsigned halves) override;

 private:
  static constexpr std::uint32_t kNone = 1;  // no line has this address
  static constexpr std::size_t kBuckets = 4096;
  static constexpr unsigned kLineBytes = Cache::kLineBytes, kHalfBytes = kLineBytes / 2;

  /// Bytes of a line (one bit each) that a master wrote after the line's fill, and its last such write.
  struct Foreign {
    std::uint32_t bytes = 0;
    Master master = Master::kCount;
    Picoseconds at = 0;
  };
  struct Store {
    std::uint32_t pc = 0;
    Picoseconds at = 0;
  };
  struct Held {
    std::uint32_t pa = kNone;
    Picoseconds filled = 0;  // when its request arrived at the controller
    Picoseconds there = 0;   // when the core went on with it
    Foreign foreign;
    std::array<Store, 2> stores{};  // the first one into each half since it was clean
    std::array<Store, kLineBytes / 4> through{};  // the last one into each word, if memory is written too
  };

  /// Bits of the bytes [offset, offset + n) of a line.
  static std::uint32_t bits(unsigned offset, unsigned n) {
    return static_cast<std::uint32_t>(((std::uint64_t{1} << n) - 1) << offset);
  }
  /// Address of the lowest of a line's bytes that are set.
  static std::uint32_t first_of(std::uint32_t line_pa, std::uint32_t bytes) {
    return line_pa + static_cast<std::uint32_t>(std::countr_zero(bytes));
  }
  static std::size_t bucket(std::uint32_t line_pa) { return line_pa / kLineBytes % kBuckets; }
  template <class F>
  void each_holder(std::uint32_t line_pa, F f);
  /// A master's write that has arrived and whose data have not moved yet.
  struct Waiting {
    Master master;
    std::uint32_t address;
    unsigned bytes;
    Picoseconds at;
  };
  void passed(Master by, const Waiting& w, std::uint32_t line_pa);
  void in_buffer(HazardKind kind, const MemRequest& r, std::uint32_t line_pa, std::uint32_t bytes, Picoseconds at);
  Store waiting_store(std::uint32_t line_pa, std::uint32_t bytes);
  void read_by(const MemRequest& r, std::uint32_t line_pa, std::uint32_t bytes, Picoseconds at);
  void written_by(const MemRequest& r, std::uint32_t line_pa, std::uint32_t bytes, Picoseconds at);
  void forget_foreign(unsigned line, std::uint32_t bytes);
  void report(const Hazard& h) { found_.push_back(h); }

  Core& core_;
  Subscription observing_;
  StaleCode code_;
  const Cache& lines_;
  const DataBus& bus_;
  std::vector<Held> held_;                             // by line
  Held victim_;                                        // the line that was moved to the victim buffer last
  std::array<std::uint16_t, kBuckets> holders_{};      // lines in held_, by bucket
  std::uint32_t filling_ = kNone;                      // line that was requested and has not come yet
  Picoseconds requested_ = 0;
  Foreign meanwhile_;                                  // written since that request arrived
  std::vector<Waiting> waiting_;                       // oldest first, after follow_moves()
  bool follows_ = false;
  std::vector<Hazard> found_;                          // since the last settle(), or beyond it
  std::array<std::uint64_t, kHazardKinds> counts_{};
  std::set<std::tuple<HazardKind, std::uint32_t, Master>> places_;
};

}  // namespace fovea::cpu
