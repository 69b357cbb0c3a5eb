// The core on crossbar and SDRAM controller: whose fault its stalls are, by cause and effect.
#include <functional>

#include "tb/dram/path.h"
#include "tb/iss/machine.h"

namespace fovea::dram {
namespace {

using cpu::BusAccess;
using cpu::Cause;
using cpu::Counts;

/// The core's two ports of a path, in addresses from 0, and another master that reads 64 bytes
/// every so often.
class PathPort : public cpu::BusPort {
 public:
  struct Load {
    Picoseconds every = kNever;  ///< kNever: no load
    std::uint32_t address = 0;
  } load;
  Picoseconds now = 0;
  Path path;

  PathPort(std::uint32_t, std::size_t) {
    for (auto& r : own_) r.parts = nullptr;
  }
  void attach(cpu::Background* background) { background_ = background; }
  std::uint8_t* at(std::uint32_t address) { return path.store.at(address); }
  void set_word(std::uint32_t address, std::uint32_t v) { std::memcpy(at(address), &v, 4); }
  void schedule(Picoseconds, const std::function<void()>&) {}  // nothing else acts

  void submit(BusAccess& a, Picoseconds t) override {
    play(t, nullptr, false);
    const unsigned port = a.port == BusAccess::Port::kData;
    PathRequest& r = own_[port];
    a.done = a.error = false;
    access_[port] = &a;
    r = {};
    r.master = port ? Master::kArmD : Master::kArmI;
    r.critical = a.kind == BusAccess::Kind::kWrap8 ? a.address & 31u : 0;
    r.address = a.address - r.critical;
    r.bytes = a.bytes;
    r.write = a.write;
    r.data = a.data;
    r.parts = &a.parts;
    path.submit(r, t);
  }
  bool poll(BusAccess& a, Picoseconds until) override {
    play(until, &a, false);
    return a.done && a.last <= until;
  }
  void finish(BusAccess& a) override { play(kNever, &a, true); }
  Picoseconds horizon() override { return kNever; }
  void sleep_until(Picoseconds) override {}
  Picoseconds wait_for_interrupt(Picoseconds) override { throw std::logic_error("no interrupts"); }

 private:
  /// What happens before `t`, in time order, up to the outcome of `a`.
  void play(Picoseconds t, const BusAccess* a, bool blocked) {
    while (!(a && a->done)) {
      const Picoseconds decision = path.next_decision();
      const Picoseconds act = blocked ? background_->next_act() : kNever;
      if (const Picoseconds first = std::min({decision, act, next_load()}); first >= t) return;
      if (next_load() <= std::min(decision, act)) {
        other_.address = load.address;
        other_.bytes = 64;
        other_.master = Master::kLoad;
        other_.data = other_data_;
        other_.responses = 0;
        path.submit(other_, next_load());
        load_at_ = next_load() + load.every;
        waiting_ = true;
      } else if (act <= decision) {
        background_->act();
      } else {
        path.step();
        notice();
      }
    }
  }
  Picoseconds next_load() const { return load.every == kNever || waiting_ ? kNever : load_at_; }
  void notice() {
    for (unsigned port = 0; port < 2; ++port) {
      if (!access_[port] || own_[port].responses == 0) continue;
      BusAccess& a = *access_[port];
      access_[port] = nullptr;
      a.first = own_[port].first;
      a.last = own_[port].last;
      a.done = true;
    }
    if (waiting_ && other_.responses) {
      waiting_ = false;
      load_at_ = std::max(load_at_, other_.last);
    }
  }

  PathRequest own_[2], other_;
  BusAccess* access_[2] = {};
  std::uint8_t other_data_[64];
  Picoseconds load_at_ = 0;
  bool waiting_ = false;
  cpu::Background* background_ = nullptr;
};

constexpr std::uint32_t kData = 0x0020'0000;
constexpr unsigned kLines = 100;

/// Reads one word from each of kLines lines, `stride` apart, with everything else in the caches.
struct Reader : cpu::test::MachineWith<PathPort> {
  std::vector<Counts> noted;
  /// Walks and the program itself stand aside: it lies in internal RAM, its page in the TLB. No
  /// refresh comes between.
  explicit Reader(unsigned stride, PathPort::Load load = {}, unsigned more_tRP = 0) {
    mem::DdrConfig c;
    c.refresh_interval = 0;
    c.timing.nRP += more_tRP;
    c.timing.nRC += more_tRP;
    port.path.ddr.configure(c, 0);
    port.load = load;
    on_svc = [this](std::uint32_t) { noted.push_back(core.counts()); };
    execute(std::string(cpu::test::kCachesOn) + "ldr r4, =" + std::to_string(kData) +
            "\n ldr r5, =" + std::to_string(stride) + "\n mov r6, #" + std::to_string(kLines) +
            "\n ldr r0, [r4, #-32]\n mov r12, #100\n9: subs r12, r12, #1\n bne 9b\n svc #3\n"
            "1: ldr r0, [r4], r5\n mov r12, #20\n2: subs r12, r12, #1\n bne 2b\n"
            "subs r6, r6, #1\n bne 1b\n svc #3");
  }
  std::uint64_t by(Culprit c) const { return by(index(c)); }
  std::uint64_t by(std::size_t c) const {
    return noted[1].stalls.by(Cause::kDcache, c) - noted[0].stalls.by(Cause::kDcache, c);
  }
  std::uint64_t dcache() const {
    return noted[1].stall[cpu::index(Cause::kDcache)] - noted[0].stall[cpu::index(Cause::kDcache)];
  }
};

TEST(CoreStallsTest, ALoneCoreWaitsForNoOtherMaster) {
  Reader r(32);
  EXPECT_GT(r.dcache(), 0u);
  for (std::size_t m = 0; m < kMasterCount; ++m)
    EXPECT_EQ(r.by(culprit(static_cast<Master>(m))), 0u) << kMasterNames[m];
  EXPECT_GT(r.by(Culprit::kBridge), 0u);
  EXPECT_GT(r.by(Culprit::kService), 0u);
  EXPECT_EQ(r.by(cpu::kCore), kLines * 1u) << "one clock from the AHB into the core";
  EXPECT_EQ(r.by(Culprit::kBridge) + r.by(Culprit::kService) + r.by(Culprit::kRowMiss) +
                r.by(Culprit::kRowConflict) + r.by(cpu::kCore),
            r.dcache());
}

/// The load reads where the core reads, so that it opens no other rows; it writes nothing.
TEST(CoreStallsTest, ALoadOnAnotherPortIsBlamed) {
  Reader alone(32), loaded(32, {150'000, kData});
  ASSERT_GT(loaded.by(culprit(Master::kLoad)), kLines * 2u);
  EXPECT_EQ(alone.by(culprit(Master::kLoad)), 0u);
  for (const Culprit c : {Culprit::kTurnaround, Culprit::kRefresh, culprit(Master::kArmD),
                          culprit(Master::kArmI), culprit(Master::kVpbe)})
    EXPECT_EQ(loaded.by(c), alone.by(c));
  EXPECT_EQ(loaded.by(cpu::kCore), alone.by(cpu::kCore));
  // All else moves by no more than the crossbar's and the SDRAM's edges, 8 and 4 ns, for each line.
  const std::uint64_t rest = loaded.dcache() - loaded.by(culprit(Master::kLoad));
  EXPECT_LE(rest, alone.dcache() + kLines * 3u);
  EXPECT_GE(rest + kLines * 3u, alone.dcache());
}

/// Each read closes the row of the one before.
TEST(CoreStallsTest, LongerPrechargeIsRowConflict) {
  const unsigned row = 2048 * 8;
  Reader usual(row), slow(row, {}, 2);
  ASSERT_GT(usual.by(Culprit::kRowConflict), 0u);
  // Two clocks of the SDRAM, which are two of the core; the first read may find its bank closed.
  const std::uint64_t more = slow.dcache() - usual.dcache();
  EXPECT_GE(more, 2u * (kLines - 1));
  EXPECT_LE(more, 2u * kLines);
  EXPECT_EQ(slow.by(Culprit::kRowConflict) - usual.by(Culprit::kRowConflict), more);
  EXPECT_EQ(slow.by(Culprit::kBridge), usual.by(Culprit::kBridge));
  EXPECT_EQ(slow.by(Culprit::kService), usual.by(Culprit::kService));
  Reader along_rows(32);
  EXPECT_LT(along_rows.by(Culprit::kRowConflict) * 20, usual.by(Culprit::kRowConflict));
}

}  // namespace
}  // namespace fovea::dram
