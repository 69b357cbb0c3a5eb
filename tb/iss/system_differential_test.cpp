// Exceptions, modes, translation and CP15: the programs of system/ produce the same log on the core
// and on QEMU's versatilepb.
#include <gtest/gtest.h>

#include <iostream>
#include <map>

#include "tb/iss/system_log.h"
#include "tb/iss/system_machine.h"

namespace fovea::cpu::test {
namespace {

/// A difference in which QEMU is not what the ARM926 should be, or in which the architecture leaves
/// the matter open. The expectation is written down here and holds for the core.
struct Excuse {
  const char* program;
  const char* why;
  std::function<bool(const Difference&, SystemMachine&)> expected;
};

/// The core takes the instruction for undefined, QEMU does not.
bool is_undefined(const Difference& d, const char* instruction) {
  return d.field == "entries" && (d.core & 15u) == 1 && (d.qemu & 15u) == 2 &&
         d.where.starts_with(std::string("privileged ") + instruction);
}

/// The ARM instruction that a data abort's record is about.
std::uint32_t aborted_word(const LogEntry& e, SystemMachine& m) {
  std::uint32_t word = 0;
  for (unsigned k = 0; k < 4; ++k) word |= std::uint32_t{m.byte(e.words[1] - 8 + k)} << (8 * k);
  return word;
}

const Excuse kExcuses[] = {
    {"aborts",
     "an aborted LDM may have loaded registers of its list (ARM ARM, effects of data-aborted "
     "instructions); the base keeps its value. QEMU loads as it goes, the core loads none",
     [](const Difference& d, SystemMachine& m) {
       if (d.context.dump || d.context.kind() != 4 || d.field[0] != 'r') return false;
       const std::uint32_t word = aborted_word(d.context, m);
       const unsigned r = static_cast<unsigned>(std::stoul(d.field.substr(1)));
       return (word & 0x0E100000u) == 0x08100000u && (word >> r & 1u) && r != (word >> 16 & 15u) &&
              d.core == (r == 0   ? 0x10203040u
                         : r == 2 ? 8u
                                  : 0x10000000u + 0x01010101u * r);
     }},
    {"faults",
     "the domain of a translation fault without a second level is not valid (ARM DDI 0198D "
     "table 3-9): 0 here, that of the descriptor in QEMU",
     [](const Difference& d, SystemMachine&) {
       return (d.field == "dfsr" || d.field == "ifsr") && d.core == 5 && (d.qemu & 15u) == 5 &&
              d.where.starts_with("no section");
     }},
    {"faults",
     "the second descriptor is read before the domain is looked at (ARM ARM, sequence for checking "
     "faults): QEMU looks at the domain first",
     [](const Difference& d, SystemMachine&) {
       return (d.field == "dfsr" || d.field == "ifsr") && (d.core & 15u) == 7 &&
              (d.qemu & 15u) == 0xB && d.core >> 4 == d.qemu >> 4 &&
              (d.where.find("no page") != std::string::npos ||
               d.where.starts_with("coarse, reserved"));
     }},
    {"cp15", "undefined codes of c0 read the main ID",
     [](const Difference& d, SystemMachine&) {
       return d.where == "identity" && d.field == "r0" && d.core == 0x41069265u;
     }},
    {"cp15", "QEMU's cache type is a placeholder; the chip has 16 KB I and 8 KB D",
     [](const Difference& d, SystemMachine&) {
       return d.where == "cache type" && d.core == 0x1D112152u && d.qemu == 0x01DD20D2u;
     }},
    {"cp15", "QEMU's board has no TCM",
     [](const Difference& d, SystemMachine&) {
       return d.where == "TCM status" && d.core == 0x00010001u && d.qemu == 0;
     }},
    {"cp15", "opcode 2 of c2 and c3 should be 0, c7,c8,0 is not listed: UNPREDICTABLE",
     [](const Difference& d, SystemMachine&) {
       return is_undefined(d, "ee121f30") || is_undefined(d, "ee131f30") ||
              is_undefined(d, "ee071f18");
     }},
    {"fcse", "FAR holds the modified virtual address (ARM ARM, FCSE); QEMU leaves the process out",
     [](const Difference& d, SystemMachine&) {
       const std::uint32_t process = static_cast<std::uint32_t>(d.where[8] - '0');
       return d.where.starts_with("process ") && d.field == "far" && d.qemu < 0x02000000u &&
              d.core == d.qemu + (process << 25);
     }},
};

class SystemDifferentialTest : public testing::TestWithParam<std::string> {};

TEST_P(SystemDifferentialTest, LeavesWhatQemuLeaves) {
  const std::string stem = SYSTEM_DIR "/system_" + GetParam();
  const auto image = read_file(stem + ".bin");
  const std::string by_qemu = by_qemu_system(stem + ".elf");
  for (const Caches caches : {Caches::kNone, Caches::kBoth}) {
    const char* with = kCacheNames[static_cast<unsigned>(caches)];
    SystemMachine m;
    m.load(0, image);
    m.run(caches);
    const auto memory = [&m](std::uint32_t a) { return m.byte(a); };
    const auto got = parse_log(m.output, memory), want = parse_log(by_qemu, memory);
    std::size_t entries = 0, wrong = 0;
    for (const LogCase& c : got) entries += c.entries.size();
    std::map<const Excuse*, unsigned> used;
    for (const Difference& d : compare_logs(got, want)) {
      const Excuse* found = nullptr;
      for (const Excuse& e : kExcuses)
        if (e.program == GetParam() && e.expected(d, m)) found = &e;
      if (found)
        ++used[found];
      else if (++wrong <= 20)
        ADD_FAILURE() << d.text();
    }
    EXPECT_EQ(wrong, 0u) << "differences"
                         << ", " << with;
    std::cout << GetParam() << ", " << with << ": " << got.size() - 1 << " cases, " << entries
              << " entries, " << m.core.counts().instructions << " instructions\n";
    for (const Excuse& e : kExcuses) {
      if (e.program != GetParam()) continue;
      std::cout << "  " << used[&e] << " excused: " << e.why << "\n";
      EXPECT_GT(used[&e], 0u) << "an excuse that nothing needs";
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Programs, SystemDifferentialTest,
                         testing::Values("exceptions", "modes", "aborts", "permissions", "faults",
                                         "cp15", "fcse"),
                         [](const auto& row) { return row.param; });

/// QEMU returns from exceptions by MOVS, SUBS and LDM only: the others are held against MOVS here.
TEST(SystemTest, AllOperationsReturnFromExceptionsAlike) {
  SystemMachine m;
  m.load(0, read_file(SYSTEM_DIR "/system_returns.bin"));
  m.run(Caches::kBoth);
  const auto log = parse_log(m.output, [&m](std::uint32_t a) { return m.byte(a); });
  std::map<std::string, const LogCase*> by_name;
  for (const LogCase& c : log) by_name[c.name] = &c;
  unsigned compared = 0;
  for (const char* how : {"adds pc, lr", "orrs pc", "mvns pc", "rsbs pc", "bics pc"})
    for (const char* mode : {"0x11", "0x12", "0x13", "0x17", "0x1b"}) {
      const std::string from = std::string(" from mode ") + mode;
      const LogCase& a = *by_name.at("movs pc, lr" + from);
      const LogCase& b = *by_name.at(how + from);
      ASSERT_EQ(a.entries.size(), b.entries.size()) << how << from;
      // The first two are the name and the way there from the case before.
      for (std::size_t k = 2; k < a.entries.size(); ++k) {
        // Kind and saved status; addresses differ.
        EXPECT_EQ(a.entries[k].words[0], b.entries[k].words[0]) << how << from;
        EXPECT_EQ(a.entries[k].words[3], b.entries[k].words[3]) << how << from << " entry " << k;
        ++compared;
      }
    }
  // 7 modes, 2 states, 2 sets of flags; one more entry after the last mode.
  EXPECT_EQ(compared, 5u * (5 * (2 * 7 * 2 * 2 - 1) + 1)) << "entries";
}

}  // namespace
}  // namespace fovea::cpu::test
