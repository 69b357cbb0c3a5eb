// A core on flat memory of fixed latency that runs a program file, to measure only the core.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "model/common/clock.h"
#include "model/cpu/core/core.h"

namespace fovea::cpu {

/// Decides every outcome at once; there are no other agents.
class QuietPort final : public BusPort {
 public:
  static constexpr Picoseconds kRead = 80'000, kWrite = 40'000, kBeat = 8'000;
  explicit QuietPort(std::size_t bytes) : memory(bytes) {}
  void submit(BusAccess& a, Picoseconds at) override;
  bool poll(BusAccess& a, Picoseconds until) override { return a.last <= until; }
  void finish(BusAccess&) override {}
  Picoseconds horizon() override { return limit; }
  /// The limit of simulated time was reached.
  void sleep_until(Picoseconds) override { core->request_stop(); }
  Picoseconds wait_for_interrupt(Picoseconds) override;

  std::vector<std::uint8_t> memory;  ///< starts at address 0
  Picoseconds limit = kNever;
  Core* core = nullptr;
};

/// Runs an ELF file from its entry up to `svc #0x123456`, or for a number of core clocks.
class CoreRig {
 public:
  static constexpr Picoseconds kClock = 4'000;
  explicit CoreRig(const std::string& elf, std::uint64_t clocks = 0);
  void run() { core.run(); }

  CpuParams params;
  QuietPort port{32u << 20};
  std::vector<std::uint8_t> tcm = std::vector<std::uint8_t>(32 * 1024);
  Core core;

 private:
  Subscription exit_;
};

}  // namespace fovea::cpu
