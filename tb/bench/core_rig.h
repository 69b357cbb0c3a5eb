// A core over flat memory of fixed latency that runs a program file: nothing else is measured.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "model/common/clock.h"
#include "model/cpu/core/core.h"

namespace fovea::cpu {

/// Every outcome is certain at once; nobody else acts.
class QuietPort final : public BusPort {
 public:
  static constexpr Picoseconds kRead = 80'000, kWrite = 40'000, kBeat = 8'000;
  explicit QuietPort(std::size_t bytes) : memory(bytes) {}
  void submit(BusAccess& a, Picoseconds at) override;
  bool poll(BusAccess& a, Picoseconds until) override { return a.last <= until; }
  void finish(BusAccess&) override {}
  Picoseconds horizon() override { return limit; }
  /// The program ran for as long as it was allowed to.
  void sleep_until(Picoseconds) override { core->request_stop(); }
  Picoseconds wait_for_interrupt(Picoseconds) override;

  std::vector<std::uint8_t> memory;  ///< from address 0
  Picoseconds limit = kNever;
  Core* core = nullptr;
};

/// Runs an ELF file from its entry to `svc #0x123456`, or for so many core clocks.
class CoreRig {
 public:
  static constexpr Picoseconds kClock = 4'000;
  explicit CoreRig(const std::string& elf, std::uint64_t clocks = 0);
  void run() { core.run(); }

  CpuParams params;
  QuietPort port{32u << 20};
  std::vector<std::uint8_t> tcm = std::vector<std::uint8_t>(32 * 1024);
  Core core;
};

}  // namespace fovea::cpu
