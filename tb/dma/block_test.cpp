// Channel controller and a transfer controller as blocks, on crossbar and SDRAM: what software sees at each
// nanosecond does not depend on how early outcomes are reported, and a burst that no other process sees costs no
// kernel event. Each run is a process of its own.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "model/dma/edma_cc.h"
#include "model/dma/edma_tc.h"
#include "tb/own_diagnostics.h"
#include "tb/sync/in_child.h"
#include "tb/sync/memory_system.h"

namespace fovea::dma {
namespace {

constexpr unsigned kTc = 3, kChannel = 3;
constexpr std::uint32_t kSdram = 0x8000'0000;
constexpr std::uint32_t kInterrupt = 1u << 20;
// Of the transfer controller.
constexpr std::uint32_t kTcstat = 0x100, kIntstat = 0x104, kInten = 0x108, kIntclr = 0x10C, kIntcmd = 0x110,
                        kErrstat = 0x120, kErren = 0x124, kErrclr = 0x128;

std::string text(const char* format, ...) {
  char line[400];
  va_list args;
  va_start(args, format);
  std::vsnprintf(line, sizeof line, format, args);
  va_end(args);
  return line;
}

std::uint32_t read(RegBank& bank, std::uint32_t offset) {
  std::uint32_t v = 0;
  bank.read(offset, 4, v);
  return v;
}

struct Rig {
  /// `in_kernel_time`: outcomes are reported at their times, as on a shared port.
  Rig(const std::map<std::string, std::string>& settings, bool in_kernel_time, bool strict = false) {
    for (const auto& [key, value] : settings) set(key, value);
    scr = std::make_unique<bus::Scr>("scr", xbar_params, ddr_params, bus::AddressMap{}, strict);
    using Speed = bus::ConfigBus::Speed;
    const std::vector<bus::ConfigBus::BlockSpec> blocks{{"ddr", 0x2000'0000, 0x8000, Speed::kFast},
                                                        {"edma", 0x01E0'0000, 0x8000, Speed::kFast},
                                                        {"tc", 0x01E1'0000, 0x400, Speed::kFast}};
    config = std::make_unique<bus::ConfigBus>("config", config_params, end_of_instant, blocks);
    ddr = std::make_unique<mem::DdrModule>("ddr", ddr_params, scr->memory());
    scr->clk(scr_clk);
    for (std::size_t i = 0; i < kMasterCount; ++i) scr->priority[i](priority[i]);
    scr->config_socket.bind(config->socket);
    ddr->ddr_clk(ddr_clk);
    ddr->scr_clk(scr_clk);
    ddr->enabled(on);
    config->to("ddr").bind(ddr->reg_socket);
    cc = std::make_unique<EdmaCc>("edma", params);
    tc = std::make_unique<EdmaTc>("edma_tc", kTc, tc_params);
    config->to("edma").bind(cc->reg_socket);
    config->to("tc").bind(tc->reg_socket);
    cc->clk(scr_clk);
    cc->lpsc(cc_on);
    cc->completion.out(completion);
    cc->error.out(error);
    for (unsigned n = 0; n < kTransferControllers; ++n) cc->priority[n](tc_priority[n]);
    tc->clk(scr_clk);
    tc->lpsc(tc_on);
    tc->error.out(tc_error);
    tc->misc(misc);
    tc->attach(*cc);
    for (const MasterPort& p : tc->masters()) p.socket->bind(*scr->target[index(p.id)]);
    if (in_kernel_time) tc->report_in_kernel_time();
    cc->regs.write(0x240, 4, kTc << 4 * kChannel);  // DMAQNUM0
    cc->regs.write(0x340, 4, 1u << kChannel);       // DRAE0
    cc->regs.write(0x2060, 4, 1u << kChannel);      // IESR
    sync::start_sdram(*ddr);
    for (std::uint32_t i = 0; i < 0x20000; ++i) *ddr->store().at(i) = static_cast<std::uint8_t>(i * 7 + i / 253);
  }
  void set(const std::string& key, const std::string& value) {
    for (ParamGroup* g : {static_cast<ParamGroup*>(&params), static_cast<ParamGroup*>(&tc_params)})
      for (auto* p : g->params())
        if (p->key() == key) return p->set(value);
    FOVEA_CHECK(false, "no parameter " + key);
  }
  /// One AB-synchronised transfer on the channel, begun now.
  void start(std::uint32_t from, std::uint32_t to, unsigned acnt, unsigned bcnt, int index) {
    const auto pitch = static_cast<std::uint16_t>(index);
    const std::uint32_t words[8] = {1u << 2 | kChannel << 12 | kInterrupt, from, acnt | bcnt << 16, to,
                                    pitch | static_cast<std::uint32_t>(pitch) << 16, 0xFFFF, 0, 1};
    for (unsigned w = 0; w < 8; ++w) cc->regs.write(0x4000 + 32 * kChannel + 4 * w, 4, words[w]);
    cc->regs.write(0x2010, 4, 1u << kChannel);  // ESR
  }
  void at_end_of(Picoseconds at, std::function<void()> f) { end_of_instant.at(at, InstantRank{}, std::move(f)); }
  /// An access over the bus, now. @return the word read
  std::uint32_t access(std::uint32_t offset, bool write, std::uint32_t word = 0) {
    tlm::tlm_generic_payload gp;
    gp.set_command(write ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND);
    gp.set_address(offset);
    gp.set_data_ptr(reinterpret_cast<unsigned char*>(&word));
    gp.set_data_length(4);
    gp.set_streaming_width(4);
    sc_core::sc_time delay;
    config->to("tc")->b_transport(gp, delay);
    return gp.is_response_ok() ? word : ~0u;
  }

  OwnDiagnostics diagnostics;
  EndOfInstant end_of_instant{"end_of_instant"};
  bus::CrossbarParams xbar_params;
  bus::ConfigBusParams config_params;
  mem::DdrParams ddr_params;
  EdmaParams params;
  EdmaTcParams tc_params;
  ClockSignal ddr_clk{"ddr_clk", Frequency(250'000'000)}, scr_clk{"scr_clk", Frequency(125'000'000)};
  sc_core::sc_signal<bool> on{"on", true}, cc_on{"cc_on", true}, tc_on{"tc_on", true};
  sc_core::sc_signal<bool> completion{"completion"}, error{"error"}, tc_error{"tc_error"};
  sc_core::sc_signal<std::uint32_t> misc{"misc"};
  sc_core::sc_vector<sc_core::sc_signal<std::uint32_t>> priority{"priority", kMasterCount},
      tc_priority{"tc_priority", kTransferControllers};
  std::unique_ptr<bus::Scr> scr;
  std::unique_ptr<bus::ConfigBus> config;
  std::unique_ptr<mem::DdrModule> ddr;
  std::unique_ptr<EdmaCc> cc;
  std::unique_ptr<EdmaTc> tc;
};

constexpr Picoseconds kClock = 8 * kPsPerNs;  // 125 MHz

/// All that software and statistics see now.
std::string state(Rig& r) {
  RegBank& tc = r.tc->regs;
  std::string s = text("%06x %x %x", read(tc, kTcstat), read(tc, kIntstat), read(tc, kErrstat));
  for (std::uint32_t offset = 0x200; offset < 0x400; offset += 4)
    if (tc.register_at(offset)) s += text(" %x", read(tc, offset));
  s += text(" %x %x", read(r.cc->regs, 0x640), read(r.cc->regs, 0x2068));
  for (StatBase* stat : r.tc->stats.stats()) {
    const StatBase::Value v = stat->value();
    s += std::holds_alternative<double>(v) ? text(" %a", std::get<double>(v))
                                           : text(" %llu", static_cast<unsigned long long>(std::get<std::uint64_t>(v)));
  }
  return s;
}

/// Random transfers, some of which overlap, INTSTAT cleared now and then; the state at the end of each `step`
/// in which it has changed, the ends of all requests, and what is in memory.
std::string record(const std::map<std::string, std::string>& settings, bool in_kernel_time, bool strict,
                   Picoseconds step) {
  return sync::in_child(0, [&] {
    Rig r(settings, in_kernel_time, strict);
    std::string out, before;
    std::uint32_t state_of_dice = 12345;
    const auto dice = [&] { return (state_of_dice = state_of_dice * 1664525u + 1013904223u) >> 8; };
    const auto log = [&](const std::string& s) {
      out += text("%llu ", static_cast<unsigned long long>(kernel_time())) + s + "\n";
    };
    r.tc->on_ended = [&](const TransferRequest& q, Picoseconds at) {
      log(text("ended %x %llu", q.source.address, static_cast<unsigned long long>(at)));
    };
    constexpr Picoseconds kEnd = 30 * kPsPerUs;
    std::function<void()> probe = [&] {
      if (const std::string now = state(r); now != before) log(before = now);
      if (kernel_time() < kEnd) r.at_end_of(kernel_time() + step, probe);
    };
    std::function<void()> transfer = [&] {
      if (dice() % 4 == 0) r.tc->regs.write(kIntclr, 4, dice() & 3u);
      if (dice() % 16 == 0) r.tc->stats.reset();
      r.cc->regs.write(0x2070, 4, dice() & 1u << kChannel);
      r.start(kSdram + dice() % 0x4000, kSdram + 0x8000 + dice() % 0x4000, 1 + dice() % 150, 1 + dice() % 4,
              static_cast<int>(dice() % 400) - 50);
      const Picoseconds gap = (dice() % 3 ? 60 : 700) * kPsPerNs + dice() % 999;
      if (kernel_time() + gap < kEnd - 5 * kPsPerUs) r.at_end_of(kernel_time() + gap, transfer);
    };
    r.at_end_of(kPsPerUs, probe);
    r.at_end_of(kPsPerUs + 1, transfer);
    sc_core::sc_start(ps_time(kEnd + kPsPerUs));
    r.scr->settle();
    std::uint64_t hash = 0xcbf29ce484222325ull;
    for (std::uint32_t i = 0; i < 0x20000; ++i) hash = (hash ^ *r.ddr->store().at(i)) * 0x100000001b3ull;
    log(text("memory %llx", static_cast<unsigned long long>(hash)));
    return out;
  });
}

using Settings = std::map<std::string, std::string>;
const std::vector<Settings> kSizes = {
    {},
    {{"edma.tc.outstanding", "1"}},
    {{"edma.tc.outstanding", "16"}, {"edma.tc.depth", "2"}},
    {{"edma.tc.burst", "64B"}, {"edma.tc.depth", "1"}},
    {{"edma.tc.burst", "16B"}, {"edma.completion_clocks", "1"}}};

// In kernel time each burst is reported at its last beat, so the state cannot lie ahead of the present.
TEST(EdmaBlockTest, SoftwareSeesTheSameAtEachNanosecondWhenOutcomesAreReportedAhead) {
  for (const Settings& s : kSizes) {
    const std::string at_its_time = record(s, true, false, kPsPerNs), ahead = record(s, false, false, kPsPerNs);
    ASSERT_GT(std::count(at_its_time.begin(), at_its_time.end(), '\n'), 500);
    ASSERT_NE(at_its_time.find(" ended "), std::string::npos);
    EXPECT_EQ(sync::first_difference(at_its_time, ahead), "");
  }
}

// Probes far apart leave the memory path a longer way to go at once.
TEST(EdmaBlockTest, AndInStrictMode) {
  for (const Picoseconds step : {Picoseconds{1373}, 7 * kPsPerNs + 1, 911 * kPsPerNs}) {
    const std::string strict = record({}, false, true, step), ahead = record({}, false, false, step);
    ASSERT_GT(strict.size(), 1000u);
    EXPECT_EQ(sync::first_difference(strict, ahead), "");
    EXPECT_EQ(sync::first_difference(record({}, true, false, step), ahead), "") << step;
  }
}

/// A copy from SDRAM to SDRAM: when it ended, and delta cycles of the kernel meanwhile.
struct Copy {
  unsigned long long end = 0, deltas = 0, bursts = 0, wrong = 0;
};
Copy copy(unsigned bytes, bool in_kernel_time) {
  const std::string s = sync::in_child(0, [&] {
    Rig r({}, in_kernel_time);
    Copy c;
    std::uint64_t before = 0;
    r.at_end_of(kPsPerUs, [&] {
      before = sc_core::sc_delta_count();
      r.start(kSdram, kSdram + 0x10000, bytes, 1, 0);
    });
    sc_core::sc_spawn_options options;
    options.spawn_method();
    options.dont_initialize();
    options.set_sensitivity(&r.completion.posedge_event());
    sc_core::sc_spawn([&] {
      c.end = kernel_time();
      c.deltas = sc_core::sc_delta_count() - before;
    }, "ended", &options);
    sc_core::sc_start(ps_time(kPsPerMs));
    r.scr->settle();
    for (StatBase* stat : {static_cast<StatBase*>(&r.tc->stats.reads), static_cast<StatBase*>(&r.tc->stats.writes)})
      c.bursts += std::get<std::uint64_t>(stat->value());
    for (unsigned i = 0; i < bytes; ++i) c.wrong += *r.ddr->store().at(i) != *r.ddr->store().at(0x10000 + i);
    return text("%llu %llu %llu %llu", c.end, c.deltas, c.bursts, c.wrong);
  });
  Copy c;
  std::istringstream(s) >> c.end >> c.deltas >> c.bursts >> c.wrong;
  return c;
}

TEST(EdmaBlockTest, ALongCopyTakesKernelEventsForItsEndsOnly) {
  const Copy ahead = copy(32768, false), at_its_time = copy(32768, true);
  EXPECT_EQ(ahead.bursts, 2048u);
  EXPECT_EQ(ahead.wrong, 0u);
  EXPECT_GT(ahead.end, 0u);
  EXPECT_EQ(ahead.end, at_its_time.end);
  EXPECT_LT(ahead.deltas, 40u);
  EXPECT_GT(at_its_time.deltas, 1024u) << "the comparison: nearly an event for each burst";
  EXPECT_EQ(copy(1024, false).deltas, ahead.deltas) << "whatever its length";
  std::printf("2048 bursts: %llu delta cycles, reported at their times %llu\n", ahead.deltas, at_its_time.deltas);
}

/// Runs one transfer; `watch` may schedule what it wants to see. Its text is the result.
std::string one_transfer(const std::function<void(Rig&, std::string&)>& watch, const Settings& settings = {}) {
  return sync::in_child(0, [&] {
    Rig r(settings, false);
    std::string out;
    watch(r, out);
    r.at_end_of(kPsPerUs, [&] { r.start(kSdram, kSdram + 0x10000, 64, 1, 0); });
    sc_core::sc_start(ps_time(20 * kPsPerUs));
    return out;
  });
}

// The request leaves for the program register at the edge at which its forming begins (assumed), and the
// program register one clock later.
TEST(EdmaBlockTest, TractvIsSetWhileARequestIsFormed) {
  for (const unsigned clocks : {1u, 8u, 128u}) {
    const std::string seen = one_transfer(
        [&](Rig& r, std::string& out) {
          r.tc->on_request = [&](const TransferRequest&, Picoseconds at) {
            for (const Picoseconds t : {at, at + clocks * kClock - 1, at + clocks * kClock})
              r.at_end_of(t, [&] {
                const std::uint32_t status = read(r.cc->regs, 0x640);
                out += text("%u%u ", status >> 2 & 1, status >> 4 & 1);
              });
          };
        },
        {{"edma.request_clocks", std::to_string(clocks)}});
    // ACTV is set by the outstanding code too, until the transfer is over.
    EXPECT_EQ(seen, clocks < 100 ? "11 11 01 " : "11 11 00 ") << clocks;
  }
}

TEST(EdmaBlockTest, IntstatIsSetByAnEmptyProgramRegisterAndByTheLastAcknowledgement) {
  const std::string seen = one_transfer([](Rig& r, std::string& out) {
    const auto look = [&r, &out](Picoseconds at, std::uint32_t clear) {
      r.at_end_of(at, [&r, &out, clear] {
        out += text("%x ", read(r.tc->regs, kIntstat));
        if (clear) r.tc->regs.write(kIntclr, 4, clear);
      });
    };
    auto first = std::make_shared<bool>(true);
    r.tc->on_request = [look, first](const TransferRequest&, Picoseconds at) {
      if (!*first) return;
      look(at, 0);
      look(at + kClock - 1, 0);
      look(at + kClock, 1);
      look(at + kClock + 1, 0);
    };
    r.tc->on_ended = [&r, &out, look, first](const TransferRequest&, Picoseconds at) {
      if (!std::exchange(*first, false)) return;
      out += "| ";
      look(at, 1);  // of another bit
      look(at + 1, 2);
      look(at + 2, 0);
      r.start(kSdram, kSdram + 0x10000, 8, 1, 0);
      look(at + 4 * kPsPerUs, 3);
      look(at + 4 * kPsPerUs + 1, 0);
    };
  });
  EXPECT_EQ(seen, "0 0 1 0 | 2 2 0 3 0 ");
}

// The last acknowledgement itself: not a picosecond earlier. The time is known from another run.
TEST(EdmaBlockTest, TrdoneComesWithTheLastAcknowledgement) {
  const std::string end = one_transfer([](Rig& r, std::string& out) {
    r.tc->on_ended = [&out](const TransferRequest&, Picoseconds at) { out = std::to_string(at); };
  });
  ASSERT_NE(end, "");
  const Picoseconds at = std::stoull(end);
  const std::string seen = one_transfer([at](Rig& r, std::string& out) {
    for (const Picoseconds t : {at - 1, at})
      r.at_end_of(t,
                  [&] { out += text("%x%x ", read(r.tc->regs, kIntstat) >> 1, read(r.tc->regs, kTcstat) >> 4 & 7); });
  });
  EXPECT_EQ(seen, "01 10 ") << "TRDONE, and DSTACTV";
}

TEST(EdmaBlockTest, AnEnabledInterruptOfATransferControllerIsSaidToBeUnconnected) {
  const auto warned = [](std::uint32_t offset, std::uint32_t word) {
    return one_transfer([&](Rig& r, std::string& out) {
      r.at_end_of(kPsPerUs / 2, [&r, &out, offset, word] {
        r.access(offset, true, word);
        unsigned warnings = 0;
        for (const auto& [what, n] : r.diagnostics.counts())
          if (what.second.find("EDMATC3 (INTEN, INTCMD) is not connected") != std::string::npos) ++warnings;
        out = std::to_string(warnings);
      });
    });
  };
  EXPECT_EQ(warned(kInten, 0), "0");
  EXPECT_EQ(warned(kInten, 1), "1");
  EXPECT_EQ(warned(kIntcmd, 2), "1");
}

// The region's bit of DRAE decides, and IER; the interrupt of region 0 comes all the same.
TEST(EdmaBlockTest, AnInterruptOfAShadowRegionThatLeadsNowhereIsSaidToBeUnconnected) {
  const auto seen = [](unsigned region, bool allowed, bool enabled) {
    return one_transfer([&](Rig& r, std::string& out) {
      r.cc->regs.write(0x340 + 8 * region, 4, allowed ? 1u << kChannel : 0);  // DRAE
      r.cc->regs.write(enabled ? 0x1060 : 0x1058, 4, 1u << kChannel);         // IESR or IECR
      r.at_end_of(4 * kPsPerUs, [&r, &out, region] {
        const std::string warning = "shadow region " + std::to_string(region) + " is not connected";
        unsigned warnings = 0;
        for (const auto& [what, n] : r.diagnostics.counts())
          if (what.second.find(warning) != std::string::npos) ++warnings;
        out = text("%u %u", warnings, static_cast<unsigned>(r.cc->stats.interrupts.count()));
      });
    });
  };
  for (unsigned region = 1; region < kShadowRegions; ++region) {
    EXPECT_EQ(seen(region, true, true), "1 1") << region;
    EXPECT_EQ(seen(region, false, true), "0 1") << region;
    EXPECT_EQ(seen(region, true, false), "0 0") << region;
  }
  EXPECT_EQ(seen(0, true, true), "0 1");
  EXPECT_EQ(seen(0, false, true), "0 0");
}

// SPRUH82C, "Error Generation": accesses to reserved addresses.
TEST(EdmaBlockTest, ReservedAddressesSetMmraerr) {
  const std::string seen = one_transfer([](Rig& r, std::string& out) {
    r.at_end_of(kPsPerUs / 2, [&r, &out] {
      const auto errors = [&] { out += text("%x", r.access(kErrstat, false)); };
      r.access(0x004, false);  // TCCFG
      r.access(0x000, false);  // the identification, which is there on the chip
      r.access(0x3D4, false);  // DFMPPRXY3, the last register
      errors();
      out += text(" %x ", r.access(0x008, false));  // behind TCCFG
      errors();
      r.access(kErrclr, true, 0x5);
      errors();
      r.access(kErrclr, true, 0x8);
      errors();
      r.access(0x3D8, true, 1);
      errors();
      r.access(kErrclr, true, 0x8);
      r.access(0x114, false);  // between INTCMD and ERRSTAT
      errors();
    });
  });
  EXPECT_EQ(seen, "0 0 88088");
}

TEST(EdmaBlockTest, MmraerrInterruptsIfItIsEnabled) {
  for (const std::uint32_t enabled : {0u, 1u, 8u}) {
    const std::string seen = one_transfer([&](Rig& r, std::string& out) {
      auto pulses = std::make_shared<unsigned>(0);
      sc_core::sc_spawn_options options;
      options.spawn_method();
      options.dont_initialize();
      options.set_sensitivity(&r.tc_error.posedge_event());
      sc_core::sc_spawn([pulses] { ++*pulses; }, "tc_error_pulse", &options);
      r.at_end_of(kPsPerUs / 2, [&r, enabled] {
        r.access(kErren, true, enabled);
        r.access(0x008, false);
      });
      r.at_end_of(kPsPerUs * 3 / 4, [&r] { r.access(0x008, false); });  // the error is pending already
      r.at_end_of(15 * kPsPerUs, [&out, pulses] { out = std::to_string(*pulses); });
    });
    EXPECT_EQ(seen, enabled == 8 ? "1" : "0") << enabled;
  }
}

/// How often a warning that contains `words` came.
std::uint64_t warned(const Rig& r, const std::string& words) {
  std::uint64_t times = 0;
  for (const auto& [what, n] : r.diagnostics.counts())
    if (what.second.find(words) != std::string::npos) times += n;
  return times;
}

// Each wait counts once, however often the queue is looked at.
TEST(EdmaBlockTest, ARequestThatWaitsForAControllerWithoutClockIsSaidToWait) {
  const std::string seen = one_transfer([](Rig& r, std::string& out) {
    const auto look = [&r, &out] {
      const auto waits = warned(r, "EDMA: a request waits for transfer controller 3, which has no clock");
      out += text("%u:%u ", static_cast<unsigned>(waits), read(r.cc->regs, 0x2068) >> kChannel & 1);  // IPR
    };
    r.at_end_of(kPsPerUs / 2, [&r] { r.tc_on.write(false); });
    r.at_end_of(2 * kPsPerUs, look);
    r.at_end_of(3 * kPsPerUs, [&r] { r.cc->regs.write(0x244, 4, 0); });  // DMAQNUM1: one more look
    r.at_end_of(4 * kPsPerUs, look);
    r.at_end_of(5 * kPsPerUs, [&r] { r.tc_on.write(true); });
    r.at_end_of(7 * kPsPerUs, [&r, look] {
      look();
      r.tc_on.write(false);
    });
    r.at_end_of(8 * kPsPerUs, look);
    r.at_end_of(9 * kPsPerUs, [&r] { r.start(kSdram, kSdram + 0x10000, 64, 1, 0); });
    r.at_end_of(10 * kPsPerUs, look);
  });
  EXPECT_EQ(seen, "1:0 1:0 1:1 1:1 2:1 ");
}

// A request waits at the head of a more urgent queue, here for a transfer controller that is not there.
TEST(EdmaBlockTest, AQueueThatWaitsDoesNotHoldBackTheOthers) {
  const auto end = [](bool other_waits) {
    return one_transfer([other_waits](Rig& r, std::string& out) {
      r.tc->on_ended = [&out](const TransferRequest&, Picoseconds at) { out = std::to_string(at); };
      if (other_waits) r.at_end_of(kPsPerUs / 2, [&r] { r.cc->regs.write(0x1010, 4, 1u << 9); });  // ESR: of queue 0
    });
  };
  EXPECT_NE(end(false), "");
  EXPECT_EQ(end(true), end(false));
}

// Events that no program has enabled are lost without a word: timers have them all the time.
TEST(EdmaBlockTest, AnEnabledEventWithoutClockIsSaidToBeLost) {
  const std::string seen = one_transfer([](Rig& r, std::string& out) {
    const auto look = [&r, &out] {
      out +=
          text("%u:%x ", static_cast<unsigned>(warned(r, "EDMA: event 5 is lost: the channel controller has no clock")),
               read(r.cc->regs, 0x1000) | read(r.cc->regs, 0x1038));  // ER, SER
    };
    const auto gated = [&r](unsigned channel) {
      r.cc_on.write(false);
      r.at_end_of(kernel_time() + kClock, [&r, channel] { r.cc->event(channel); });
      r.at_end_of(kernel_time() + 2 * kClock, [&r] { r.cc_on.write(true); });
    };
    r.at_end_of(3 * kPsPerUs, [gated] { gated(5); });
    r.at_end_of(4 * kPsPerUs, look);
    r.at_end_of(5 * kPsPerUs, [&r, gated] {
      r.cc->regs.write(0x1030, 4, 1u << 5);  // EESR
      gated(5);
    });
    r.at_end_of(6 * kPsPerUs, look);
    r.at_end_of(7 * kPsPerUs, [gated] { gated(6); });
    r.at_end_of(8 * kPsPerUs, look);
    r.at_end_of(9 * kPsPerUs, [gated] { gated(5); });
    r.at_end_of(10 * kPsPerUs, [&r, look] {
      look();
      r.cc->event(5);
    });
    r.at_end_of(10 * kPsPerUs + kClock, look);
  });
  EXPECT_EQ(seen, "0:0 1:0 1:0 2:0 2:20 ");
}

}  // namespace
}  // namespace fovea::dma

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
