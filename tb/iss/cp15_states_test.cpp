// Every register of CP15, written in the states in which some of what they hold is locked or in use: caches and MMU off
// and on, a locked way in each cache, a locked TLB entry, a process number. What each register keeps is data, from ARM
// DDI 0198D chapter 2.
#include <gtest/gtest.h>

#include <array>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tb/iss/machine.h"

namespace fovea::cpu::test {
namespace {

struct Cp15Register {
  const char* name;
  const char* operands;  ///< behind the ARM register: CRn, CRm, opcode 2
  std::uint32_t keeps;   ///< bits that read back what is written
  std::uint32_t open;    ///< bits whose value is unpredictable after a write
  std::uint32_t reads;   ///< what the other bits read, whatever is written
  const char* source;    ///< section of ARM DDI 0198D
};

constexpr std::uint32_t kInUse = 0x3085;  // M, C, B, I and V would change what the test itself runs on

/// c7, c8: operations, which keep nothing. c9,c1: the regions of internal RAM have tests of their own (iss.system).
const std::array<Cp15Register, 13> kRegisters{{
    {"control", "c1, c0, 0", 0x0000'C302, 0, 0x0005'0078, "2.3.4: bits 18 and 16 and 6:3 read as one, 31:19 as zero"},
    {"ttbr", "c2, c0, 0", 0xFFFF'C000, 0x3FFF, 0, "2.3.5: 31:14, the others should be zero"},
    {"dacr", "c3, c0, 0", ~0u, 0, 0, "2.3.6: sixteen domains of two bits"},
    {"dfsr", "c5, c0, 0", 0xFF, 0xFFFF'FE00, 0, "2.3.7: domain and status, bit 8 reads as zero"},
    {"ifsr", "c5, c0, 1", 0xFF, 0xFFFF'FE00, 0, "2.3.7: domain and status, bit 8 reads as zero"},
    {"far", "c6, c0, 0", ~0u, 0, 0, "2.3.8"},
    {"dlock", "c9, c0, 0", 0xF, 0xFFFF'FFF0, 0, "2.3.11: a bit for each way"},
    {"ilock", "c9, c0, 1", 0xF, 0xFFFF'FFF0, 0, "2.3.11: a bit for each way"},
    {"tlb_lock", "c10, c0, 0", 0x1C00'0001, 0xE3FF'FFFE, 0, "2.3.13: victim and P"},
    {"fcse", "c13, c0, 0", 0xFE00'0000, 0x01FF'FFFF, 0, "2.3.14: 31:25"},
    {"context", "c13, c0, 1", ~0u, 0, 0, "2.3.14"},
    {"id", "c0, c0, 0", 0, 0, 0x4106'9265, "2.3.1: a write is unpredictable"},
    {"cache_type", "c0, c0, 1", 0, 0, 0, "2.3.2: a write is unpredictable"},
}};

struct Cp15State {
  const char* name;
  std::string enter;
  /// Bits that may not be written, as the code of the test would not go on, by the register's name.
  std::vector<std::pair<std::string, std::uint32_t>> left_out;
};

/// Code lies at 0, in internal RAM, mapped one to one; DACR stays all manager where the MMU is on.
std::vector<Cp15State> cp15_states() {
  // What the program uses is in the TLB before it is locked: an entry that is locked moves the victim on.
  const auto lock = [](const char* operands, const char* value) {
    return std::string(kCachesOn) + " ldr r0, =0x00900000\n ldr r0, [r0]\n ldr r0, =0x00880000\n ldr r0, [r0]\n" +
           " ldr r0, =" + value + "\n mcr p15, 0, r0, " + operands + "\n";
  };
  const std::vector<std::pair<std::string, std::uint32_t>> translated{{"ttbr", ~0u}, {"dacr", ~0u}, {"fcse", ~0u}};
  return {{"MMU and caches off", "", {}},
          {"MMU and caches on", kCachesOn, translated},
          {"three ways of the D-cache locked", lock("c9, c0, 0", "7"), translated},
          {"three ways of the I-cache locked", lock("c9, c0, 1", "7"), translated},
          {"the next TLB entry is locked", lock("c10, c0, 0", "0x04000001"), translated},
          {"a process number, MMU off", " ldr r0, =0x02000000\n mcr p15, 0, r0, c13, c0, 0\n", {}}};
}

constexpr unsigned kRounds = 8;
constexpr std::size_t kCount = kRegisters.size(), kWritten = kCount - 2;  // the last two are only read

/// One program for each state: in each round it writes each register once, with a word from memory in which the bits
/// that are left out keep their value, and stores all registers before and after.
/// r10: where results go; r9: words to write and the bits that are left out; r11: rounds.
std::string program(const std::string& enter) {
  std::string read_all;
  for (const Cp15Register& r : kRegisters)
    read_all += std::string(" mrc p15, 0, r1, ") + r.operands + "\n str r1, [r10], #4\n";
  std::string text = enter + " ldr r10, =0x00900000\n ldr r9, =0x00880000\n mov r11, #" + std::to_string(kRounds) +
                     "\n b round\n .ltorg\nround:\n";
  for (const Cp15Register& r : std::span(kRegisters).first(kWritten))
    text += read_all + " ldr r6, [r9], #4\n ldr r5, [r9], #4\n mrc p15, 0, r7, " + r.operands +
            "\n and r7, r7, r5\n orr r6, r6, r7\n mcr p15, 0, r6, " + r.operands + "\n" + read_all;
  return text +
         " subs r11, r11, #1\n bne round\n"
         "1: mrc p15, 0, r15, c7, c14, 3\n bne 1b\n mov r0, #0\n mcr p15, 0, r0, c7, c10, 4\n";
}

TEST(Cp15StatesTest, EachRegisterKeepsWhatItMayAndTheOthersStay) {
  constexpr std::uint32_t kWords = 0x0088'0000, kResults = 0x0090'0000;
  std::mt19937 random{1};
  unsigned writes = 0;
  for (const Cp15State& s : cp15_states()) {
    const auto spared = [&](const Cp15Register& r) {
      std::uint32_t bits = r.name == std::string("control") ? kInUse : 0;
      for (const auto& [name, more] : s.left_out)
        if (name == r.name) bits |= more;
      return bits;
    };
    Machine m;
    for (unsigned n = 0; n < kRounds * kWritten; ++n) {
      const std::uint32_t word = static_cast<std::uint32_t>(random());
      m.port.set_word(kWords + 8 * n, word & ~spared(kRegisters[n % kWritten]));
      m.port.set_word(kWords + 8 * n + 4, spared(kRegisters[n % kWritten]));
    }
    m.execute(program(s.enter));
    for (unsigned n = 0; n < kRounds * kWritten; ++n) {
      const Cp15Register& written = kRegisters[n % kWritten];
      const std::uint32_t word = m.port.word(kWords + 8 * n);
      ++writes;
      for (std::size_t k = 0; k < kCount; ++k) {
        const Cp15Register& r = kRegisters[k];
        const auto at = static_cast<std::uint32_t>(kResults + 4 * (2 * n * kCount + k));
        const std::uint32_t before = m.port.word(at), after = m.port.word(at + 4 * kCount);
        const std::uint32_t may = &r == &written ? r.keeps & ~spared(r) : 0;
        const std::uint32_t fixed = ~(r.keeps | r.open | spared(r)), open = &r == &written ? r.open : 0;
        EXPECT_EQ(after & may, word & may) << s.name << ": " << r.name << " (" << r.source << ")";
        EXPECT_EQ(after & ~may & ~open, before & ~may & ~open)
            << s.name << ": a write of " << std::hex << word << " to " << written.name << " changes " << r.name;
        if (r.name != std::string("cache_type"))  // the caches' sizes
          EXPECT_EQ(after & fixed, r.reads & fixed) << s.name << ": " << r.name << " (" << r.source << ")";
      }
      if (testing::Test::HasFailure()) return;
    }
  }
  std::printf("%u writes in %zu states\n", writes, cp15_states().size());
}

}  // namespace
}  // namespace fovea::cpu::test
