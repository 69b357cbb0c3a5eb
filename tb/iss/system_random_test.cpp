// Random privileged sequences produce the same log on the core and on QEMU's versatilepb; a core
// with a defect in its system part does not.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <map>
#include <sstream>
#include <utility>

#include "tb/iss/system_code.h"
#include "tb/iss/system_log.h"
#include "tb/iss/system_machine.h"

namespace fovea::cpu {

/// The state that a defect would have changed.
class CoreTest {
 public:
  explicit CoreTest(Core& core) : c(core) {}
  Core& c;
  std::uint32_t pc() const { return c.regs_.pc; }
  std::uint32_t mode() const { return c.regs_.cpsr & kModeBits; }
  std::uint32_t& r(unsigned n) { return c.regs_.r[n]; }
  std::uint32_t& cpsr() { return c.regs_.cpsr; }
  std::uint32_t& spsr() { return c.regs_.spsr(); }
  std::uint32_t& far() { return c.system_.far; }
  std::uint32_t& dfsr() { return c.system_.dfsr; }
  std::uint32_t& dacr() { return c.system_.dacr; }
  /// r13 (0) or r14 (1) of a mode that is not the present one.
  std::uint32_t& banked(std::uint32_t mode, unsigned which) {
    return c.regs_.banked(RegisterFile::bank(mode), 13 + which);
  }
  std::uint32_t& user_high(unsigned n) { return c.regs_.user_high(n); }
};

namespace test {
namespace {

constexpr std::uint32_t kTables = 0x0040'0000;

std::string elf() { return SYSTEM_DIR "/system_random.elf"; }

std::uint32_t symbol(const std::string& name) {
  static const std::string names = output_of(std::string(ARM_PREFIX "nm ") + elf());
  std::istringstream in(names);
  std::string value, kind, each;
  while (in >> value >> kind >> each)
    if (each == name) return static_cast<std::uint32_t>(std::stoul(value, nullptr, 16));
  throw std::runtime_error("no symbol " + name);
}

/// `--seed` of one's own: the variable FOVEA_SEED.
std::uint64_t first_seed() {
  const char* s = std::getenv("FOVEA_SEED");
  return s ? std::strtoull(s, nullptr, 0) : 365;
}

using Log = std::vector<LogCase>;

struct Here {
  Log log;
  std::uint64_t instructions = 0, exceptions = 0;
};

/// @param plant what imitates a defect, if any
Here by_core(const SystemCode& code, Caches caches,
             const std::function<void(SystemMachine&)>& plant = {}) {
  static const auto image = read_file(SYSTEM_DIR "/system_random.bin");
  SystemMachine m;
  m.load(0, image);
  m.load(SystemCode::kBase, code.image);
  if (plant) plant(m);
  m.run(caches);
  const Counts& n = m.core.counts();
  return {parse_log(m.output, [&m](std::uint32_t a) { return m.byte(a); }), n.instructions,
          n.exceptions};
}

Log by_qemu(const SystemCode& code, const Log& names) {
  const std::string bytes = by_qemu_system(elf(), code.image, SystemCode::kBase);
  // Names of cases lie in memory that only the core's side keeps: they come in the same order.
  std::size_t next = 1;
  Log log = parse_log(bytes, [](std::uint32_t) { return std::uint8_t{0}; });
  for (std::size_t k = 1; k < log.size() && next < names.size(); ++k)
    log[k].name = names[next++].name;
  return log;
}

/// What an LDM that aborted has loaded of its list is open; the base is not.
Open aborted_load(const SystemCode& code) {
  return [&code](const LogEntry& e, const std::string& field) {
    if (e.dump || e.kind() != 4 || field[0] != 'r' || (e.words[3] & 0x20u)) return false;
    const std::uint32_t at = e.words[1] - 8 - SystemCode::kBase;
    if (at >= code.image.size()) return false;
    std::uint32_t word = 0;
    std::memcpy(&word, code.image.data() + at, 4);
    const unsigned r = static_cast<unsigned>(std::stoul(field.substr(1)));
    return (word & 0x0E100000u) == 0x08100000u && (word >> r & 1u) && r != (word >> 16 & 15u);
  };
}

TEST(SystemRandomTest, SequencesLeaveWhatQemuLeaves) {
  SystemCode all;
  std::uint64_t entries = 0, exceptions = 0;
  std::map<std::uint32_t, unsigned> kinds, statuses;
  for (std::uint64_t seed = first_seed(); seed < first_seed() + 6; ++seed) {
    const SystemCode code = generate_system(seed, 250, 40, symbol("resume"));
    const Here plain = by_core(code, Caches::kNone);
    const Log want = by_qemu(code, plain.log);
    for (const Caches caches : {Caches::kNone, Caches::kI, Caches::kD, Caches::kBoth}) {
      const Here here = caches == Caches::kNone ? plain : by_core(code, caches);
      const auto wrong = compare_logs(here.log, want, aborted_load(code));
      EXPECT_TRUE(wrong.empty()) << "seed " << seed << ", "
                                 << kCacheNames[static_cast<unsigned>(caches)] << ": "
                                 << wrong.size() << ", first " << wrong.front().text();
    }
    std::cout << "seed " << seed << ": " << code.instructions << " instructions, "
              << plain.exceptions << " exceptions\n";
    all.instructions += code.instructions;
    exceptions += plain.exceptions;
    for (const LogCase& c : plain.log)
      for (const LogEntry& e : c.entries) {
        ++entries;
        if (!e.dump) ++kinds[e.kind()];
        if (!e.dump && e.kind() == 4) ++statuses[e.words[4] & 15u];
      }
    for (std::size_t k = 0; k < all.counts.size(); ++k) all.counts[k] += code.counts[k];
  }
  for (std::size_t k = 0; k < all.counts.size(); ++k) {
    std::cout << std::setw(16) << kStepNames[k] << std::setw(8) << all.counts[k] << "\n";
    EXPECT_GE(all.counts[k], 500u) << kStepNames[k];
  }
  std::cout << "exceptions by vector:";
  for (const auto& [kind, n] : kinds) {
    std::cout << " " << kind << ": " << n;
    EXPECT_GE(n, 500u) << "vector " << kind;
  }
  std::cout << "\ndata aborts by status:";
  for (const unsigned status : {0x1u, 0x5u, 0x7u, 0x9u, 0xBu, 0xDu, 0xFu}) {
    std::cout << std::hex << " " << status << std::dec << ": " << statuses[status];
    EXPECT_GE(statuses[status], 200u) << "status " << status;
  }
  std::cout << "\n"
            << all.instructions << " instructions of random code, " << exceptions << " exceptions, "
            << entries << " entries compared\n";
  EXPECT_GE(all.instructions, 50'000u);
}

/// What a defect would have changed, done at a fetch. @return true: it did
struct Plant {
  const char* what;
  std::function<bool(CoreTest&, SystemMachine&)> change;
};

std::uint32_t aborted_word(CoreTest& t, SystemMachine& m) { return m.port.word(t.r(14) - 8); }
bool from_thumb(CoreTest& t) { return t.spsr() & 0x20u; }
bool in_code(std::uint32_t pc) { return pc >= SystemCode::kBase && pc < kTables; }

const Plant kAtVectors[] = {
    {"the user's r13 is not kept on an undefined instruction",
     [](CoreTest& t, SystemMachine&) {
       if (t.pc() != 0x04 || (t.spsr() & 31u) != 0x10) return false;
       t.banked(0x10, 0) ^= 0x40;
       return true;
     }},
    {"r14 of the supervisor is lost on a data abort",
     [](CoreTest& t, SystemMachine&) {
       if (t.pc() != 0x10 || (t.spsr() & 31u) != 0x13) return false;
       t.banked(0x13, 1) = t.r(14);
       return true;
     }},
    {"FIQ shares r12 with the other modes",
     [](CoreTest& t, SystemMachine&) {
       if (t.pc() != 0x1C || (t.spsr() & 31u) == 0x11 || t.r(12) == t.user_high(12)) return false;
       t.user_high(12) = t.r(12);
       return true;
     }},
    {"the SPSR loses Q",
     [](CoreTest& t, SystemMachine&) {
       if (t.pc() != 0x08 || !(t.spsr() & 0x08000000u)) return false;
       t.spsr() &= ~0x08000000u;
       return true;
     }},
    {"the SPSR says another mode",
     [](CoreTest& t, SystemMachine&) {
       if (t.pc() != 0x10 || (t.spsr() & 31u) != 0x1F) return false;
       t.spsr() ^= 0x0Fu;
       return true;
     }},
    {"the base keeps the write-back of an aborted load or store",
     [](CoreTest& t, SystemMachine& m) {
       if (t.pc() != 0x10 || from_thumb(t)) return false;
       const std::uint32_t w = aborted_word(t, m), rn = w >> 16 & 15u;
       const bool back = !(w >> 24 & 1u) || (w >> 21 & 1u);
       if ((w & 0x0E000000u) != 0x04000000u || !back || rn > 7 || !(w & 0xFFFu)) return false;
       t.r(rn) += (w >> 23 & 1u) ? w & 0xFFFu : 0u - (w & 0xFFFu);
       return true;
     }},
    {"the base keeps the write-back of an aborted LDM or STM",
     [](CoreTest& t, SystemMachine& m) {
       if (t.pc() != 0x10 || from_thumb(t)) return false;
       const std::uint32_t w = aborted_word(t, m), rn = w >> 16 & 15u;
       if ((w & 0x0E200000u) != 0x08200000u || rn > 7) return false;
       t.r(rn) += 4;
       return true;
     }},
    {"FAR says the word, not the byte",
     [](CoreTest& t, SystemMachine&) {
       if (t.pc() != 0x10 || !(t.far() & 3u)) return false;
       t.far() &= ~3u;
       return true;
     }},
    {"FAR is not written",
     [](CoreTest& t, SystemMachine&) {
       if (t.pc() != 0x10) return false;
       t.far() += 0x400;
       return true;
     }},
    {"DFSR says another domain",
     [](CoreTest& t, SystemMachine&) {
       if (t.pc() != 0x10) return false;
       t.dfsr() ^= 0x10;
       return true;
     }},
    {"LR of a data abort is 4 short",
     [](CoreTest& t, SystemMachine&) {
       if (t.pc() != 0x10 || from_thumb(t)) return false;
       t.r(14) -= 4;
       return true;
     }},
    {"LR of an undefined Thumb instruction is that of an ARM one",
     [](CoreTest& t, SystemMachine&) {
       if (t.pc() != 0x04 || !from_thumb(t)) return false;
       t.r(14) += 2;
       return true;
     }},
    {"LR of an interrupt is 4 too far",
     [](CoreTest& t, SystemMachine&) {
       if (t.pc() != 0x18) return false;
       t.r(14) += 4;
       return true;
     }},
    {"an exception leaves I open",
     [](CoreTest& t, SystemMachine&) {
       if (t.pc() != 0x04) return false;
       t.cpsr() &= ~0x80u;
       return true;
     }},
};

/// At the first instruction after a return, which is where its status comes from the SPSR.
const Plant kAtReturns[] = {
    {"a return leaves I as it was",
     [](CoreTest& t, SystemMachine&) {
       if (t.cpsr() & 0x80u) return false;
       t.cpsr() |= 0x80u;
       return true;
     }},
    {"a return leaves Q as it was",
     [](CoreTest& t, SystemMachine&) {
       t.cpsr() ^= 0x08000000u;
       return true;
     }},
    {"a return to FIQ mode does not bring its r8",
     [](CoreTest& t, SystemMachine&) {
       if (t.mode() != 0x11 || t.r(8) == t.user_high(8)) return false;
       t.r(8) = t.user_high(8);
       return true;
     }},
};

/// Errors of the page walk, made in what it reads: they last.
struct WalkPlant {
  const char* what;
  std::function<void(SystemMachine&)> set;
};
bool first_level(const BusAccess& a) {
  return a.port == BusAccess::Port::kData && !a.write && a.address - kTables < 0x4000u;
}
bool second_level(const BusAccess& a) {
  return a.port == BusAccess::Port::kData && !a.write && a.address - (kTables + 0x5000u) < 0x4000u;
}
std::uint32_t word_of(const BusAccess& a) {
  std::uint32_t w = 0;
  std::memcpy(&w, a.data, 4);
  return w;
}

const WalkPlant kInWalks[] = {
    {"users may write what they may only read, in sections",
     [](SystemMachine& m) {
       m.port.after = [](BusAccess& a) {
         const std::uint32_t w = word_of(a);
         if (first_level(a) && (w & 3u) == 2 && (w >> 10 & 3u) == 2) a.data[1] |= 0x0C;
       };
     }},
    {"users may do what others may, in sections",
     [](SystemMachine& m) {
       m.port.after = [](BusAccess& a) {
         const std::uint32_t w = word_of(a);
         if (first_level(a) && (w & 3u) == 2 && (w >> 10 & 3u) == 1) a.data[1] |= 0x0C;
       };
     }},
    {"all quarters of a small page have the rights of the first",
     [](SystemMachine& m) {
       m.port.after = [](BusAccess& a) {
         std::uint32_t w = word_of(a);
         if (!second_level(a) || (w & 3u) != 2) return;
         w = (w & ~0xFF0u) | (w >> 4 & 3u) * 0x550u;
         std::memcpy(a.data, &w, 4);
       };
     }},
    {"another domain",
     [](SystemMachine& m) {
       m.port.after = [](BusAccess& a) {
         if (a.address - (kTables + 0x1000u) < 0x28u && first_level(a)) a.data[0] ^= 0x40;
       };
     }},
    {"no access counts as client",
     [](SystemMachine& m) {
       m.port.before = [&m, planted = false, kept = 0u, shown = 0u](BusAccess& a) mutable {
         std::uint32_t& dacr = CoreTest(m.core).dacr();
         if (first_level(a) && !planted) {
           planted = true;
           kept = dacr;
           shown = dacr |= ~(dacr >> 1) & 0x55555555u;
         } else if (a.port == BusAccess::Port::kInstruction && planted) {
           planted = false;
           if (dacr == shown) dacr = kept;
         }
       };
     }},
};

/// Without caches each vector and each first instruction after a branch is fetched over the bus.
void plant(SystemMachine& m, const Plant& p, bool at_return, std::uint64_t from, bool& done) {
  m.port.before = [&m, &p, at_return, from, &done, last = 0u, times = 0u](BusAccess& a) mutable {
    if (a.port != BusAccess::Port::kInstruction) return;
    CoreTest t(m.core);
    const std::uint32_t before = std::exchange(last, t.pc());
    if (done || m.core.counts().exceptions < from) return;
    // A single wrong status may be overwritten unseen by the next instruction.
    if (at_return)
      done = before < 0x1000 && in_code(t.pc()) && p.change(t, m) && ++times == 4;
    else
      done = t.pc() < 0x20 && p.change(t, m);
  };
}

TEST(SystemRandomTest, ComparisonComplainsAboutPlantedDefects) {
  const SystemCode code = generate_system(4711, 120, 40, symbol("resume"));
  const Log right = by_core(code, Caches::kNone).log, want = by_qemu(code, right);
  ASSERT_TRUE(compare_logs(right, want, aborted_load(code)).empty());
  const auto look_for = [&](const char* what, const std::function<void(SystemMachine&)>& set) {
    try {
      const auto wrong =
          compare_logs(by_core(code, Caches::kNone, set).log, want, aborted_load(code));
      EXPECT_FALSE(wrong.empty()) << what;
      if (!wrong.empty())
        std::cout << what << ": " << wrong.size() << ", first " << wrong.front().text() << "\n";
    } catch (const std::exception& e) {  // it went astray, which no test overlooks
      std::cout << what << ": " << e.what() << "\n";
    }
  };
  for (const std::uint64_t from : {1u, 500u})
    for (const bool at_return : {false, true}) {
      const auto each = [&](const Plant& p) {
        bool done = false;
        look_for(p.what, [&](SystemMachine& m) { plant(m, p, at_return, from, done); });
        EXPECT_TRUE(done) << p.what << ": never happened";
      };
      if (at_return)
        for (const Plant& p : kAtReturns) each(p);
      else
        for (const Plant& p : kAtVectors) each(p);
    }
  for (const WalkPlant& p : kInWalks) look_for(p.what, p.set);
}

}  // namespace
}  // namespace test
}  // namespace fovea::cpu
