// The documented address map, and the message for an access to a part of it that is not modelled.
#include "model/soc/memory_map.h"

#include <map>
#include <optional>

#include "model/common/check.h"
#include "model/periph/clocked_target.h"
#include "tb/own_diagnostics.h"
#include "tb/periph/bench.h"

namespace fovea::soc {
namespace {

/// Bases of blocks that are not modelled, typed in apart from the table: Linux mach-davinci/dm365.c
/// and devices.c, U-Boot asm/arch-davinci/hardware.h.
const std::map<std::uint32_t, std::string> kAbsent = {
    {0x01C2'0C00, "RTO"},
    {0x01C2'2000, "PWM0"},
    {0x01C2'2C00, "PWM3"},
    {0x01C2'3000, "SPI4"},
    {0x01C2'3C00, "ADC"},
    {0x01C6'4000, "USB"},
    {0x01C6'6000, "SPI0"},
    {0x01C6'6800, "SPI1"},
    {0x01C6'7800, "SPI2"},
    {0x01C6'8000, "SPI3"},
    {0x01C6'9000, "RTC"},
    {0x01C6'9400, "key scan"},
    {0x01C6'9800, "UHPI"},
    {0x01CA'0000, "MJCP"},
    {0x01D0'0000, "MMCSD1"},
    {0x01D0'2000, "McBSP"},
    {0x01D0'7000, "EMAC"},
    {0x01D0'A000, "EMAC control"},
    {0x01D0'B000, "MDIO"},
    {0x01D0'C000, "voice codec"},
    {0x01D1'0000, "AEMIF"},
    {0x01D1'1000, "MMCSD0"},
    {0x01D2'0000, "memory stick"},
    {0x01E0'0000, "HDVICP"},
    {0x0000'8000, "ROM"},
    {0x0200'0000, "chip select 0"},
    {0x0400'0000, "chip select 1"},
};

TEST(MemoryMapTest, IsSortedWithoutOverlapAndWordAligned) {
  std::uint64_t end = 0;
  for (const MapEntry& e : memory_map()) {
    EXPECT_GE(e.base, end) << e.title;
    EXPECT_GT(e.size, 0u) << e.title;
    EXPECT_EQ(e.base % 4 + e.size % 4, 0u) << e.title;
    EXPECT_FALSE(e.title.empty());
    end = std::uint64_t{e.base} + e.size;
  }
  EXPECT_LE(end, 0x8000'0000u);  // the SDRAM
}

TEST(MemoryMapTest, EachBlockIsNamedFromItsFirstToItsLastByte) {
  unsigned absent = 0;
  for (const MapEntry& e : memory_map()) {
    const bool modelled = !e.block.empty() && !e.partly;
    absent += !modelled;
    for (const std::uint32_t inside : {e.base, e.base + e.size - 1}) {
      const std::string text = not_modelled_at(inside);
      if (modelled)
        EXPECT_EQ(text, "") << e.title;
      else
        EXPECT_TRUE(text.starts_with(e.title + " at 0x")) << text;
    }
    for (const std::uint32_t outside : {e.base - 1, e.base + e.size})
      EXPECT_FALSE(not_modelled_at(outside).starts_with(e.title + " at ")) << e.title;
  }
  EXPECT_GT(absent, 30u);
}

TEST(MemoryMapTest, WhatOtherSoftwareTouchesFirstIsNamed) {
  for (const auto& [base, part] : kAbsent) {
    const std::string text = not_modelled_at(base);
    EXPECT_NE(text.find(part), std::string::npos) << std::hex << base << ": " << text;
    char address[16];
    std::snprintf(address, sizeof address, "0x%08x", base);
    EXPECT_NE(text.find(address), std::string::npos) << text;
    EXPECT_TRUE(text.ends_with(" is not modelled")) << text;
  }
  EXPECT_EQ(not_modelled_at(0x01C3'0000), "");  // nothing is documented there
}

TEST(MemoryMapTest, ModelledBlocksAreThoseOfTheChip) {
  std::map<std::string, std::uint32_t> bases;
  for (const Placement& b : dm365_blocks()) EXPECT_TRUE(bases.emplace(b.name, b.base).second);
  const std::map<std::string, std::uint32_t> timers = {{"timer0", 0x01C2'1400},
                                                       {"timer1", 0x01C2'1800},
                                                       {"timer2", 0x01C2'1C00},
                                                       {"timer3", 0x01C2'0800},
                                                       {"timer4", 0x01C2'3800}};
  for (const auto& [name, base] : timers) EXPECT_EQ(bases[name], base) << name;
}

struct OneRegister : RegBank {
  Reg r{*this, "R", 8, Mode::kRw, "a register"};
  OneRegister() : RegBank("BLOCK") {}
};

struct Block : WithRegs<OneRegister>, BusTarget {
  bool answers = true;
  explicit Block(sc_core::sc_module_name name) : BusTarget(name, regs) {}

 protected:
  bool holes_answer() const override { return answers; }
};

/// A master on the configuration bus that makes one access at a time.
struct Initiator : sc_core::sc_module, MemInitiatorIf {
  MemInitiatorSocket<32> socket{"socket"};
  bool done = false;
  explicit Initiator(sc_core::sc_module_name name) : sc_module(name) { socket.bind(*this); }
  tlm::tlm_sync_enum nb_transport_bw(MemRequest&, MemPhase&, sc_core::sc_time&) override {
    done = true;
    return tlm::TLM_COMPLETED;
  }
  bool fails(std::uint32_t address, unsigned bytes = 4) {
    std::array<std::uint8_t, 64> data{};
    MemRequest r;
    r.address = address;
    r.bytes = static_cast<std::uint8_t>(bytes);
    r.data = data.data();
    MemPhase phase = MemPhase::kRequest;
    sc_core::sc_time delay;
    done = false;
    socket->nb_transport_fw(r, phase, delay);
    while (!done) test::run_until(test::now() + kPsPerNs);
    return r.error;
  }
};

/// Requests of one or several masters at the same time, and when each has ended.
struct Requests : sc_core::sc_module, MemInitiatorIf {
  struct Ended {
    Picoseconds after;
    bool error;
  };
  MemInitiatorSocket<32> socket{"socket"};
  std::map<const MemRequest*, Ended> ended;
  Picoseconds start = 0;
  explicit Requests(sc_core::sc_module_name name) : sc_module(name) { socket.bind(*this); }
  tlm::tlm_sync_enum nb_transport_bw(MemRequest& r, MemPhase&, sc_core::sc_time&) override {
    ended[&r] = {kernel_time() - start, r.error};
    return tlm::TLM_COMPLETED;
  }
  std::vector<Ended> run(std::vector<MemRequest>& requests) {
    ended.clear();
    start = kernel_time();
    for (MemRequest& r : requests) {
      MemPhase phase = MemPhase::kRequest;
      sc_core::sc_time delay;
      socket->nb_transport_fw(r, phase, delay);
    }
    while (ended.size() < requests.size()) test::run_until(test::now() + kPsPerNs);
    std::vector<Ended> out;
    for (const MemRequest& r : requests) out.push_back(ended.at(&r));
    return out;
  }
};

/// Another bus, with the master above.
struct BurstChip {
  OwnDiagnostics diagnostics;
  bus::ConfigBusParams params;
  bus::ConfigBus config;
  Block edma{"burst_edma"}, timer{"burst_timer"};
  Requests master{"burst_master"};
  explicit BurstChip(EndOfInstant& end_of_instant)
      : config("burst_config", params, end_of_instant,
               {{"edma", 0x01C0'0000, 0x1'0000, bus::ConfigBus::Speed::kFast},
                {"timer", 0x01C2'1400, 0x400, bus::ConfigBus::Speed::kSlow}}) {
    config.to("edma").bind(edma.reg_socket);
    config.to("timer").bind(timer.reg_socket);
    master.socket.bind(config.socket);
  }
};

struct Chip {
  OwnDiagnostics diagnostics;
  EndOfInstant end_of_instant{"end_of_instant"};
  bus::ConfigBusParams params;
  bus::ConfigBus config{"config",
                        params,
                        end_of_instant,
                        {{"edma", 0x01C0'0000, 0x1'0000, bus::ConfigBus::Speed::kFast},
                         {"psc", 0x01C4'1000, 0x1000, bus::ConfigBus::Speed::kFast}}};
  Block edma{"edma"}, psc{"psc"};
  Initiator master{"master"};
  BurstChip burst{end_of_instant};
  Chip() {
    // Rows in which the EDMA would be modelled in part only.
    static const Placements rows = [] {
      Placements all = dm365_blocks();
      for (Placement& row : all) row.partly |= row.name == "edma";
      return all;
    }();
    config.describe = [](std::uint32_t a) { return not_modelled_at(a, rows); };
    config.to("edma").bind(edma.reg_socket);
    config.to("psc").bind(psc.reg_socket);
    edma.answers = false;
    master.socket.bind(config.socket);
  }
};

/// A process elaborates once.
Chip& the_chip() {
  static Chip chip;
  return chip;
}

TEST(MemoryMapTest, ABusErrorNamesTheBlockOnceAndAnUnknownAddressItself) {
  Chip& chip = the_chip();
  auto& notes = chip.diagnostics;
  using Kind = Diagnostics::Kind;
  notes.clear();
  EXPECT_FALSE(chip.master.fails(0x01C4'1008));
  EXPECT_FALSE(chip.master.fails(0x01C0'0008));
  EXPECT_TRUE(notes.counts().empty());
  EXPECT_TRUE(chip.master.fails(0x01D0'7008));
  EXPECT_TRUE(chip.master.fails(0x01D0'7FFC));
  EXPECT_TRUE(chip.master.fails(0x01C0'0004));   // a hole that does not answer
  EXPECT_FALSE(chip.master.fails(0x01C4'1004));  // one that does
  EXPECT_TRUE(chip.master.fails(0x01C3'0000));
  EXPECT_TRUE(chip.master.fails(0x01C3'0000, 32));  // a burst to nowhere is one error
  const std::map<std::pair<Kind, std::string>, std::uint64_t> expected = {
      {{Kind::kNotModelled, "bus error: EMAC at 0x01d07000 is not modelled"}, 2},
      {{Kind::kNotModelled,
        "bus error: EDMA3 channel controller at 0x01c00000 is modelled in part only"},
       1},
      {{Kind::kNotModelled, "BLOCK register at offset 0x4"}, 1},
      {{Kind::kGuest, "bus error at 0x01c30000"}, 2}};
  EXPECT_EQ(notes.counts(), expected);
  EXPECT_EQ(chip.config.stats.errors.count(), 5u);
}

MemRequest request(Master master, std::uint32_t address, std::uint8_t* data, unsigned bytes, bool write) {
  MemRequest r;
  r.master = master;
  r.address = address;
  r.data = data;
  r.bytes = static_cast<std::uint8_t>(bytes);
  r.write = write;
  return r;
}

constexpr Picoseconds kFast = 40 * kPsPerNs, kSlow = 120 * kPsPerNs;

TEST(ConfigBusTest, ABurstIsItsWordsOneAfterTheOther) {
  BurstChip& c = the_chip().burst;
  c.edma.answers = true;
  std::array<std::uint8_t, 64> out{}, in{};
  for (unsigned i = 0; i < out.size(); ++i) out[i] = static_cast<std::uint8_t>(i + 1);
  std::vector<MemRequest> one{request(Master::kEdmaTc0Write, 0x01C0'0000, out.data(), 32, true)};
  auto ended = c.master.run(one);
  EXPECT_EQ(ended[0].after, 8 * kFast);
  EXPECT_FALSE(ended[0].error);
  EXPECT_EQ(c.edma.regs.r.get(), 0x0C0B0A09u);  // the register is the third word
  one = {request(Master::kEdmaTc0Read, 0x01C0'0004, in.data(), 12, false)};
  ended = c.master.run(one);
  EXPECT_EQ(ended[0].after, 3 * kFast);
  EXPECT_EQ(in[4], 0x09);
  EXPECT_EQ(in[7], 0x0C);
  EXPECT_EQ(in[12], 0) << "behind the burst";
  one = {request(Master::kEdmaTc0Write, 0x01C2'1400, out.data(), 8, true)};
  EXPECT_EQ(c.master.run(one)[0].after, 2 * kSlow);
  // Unaligned: a byte, a half-word, a word, a byte.
  one = {request(Master::kEdmaTc0Read, 0x01C0'0009, in.data(), 8, false)};
  EXPECT_EQ(c.master.run(one)[0].after, 4 * kFast);
  EXPECT_EQ(in[0], 0x0A);
  // A byte, a word, a byte.
  one = {request(Master::kEdmaTc0Read, 0x01C0'000B, in.data(), 6, false)};
  EXPECT_EQ(c.master.run(one)[0].after, 3 * kFast);
}

TEST(ConfigBusTest, AMasterHasOneAccessAtATimeAndOthersAreBesideIt) {
  BurstChip& c = the_chip().burst;
  c.edma.answers = true;
  std::array<std::uint8_t, 64> a{}, b{};
  std::vector<MemRequest> three{request(Master::kEdmaTc0Write, 0x01C0'0008, a.data(), 4, true),
                                request(Master::kEdmaTc0Write, 0x01C0'0008, a.data(), 8, true),
                                request(Master::kEdmaTc1Write, 0x01C0'0008, b.data(), 4, true)};
  auto ended = c.master.run(three);
  EXPECT_EQ(ended[0].after, kFast);
  EXPECT_EQ(ended[1].after, 3 * kFast);
  EXPECT_EQ(ended[2].after, kFast);
}

TEST(ConfigBusTest, AnErrorOfOneWordIsTheBurstsAndTheOthersAreMadeAllTheSame) {
  BurstChip& c = the_chip().burst;
  c.edma.answers = false;
  std::array<std::uint8_t, 64> out{};
  out[4] = 0x55;
  std::vector<MemRequest> one{request(Master::kEdmaTc0Write, 0x01C0'0004, out.data(), 8, true)};
  auto ended = c.master.run(one);
  EXPECT_TRUE(ended[0].error);
  EXPECT_EQ(ended[0].after, 2 * kFast);
  EXPECT_EQ(c.edma.regs.r.get(), 0x55u);
  one = {request(Master::kEdmaTc0Write, 0x01C0'0008, out.data(), 4, true)};
  EXPECT_FALSE(c.master.run(one)[0].error) << "the next request is good";
}

// A block keeps the diagnostics that were current when it was made, whichever are current when it warns.
TEST(ConfigBusTest, TwoBusesOfOneProcessWarnEachItsOwn) {
  Chip& chip = the_chip();
  BurstChip& burst = chip.burst;
  chip.diagnostics.clear();
  burst.diagnostics.clear();
  const auto only = [](const char* text) { return Diagnostics::Counts{{{Diagnostics::Kind::kGuest, text}, 1}}; };
  std::array<std::uint8_t, 64> data{};
  std::vector<MemRequest> one{request(Master::kEdmaTc0Read, 0x01C3'0004, data.data(), 4, false)};
  EXPECT_TRUE(burst.master.run(one)[0].error);
  EXPECT_EQ(burst.diagnostics.counts(), only("bus error at 0x01c30004"));
  EXPECT_TRUE(chip.diagnostics.counts().empty());
  EXPECT_TRUE(chip.master.fails(0x01C3'0000));
  EXPECT_EQ(burst.diagnostics.counts(), only("bus error at 0x01c30004"));
  EXPECT_EQ(chip.diagnostics.counts(), only("bus error at 0x01c30000"));
}

}  // namespace
}  // namespace fovea::soc

FOVEA_SC_TEST_MAIN
