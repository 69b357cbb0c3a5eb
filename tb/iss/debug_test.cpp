// What a debugger reads and writes is what the program loads, stores and executes.
#include "model/cpu/core/debug_control.h"

#include "tb/iss/debug_machine.h"

namespace fovea::cpu::test {
namespace {

constexpr std::uint32_t kCode = kMemory + 0x2000;

TEST(CoreDebugTest, SeesDirtyLineAndChangesItForTheProgram) {
  DebugMachine m;
  m.on_svc = [&](std::uint32_t) {
    EXPECT_EQ(m.get(kData), 0x11u);
    EXPECT_EQ(m.port.word(kData), 0u);  // still in the cache
    m.put(kData, 0x22);
  };
  m.execute(std::string(kCachesOn) + R"(
    ldr r1, =0x00101000
    ldr r2, [r1]
    mov r2, #0x11
    str r2, [r1]
    svc #3
    ldr r4, [r1]
    mcr p15, 0, r1, c7, c10, 1
    mcr p15, 0, r1, c7, c10, 4
  )");
  EXPECT_EQ(m.core.reg(4), 0x22u);
  EXPECT_EQ(m.port.word(kData), 0x22u);  // what the clean wrote back
}

TEST(CoreDebugTest, SeesPendingWriteAndIsNotUndoneByIt) {
  DebugMachine m;
  m.port.write_latency = 4'000'000;
  m.port.decide_late = true;
  m.on_svc = [&](std::uint32_t) {
    EXPECT_EQ(m.get(kData), 0x11u);
    EXPECT_EQ(m.get(kData + 64), 0x11u);
    EXPECT_EQ(m.port.word(kData), 0u);  // the first is on the bus, the second in the buffer
    m.put(kData, 0x22);
    m.put(kData + 64, 0x33);
  };
  m.execute(std::string(kCachesOn) + R"(
    ldr r1, =0x00101000
    mov r2, #0x11
    str r2, [r1]
    str r2, [r1, #64]
    svc #3
    mcr p15, 0, r1, c7, c10, 4
  )");
  EXPECT_EQ(m.port.word(kData), 0x22u);
  EXPECT_EQ(m.port.word(kData + 64), 0x33u);
}

/// Replaces an instruction that has already run twice, from where it is kept.
/// @param cached the second time from the instruction cache
void expect_patched(const std::string& start, std::uint32_t base, bool cached) {
  DebugMachine m;
  std::uint32_t patched = 0;
  m.on_svc = [&](std::uint32_t) {
    EXPECT_EQ(m.core.counts().icache_fills > 0, cached);
    m.put(patched, 0xE3A05002u);  // mov r5, #2
  };
  const std::string text = start + R"(
    mov r6, #3
    again:
    mov r5, #1
    cmp r6, #1
    beq done
    cmp r6, #2
    svceq #3
    sub r6, r6, #1
    b again
    done:
  )";
  patched = assemble(text + "\n svc #2\n .ltorg\n", base).symbols.at("again");
  EXPECT_NE(patched % 32, 0u) << "not at the begin of a line";
  m.execute(text, base);
  EXPECT_EQ(m.core.reg(5), 2u);
}

TEST(CoreDebugTest, PatchesCodeInTcmInCacheAndInMemory) {
  expect_patched("", 0, false);
  expect_patched(kCachesOn, kCode, true);
  expect_patched("", kCode, false);
}

TEST(CoreDebugTest, TranslatesByTlbAndByTables) {
  DebugMachine m;
  m.section(0x4000'0000, kMemory, 1, 1);
  m.section(0x5000'0000, kMemory, 0, 0);
  m.port.set_word(kData, 0x1234);
  m.on_svc = [&](std::uint32_t) {
    EXPECT_EQ(m.get(0x4000'1000), 0x1234u);  // the program has accessed this page
    EXPECT_EQ(m.get(0x5000'1000), 0x1234u);  // and not this one
    EXPECT_EQ(m.debug.physical(0x5000'1004), kData + 4);
    m.section(0x6000'0000, 0, 0, 0);
    m.port.set_word(kTables + 4 * 0x600, 0);
    EXPECT_FALSE(m.debug.physical(0x6000'0000));
    std::array<std::uint8_t, 1> b;
    EXPECT_FALSE(m.debug.read(0x6000'0000, b));
    EXPECT_FALSE(m.debug.write(0x7000'0000, b));  // mapped, but no slave answers
  };
  m.execute(std::string(kCachesOn) + " ldr r1, =0x40001000\n ldr r2, [r1]\n svc #3\n");
}

/// Small, large and tiny pages, through second-level tables in memory.
TEST(CoreDebugTest, WalksSecondLevelTables) {
  DebugMachine m;
  const std::uint32_t coarse = kTables + 0x4000, fine = kTables + 0x5000;
  m.port.set_word(kTables + 4 * 0x400, coarse | 0x11u);
  m.port.set_word(kTables + 4 * 0x401, fine | 0x13u);
  m.port.set_word(coarse + 4 * 1, kMemory | 0xFF2u);           // small page at 0x40001000
  for (unsigned k = 16; k < 32; ++k) m.port.set_word(coarse + 4 * k, kMemory | 0xFF1u);
  m.port.set_word(fine + 4 * 3, (kMemory + 0x400) | 0x33u);    // tiny page at 0x40100C00
  m.on_svc = [&](std::uint32_t) {
    EXPECT_EQ(m.debug.physical(0x4000'1234), kMemory + 0x234);
    EXPECT_EQ(m.debug.physical(0x4001'2345), kMemory + 0x2345);
    EXPECT_EQ(m.debug.physical(0x4010'0C08), kMemory + 0x408);
    EXPECT_FALSE(m.debug.physical(0x4000'2000));
  };
  m.execute(std::string(kCachesOn) + " svc #3\n");
}

TEST(CoreDebugTest, LooksAndWritesTakeNoTime) {
  const std::string text = std::string(kCachesOn) + R"(
    ldr r1, =0x00101000
    mov r3, #20
    loop:
    ldr r2, [r1], #36
    str r2, [r1]
    svc #3
    subs r3, r3, #1
    bne loop
  )";
  std::uint64_t clocks[2];
  for (const bool look : {false, true}) {
    DebugMachine m;
    m.on_svc = [&](std::uint32_t) {
      if (!look) return;
      for (std::uint32_t a = kMemory; a < kMemory + 0x2000; a += 4) m.put(a, m.get(a));
    };
    m.execute(text);
    clocks[look] = m.core.clock_count();
  }
  EXPECT_EQ(clocks[0], clocks[1]);
}

/// A core without TCMs: their addresses go to the bus, and CP15 says so.
TEST(CoreDebugTest, WithoutTcmItsWindowsAreMemory) {
  const Machine::Params params({});
  FlatPort port(0, 0x20000);
  Core core(params, port, {}, {});
  port.attach(&core);
  core.set_clock(Frequency(250'000'000), 0);
  const Subscription exit = core.handle_swi([](Core& c, std::uint32_t) {
    c.request_stop();
    return true;
  });
  const Program p = assemble(R"(
    ldr r0, =0x10000
    mov r1, #7
    str r1, [r0]
    mrc p15, 0, r2, c0, c0, 2
    mov r3, #0x19
    mcr p15, 0, r3, c9, c1, 1
    mrc p15, 0, r3, c9, c1, 1
    ldr r4, [r0]
    svc #0
    .ltorg
  )", 0);
  std::memcpy(port.at(0), p.bytes.data(), p.bytes.size());
  core.reset(0, 0);
  core.run();
  EXPECT_EQ(port.word(0x1'0000), 7u);
  EXPECT_EQ(core.reg(2), 0u);
  EXPECT_EQ(core.reg(3), 0u);
  EXPECT_EQ(core.reg(4), 7u);
}

/// A debugger that answers each stop and runs on.
struct ControlledMachine : DebugMachine {
  CoreControl control{core, debug};
  std::vector<std::uint32_t> pcs, addresses;
  ControlledMachine() {
    control.on_stop = [this](const CoreControl::Stop& s) {
      pcs.push_back(core.reg(15));
      addresses.push_back(s.address);
    };
  }
};

const char* const kLoop = R"(
    mov r3, #3
    ldr r1, =0x00101000
    loop:
    ldr r2, [r1], #4
    add r2, r2, r3, lsl #1
    cmp r2, #4
    streq r2, [r1, #60]
    here:
    subs r3, r3, #1
    bne loop
)";

/// A store or a load under a new translation, protection or mode, all set by the debugger.
TEST(CoreDebugTest, SystemRegistersHaveTheEffectsOfTheProgramsOwnWrites) {
  DebugMachine m;
  const auto reg = [&](const char* name) -> const CoreDebug::SystemRegister& {
    for (const auto& r : CoreDebug::system_registers())
      if (std::string(r.name) == name) return r;
    throw std::out_of_range(name);
  };
  m.section(0x4000'0000, kMemory, 0, 0);
  const std::uint32_t others = kTables + 0x8000;
  m.port.set_word(kData, 0x11);
  m.port.set_word(kData + 0x10'0000, 0x22);
  unsigned n = 0;
  m.on_svc = [&](std::uint32_t) {
    switch (n++) {
      case 0:  // the address is looked up again: TLB entries stay, as after an MCR
        EXPECT_EQ(m.debug.system_register(reg("ttbr")), kTables);
        m.debug.set_system_register(reg("ttbr"), others);
        EXPECT_EQ(m.debug.system_register(reg("ttbr")), others);
        m.debug.set_system_register(reg("ttbr"), kTables);
        break;
      case 1:  // no access to any domain, then back
        m.debug.set_system_register(reg("dacr"), 0);
        m.debug.set_system_register(reg("dacr"), 3);
        m.debug.set_system_register(reg("far"), 0x1234'5678);
        break;
      default:  // the MMU goes off: the next load is physical
        m.debug.set_system_register(reg("control"), m.debug.system_register(reg("control")) & ~5u);
        EXPECT_EQ(m.debug.system_register(reg("control")) & 5u, 0u);
    }
  };
  m.execute(std::string(kCachesOn) + R"(
    ldr r1, =0x40001000
    ldr r2, [r1]
    svc #3
    ldr r3, [r1]
    svc #3
    mrc p15, 0, r4, c6, c0, 0
    svc #3
    ldr r1, =0x00101000
    ldr r5, [r1]
  )");
  EXPECT_EQ(n, 3u);
  EXPECT_EQ(m.core.reg(2), 0x11u);
  EXPECT_EQ(m.core.reg(3), 0x11u);
  EXPECT_EQ(m.core.reg(4), 0x1234'5678u);
  EXPECT_EQ(m.core.reg(5), 0x11u);
}

TEST(CoreDebugTest, RegistersOfAllModes) {
  DebugMachine m;
  const auto value = [&](const char* name) {
    for (const auto& r : CoreDebug::banked_registers())
      if (std::string(r.name) == name) return m.debug.banked_register(r);
    ADD_FAILURE() << name;
    return 0u;
  };
  unsigned n = 0;
  m.on_svc = [&](std::uint32_t) {
    EXPECT_EQ(value("sp_svc"), 0x300u);
    EXPECT_EQ(value("sp_irq"), 0x200u);
    EXPECT_EQ(value("r8_fiq"), 0x108u);
    EXPECT_EQ(value("r8_usr"), 0x8u);
    EXPECT_EQ(value("spsr_irq"), 0x10u);
    EXPECT_EQ(m.core.reg(8), 0x8u);
    for (const auto& r : CoreDebug::banked_registers()) {
      if (std::string(r.name) == "r8_fiq") m.debug.set_banked_register(r, 0x99);
      if (std::string(r.name) == "r8_usr") m.debug.set_banked_register(r, 0x77);
    }
    EXPECT_EQ(m.core.reg(8), 0x77u) << "the present mode's own";
    EXPECT_TRUE(m.debug.set_spsr(0x1F));
    EXPECT_EQ(value("spsr_svc"), 0x1Fu);
    ++n;
  };
  m.execute(R"(
    mov sp, #0x300
    mov r8, #8
    msr cpsr_c, #0xD1
    mov r8, #0x108
    msr cpsr_c, #0xD2
    mov sp, #0x200
    mov r0, #0x10
    msr spsr_cxsf, r0
    msr cpsr_c, #0xD3
    svc #3
    msr cpsr_c, #0xD1
    mov r0, r8
    msr cpsr_c, #0xD3
  )");
  EXPECT_EQ(n, 1u);
  EXPECT_EQ(m.core.reg(0), 0x99u);
}

TEST(CoreControlTest, StopsAtTheFirstBoundaryAfterATime) {
  ControlledMachine m;
  std::vector<Picoseconds> times;
  m.control.on_stop = [&](const CoreControl::Stop& s) {
    EXPECT_EQ(s.reason, CoreControl::Stop::Reason::kTime);
    times.push_back(m.debug.now());
  };
  m.control.follow_bus(true);
  m.control.stop_after(40'000);
  m.execute(kLoop);
  ASSERT_EQ(times.size(), 1u);
  EXPECT_GT(times[0], 40'000u);
  EXPECT_LE(times[0], 40'000u + 400'000u);
  ControlledMachine free;
  free.execute(kLoop);
  EXPECT_EQ(m.core.clock_count(), free.core.clock_count());
}

TEST(CoreControlTest, BreakpointStopsEachTimeAndCostsNoTime) {
  std::uint64_t clocks[2];
  Counts counts[2];
  for (const bool debugged : {false, true}) {
    ControlledMachine m;
    const std::string text = std::string(kCachesOn) + kLoop;
    const auto here = assemble(text + "\n svc #2\n .ltorg\n", 0).symbols.at("here");
    if (debugged) m.control.set_breakpoint(here);
    m.execute(text);
    EXPECT_EQ(m.pcs, std::vector<std::uint32_t>(debugged ? 3 : 0, here));
    clocks[debugged] = m.core.clock_count();
    counts[debugged] = m.core.counts();
  }
  EXPECT_EQ(clocks[0], clocks[1]);
  EXPECT_EQ(counts[0].instructions, counts[1].instructions);
  EXPECT_EQ(counts[0].stall, counts[1].stall);
  EXPECT_EQ(counts[0].icache_accesses(), counts[1].icache_accesses());
}

TEST(CoreControlTest, StepsGoInstructionByInstructionAndRangesAsOne) {
  ControlledMachine m;
  const auto p = assemble(std::string(kLoop) + "\n svc #2\n .ltorg\n", 0);
  const std::uint32_t loop = p.symbols.at("loop"), here = p.symbols.at("here");
  m.control.on_stop = [&](const CoreControl::Stop& s) {
    const std::uint32_t pc = m.core.reg(15);
    m.pcs.push_back(pc);
    if (pc == loop) return m.control.step(loop, here);
    if (m.pcs.size() < 4) m.control.step();
  };
  m.control.request_halt();
  m.execute(kLoop);
  EXPECT_EQ(m.pcs, (std::vector<std::uint32_t>{0, 4, loop, here}));
}

TEST(CoreControlTest, TwoToolsWatchOneCoreAndEachIsReleasedAlone) {
  ControlledMachine m;
  const auto p = assemble(std::string(kLoop) + "\n svc #2\n .ltorg\n", 0);
  const std::uint32_t loop = p.symbols.at("loop"), here = p.symbols.at("here");
  std::vector<std::uint32_t> seen;
  std::optional<CoreControl> other(std::in_place, m.core, m.debug);
  other->on_stop = [&](const CoreControl::Stop&) { seen.push_back(m.core.reg(15)); };
  m.control.on_stop = [&](const CoreControl::Stop&) {
    m.pcs.push_back(m.core.reg(15));
    if (m.pcs.size() == 2) other.reset();
  };
  m.control.set_breakpoint(here);
  other->set_breakpoint(loop);
  m.execute(kLoop);
  EXPECT_EQ(m.pcs, (std::vector<std::uint32_t>{here, here, here}));
  EXPECT_EQ(seen, (std::vector<std::uint32_t>{loop, loop})) << "gone before the third round";
}

TEST(CoreControlTest, ClearEndsWatchpointsAndBreakpoints) {
  ControlledMachine m;
  const auto p = assemble(std::string(kLoop) + "\n svc #2\n .ltorg\n", 0);
  m.control.on_stop = [&](const CoreControl::Stop& s) {
    m.pcs.push_back(m.core.reg(15));
    m.addresses.push_back(s.address);
    m.control.clear();
  };
  m.control.set_watch(kData, 12, CoreControl::Watch::kRead);
  m.control.set_breakpoint(p.symbols.at("here"));
  m.execute(kLoop);
  EXPECT_EQ(m.pcs, std::vector<std::uint32_t>{p.symbols.at("loop")}) << "not at the second word, nor at the breakpoint";
  EXPECT_EQ(m.addresses, std::vector<std::uint32_t>{kData});
}

TEST(SwiTest, HandlersOfSwisAreAskedInOrderUntilOneAnswers) {
  DebugMachine m;
  m.svc_handling.reset();
  std::vector<std::uint32_t> first, second;
  const Subscription a = m.core.handle_swi([&](Core&, std::uint32_t n) {
    first.push_back(n);
    return n == 20;
  });
  const Subscription b = m.core.handle_swi([&](Core& c, std::uint32_t n) {
    second.push_back(n);
    if (n == 2) c.request_stop();
    return true;
  });
  m.execute("svc #20\n svc #21\n");
  EXPECT_EQ(first, (std::vector<std::uint32_t>{20, 21, 2}));
  EXPECT_EQ(second, (std::vector<std::uint32_t>{21, 2}));
}

/// Stops come before the access, with its lowest address; each address is worked out by hand.
TEST(CoreControlTest, WatchpointsKnowEveryFormOfAccess) {
  ControlledMachine m;
  m.control.set_watch(0, 0xFFFF'FFFFu, CoreControl::Watch::kAccess);
  m.execute(R"(
    mov r1, #0x1000
    mov r2, #0x10
    movs r3, #3, 2
    mov sp, #0x2000
    str r2, [r1]
    ldr r4, [r1, #4]!
    ldrb r4, [r1], #-4
    strh r2, [r1, #-2]
    ldrsh r4, [r1, r2]
    ldrsb r4, [r1, -r2]!
    str r2, [r1, r2, lsl #2]
    ldrd r4, [r1, #8]
    strd r4, [r1, #16]
    ldrne r4, [r1]
    cmp r1, r1
    ldrne r4, [r1]
    stmia r1, {r2, r3}
    ldmib r1!, {r4, r5, r6}
    stmdb sp!, {r4-r7, lr}
    ldmda r1, {r4, r5}
    swp r4, r2, [r1]
    swpb r4, r2, [r1]
    ldr r4, lit
    add r0, pc, #1
    bx r0
    .thumb
    push {r4, r5}
    ldr r4, [sp, #4]
    strb r4, [r1, #3]
    ldmia r1!, {r4, r5}
    pop {r4, r5}
    ldr r4, lit2
    adr r0, back
    bx r0
    .align 2
    lit2: .word 0
    .arm
    back: b over
    lit: .word 0
    over:
  )");
  const std::uint32_t lit = m.program.symbols.at("lit"), lit2 = m.program.symbols.at("lit2");
  EXPECT_EQ(m.addresses,
            (std::vector<std::uint32_t>{0x1000, 0x1004, 0x1004, 0xFFE, 0x1010, 0xFF0, 0x1030, 0xFF8,
                                        0x1000, 0xFF0, 0xFF0, 0xFF4, 0x1FEC, 0xFF8, 0xFFC, 0xFFC, lit,
                                        0x1FE4, 0x1FE8, 0xFFF, 0xFFC, 0x1FE4, lit2}));
}

TEST(CoreControlTest, WatchpointsMindKindAndBytes) {
  using Watch = CoreControl::Watch;
  const std::string text = R"(
    mov r1, #0x1000
    ldrb r2, [r1, #3]
    ldrb r2, [r1, #4]
    strh r2, [r1, #6]
    strb r2, [r1, #8]
    str r2, [r1, #0]
  )";
  const std::pair<Watch, std::vector<std::uint32_t>> expected[] = {
      {Watch::kRead, {8}}, {Watch::kWrite, {12}}, {Watch::kAccess, {8, 12}}};
  for (const auto& [kind, pcs] : expected) {
    ControlledMachine m;
    m.control.set_watch(0x1004, 4, kind);
    m.execute(text);
    EXPECT_EQ(m.pcs, pcs);
  }
  ControlledMachine none;
  none.control.set_watch(0x1004, 4, Watch::kAccess);
  none.control.clear_watch(0x1004, 4, Watch::kAccess);
  none.execute(text);
  EXPECT_TRUE(none.pcs.empty());
}

/// As debuggers do at a watchpoint: all points out, one step, all points in again.
struct SteppingMachine : ControlledMachine {
  using Stop = CoreControl::Stop;
  using Watch = CoreControl::Watch;
  struct Point {
    std::uint32_t va, bytes;
    Watch kind;
  };
  std::vector<Point> points;
  struct Seen {
    std::uint32_t pc, address;
    bool past;
    std::uint32_t r2;
    friend bool operator==(const Seen&, const Seen&) = default;
  };
  std::vector<Seen> seen;
  bool stepping_over = false;
  std::function<void()> at_watch;
  SteppingMachine() {
    control.on_stop = [this](const Stop& s) {
      if (s.reason == Stop::Reason::kWatch) {
        seen.push_back({core.reg(15), s.address, s.past, core.reg(2)});
        if (at_watch) at_watch();
        for (const auto& p : points) control.clear_watch(p.va, p.bytes, p.kind);
        control.step();
        stepping_over = true;
      } else if (stepping_over) {
        stepping_over = false;
        for (const auto& p : points) control.set_watch(p.va, p.bytes, p.kind);
      }
    };
  }
  void watch(std::uint32_t va, std::uint32_t bytes, Watch kind) {
    points.push_back({va, bytes, kind});
    control.set_watch(va, bytes, kind);
  }
};

constexpr const char* kTwoAtOnce = R"(
    mov r1, #0x1000
    mov r2, #1
    stmia r1, {r2, r3, r4}
    mov r2, #2
    mov r2, #3
    ldr r4, [r1]
)";

TEST(CoreControlTest, EachWatchpointOfOneInstructionIsTold) {
  SteppingMachine m;
  m.watch(0x1000, 4, CoreControl::Watch::kWrite);
  m.watch(0x1008, 4, CoreControl::Watch::kAccess);
  m.watch(0x1000, 2, CoreControl::Watch::kAccess);  // the debugger finds it by the first's address
  m.watch(0x1010, 4, CoreControl::Watch::kWrite);
  m.execute(kTwoAtOnce);
  // The second one behind the store, and before anything more happens.
  EXPECT_EQ(m.seen, (std::vector<SteppingMachine::Seen>{
                        {8, 0x1000, false, 1}, {12, 0x1008, true, 1}, {20, 0x1000, false, 3}}));
  SteppingMachine free;
  free.execute(kTwoAtOnce);
  EXPECT_EQ(m.core.clock_count(), free.core.clock_count());
}

TEST(CoreControlTest, WhatWasNotTouchedInTheEndIsNotTold) {
  SteppingMachine moved;  // the debugger goes on elsewhere
  moved.watch(0x1000, 4, CoreControl::Watch::kWrite);
  moved.watch(0x1004, 4, CoreControl::Watch::kWrite);
  moved.at_watch = [&] { moved.debug.set_reg(15, 16); };
  moved.execute(kTwoAtOnce);
  EXPECT_EQ(moved.seen.size(), 1u);

  SteppingMachine deleted;  // the debugger does not watch it any more
  deleted.watch(0x1000, 4, CoreControl::Watch::kWrite);
  deleted.watch(0x1004, 4, CoreControl::Watch::kWrite);
  deleted.at_watch = [&] {
    deleted.control.clear_watch(0x1004, 4, CoreControl::Watch::kWrite);
    deleted.points.resize(1);
  };
  deleted.execute(kTwoAtOnce);
  EXPECT_EQ(deleted.seen.size(), 1u);
}

/// Where a debugger goes on from, for whatever reason it stood there, is looked at as well.
TEST(CoreControlTest, WatchpointIsFoundBehindAnotherStopAtItsInstruction) {
  for (const bool by_step : {false, true}) {
    ControlledMachine m;
    m.control.set_watch(0x1008, 4, CoreControl::Watch::kWrite);
    if (!by_step) m.control.set_breakpoint(8);
    std::vector<CoreControl::Stop::Reason> reasons;
    m.control.on_stop = [&](const CoreControl::Stop& s) {
      reasons.push_back(s.reason);
      m.pcs.push_back(m.core.reg(15));
      if (by_step && m.core.reg(15) < 8) m.control.step();
    };
    if (by_step) m.control.request_halt();
    m.execute(kTwoAtOnce);
    using R = CoreControl::Stop::Reason;
    if (by_step) {
      EXPECT_EQ(reasons, (std::vector<R>{R::kRequest, R::kStep, R::kStep, R::kWatch}));
    } else {
      EXPECT_EQ(reasons, (std::vector<R>{R::kBreakpoint, R::kWatch}));
    }
    EXPECT_EQ(m.pcs.back(), 8u);
  }
}

TEST(CoreControlTest, UnalignedAddressesTouchTheWholeWordOrHalfWord) {
  ControlledMachine m;
  m.control.set_watch(0x1000, 1, CoreControl::Watch::kAccess);
  m.execute(R"(
    mov r1, #0x1000
    ldr r2, [r1, #3]
    ldr r2, [r1, #4]
    strh r2, [r1, #1]
    ldrb r2, [r1, #1]
    add r3, r1, #2
    swp r2, r2, [r3]
  )");
  EXPECT_EQ(m.pcs, (std::vector<std::uint32_t>{4, 12, 24}));
}

/// A debugger may change where and in which state the program goes on.
TEST(CoreControlTest, RegistersAreChangedInAStop) {
  ControlledMachine m;
  const std::string text = "mov r0, #1\n mov r1, #1\n mov r2, #1\n";
  m.control.set_breakpoint(4);
  m.control.on_stop = [&](const CoreControl::Stop&) {
    m.debug.set_reg(0, 7);
    m.debug.set_reg(15, 8);
    m.debug.set_cpsr(m.debug.cpsr() | 0x4000'0000u);
  };
  m.execute(text);
  EXPECT_EQ(m.core.reg(0), 7u);
  EXPECT_EQ(m.core.reg(1), 0u);
  EXPECT_EQ(m.core.reg(2), 1u);
  EXPECT_TRUE(m.core.cpsr() & 0x4000'0000u);
}

}  // namespace
}  // namespace fovea::cpu::test
