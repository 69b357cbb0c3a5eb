// Random words as ARM and Thumb code, in each mode, with the MMU on: the core has a defined
// reaction to all of them, stays within its bounds (AddressSanitizer, UBSan), and counts
// UNPREDICTABLE ones.
#include <cstdlib>
#include <iostream>
#include <numeric>
#include <random>

#include "model/cpu/core/debug.h"
#include "model/cpu/core/isa.h"
#include "tb/iss/machine.h"

int fovea_planted = 0;

namespace fovea::cpu {

/// Puts the core where a random word finds it.
class CoreTest {
 public:
  explicit CoreTest(Core& core) : c(core) {}
  void begin(std::uint32_t pc, std::uint32_t cpsr) {
    c.stop_requested_ = false;
    c.failure_.exceptions = 0;
    c.failure_.failed = false;
    c.set_cpsr(cpsr);
    c.next_pc_ = pc;
    c.enter_exception();
    c.fetch_.branched = true;
    c.end_chain();
  }
  void system(std::uint32_t control, std::uint32_t tables, std::uint32_t domains,
              std::uint32_t process) {
    c.cp15_write(1u << 8, control);
    c.cp15_write(2u << 8, tables);
    c.cp15_write(3u << 8, domains);
    c.cp15_write(13u << 8, process);
    c.system_.tlb_lock = c.system_.dlock = c.system_.ilock = 0;
    c.cp15_write(8u << 8 | 7u << 4, 0);
  }
  std::uint32_t pc() const { return c.regs_.pc; }
  bool flags_hold() const { return c.cpsr() == c.regs_.cpsr; }
  Core& c;
};

namespace test {
namespace {

/// Lets the core execute one instruction for each run(); always has an interrupt for a sleeper.
class StepPort : public FlatPort {
 public:
  using FlatPort::FlatPort;
  Core* core = nullptr;
  Picoseconds horizon() override { return 0; }
  void sleep_until(Picoseconds t) override {
    FlatPort::sleep_until(t);
    core->request_stop();
  }
  Picoseconds wait_for_interrupt(Picoseconds from) override { return from; }
};

class FuzzTest : public testing::Test {
 protected:
  static constexpr std::uint32_t kCode = kMemory, kRefused = 0x0C00'0000;
  MachineWith<StepPort> m;
  CoreTest t{m.core};
  std::mt19937_64 random{seed()};
  std::uint64_t tried = 0, defined = 0, unpredictable = 0, undefined = 0, faults = 0;
  std::vector<std::uint64_t> rows = std::vector<std::uint64_t>(isa_rows().size());

  static std::uint64_t seed() {
    const char* s = std::getenv("FOVEA_SEED");
    return s ? std::strtoull(s, nullptr, 0) : 926;
  }
  FuzzTest() {
    m.port.core = &m.core;
    m.svc_handling.reset();
    m.core.reset(0, 0);
  }
  /// As they were: random stores reach them.
  void tables() {
    m.identity_map();
    // Pages of all kinds, most of them to memory, some to nothing.
    constexpr std::uint32_t kPages = kTables + 0x8000;
    m.port.set_word(kTables + 4 * (kRefused >> 20), kPages | 1u << 5 | 0x11u);
    m.port.set_word(kTables + 4 * (kRefused >> 20) + 4, (kPages + 0x1000) | 2u << 5 | 0x13u);
    for (std::uint32_t k = 0; k < 256; ++k) m.port.set_word(kPages + 4 * k, page(1, 3));
    for (std::uint32_t k = 0; k < 1024; ++k) m.port.set_word(kPages + 0x1000 + 4 * k, page(3, 0));
  }
  std::uint32_t word() { return static_cast<std::uint32_t>(random()); }
  std::uint32_t r(std::uint32_t n) { return word() % n; }
  std::uint32_t page(std::uint32_t kind, std::uint32_t kinds) {
    const std::uint32_t to = r(4) ? kMemory + (r(0xD00) << 12) : 0x7000'0000;
    return (to & ~0xFFFu) | (word() & 0xFFCu) | (kinds ? r(kinds) : 0) | (kinds ? 0 : kind);
  }
  std::uint32_t value() {
    switch (r(8)) {
      case 0:
        return word();
      case 1:
        return r(64);
      case 2:
        return 0x10000 + r(0x8000);  // internal RAM
      case 3:
        return r(0x8000);
      case 4:
        return kRefused + r(0x200000);  // pages
      case 5:
        return 0x7000'0000 + r(1 << 20);  // nothing there
      default:
        return kMemory + 0x20000 + r(0xE0'0000 - 0x20000);
    }
  }
  /// Any word, or one of a row with its other bits at random.
  std::uint32_t code(bool thumb) {
    if (r(2)) return thumb ? word() & 0xFFFFu : word();
    int row = 0;
    do row = static_cast<int>(r(static_cast<std::uint32_t>(isa_rows().size())));
    while (isa_rows()[static_cast<std::size_t>(row)].thumb() != thumb);
    const IsaBits& bits = isa_bits(row);
    const std::uint32_t should = r(2) ? bits.zeros | bits.ones : 0;
    return ((word() & ~bits.mask & ~should) | bits.value | (bits.ones & should)) &
           (thumb ? 0xFFFFu : ~0u);
  }
  /// The MMU on, caches, alignment checks and S and R at random.
  void settings() {
    tables();
    t.system(0x0005'0079u | (word() & 0x0000'5306u) | (word() & 0x2u), kTables,
             r(2) ? ~0u : word() | 3u, 0);
  }
  void one(bool thumb) {
    static constexpr std::uint32_t kModes[] = {0x10, 0x11, 0x12, 0x13, 0x17, 0x1B, 0x1F};
    const std::uint32_t at = thumb ? r(0x3FF0) * 2 : r(0x1FF0) * 4;
    const std::uint32_t pc = r(4) ? kCode + at : at;
    const std::uint32_t status =
        (word() & 0xF800'0000u) | 0xC0u | (thumb ? 0x20u : 0) | kModes[r(7)];
    t.begin(pc, status);
    const std::uint32_t w = code(thumb);
    std::uint8_t bytes[4];
    std::memcpy(bytes, &w, 4);
    if (!debug.write(pc, std::span(bytes).first(thumb ? 2 : 4))) return;  // no page
    for (unsigned k = 0; k < 15; ++k) m.core.set_reg(k, value());
    const Counts before = m.core.counts();
    m.core.run();
    const Counts& after = m.core.counts();
    ++tried;
    const std::uint64_t done = after.instructions - before.instructions;
    const std::uint64_t taken = after.exceptions - before.exceptions;
    ASSERT_TRUE(done + taken >= 1 && done <= 1 && taken <= 1)
        << std::hex << w << " at " << pc << ": " << done << " and " << taken;
    ASSERT_TRUE(t.flags_hold());
    ASSERT_EQ(t.pc() & ((m.core.cpsr() & 0x20u) ? 1u : 3u), 0u) << std::hex << w;
    const int row = isa_row(w, thumb);
    const bool aborted_fetch = taken && (m.core.cpsr() & 31u) == 0x17 && (t.pc() & 0xFFFFu) == 0xC;
    if (aborted_fetch) {  // or a BKPT, which looks the same
      if (row != kNoRow && isa_rows()[static_cast<std::size_t>(row)].op == Op::kBkpt)
        ++rows[static_cast<std::size_t>(row)];
      return;
    }
    const bool passes = thumb || passes_condition(w >> 28, status >> 28);
    const std::uint64_t counted = after.unpredictable - before.unpredictable;
    faults += taken;
    if (row == kNoRow) {
      ++undefined;
      ASSERT_EQ(taken, passes ? 1u : 0u) << std::hex << w;
      ASSERT_EQ(counted, 0u) << std::hex << w;
      return;
    }
    const bool wrong = !isa_defined(row, w);
    const IsaRow& form = isa_rows()[static_cast<std::size_t>(row)];
    ASSERT_EQ(counted, passes && wrong ? 1u : 0u) << std::hex << w << " " << form.name;
    ++(wrong ? unpredictable : defined);
    ++rows[static_cast<std::size_t>(row)];
  }
  static bool passes_condition(std::uint32_t cond, std::uint32_t flags) {
    const bool n = flags >> 3 & 1u, z = flags >> 2 & 1u, c = flags >> 1 & 1u, v = flags & 1u;
    const bool pass[16] = {z,    !z,      c,       !c,     n,      !n,           v,
                           !v,   c && !z, !c || z, n == v, n != v, !z && n == v, z || n != v,
                           true, true};
    return pass[cond];
  }
  struct Behind : DebugMemory {
    FlatPort& port;
    explicit Behind(FlatPort& p) : port(p) {}
    bool debug_read(std::uint32_t a, std::span<std::uint8_t> to) override {
      if (!port.mapped(a, static_cast<unsigned>(to.size()))) return false;
      std::memcpy(to.data(), port.at(a), to.size());
      return true;
    }
    bool debug_write(std::uint32_t a, std::span<const std::uint8_t> from) override {
      if (!port.mapped(a, static_cast<unsigned>(from.size()))) return false;
      std::memcpy(port.at(a), from.data(), from.size());
      return true;
    }
  } memory{m.port};
  CoreDebug debug{m.core, memory};
};

TEST_F(FuzzTest, EveryWordHasADefinedReaction) {
  constexpr std::uint64_t kWords = 1'000'000;
  std::cout << "seed " << seed() << "\n";
  for (std::uint64_t n = 0; tried < kWords && n < 2 * kWords && !HasFailure(); ++n) {
    if (n % 64 == 0) settings();
    if (n % 4096 == 0) m.port.log.clear();
    one(r(3) == 0);
  }
  EXPECT_GE(tried, kWords) << "too few places are mapped";
  std::uint64_t fewest = tried;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    fewest = std::min(fewest, rows[row]);
    EXPECT_GE(rows[row], 100u) << isa_rows()[row].name;
  }
  std::cout << tried << " words: " << defined << " defined, " << unpredictable << " UNPREDICTABLE, "
            << undefined << " undefined; " << faults << " exceptions; rows at least " << fewest
            << " each\n";
  const Counts& c = m.core.counts();
  EXPECT_EQ(m.core.clock_count() - m.first_clock,
            c.issue + c.idle + std::accumulate(c.stall.begin(), c.stall.end(), std::uint64_t{0}));
}

}  // namespace
}  // namespace test
}  // namespace fovea::cpu
