// Reset values, set and clear registers, shadow regions and status: SPRUEE4A and SPRUH82C, "EDMA3
// Channel Controller Control Registers".
#include "tb/dma/channel_bench.h"

namespace fovea::dma {
namespace {

struct DmaRegisters : ChannelBench {};

TEST_F(DmaRegisters, ResetValues) {
  EXPECT_EQ(read(kCccfg), 0x0023'4445u);
  EXPECT_EQ(read(kQuetcmap), 0x3210u);
  EXPECT_EQ(read(kQuepri), 0x7777u);
  EXPECT_EQ(read(kQwmthra), 0x1010'1010u);
  for (const Reg* r : regs.regs()) {
    const std::uint32_t o = r->offset();
    if (o == kCccfg || o == kQuetcmap || o == kQuepri || o == kQwmthra) continue;
    EXPECT_EQ(read(o), 0u) << r->name();
  }
  EXPECT_EQ(EdmaRegs(3).quepri.get(), 0x3333u);
}

/// CCCFG as Linux, drivers/dma/ti/edma.c, decodes it.
TEST_F(DmaRegisters, ConfigurationDescribesTheController) {
  const std::uint32_t v = read(kCccfg);
  EXPECT_EQ(1u << ((v & 7) + 1), 64u);         // DMA channels
  EXPECT_EQ((v >> 4 & 7) * 2, 8u);             // QDMA channels
  EXPECT_EQ(1u << ((v >> 12 & 7) + 4), 256u);  // parameter sets
  EXPECT_EQ((v >> 16 & 7) + 1, 4u);            // queues
  EXPECT_EQ(1u << (v >> 20 & 3), 4u);          // regions
  EXPECT_EQ(v >> 24 & 1, 0u);                  // no mapping of channels to sets
  write(kCccfg, 0);
  EXPECT_EQ(read(kCccfg), v);
}

/// Offsets that hold nothing on a controller without memory protection and channel mapping.
TEST_F(DmaRegisters, NothingElseAnswers) {
  std::uint32_t v;
  for (std::uint32_t o :
       {0x000u, 0x008u, 0x100u, 0x220u, 0x264u, 0x324u, 0x360u, 0x390u, 0x500u, 0x610u, 0x624u,
        0x644u, 0x800u, 0x1048u, 0x1098u, 0x2098u, 0x2800u, 0x6000u})
    EXPECT_EQ(regs.read(o, 4, v), Access::kNoRegister) << std::hex << o;
}

TEST_F(DmaRegisters, PaRamTakesAnyAccess) {
  for (std::uint32_t set : {0u, 1u, 255u})
    for (std::uint32_t w = 0; w < 8; ++w) {
      const std::uint32_t at = kPaRam + 32 * set + 4 * w;
      write(at, 0xA5A5'0000 + 8 * set + w);
      EXPECT_EQ(read(at), 0xA5A5'0000 + 8 * set + w);
    }
  EXPECT_EQ(regs.write(kPaRam + 10, 2, 7), Access::kOk);  // BCNT alone
  EXPECT_EQ(read(kPaRam + 8), 0x0007'0002u);
}

TEST_F(DmaRegisters, ReservedBitsOfMapsReadZero) {
  for (unsigned i = 0; i < 8; ++i) {
    write(kQchmap0 + 4 * i, ~0u);
    EXPECT_EQ(read(kQchmap0 + 4 * i), 0x3FFCu);
    write(kDmaqnum0 + 4 * i, ~0u);
    EXPECT_EQ(read(kDmaqnum0 + 4 * i), 0x7777'7777u);
  }
  write(kQdmaqnum, ~0u);
  EXPECT_EQ(read(kQdmaqnum), 0x7777'7777u);
  write(kQuetcmap, ~0u);
  EXPECT_EQ(read(kQuetcmap), 0x7777u);
  write(kQwmthra, ~0u);
  EXPECT_EQ(read(kQwmthra), 0x1F1F'1F1Fu);
}

/// Registers where a write of 1 to `set` sets and to `clear` clears a bit of `shown`; 0 changes
/// nothing.
struct Pair {
  const char* name;
  std::uint32_t shown, set, clear;
  bool two;  ///< low and high half
};
constexpr Pair kPairs[] = {{"EER", kEer, kEesr, kEecr, true},
                           {"IER", kIer, kIesr, kIecr, true},
                           {"QEER", kQeer, kQeesr, kQeecr, false}};

TEST_F(DmaRegisters, SetAndClearPairs) {
  for (const Pair& p : kPairs)
    for (std::uint32_t half : {0u, 4u}) {
      if (half && !p.two) continue;
      const std::uint32_t all = p.two ? ~0u : 0xFFu;
      put(p.set + half, 0x8000'0041);
      EXPECT_EQ(get(p.shown + half), 0x8000'0041 & all) << p.name;
      put(p.set + half, 0x12);
      EXPECT_EQ(get(p.shown + half), 0x8000'0053 & all) << p.name;
      put(p.clear + half, 0x8000'0050);
      EXPECT_EQ(get(p.shown + half), 0x03u) << p.name;
      put(p.shown + half, 0xFF);  // read only
      EXPECT_EQ(get(p.shown + half), 0x03u) << p.name;
      if (p.two) {
        EXPECT_EQ(get(p.shown + 4 - half), half ? 0x03u : 0u) << p.name;
      }
      EXPECT_EQ(get(p.set + half) | get(p.clear + half), 0u) << p.name;
    }
}

TEST_F(DmaRegisters, ClearRegistersOfWhatHardwareSets) {
  const auto check = [&](RegPair& pair, std::uint32_t shown, std::uint32_t clear) {
    for (std::uint32_t half : {0u, 4u}) {
      pair.set(0xFFFF'0000'FFFF'0000);
      write(clear + half, 0xF00F'000F);
      EXPECT_EQ(read(shown + half), 0x0FF0'0000u) << std::hex << shown;
      EXPECT_EQ(read(shown + 4 - half), 0xFFFF'0000u) << std::hex << shown;
      EXPECT_EQ(read(clear + half), 0u);
    }
    pair.set(0);
  };
  ChannelRegs& g = regs.global;
  check(g.er, kGlobal + kEr, kGlobal + kEcr);
  check(g.ser, kGlobal + kSer, kGlobal + kSecr);
  check(g.ipr, kGlobal + kIpr, kGlobal + kIcr);
  check(regs.emr, kEmr, kEmcr);
  regs.qemr.set(0xFF);
  write(kQemcr, 0x3C);
  EXPECT_EQ(read(kQemr), 0xC3u);
}

/// A DMA channel of each half and a QDMA channel, inside the region and outside.
struct Shadow : ChannelBench, testing::WithParamInterface<unsigned> {
  const std::uint32_t base = kShadow0 + 0x200 * GetParam();
  void SetUp() override {
    write(kDrae0 + 8 * GetParam(), 0x0000'F0F0);
    write(kDrae0 + 8 * GetParam() + 4, 0x00FF'0000);
    write(kQrae0 + 4 * GetParam(), 0x0F);
  }
};
INSTANTIATE_TEST_SUITE_P(Regions, Shadow, testing::Range(0u, 4u));

TEST_P(Shadow, ReadsShowTheRegionsOwn) {
  ChannelRegs& g = regs.global;
  const std::tuple<std::uint32_t, RegPair*> all[] = {{kEr, &g.er},   {kEsr, &g.esr}, {kCer, &g.cer},
                                                     {kEer, &g.eer}, {kSer, &g.ser}, {kIer, &g.ier},
                                                     {kIpr, &g.ipr}};
  for (const auto& [offset, pair] : all) {
    pair->set(~0ull);
    EXPECT_EQ(read(base + offset), 0x0000'F0F0u) << std::hex << offset;
    EXPECT_EQ(read(base + offset + 4), 0x00FF'0000u) << std::hex << offset;
    const std::uint32_t other = kShadow0 + 0x200 * ((GetParam() + 1) % 4);
    EXPECT_EQ(read(other + offset) | read(other + offset + 4), 0u) << std::hex << offset;
    EXPECT_EQ(get(offset), ~0u);
    pair->set(0);
    EXPECT_EQ(read(base + offset), 0u);
  }
  for (auto [offset, reg] : {std::pair{kQer, &g.qer}, {kQeer, &g.qeer}, {kQser, &g.qser}}) {
    reg->set(0xFF);
    EXPECT_EQ(read(base + offset), 0x0Fu) << std::hex << offset;
    reg->set(0);
  }
}

TEST_P(Shadow, WritesReachTheRegionsOwn) {
  ChannelRegs& g = regs.global;
  const std::pair<std::uint32_t, RegPair*> setters[] = {
      {kEsr, &g.esr}, {kEesr, &g.eer}, {kIesr, &g.ier}};
  for (const auto& [offset, pair] : setters) {
    write(base + offset, ~0u);
    EXPECT_EQ(pair->get(), 0xF0F0u) << std::hex << offset;
    write(base + offset + 4, ~0u);
    EXPECT_EQ(pair->get(), 0x00FF'0000'0000'F0F0u) << std::hex << offset;
    pair->set(0);
  }
  const std::pair<std::uint32_t, RegPair*> clearers[] = {
      {kEcr, &g.er}, {kEecr, &g.eer}, {kSecr, &g.ser}, {kIecr, &g.ier}, {kIcr, &g.ipr}};
  for (const auto& [offset, pair] : clearers) {
    pair->set(~0ull);
    write(base + offset, ~0u);
    EXPECT_EQ(pair->get(), 0xFFFF'FFFF'FFFF'0F0Fu) << std::hex << offset;
    write(base + offset + 4, ~0u);
    EXPECT_EQ(pair->get(), 0xFF00'FFFF'FFFF'0F0Fu) << std::hex << offset;
    pair->set(0);
  }
  write(base + kQeesr, 0xFF);
  EXPECT_EQ(get(kQeer), 0x0Fu);
  put(kQeesr, 0xFF);
  write(base + kQeecr, 0xFF);
  EXPECT_EQ(get(kQeer), 0xF0u);
  g.qer.set(0xFF);
  g.qser.set(0xFF);
  write(base + kQsecr, 0xFF);
  EXPECT_EQ(get(kQer), 0xF0u);
  EXPECT_EQ(get(kQser), 0xF0u);
}

TEST_P(Shadow, ManualTriggersOfOthersAreNotMissed) {
  put(kEsr, 0xF);
  write(base + kEsr, ~0u);
  EXPECT_EQ(read(kEmr), 0u);
  write(base + kEsr, ~0u);
  EXPECT_EQ(read(kEmr), 0xF0F0u);
}

TEST_F(DmaRegisters, StatusTellsWhatIsPending) {
  EXPECT_EQ(read(kCcstat), 0u);
  core.event(5);
  EXPECT_EQ(read(kCcstat), 0u);  // not enabled
  put(kEesr, 1u << 5);
  EXPECT_EQ(read(kCcstat), 1u << 4 | 1u);
  ready.fill(false);
  write(kDmaqnum0, 2u << 20);
  queue_all();
  EXPECT_EQ(read(kCcstat), 1u << 18 | 1u << 4);
  map_qdma(0, 130, 7);
  fill(130, {});
  EXPECT_EQ(read(kCcstat), 1u << 18 | 1u << 4 | 1u << 1);
  queue_all();
  EXPECT_EQ(read(kCcstat), 1u << 18 | 1u << 16 | 1u << 4);
  ready.fill(true);
  fill(5, {.opt = kTcinten});
  run();
  EXPECT_EQ(read(kCcstat), 1u << 8 | 1u << 4);
  core.completed(last());
  EXPECT_EQ(read(kCcstat), 0u);
  forms = true;
  EXPECT_EQ(read(kCcstat), 1u << 2 | 1u << 4);
}

TEST_F(DmaRegisters, ResetForgetsQueuesAndCodes) {
  fill(5, {.opt = kTcinten});
  trigger_and_run(5);
  ready.fill(false);
  trigger(6);
  queue_all();
  regs.reset();
  core.reset();
  EXPECT_EQ(core.next_turn(), kNever);
  EXPECT_EQ(read(kCcstat), 0u);
  EXPECT_EQ(read(kQstat0), 0u);
  ready.fill(true);
  run();
  EXPECT_EQ(submitted.size(), 1u);
  fill(7, {});
  trigger_and_run(7);
  EXPECT_EQ(submitted.size(), 2u);
  EXPECT_EQ(read(kQ0e0), 1u << 6 | 7);  // from entry 0 on again
}

}  // namespace
}  // namespace fovea::dma
