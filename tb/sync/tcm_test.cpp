// The core and a DMA share internal RAM: strict and default synchronisation give the same record,
// and a planted late horizon is found.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "model/common/burst_master.h"
#include "model/cpu/arm926.h"
#include "model/cpu/tcm_dma.h"
#include "tb/iss/assembler.h"
#include "tb/sync/in_child.h"
#include "tb/sync/memory_system.h"

namespace fovea::sync {
namespace {

constexpr std::uint32_t kRam = 0x1'0000, kSdram = 0x8000'0000, kTables = 0x0010'0000;
// Offsets in internal RAM: the program, a piece of code that the DMA rewrites, data.
constexpr std::uint32_t kCode = 0x800, kData = 0x1000;

std::uint64_t hash(const std::uint8_t* p, std::size_t n) {
  std::uint64_t h = 0xcbf29ce484222325ull;
  for (std::size_t i = 0; i < n; ++i) h = (h ^ p[i]) * 0x100000001b3ull;
  return h;
}

/// Loads and stores at random places of both banks, one word and several; calls of code that changes;
/// now and then it empties the TLB, so that a walk comes before the next access, or reads SDRAM.
const char* const kProgram = R"(
  ldr r0, =0x80100000
  mcr p15, 0, r0, c2, c0, 0
  mvn r0, #0
  mcr p15, 0, r0, c3, c0, 0
  ldr r0, =0x0005107d
  mcr p15, 0, r0, c1, c0, 0
  ldr r10, =SEED
  ldr r11, =1664525
  ldr r12, =1013904223
  ldr r13, =OPERATIONS
  mov r8, #0
1: mla r10, r11, r10, r12
  mov r0, r10, lsr #17      @ 15 bits
  bic r0, r0, #3
  cmp r0, #0x1000
  addlo r0, r0, #0x2000
  cmp r0, #0x7f00
  subhs r0, r0, #0x2000
  add r1, r0, #0x10000
  tst r10, #0x1000
  ldrne r2, [r1]
  strne r8, [r0]
  ldmeqia r1, {r2-r5}
  stmeqia r0, {r3-r6}
  add r8, r2, r8, ror #7
  tst r10, #0x6000
  bleq code
  ands r3, r10, #0xE000
  mcreq p15, 0, r3, c8, c7, 0
  cmp r3, #0x2000
  ldreq r4, [r9, r0]
  addeq r8, r8, r4
  subs r13, r13, #1
  bne 1b
  svc #2
  .ltorg
  .org 0x800
code:
  .rept 16
  add r8, r8, #0
  .endr
  bx lr
)";

constexpr Picoseconds kEnd = 50 * kPsPerMs, kLastBurst = kEnd - kPsPerMs;

/// Bursts on one port, one after the other, at random places, with pauses; those that hit `code`
/// write instructions. As a transfer controller does, one that is told ahead issues the next burst ahead, too.
class Traffic : public sc_core::sc_module {
 public:
  BurstMaster master;
  std::string record;
  Traffic(sc_core::sc_module_name name, Master id, std::uint64_t seed, bool ahead)
      : sc_module(name),
        master("master", id, 1, ahead ? BurstMaster::Report::kWhenDecided : BurstMaster::Report::kAtLastBeat),
        name_(kMasterNames[index(id)]),
        state_(seed) {
    SC_HAS_PROCESS(Traffic);
    SC_METHOD(issue_now);
    sensitive << due_.event();
    dont_initialize();
    due_.at(kPsPerUs + index(id));
    master.on_done = [this, ahead](const BurstMaster::Completion& c) {
      if (c.last > kLastBurst) return;
      char line[160];
      std::snprintf(line, sizeof line, "%llu %s %s %08x %llu %016llx\n",
                    static_cast<unsigned long long>(c.last), std::string(name_).c_str(),
                    c.write ? "w" : "r", c.address, static_cast<unsigned long long>(c.issued),
                    static_cast<unsigned long long>(hash(c.data.data(), c.data.size())));
      record += line;
      const Picoseconds next = c.last + 1 + random(4) * random(300) * kPsPerNs;
      if (ahead)
        issue(next);
      else
        due_.at(next);
    };
  }

 private:
  std::uint64_t random(std::uint64_t n) {
    state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
    return (state_ >> 33) % n;
  }
  void issue_now() { issue(kernel_time()); }
  void read(std::uint32_t address, unsigned bytes, Picoseconds at) { master.read(address, bytes, 0, at, false); }
  void issue(Picoseconds at) {
    const unsigned bytes = 4u << random(5);
    const std::uint64_t what = random(8);
    if (what == 0)
      return read(kSdram + 0x20'0000 + static_cast<std::uint32_t>(random(64) * 64), 64, at);
    std::array<std::uint8_t, 64> data;
    if (what == 1) {
      for (unsigned k = 0; k < 16; ++k) {
        const auto word = 0xE288'8000u | static_cast<std::uint32_t>(random(256));  // add r8, r8, #k
        std::memcpy(data.data() + 4 * k, &word, 4);
      }
      return master.write(kRam + kCode, data, 0, at, false);
    }
    const auto place = static_cast<std::uint32_t>(kRam + kData + random((0x8000 - kData) / bytes) * bytes);
    for (auto& b : data) b = static_cast<std::uint8_t>(random(256));
    if (what < 5) return master.write(place, std::span(data).first(bytes), 0, at, false);
    read(place, bytes, at);
  }
  std::string_view name_;
  std::uint64_t state_;
  Timer due_;
};

struct Case {
  std::uint64_t seed = 1;
  bool strict = false, dma_first = false, ahead = false;
  Picoseconds late = 0;
};

std::string run(const Case& s) {
  cpu::CpuParams cpu_params;
  cpu_params.tcm_first.set(s.dma_first ? "dma" : "core");
  std::vector<std::uint8_t> ram(0x8000);
  bus::AddressMap map;
  map.ram_size = 0x8000;
  MemorySystem system(map, s.strict, Frequency(243'000'000), Frequency(121'500'000));
  bus::Scr& scr = system.scr;
  mem::DdrModule& ddr = system.ddr;
  cpu::Arm926 arm("arm", cpu_params, ram, 0);
  cpu::TcmDma dma("dma", arm.core(), system.end_of_instant);
  Traffic first("first", Master::kEdmaTc0Write, s.seed * 2 + 1, s.ahead),
      second("second", Master::kEdmaTc1Read, s.seed * 2 + 2, s.ahead);
  ClockSignal arm_clk{"arm_clk", Frequency(297'000'000)};
  sc_core::sc_signal<bool> irq{"irq"}, fiq{"fiq"};
  arm.clk(arm_clk);
  dma.clk(arm_clk);
  arm.irq(irq);
  arm.fiq(fiq);
  arm.path(scr.path);
  arm.sockets[cpu::Arm926::kInstructionPort]->bind(*scr.target[index(Master::kArmI)]);
  arm.sockets[cpu::Arm926::kDataPort]->bind(*scr.target[index(Master::kArmD)]);
  first.master.socket.bind(*scr.target[index(Master::kEdmaTc0Write)]);
  second.master.socket.bind(*scr.target[index(Master::kEdmaTc1Read)]);
  scr.ram_socket.bind(dma.socket);
  dma.path(scr.path);

  std::string text = kProgram;
  const auto fill_in = [&text](const std::string& word, std::uint64_t value) {
    text.replace(text.find(word), word.size(), std::to_string(value));
  };
  fill_in("SEED", s.seed * 2654435761u % 0xFFFF'FFFFu);
  fill_in("OPERATIONS", 4000);
  const auto program = cpu::test::assemble(text, 0);
  std::memcpy(ram.data(), program.bytes.data(), program.bytes.size());
  for (std::uint32_t section = 0; section < 4096; ++section) {  // SDRAM cached, all else flat
    const std::uint32_t d = section << 20 | 0xC12u | (section >= 0x800 ? 0xCu : 0u);
    std::memcpy(ddr.store().at(kTables + 4 * section), &d, 4);
  }
  // Internal RAM in small pages: a TLB entry for the code, others for the data.
  const std::uint32_t coarse = (kSdram + kTables + 0x4000) | 0x11u;
  std::memcpy(ddr.store().at(kTables), &coarse, 4);
  for (std::uint32_t page = 0; page < 256; ++page) {
    const std::uint32_t d = page << 12 | 0xFF2u;
    std::memcpy(ddr.store().at(kTables + 0x4000 + 4 * page), &d, 4);
  }
  arm.core().set_reg(9, kSdram + 0x20'0000);
  bool ended = false;
  const Subscription exit = arm.core().handle_swi([&ended](cpu::Core& c, std::uint32_t number) {
    ended = number == 2;
    c.request_stop();
    return true;
  });
  sc_core::sc_start(ps_time(kEnd));

  std::string out = first.record + second.record;
  const auto add = [&out](const char* what, std::uint64_t value) {
    out += std::string(what) + " " + std::to_string(value) + "\n";
  };
  if (!ended) out += "did not end: " + arm.failure() + "\n";
  const cpu::Counts& c = arm.core().counts();
  add("r8", arm.core().reg(8));
  add("ram", hash(ram.data(), ram.size()));
  add("clocks", arm.core().clock_count());
  add("instructions", c.instructions);
  for (const cpu::CauseInfo& info : cpu::kCauseTable) add(info.name, c.stall[index(info.cause)]);
  for (std::size_t k = 0; k < cpu::kStallCulprits; ++k)
    add(std::string(cpu::stall_culprit_name(k)).c_str(), c.stalls.by(cpu::Cause::kTcm, k));
  for (const StatBase* stat : dma.stats.stats())
    add(stat->name().c_str(), std::get<std::uint64_t>(stat->value()));
  return out;
}

std::string in_child(const Case& s) {
  return sync::in_child(s.late, [&s] { return run(s); });
}

std::uint64_t value(const std::string& record, const std::string& name) {
  const std::size_t at = record.find("\n" + name + " ");
  return at == std::string::npos ? 0 : std::stoull(record.substr(at + name.size() + 2));
}

constexpr std::uint64_t kSeeds = 12;

TEST(SharedRamTest, StrictAndDefaultAreIdentical) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Case s{seed, true, seed % 2 == 0, seed % 4 < 2, 0};
    const std::string strict = in_child(s);
    s.strict = false;
    const std::string fast = in_child(s);
    ASSERT_GT(strict.size(), 1000u);
    ASSERT_EQ(strict.find("did not end"), std::string::npos) << strict.substr(strict.size() - 900);
    ASSERT_TRUE(strict == fast) << "seed " << seed << "\n" << first_difference(strict, fast);
    // Something was compared: bursts both ways, waits on both sides.
    EXPECT_GT(value(strict, "cpu.tcm.dma_reads"), 100u);
    EXPECT_GT(value(strict, "cpu.tcm.dma_writes"), 100u);
    EXPECT_GT(value(strict, "edma_tc0_write"), 20u);
    EXPECT_GT(value(strict, "edma_tc1_read"), 20u);
    if (!s.dma_first) {
      EXPECT_GT(value(strict, "cpu.tcm.dma_wait.arm_i"), 20u);
      EXPECT_GT(value(strict, "cpu.tcm.dma_wait.arm_d"), 20u);
    }
    EXPECT_GT(value(strict, "tlb"), 1000u);
  }
}

TEST(SharedRamTest, ALateHorizonIsFound) {
  Case s{1, true, false, false, 0};
  const std::string strict = in_child(s);
  s.strict = false;
  s.late = 200 * kPsPerNs;
  const std::string late = in_child(s);
  ASSERT_GT(late.size(), 1000u) << "the late run must run";
  EXPECT_FALSE(strict == late) << "the comparison cannot fail";
}

}  // namespace
}  // namespace fovea::sync

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
