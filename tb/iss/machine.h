// A core with 32 KB of internal RAM and flat memory, to run programs.
#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "model/cpu/core/core.h"
#include "tb/iss/assembler.h"
#include "tb/iss/flat_port.h"

namespace fovea::cpu::test {

inline constexpr std::uint32_t kMemory = 0x0010'0000;  ///< start of the flat memory
inline constexpr std::size_t kMemoryBytes = 16u << 20;
inline constexpr std::uint32_t kTables = kMemory + 0x00F0'0000;  ///< space for page tables

/// Assembly that enables MMU (tables at kTables), I-cache and D-cache; changes r0.
inline const char* const kCachesOn = R"(
  ldr r0, =0x01000000
  mcr p15, 0, r0, c2, c0, 0
  mvn r0, #0
  mcr p15, 0, r0, c3, c0, 0
  ldr r0, =0x0005107d
  mcr p15, 0, r0, c1, c0, 0
)";
static_assert(kTables == 0x0100'0000);

/// At 250 MHz, a core clock is 4 ns and an AHB clock (ratio 2) 8 ns.
/// @tparam Port FlatPort or a class derived from it
template <class Port>
class MachineWith {
 public:
  static constexpr Picoseconds kClock = 4'000;
  using Settings = std::vector<std::pair<std::string, std::string>>;
  struct Params : CpuParams {
    explicit Params(const Settings& settings) {
      ParamSet set;
      set.add(*this);
      for (const auto& [key, text] : settings) set.set(key, text);
    }
  } params;
  Port port{kMemory, kMemoryBytes};
  std::vector<std::uint8_t> tcm = std::vector<std::uint8_t>(32 * 1024);
  Diagnostics diagnostics;  ///< of the core
  Core core;
  std::vector<std::uint64_t> marks;  ///< clock of each `svc #1`
  std::string output;                ///< output of the program by Linux' write()
  int exit_status = -1;

  explicit MachineWith(const Settings& settings = {}) : params(settings), core(params, port, tcm, diagnostics) {
    port.attach(&core);
    core.set_clock(Frequency(250'000'000), 0);
    svc_handling = core.handle_swi([this](Core& c, std::uint32_t n) { return swi(c, n); });
    identity_map();
  }
  Subscription svc_handling;  ///< reset(): no SWI is handled, each goes to the guest
  std::function<void(std::uint32_t)> on_svc;  ///< called for `svc #3` to `svc #15`
  /// `svc #0` with r7: Linux write and exit; #1 records the clock; #2 ends the run; from 16 on a
  /// real exception.
  bool swi(Core& c, std::uint32_t number) {
    if (number == 1) {
      marks.push_back(c.clock_count());
      return true;
    }
    if (number == 2) {
      c.request_stop();
      return true;
    }
    if (number >= 3 && number < 16 && on_svc) {
      on_svc(number);
      return true;
    }
    if (number != 0) return false;
    if (c.reg(7) == 4) {
      for (std::uint32_t k = 0; k < c.reg(2); ++k)
        output += static_cast<char>(virtual_byte(c.reg(1) + k));
      c.set_reg(0, c.reg(2));
    } else {
      exit_status = static_cast<int>(c.reg(0));
      c.request_stop();
    }
    return true;
  }
  std::uint8_t virtual_byte(std::uint32_t a) {
    std::uint8_t b = 0;
    return core.peek(a, b) ? b : *port.at(a);
  }
  void load(const Program& p) {
    std::uint8_t* to = p.base < tcm.size() ? tcm.data() + p.base : port.at(p.base);
    std::memcpy(to, p.bytes.data(), p.bytes.size());
  }
  /// Sections with VA = PA in domain 0; the flat memory is write-back, everything else uncached.
  void identity_map() {
    for (std::uint32_t s = 0; s < 4096; ++s) {
      const bool cached = s >= kMemory >> 20 && s < (kMemory + kMemoryBytes) >> 20;
      port.set_word(kTables + 4 * s, s << 20 | 0xC00u | 0x12u | (cached ? 0xCu : 0u));
    }
  }
  void run(std::uint32_t entry = 0) {
    core.reset(entry, port.now);
    port.schedule(port.now + limit, [this, run = ++runs] {
      if (run == runs) throw std::runtime_error("the program does not end");
    });
    core.run();
    ++runs;
    // Every clock since the start has exactly one cause.
    const Counts& c = core.counts();
    const std::uint64_t sum =
        c.issue + c.idle + std::accumulate(c.stall.begin(), c.stall.end(), std::uint64_t{0});
    EXPECT_EQ(core.clock_count() - first_clock, sum);
    // Every stalled clock has a region and a culprit.
    EXPECT_EQ(c.unexplained(), Cause::kCount);
  }
  Picoseconds limit = 500 * kPsPerMs;  ///< simulated time that a program may take
  unsigned runs = 0;
  std::uint64_t first_clock = 1;  ///< the first edge after time 0
  /// Assembles at `base` and runs from there to `svc #2`.
  const Program& execute(const std::string& text, std::uint32_t base = 0) {
    program = assemble(text + "\n svc #2\n .ltorg\n", base);
    load(program);
    run(base);
    return program;
  }
  /// Clocks between mark n and mark n+1, minus the three of the mark itself.
  std::uint64_t between(unsigned n = 0) const { return marks.at(n + 1) - marks.at(n) - 3; }
  Picoseconds time() const { return core.clock_count() * kClock; }
  std::uint32_t tcm_word(std::uint32_t address) const {
    std::uint32_t v;
    std::memcpy(&v, tcm.data() + address, 4);
    return v;
  }
  /// Writes the first-level descriptor of the section that holds `va`, which maps it to `pa`.
  void section(std::uint32_t va, std::uint32_t pa, unsigned c, unsigned b, unsigned ap = 3,
               unsigned domain = 0) {
    port.set_word(kTables + 4 * (va >> 20),
                  (pa & 0xFFF00000u) | ap << 10 | domain << 5 | 0x12u | c << 3 | b << 2);
  }
  std::uint64_t stall(Cause c) const { return core.counts().stall[static_cast<std::size_t>(c)]; }
  Program program;
};
using Machine = MachineWith<FlatPort>;

}  // namespace fovea::cpu::test
