// The transfer controller over a memory with fixed latencies, on a clock of 8 ns: bytes, and times
// that are counted by hand. Structure: SPRUH82C, section 17.2.11.
#include "model/dma/core/transfer_controller.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <string>

namespace fovea::dma {
namespace {

constexpr Picoseconds ns(unsigned n) { return n * kPsPerNs; }
using Failure = TransferController::Failure;
using Sizes = TransferController::Sizes;

/// Reads are answered 40 ns after their issue, writes 20 ns after. The ports are always free unless
/// a test says otherwise.
struct Memory : TransferController::Host {
  struct Access {
    std::uint32_t address;
    unsigned bytes;
    unsigned at;  // ns
    bool operator==(const Access&) const = default;
  };
  friend void PrintTo(const Access& a, std::ostream* os) {
    *os << a.bytes << " bytes at " << a.address << ", " << a.at << " ns";
  }
  std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(4096);
  std::vector<Access> reads, writes;
  std::vector<unsigned> program_free_at, completed_at;  // ns
  std::vector<TransferRequest> completed_requests;
  struct Failed {
    Failure failure;
    unsigned tcc, at;
    bool operator==(const Failed&) const = default;
  };
  std::vector<Failed> failures;
  Picoseconds read_port = 0, write_port = 0;
  std::uint32_t bad_read = ~0u, bad_write = ~0u;  // addresses that no slave answers
  std::multimap<Picoseconds, std::function<void()>> events;
  unsigned ahead = 0;  // ns: outcomes are reported so much before their times, at most 20
  TransferController tc;

  explicit Memory(Sizes sizes) : tc(*this, sizes) {
    for (std::size_t i = 0; i < bytes.size(); ++i)
      bytes[i] = static_cast<std::uint8_t>(i * 7 + i / 256);
  }
  static unsigned in_ns(Picoseconds t) {
    EXPECT_EQ(t % kPsPerNs, 0u);
    return static_cast<unsigned>(t / kPsPerNs);
  }
  Picoseconds edge(Picoseconds t, unsigned clocks) const override {
    return ((t + ns(8) - 1) / ns(8) + clocks) * ns(8);
  }
  Picoseconds read_free() const override { return read_port; }
  Picoseconds write_free() const override { return write_port; }
  void read(Command c, Picoseconds at) override {
    reads.push_back({c.address, c.bytes, in_ns(at)});
    events.emplace(at + ns(40 - ahead), [this, c, at] {
      const std::vector<std::uint8_t> data(bytes.begin() + c.address,
                                           bytes.begin() + c.address + c.bytes);
      tc.read_done(data, c.address == bad_read, at + ns(40));
    });
  }
  void write(Command c, std::span<const std::uint8_t> data, Picoseconds at) override {
    writes.push_back({c.address, c.bytes, in_ns(at)});
    std::copy(data.begin(), data.end(), bytes.begin() + c.address);
    events.emplace(at + ns(20 - ahead),
                   [this, c, at] { tc.write_done(c.address == bad_write, at + ns(20)); });
  }
  void program_free(Picoseconds at) override { program_free_at.push_back(in_ns(at)); }
  void completed(const TransferRequest& r, Picoseconds at) override {
    completed_requests.push_back(r);
    completed_at.push_back(in_ns(at));
  }
  void failed(const TransferRequest& r, Failure f, Picoseconds at) override {
    failures.push_back({f, r.tcc, in_ns(at)});
  }
  void step() {
    const auto next = events.begin()->second;
    events.erase(events.begin());
    next();
  }
  void run() {
    while (!events.empty()) step();
  }
  void run_to(Picoseconds now) {
    while (!events.empty() && events.begin()->first <= now) step();
  }
};

using Accesses = std::vector<Memory::Access>;
using Times = std::vector<unsigned>;

/// One array; the addresses are far apart.
TransferRequest copy(unsigned bytes, std::uint32_t from, std::uint32_t to) {
  TransferRequest r;
  r.acnt = static_cast<std::uint16_t>(bytes);
  r.bcnt = 1;
  r.source.address = from;
  r.destination.address = to;
  return r;
}

TEST(TransferController, TwoBurstsByTheClock) {
  Memory m({32, 128, 4});
  const std::vector<std::uint8_t> source(m.bytes.begin() + 256, m.bytes.begin() + 320);
  m.tc.submit(copy(64, 256, 1024), 0);
  EXPECT_EQ(m.program_free_at, Times{8});
  EXPECT_TRUE(m.tc.idle() == false);
  m.run();
  EXPECT_EQ(m.reads, (Accesses{{256, 32, 8}, {288, 32, 16}}));
  EXPECT_EQ(m.writes, (Accesses{{1024, 32, 48}, {1056, 32, 56}}));
  EXPECT_EQ(m.completed_at, Times{76});
  EXPECT_TRUE(m.tc.idle());
  EXPECT_TRUE(std::equal(source.begin(), source.end(), m.bytes.begin() + 1024));
  EXPECT_NE(m.bytes[1023], m.bytes[255]);
  EXPECT_EQ(m.bytes[1088], static_cast<std::uint8_t>(1088 * 7 + 4));  // nothing behind it
}

// The copy above takes 76 ns; one of 4 bytes at 209 ns reads at 224, writes at 264 and ends at 284.
TEST(TransferController, BusyFromTheFirstSubmissionToTheLastAcknowledgement) {
  Memory m({32, 128, 4});
  EXPECT_EQ(m.tc.busy(ns(5)), 0u);
  m.tc.submit(copy(64, 256, 1024), 0);
  EXPECT_EQ(m.tc.busy(ns(30)), ns(30));
  m.run();
  EXPECT_EQ(m.tc.busy(ns(76)), ns(76));
  EXPECT_EQ(m.tc.busy(ns(200)), ns(76)) << "idle since";
  m.tc.submit(copy(4, 256, 1024), ns(209));
  EXPECT_EQ(m.tc.busy(ns(219)), ns(76 + 10));
  m.tc.start_count(ns(219));
  EXPECT_EQ(m.tc.busy(ns(219)), 0u);
  m.run();
  EXPECT_EQ(m.completed_at, (Times{76, 284}));
  EXPECT_EQ(m.tc.busy(ns(1000)), ns(284 - 219));
}

// Two requests that overlap count once: from the first one's submission to the second one's end.
TEST(TransferController, OverlappingRequestsAreBusyOnce) {
  Memory m({32, 128, 4});
  m.tc.submit(copy(4, 256, 1024), 0);
  m.tc.submit(copy(4, 260, 1028), ns(20));
  m.run();
  ASSERT_EQ(m.completed_at.size(), 2u);
  ASSERT_LT(20u, m.completed_at[0]);
  EXPECT_EQ(m.tc.busy(ns(500)), ns(m.completed_at[1]));
  TransferRequest refused = copy(4, 256, 1024);
  refused.source.constant = true;
  refused.source.address = 4;
  m.tc.submit(refused, ns(600));
  EXPECT_EQ(m.tc.busy(ns(700)), ns(m.completed_at[1])) << "a refused request is none";
}

TEST(TransferController, SubmissionBetweenEdgesWaitsForTheNextOne) {
  Memory m({32, 128, 4});
  m.tc.submit(copy(4, 256, 1024), ns(9));
  m.run();
  EXPECT_EQ(m.program_free_at, Times{24});
  EXPECT_EQ(m.reads, (Accesses{{256, 4, 24}}));
  EXPECT_EQ(m.writes, (Accesses{{1024, 4, 64}}));
  EXPECT_EQ(m.completed_at, Times{84});
}

TEST(TransferController, WritesWaitForAllOfTheirBytes) {
  Memory m({32, 128, 4});
  m.tc.submit(copy(64, 287, 1024), 0);  // reads of 1, 32, 31; writes of 32, 32
  m.run();
  EXPECT_EQ(m.reads, (Accesses{{287, 1, 8}, {288, 32, 16}, {320, 31, 24}}));
  EXPECT_EQ(m.writes, (Accesses{{1024, 32, 56}, {1056, 32, 64}}));
  EXPECT_EQ(m.completed_at, Times{84});
}

TEST(TransferController, ReadsWaitForRoomInTheFifo) {
  Memory m({32, 64, 4});
  m.tc.submit(copy(128, 256, 1024), 0);
  m.run();
  // Two bursts fill the FIFO. They leave it with the acknowledgements at 68 and 76.
  EXPECT_EQ(m.reads, (Accesses{{256, 32, 8}, {288, 32, 16}, {320, 32, 72}, {352, 32, 80}}));
  EXPECT_EQ(m.writes, (Accesses{{1024, 32, 48}, {1056, 32, 56}, {1088, 32, 112}, {1120, 32, 120}}));
  EXPECT_EQ(m.completed_at, Times{140});
}

/// Times are computed, so a read that is issued too late in the order of calls would have the right time and yet lie in
/// the past of the port.
TEST(TransferController, AReadIsIssuedWithTheLastOfItsRoom) {
  Memory exact({32, 64, 4});
  exact.tc.submit(copy(96, 256, 1024), 0);
  EXPECT_EQ(exact.reads, (Accesses{{256, 32, 8}, {288, 32, 16}})) << "both fill the FIFO, before anything is answered";
  while (exact.reads.size() == 2) exact.step();
  EXPECT_EQ(exact.writes.size(), 2u);
  EXPECT_TRUE(exact.completed_at.empty());
  EXPECT_EQ(exact.reads.back(), (Memory::Access{320, 32, 72})) << "with the first acknowledgement";
  EXPECT_EQ(exact.events.size(), 2u) << "before the second one";
  Memory less({32, 64, 4});
  less.tc.submit(copy(33, 287, 1024), 0);  // 1 byte, then 32
  less.tc.submit(copy(32, 512, 1024), ns(8));
  EXPECT_EQ(less.reads, (Accesses{{287, 1, 8}, {288, 32, 16}})) << "31 bytes are left";
}

TEST(TransferController, AFifoOfOneMoreBurstLetsOneMoreReadGo) {
  Memory m({32, 96, 4});
  m.tc.submit(copy(128, 256, 1024), 0);
  m.run();
  EXPECT_EQ(m.reads, (Accesses{{256, 32, 8}, {288, 32, 16}, {320, 32, 24}, {352, 32, 72}}));
  EXPECT_EQ(m.completed_at, Times{132});
}

TEST(TransferController, ReadsOfTheNextRequestBeginBeforeTheWritesOfThisOneEnd) {
  Memory m({32, 128, 4});
  m.tc.submit(copy(32, 256, 1024), 0);
  EXPECT_FALSE(m.tc.program_busy());
  m.tc.submit(copy(32, 512, 2048), ns(8));
  EXPECT_EQ(m.program_free_at, (Times{8, 24}));  // the source registers are free from 16 on
  EXPECT_EQ(m.tc.destinations(), 2u);
  m.run();
  EXPECT_EQ(m.reads, (Accesses{{256, 32, 8}, {512, 32, 24}}));
  EXPECT_EQ(m.writes, (Accesses{{1024, 32, 48}, {2048, 32, 64}}));
  EXPECT_EQ(m.completed_at, (Times{68, 84}));
}

TEST(TransferController, ARequestStaysInTheProgramRegisterWhileTheOneBeforeItReads) {
  Memory m({32, 64, 4});
  m.tc.submit(copy(96, 256, 1024), 0);
  m.tc.submit(copy(32, 512, 2048), ns(8));
  EXPECT_TRUE(m.tc.program_busy());
  EXPECT_TRUE(m.tc.source_active());
  m.run();
  EXPECT_EQ(m.program_free_at, (Times{8, 88}));  // third read at 72, source registers free at 80
  EXPECT_EQ(m.reads, (Accesses{{256, 32, 8}, {288, 32, 16}, {320, 32, 72}, {512, 32, 88}}));
}

TEST(TransferController, DestinationRegistersLimitTheRequestsUnderWay) {
  for (unsigned depth : {1u, 2u, 3u}) {
    Memory m({32, 256, depth});
    for (unsigned i = 0; i <= depth; ++i) m.tc.submit(copy(8, 256 + 64 * i, 1024 + 64 * i), ns(8));
    EXPECT_TRUE(m.tc.program_busy()) << depth;
    EXPECT_EQ(m.tc.destinations(), depth);
    m.run();
    // Reads at 16, 32, 48; the first request ends at 16 + 40 + 20 = 76; the next is loaded at 80
    // + 8.
    EXPECT_EQ(m.reads.back(), (Memory::Access{256 + 64 * depth, 8, 88})) << depth;
    EXPECT_EQ(m.completed_at.back(), 88u + 60) << depth;
    EXPECT_EQ(m.completed_at.size(), depth + 1);
  }
}

/// BCNT and ACNT as xxCNT has them.
constexpr std::uint32_t counts(std::uint32_t bcnt, std::uint32_t acnt) { return bcnt << 16 | acnt; }

// Two arrays of 40 bytes, with room for 64: reads of 32, 8 | 28, 12; writes of 32, 8 | 24, 16.
TEST(TransferController, RegisterSetsFollowTheCommands) {
  Memory m({32, 64, 4});
  TransferRequest r = copy(40, 256, 1024);
  r.bcnt = 2;
  r.source.index = 100;
  r.destination.index = 200;
  r.tcc = 9;
  const auto source = [&] {
    const RegisterSet s = m.tc.source_set();
    return std::array{s.counts(), s.reference(r.source), s.address(r.source)};
  };
  const auto target = [&] {
    const RegisterSet s = m.tc.destination_set(0);
    return std::array{s.counts(), s.reference(r.destination), s.address(r.destination)};
  };
  using Set = std::array<std::uint32_t, 3>;
  EXPECT_EQ(source(), (Set{0, 256, 256})) << "nothing yet; the reference is the argument's";
  m.tc.submit(r, 0);
  EXPECT_EQ(m.tc.program_set().counts(), counts(2, 40)) << "the program register is not counted down";
  EXPECT_EQ(source(), (Set{counts(1, 40), 356, 356}));
  EXPECT_EQ(target(), (Set{counts(2, 40), 1024, 1024}));
  m.step();  // 32 bytes are there, and written
  EXPECT_EQ(source(), (Set{counts(1, 40), 356, 356}));
  EXPECT_EQ(target(), (Set{counts(2, 8), 1024, 1056}));
  m.step();  // 8 more
  EXPECT_EQ(target(), (Set{counts(1, 40), 1224, 1224}));
  m.step();  // the first acknowledgement makes room for the rest
  EXPECT_EQ(source(), (Set{0, 356, 396}));
  EXPECT_EQ(target(), (Set{counts(1, 40), 1224, 1224}));
  m.run();
  EXPECT_EQ(source(), (Set{0, 356, 396}));
  EXPECT_EQ(target(), (Set{0, 1224, 1264}));
  EXPECT_EQ(m.tc.program_set().counts(), counts(2, 40));
  EXPECT_EQ(m.tc.source_set().request.tcc, 9u);
  m.tc.reset();
  EXPECT_EQ(m.tc.source_set().request.acnt, 0u);
  EXPECT_EQ(m.tc.destination_set(0).request.acnt, 0u);
  EXPECT_EQ(m.tc.program_set().request.acnt, 0u);
}

TEST(TransferController, DestinationRegistersAreUsedInTurn) {
  Memory m({32, 256, 2});
  const auto tcc = [&](unsigned n) { return unsigned{m.tc.destination_set(n).request.tcc}; };
  for (unsigned i = 1; i <= 3; ++i) {
    TransferRequest r = copy(64, 256, 1024 * i);
    r.tcc = static_cast<std::uint8_t>(i);
    m.tc.submit(r, 0);
    if (i == 1) {
      EXPECT_EQ(m.tc.destination_head(), 0u);
      EXPECT_EQ(tcc(1), 0u);
    }
  }
  EXPECT_EQ(m.tc.destination_head(), 0u);
  EXPECT_EQ(m.tc.destination_writing(), 0u);
  EXPECT_EQ(tcc(0), 1u);
  EXPECT_EQ(tcc(1), 2u);
  EXPECT_EQ(m.tc.program_set().request.tcc, 3u);
  while (m.writes.size() < 3) m.step();
  EXPECT_EQ(m.tc.destination_head(), 0u) << "its last acknowledgement is outstanding";
  EXPECT_EQ(m.tc.destination_writing(), 1u);
  while (m.completed_at.empty()) m.step();
  EXPECT_EQ(m.tc.destination_head(), 1u);
  EXPECT_EQ(tcc(0), 3u) << "the third takes the place of the first";
  m.run();
  EXPECT_EQ(m.tc.destination_head(), 1u);
  EXPECT_EQ(m.tc.destination_writing(), 0u) << "the third was the last";
}

/// What software would see at `now`.
std::string seen(const TransferController& tc, Picoseconds now, unsigned depth) {
  std::string s;
  const auto add = [&s](std::uint64_t n) { s += std::to_string(n) + " "; };
  const auto add_set = [&](const RegisterSet& set) {
    add(set.request.tcc);
    add(set.counts());
  };
  add(tc.program_taken(now));
  add(tc.source_active(now));
  add(tc.writing(now));
  add(tc.destinations(now));
  add(tc.destination_head(now));
  add(tc.destination_writing(now));
  add(tc.loaded(now));
  add(tc.ended(now));
  add(tc.busy(now));
  add_set(tc.source_set(now));
  for (unsigned n = 0; n < depth; ++n) add_set(tc.destination_set(n, now));
  return s;
}

/// Requests of growing size, each submitted as soon as the program register is free, then one after a pause; the
/// count of busy time begins anew in between. What is seen after each nanosecond, and the accesses.
std::string followed(Sizes sizes, unsigned ahead) {
  Memory m(sizes);
  m.ahead = ahead;
  std::string out;
  unsigned submitted = 0;
  for (unsigned t = 0; t < 2500; ++t) {
    m.run_to(ns(t));
    const bool pause = submitted == 8 && t < 1800;
    if (submitted < 10 && !pause && !m.tc.program_taken(ns(t)) &&
        (m.program_free_at.empty() || m.program_free_at.back() < t)) {
      TransferRequest r = copy(4 + 23 * submitted, 256 + 8 * submitted, 2048 + 12 * submitted);
      r.tcc = static_cast<std::uint8_t>(++submitted);
      m.tc.submit(r, ns(t));
    }
    if (t == 333) m.tc.start_count(ns(t));
    out += seen(m.tc, ns(t), sizes.depth) + "at " + std::to_string(t) + "\n";
  }
  EXPECT_EQ(m.completed_at.size(), 10u);
  for (const Accesses* a : {&m.reads, &m.writes})
    for (const Memory::Access& x : *a) out += std::to_string(x.address) + " at " + std::to_string(x.at) + "\n";
  for (const Times* times : {&m.program_free_at, &m.completed_at})
    for (const unsigned t : *times) out += std::to_string(t) + "\n";
  return out;
}

// The same accesses at the same times, and at each nanosecond the same is seen.
TEST(TransferController, OutcomesReportedAheadOfTheirTimesChangeNothing) {
  for (const Sizes& sizes : {Sizes{32, 256, 4}, Sizes{16, 128, 1}, Sizes{64, 128, 2}, Sizes{32, 128, 3}})
    for (const unsigned ahead : {1u, 7u, 19u}) {
      const std::string want = followed(sizes, 0), got = followed(sizes, ahead);
      const auto differs = std::mismatch(want.begin(), want.end(), got.begin(), got.end()).first - want.begin();
      EXPECT_TRUE(want == got) << sizes.burst << " bytes, " << ahead << " ns ahead, from: "
                               << want.substr(want.rfind('\n', static_cast<std::size_t>(differs)) + 1, 200);
    }
}

TEST(RegisterSet, ConstantAddressingGoesRoundWithinTheWidth) {
  TransferRequest r = copy(12, 0x100, 0x200);
  r.source.constant = true;
  r.fifo_bytes = 4;
  for (const auto& [left, address] : {std::pair{12u, 0x100u}, {11u, 0x101u}, {8u, 0x100u}, {6u, 0x102u}})
    EXPECT_EQ((RegisterSet{r, left}.address(r.source)), address) << left;
  EXPECT_EQ((RegisterSet{r, 6}.address(r.destination)), 0x206u);
}

// SAM 0, DAM 1, PRI 6:4, FWID 10:8, TCC 17:12, TCINTEN 20, TCCHEN 22.
TEST(RegisterSet, OptionsAndIndices) {
  TransferRequest r = copy(4, 0, 0);
  r.source.index = -2;
  r.destination.index = 0x1234;
  EXPECT_EQ((RegisterSet{r, 4}.indices()), 0x1234FFFEu);
  EXPECT_EQ((RegisterSet{r, 4}.options(0)), 0u);
  EXPECT_EQ((RegisterSet{r, 4}.options(5)), 0x50u);
  r.tcc = 0x2A;
  EXPECT_EQ((RegisterSet{r, 4}.options(0)), 0x2A000u);
  r.tcc = 0;
  r.interrupt = true;
  EXPECT_EQ((RegisterSet{r, 4}.options(0)), 0x100000u);
  r.chain = true;
  EXPECT_EQ((RegisterSet{r, 4}.options(0)), 0x500000u);
  r.interrupt = r.chain = false;
  r.destination.constant = true;
  r.fifo_bytes = 32;
  EXPECT_EQ((RegisterSet{r, 4}.options(0)), 0x502u);
  r.source.constant = true;
  EXPECT_EQ((RegisterSet{r, 4}.options(0)), 0x503u);
}

TEST(TransferController, ReadsKeepTheirInterval) {
  Memory m({32, 256, 4});
  m.tc.set_read_interval(4);
  m.tc.submit(copy(64, 256, 1024), 0);
  m.run();
  m.tc.submit(copy(8, 512, 2048), ns(44));
  m.run();
  // 4 clocks between reads, across requests too: 8, 40, 72.
  EXPECT_EQ(m.reads, (Accesses{{256, 32, 8}, {288, 32, 40}, {512, 8, 72}}));
  EXPECT_EQ(m.writes, (Accesses{{1024, 32, 48}, {1056, 32, 80}, {2048, 8, 112}}));
}

TEST(TransferController, PortsThatAreNotFreeHoldTheirBursts) {
  Memory m({32, 128, 4});
  m.read_port = ns(30);
  m.write_port = ns(90);
  m.tc.submit(copy(8, 256, 1024), 0);
  m.run();
  EXPECT_EQ(m.reads, (Accesses{{256, 8, 32}}));
  EXPECT_EQ(m.writes, (Accesses{{1024, 8, 96}}));
}

TEST(TransferController, ResumesWhenAPortIsKnownToBeFree) {
  Memory m({32, 128, 4});
  m.read_port = m.write_port = kNever;
  m.tc.submit(copy(8, 256, 1024), 0);
  m.run();
  EXPECT_TRUE(m.reads.empty());
  m.read_port = ns(100);
  m.tc.resume(0);
  m.run();
  EXPECT_EQ(m.reads, (Accesses{{256, 8, 104}}));
  EXPECT_TRUE(m.writes.empty());
  m.write_port = 0;
  m.tc.resume(0);
  m.run();
  EXPECT_EQ(m.writes, (Accesses{{1024, 8, 144}}));
  EXPECT_EQ(m.completed_at, Times{164});
}

// The port has been free for long when the clock's gate opens: nothing may be issued in the past.
TEST(TransferController, IssuesNothingBeforeTheTimeAtWhichItResumes) {
  Memory m({32, 128, 4});
  m.read_port = m.write_port = kNever;
  m.tc.submit(copy(8, 256, 1024), 0);
  m.run();
  m.read_port = m.write_port = 0;
  m.tc.resume(ns(1000));
  m.run();
  EXPECT_EQ(m.reads, (Accesses{{256, 8, 1000}}));
  EXPECT_EQ(m.writes, (Accesses{{1024, 8, 1040}}));
}

TEST(TransferController, ArraysAndIndices) {
  Memory m({32, 128, 4});
  TransferRequest r = copy(4, 256, 1024);
  r.bcnt = 3;
  r.source.index = -8;
  r.destination.index = 6;
  r.tcc = 21;
  r.interrupt = true;
  const auto before = m.bytes;
  m.tc.submit(r, 0);
  m.run();
  auto want = before;
  for (unsigned b = 0; b < 3; ++b)
    for (unsigned a = 0; a < 4; ++a) want[1024 + 6 * b + a] = before[256 - 8 * b + a];
  EXPECT_EQ(m.bytes, want);
  ASSERT_EQ(m.completed_requests.size(), 1u);
  EXPECT_EQ(m.completed_requests[0].tcc, 21u);
  EXPECT_TRUE(m.completed_requests[0].interrupt);
}

TEST(TransferController, ConstantAddressingUsesThePortAgainAndAgain) {
  Memory m({32, 128, 4});
  TransferRequest r = copy(10, 256, 1024);
  r.destination.constant = true;
  r.fifo_bytes = 4;
  const auto before = m.bytes;
  m.tc.submit(r, 0);
  m.run();
  EXPECT_EQ(m.writes, (Accesses{{1024, 4, 48}, {1024, 4, 56}, {1024, 2, 64}}));
  EXPECT_EQ(m.bytes[1024], before[264]);
  EXPECT_EQ(m.bytes[1027], before[263]);
  EXPECT_EQ(m.bytes[1028], before[1028]);
  EXPECT_TRUE(m.failures.empty());
}

TEST(TransferController, ReadErrorsAreReportedAndTheTransferGoesOn) {
  Memory m({32, 128, 4});
  m.bad_read = 288;
  TransferRequest r = copy(96, 256, 1024);
  r.tcc = 5;
  m.tc.submit(r, 0);
  m.run();
  EXPECT_EQ(m.failures, (std::vector<Memory::Failed>{{Failure::kRead, 5, 56}}));
  EXPECT_EQ(m.writes.size(), 3u);
  EXPECT_EQ(m.completed_at.size(), 1u);
  EXPECT_TRUE(m.tc.idle());
}

TEST(TransferController, WriteErrorsNameTheirRequest) {
  Memory m({32, 128, 4});
  m.bad_write = 2048;
  TransferRequest first = copy(32, 256, 1024), second = copy(32, 512, 2048);
  first.tcc = 1;
  second.tcc = 2;
  m.tc.submit(first, 0);
  m.tc.submit(second, ns(8));
  m.run();
  EXPECT_EQ(m.failures, (std::vector<Memory::Failed>{{Failure::kWrite, 2, 84}}));
  EXPECT_EQ(m.completed_at, (Times{68, 84}));
}

TEST(TransferController, ReadErrorsNameTheirRequest) {
  Memory m({32, 128, 4});
  m.bad_read = 512;
  TransferRequest first = copy(32, 256, 1024), second = copy(32, 512, 2048);
  first.tcc = 1;
  second.tcc = 2;
  m.tc.submit(first, 0);
  m.tc.submit(second, ns(8));
  m.run();
  EXPECT_EQ(m.failures, (std::vector<Memory::Failed>{{Failure::kRead, 2, 64}}));
}

struct Rules : testing::Test {
  /// Whether a request with constant addressing on one side is refused, and that nothing moves
  /// then.
  static bool refused(std::uint32_t address, int index, unsigned bcnt, bool at_source) {
    Memory m({32, 128, 4});
    TransferRequest r = copy(4, 256, 1024);
    TransferRequest::Side& side = at_source ? r.source : r.destination;
    side = {address, index, true};
    r.bcnt = static_cast<std::uint16_t>(bcnt);
    r.fifo_bytes = 4;
    r.tcc = 3;
    m.tc.submit(r, ns(1));
    m.run();
    if (m.failures.empty()) {
      EXPECT_EQ(m.completed_at.size(), 1u);
      return false;
    }
    EXPECT_EQ(m.failures, (std::vector<Memory::Failed>{{Failure::kRequest, 3, 1}}));
    EXPECT_TRUE(m.reads.empty() && m.writes.empty() && m.completed_at.empty());
    EXPECT_EQ(m.program_free_at, Times{16});
    EXPECT_TRUE(m.tc.idle());
    return true;
  }
};

TEST_F(Rules, ConstantAddressesAndIndicesAreMultiplesOf32) {
  for (bool source : {true, false}) {
    EXPECT_FALSE(refused(512, 0, 2, source));
    EXPECT_FALSE(refused(512, 64, 2, source));
    EXPECT_FALSE(refused(512, -32, 2, source));
    for (unsigned low : {1u, 4u, 16u, 31u}) EXPECT_TRUE(refused(512 + low, 0, 1, source)) << low;
    for (int index : {1, 4, 16, 31, 33, -1, -16})
      EXPECT_TRUE(refused(512, index, 2, source)) << index;
    EXPECT_FALSE(refused(512, 4, 1, source));  // one array: the index moves nothing
  }
}

TEST_F(Rules, TheOtherSideIsFree) {
  Memory m({32, 128, 4});
  TransferRequest r = copy(4, 512, 1027);
  r.source.constant = true;
  r.destination.index = 5;
  r.bcnt = 2;
  r.fifo_bytes = 4;
  m.tc.submit(r, 0);
  m.run();
  EXPECT_TRUE(m.failures.empty());
  EXPECT_EQ(m.completed_at.size(), 1u);
}

TEST_F(Rules, TheNextRequestFollowsARefusedOne) {
  Memory m({32, 128, 4});
  TransferRequest r = copy(4, 513, 1024);
  r.source.constant = true;
  m.tc.submit(r, 0);
  EXPECT_FALSE(m.tc.program_busy());
  m.tc.submit(copy(8, 256, 1024), ns(8));
  m.run();
  EXPECT_EQ(m.completed_at, Times{76});
}

/// The worst case for a FIFO of two bursts: neither side's command fits the other's.
TEST(TransferController, UnlikeAlignmentsDoNotBlockTheFifo) {
  for (unsigned burst : {16u, 32u, 64u})
    for (unsigned from = 0; from < burst; ++from)
      for (unsigned to : {0u, 1u, burst - 1}) {
        Memory m({burst, 2 * burst, 4});
        const auto before = m.bytes;
        m.tc.submit(copy(5 * burst, 256 + from, 2048 + to), 0);
        m.run();
        ASSERT_EQ(m.completed_at.size(), 1u) << burst << " " << from << " " << to;
        ASSERT_TRUE(std::equal(before.begin() + 256 + from, before.begin() + 256 + from + 5 * burst,
                               m.bytes.begin() + 2048 + to));
      }
}

TEST(TransferControllerDeathTest, AFifoTooSmallForTwoBurstsIsADefect) {
  const auto defect = testing::ExitedWithCode(4);
  EXPECT_EXIT(Memory({64, 127, 4}), defect, "two bursts do not fit");
  Memory m({32, 64, 4});
  EXPECT_EXIT(m.tc.set_burst(64), defect, "two bursts do not fit");
  Memory({64, 128, 4});
}

TEST(TransferController, TheBurstSizeIsThatOfTheLoad) {
  Memory m({32, 256, 4});
  m.tc.set_burst(64);
  m.tc.submit(copy(64, 256, 1024), 0);
  m.tc.set_burst(16);
  m.tc.submit(copy(32, 512, 2048), ns(8));
  m.run();
  EXPECT_EQ(m.reads, (Accesses{{256, 64, 8}, {512, 16, 24}, {528, 16, 32}}));
}

TEST(TransferController, ResetForgetsEverything) {
  Memory m({32, 64, 1});
  m.read_port = kNever;
  m.tc.submit(copy(64, 256, 1024), 0);
  m.tc.submit(copy(8, 256, 1024), ns(8));
  m.tc.reset();
  EXPECT_TRUE(m.tc.idle());
  m.read_port = 0;
  m.tc.submit(copy(64, 256, 1024), 0);
  m.run();
  EXPECT_EQ(m.reads, (Accesses{{256, 32, 8}, {288, 32, 16}}));
  EXPECT_EQ(m.completed_at, Times{76});
}

}  // namespace
}  // namespace fovea::dma
