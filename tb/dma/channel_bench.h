// A channel controller whose transfer controllers only note what they are given.
#pragma once
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "model/dma/core/channel_controller.h"

namespace fovea::dma {

/// Offsets of registers, as SPRUEE4A and SPRUH82C print them. Those from `kEr` on are relative to
/// the base of the global region (0x1000) or of a shadow region (0x2000 + 0x200 n).
enum Offset : std::uint32_t {
  kCccfg = 0x004,
  kQchmap0 = 0x200,
  kDmaqnum0 = 0x240,
  kQdmaqnum = 0x260,
  kQuetcmap = 0x280,
  kQuepri = 0x284,
  kEmr = 0x300,
  kEmrh = 0x304,
  kEmcr = 0x308,
  kEmcrh = 0x30C,
  kQemr = 0x310,
  kQemcr = 0x314,
  kCcerr = 0x318,
  kCcerrclr = 0x31C,
  kEeval = 0x320,
  kDrae0 = 0x340,
  kQrae0 = 0x380,
  kQ0e0 = 0x400,
  kQstat0 = 0x600,
  kQwmthra = 0x620,
  kCcstat = 0x640,
  kGlobal = 0x1000,
  kShadow0 = 0x2000,
  kPaRam = 0x4000,
  kEr = 0x00,
  kEcr = 0x08,
  kEsr = 0x10,
  kCer = 0x18,
  kEer = 0x20,
  kEecr = 0x28,
  kEesr = 0x30,
  kSer = 0x38,
  kSecr = 0x40,
  kIer = 0x50,
  kIecr = 0x58,
  kIesr = 0x60,
  kIpr = 0x68,
  kIcr = 0x70,
  kIeval = 0x78,
  kQer = 0x80,
  kQeer = 0x84,
  kQeecr = 0x88,
  kQeesr = 0x8C,
  kQser = 0x90,
  kQsecr = 0x94,
};

/// Bits of OPT.
enum Opt : std::uint32_t {
  kSam = 1u << 0,
  kDam = 1u << 1,
  kAbSync = 1u << 2,
  kStatic = 1u << 3,
  kTccmode = 1u << 11,
  kTcinten = 1u << 20,
  kItcinten = 1u << 21,
  kTcchen = 1u << 22,
  kItcchen = 1u << 23,
};
constexpr std::uint32_t tcc(unsigned n) { return n << 12; }
constexpr std::uint32_t fwid(unsigned n) { return n << 8; }

/// A parameter set as software fills it in.
struct Set {
  std::uint32_t opt = 0, source = 0x1000, destination = 0x2000;
  unsigned acnt = 1, bcnt = 1, ccnt = 1;
  int source_b = 0, destination_b = 0, source_c = 0, destination_c = 0;
  unsigned link = 0xFFFF, reload = 0;

  std::array<std::uint32_t, 8> words() const {
    const auto pair = [](int low, int high) {
      return (static_cast<std::uint32_t>(low) & 0xFFFF) | static_cast<std::uint32_t>(high) << 16;
    };
    return {opt,
            source,
            acnt | bcnt << 16,
            destination,
            pair(source_b, destination_b),
            link | reload << 16,
            pair(source_c, destination_c),
            ccnt};
  }
};

constexpr std::array<std::uint32_t, 8> kNullLinked{0, 0, 0, 0, 0, 0xFFFF, 0, 0};

struct ChannelBench : testing::Test, ChannelController::Host {
  struct Submitted {
    unsigned controller;
    TransferRequest request;
  };
  EdmaRegs regs{7};
  ChannelController core{regs, *this};
  std::array<bool, 4> ready{true, true, true, true};
  std::vector<Submitted> submitted;
  std::array<int, 4> completion_pulses{};
  int error_pulses = 0, wakes = 0;
  std::vector<std::string> warnings;

  bool can_submit(unsigned controller) const override { return ready.at(controller); }
  void submit(unsigned controller, const TransferRequest& r) override {
    submitted.push_back({controller, r});
  }
  bool forms = false;  // CCSTAT.TRACTV
  bool forms_request() const override { return forms; }
  void pulse_completion(unsigned region) override { ++completion_pulses.at(region); }
  void pulse_error() override { ++error_pulses; }
  void work_arrived() override { ++wakes; }
  std::uint64_t enabled = 0;  // events, since the test cleared it
  void events_enabled(std::uint64_t events) override { enabled |= events; }
  void warn(const std::string& what) override { warnings.push_back(what); }

  void write(std::uint32_t offset, std::uint32_t value) {
    ASSERT_EQ(regs.write(offset, 4, value), Access::kOk) << std::hex << offset;
  }
  std::uint32_t read(std::uint32_t offset) {
    std::uint32_t v = 0xDEADBEEF;
    EXPECT_EQ(regs.read(offset, 4, v), Access::kOk) << std::hex << offset;
    return v;
  }
  /// A register of the global region.
  void put(std::uint32_t offset, std::uint32_t value) { write(kGlobal + offset, value); }
  std::uint32_t get(std::uint32_t offset) { return read(kGlobal + offset); }

  void fill(unsigned set, const Set& value) {
    const auto words = value.words();
    for (unsigned w = 0; w < 8; ++w) write(kPaRam + 32 * set + 4 * w, words[w]);
  }
  std::array<std::uint32_t, 8> words(unsigned set) {
    std::array<std::uint32_t, 8> out;
    for (unsigned w = 0; w < 8; ++w) out[w] = read(kPaRam + 32 * set + 4 * w);
    return out;
  }
  /// All that is possible at time 0: events enter queues, heads are served.
  void run() {
    for (int i = 0; i < 10'000; ++i) {
      const bool queued = core.prioritise(0), served = core.process(0);
      if (!queued && !served) return;
    }
    ADD_FAILURE() << "the controller does not come to rest";
  }
  void queue_all() {
    for (int i = 0; core.prioritise(0); ++i) ASSERT_LT(i, 100);
  }
  void trigger(unsigned channel) { put(channel < 32 ? kEsr : kEsr + 4, 1u << channel % 32); }
  void trigger_and_run(unsigned channel) {
    trigger(channel);
    run();
  }
  const TransferRequest& last() { return submitted.back().request; }
  void map_qdma(unsigned channel, unsigned set, unsigned word) {
    write(kQchmap0 + 4 * channel, set << 5 | word << 2);
    put(kQeesr, 1u << channel);
  }
};

}  // namespace fovea::dma
