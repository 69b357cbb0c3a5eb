// In a replay: the slaves beside the SDRAM, registers and internal RAM, as far as their times go.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "model/common/clock.h"
#include "model/common/masters.h"
#include "model/common/mem_request.h"
#include "model/trace/core/trace.h"

namespace fovea::app {

/// When each of their requests ends, and which of them ends next. The internal RAM takes one burst at a time, registers
/// one word of a master at a time; both in the order of the calls, which is that of the arrivals.
class ReplaySlaves {
 public:
  struct Due {
    MemRequest* request;
    Picoseconds at;
    bool arrives = false;  ///< it is no end: the request comes to its slave then
  };

  explicit ReplaySlaves(const trace::EdmaInfo& edma) : edma_(edma) {}

  /// A transfer of a master will move these bytes of internal RAM, in bursts that wait there for the core: clocks of
  /// the core for each, as recorded.
  void expect(Master master, std::uint32_t bytes, std::vector<std::uint16_t> waits) {
    ram_bursts_[index(master)].push_back({bytes, std::move(waits)});
  }
  /// A burst to internal RAM arrives. @param core the core's clock @return when it is over
  Picoseconds serve_ram(const MemRequest& burst, const Clock& core, Picoseconds arrival);
  /// A request to registers arrives. @param word what each word takes @return when it is over
  Picoseconds serve_registers(const MemRequest& request, Picoseconds word, Picoseconds arrival);
  /// The same by what a burst of a transfer takes.
  Picoseconds serve_registers(const MemRequest& request, Picoseconds arrival) {
    return serve_registers(request, edma_.register_latency, arrival);
  }

  void add(const Due& due);
  /// Of the first of those added, which stay in the order of the calls at equal times; kNever: none.
  Picoseconds next() const { return next_; }
  Due take();

  /// Clocks of the core for which bursts have waited in internal RAM, as recorded.
  std::uint64_t waited_in_ram() const { return waited_in_ram_; }

 private:
  /// Of a transfer: what it has still to move, and the clocks that its bursts wait for.
  struct RamBursts {
    std::uint32_t left = 0;
    std::vector<std::uint16_t> waits;
    std::size_t next = 0;
  };
  std::uint32_t next_wait(const MemRequest& burst);

  const trace::EdmaInfo& edma_;
  std::deque<Due> due_;  // by time
  Picoseconds next_ = kNever;
  Picoseconds ram_free_ = 0;
  std::uint64_t waited_in_ram_ = 0;
  std::array<std::deque<RamBursts>, kMasterCount> ram_bursts_;  // by master, of its transfers in order
  std::array<Picoseconds, kMasterCount> registers_free_{};
};

}  // namespace fovea::app
