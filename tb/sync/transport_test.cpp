// What masters and slaves of the crossbar see on their TLM sockets: the times that a call names, and the way of
// a request that a slave has no room for yet.
#include <gtest/gtest.h>

#include <deque>
#include <string>

#include "model/bus/lookahead_initiator.h"
#include "model/common/burst_master.h"
#include "tb/sync/in_child.h"
#include "tb/sync/memory_system.h"
#include "tb/sync/reader.h"

namespace fovea::sync {
namespace {

constexpr std::uint32_t kSdram = 0x8000'0000, kRegisters = 0x01C0'0000;

/// Passes requests on and notes when they were put on the port and what was said of their time.
class Between : public sc_core::sc_module, public MemTargetIf, public MemInitiatorIf {
 public:
  MemTargetSocket<32> in{"in"};
  MemInitiatorSocket<32> out{"out"};
  Picoseconds called = 0, said = 0, issued = 0;
  explicit Between(sc_core::sc_module_name name) : sc_module(name) {
    in.bind(*this);
    out.bind(*this);
  }
  tlm::tlm_sync_enum nb_transport_fw(MemRequest& r, MemPhase& phase, sc_core::sc_time& delay) override {
    called = kernel_time();
    said = delay.value();
    issued = r.issued;
    return out->nb_transport_fw(r, phase, delay);
  }
  tlm::tlm_sync_enum nb_transport_bw(MemRequest& r, MemPhase& phase, sc_core::sc_time& delay) override {
    return in->nb_transport_bw(r, phase, delay);
  }
};

/// When the call that puts the read on its port came, how much later the request is there by its delay, and
/// when it is there.
std::string transported(Picoseconds at, Picoseconds early) {
  MemorySystem system({}, false, Frequency(250'000'000), Frequency(125'000'000));
  Reader reader("reader", kSdram, at, early);
  Between between("between");
  reader.path(system.scr.path);
  reader.sockets[0]->bind(between.in);
  between.out.bind(*system.scr.target[index(Master::kEdmaTc1Read)]);
  sc_core::sc_start(ps_time(20 * kPsPerUs));
  if (!reader.first) return "no read";
  return std::to_string(between.called) + " + " + std::to_string(between.said) + " = " +
         std::to_string(between.issued);
}

// A port's annotated delay is what TLM-2.0 means by it: the request is there so much after the call.
TEST(TransportTest, TheDelayOfARequestIsTheTimeUntilItIsOnThePort) {
  EXPECT_EQ(in_child(0, [] { return transported(10'000'100, 0); }), "10000100 + 0 = 10000100");
  EXPECT_EQ(in_child(0, [] { return transported(10'000'100, 70); }), "10000030 + 70 = 10000100");
}

/// A slave whose input is taken for `kBusy` after each request, and which answers `kAnswer` after it came.
class SlowSlave : public sc_core::sc_module, public MemTargetIf {
 public:
  static constexpr Picoseconds kBusy = 400'000, kAnswer = 3'000'000;
  MemTargetSocket<32> socket{"socket"};
  std::string came;
  bool fails = false;  ///< each request ends in an error, a read with something in its data
  explicit SlowSlave(sc_core::sc_module_name name) : sc_module(name) {
    socket.bind(*this);
    SC_HAS_PROCESS(SlowSlave);
    SC_METHOD(accept);
    sensitive << accept_.event();
    dont_initialize();
    SC_METHOD(answer);
    sensitive << answer_.event();
    dont_initialize();
  }
  tlm::tlm_sync_enum nb_transport_fw(MemRequest& r, MemPhase&, sc_core::sc_time& delay) override {
    const Picoseconds at = kernel_time() + delay.value();
    came += (came.empty() ? "" : " ") + std::to_string(at / 1000);
    requests_.push_back({&r, at + kAnswer});
    if (requests_.size() == 1) answer_.at(at + kAnswer);
    waiting_ = &r;
    accept_.at(at + kBusy);
    return tlm::TLM_ACCEPTED;
  }

 private:
  void accept() {
    MemPhase phase = MemPhase::kAccepted;
    sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
    socket->nb_transport_bw(*waiting_, phase, delay);
  }
  void answer() {
    MemRequest& r = *requests_.front().first;
    requests_.pop_front();
    if (!requests_.empty()) answer_.at(requests_.front().second);
    r.error = fails;
    if (fails && !r.write) std::fill_n(r.data, r.bytes, std::uint8_t{0xEE});
    MemPhase phase = MemPhase::kResponse;
    sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
    socket->nb_transport_bw(r, phase, delay);
  }
  std::deque<std::pair<MemRequest*, Picoseconds>> requests_;
  MemRequest* waiting_ = nullptr;
  Timer accept_, answer_;
};

/// A crossbar with the slow slave where the registers are.
struct SlowBoard {
  explicit SlowBoard(bool strict) : scr("scr", params, ddr, {}, strict) {
    for (std::size_t i = 0; i < kMasterCount; ++i) scr.priority[i](priority[i]);
    scr.clk(clock);
    scr.config_socket.bind(slave.socket);
  }
  bus::CrossbarParams params;
  mem::DdrParams ddr;
  bus::Scr scr;
  ClockSignal clock{"clock", Frequency(125'000'000)};
  sc_core::sc_vector<sc_core::sc_signal<std::uint32_t>> priority{"priority", kMasterCount};
  SlowSlave slave{"slave"};
};

/// When the slave got the requests of two masters, in nanoseconds.
std::string at_a_slow_slave(bool strict) {
  SlowBoard board(strict);
  BurstMaster one("one", Master::kEdmaTc0Read, 1), two("two", Master::kEdmaTc1Read, 1);
  one.socket.bind(*board.scr.target[index(Master::kEdmaTc0Read)]);
  two.socket.bind(*board.scr.target[index(Master::kEdmaTc1Read)]);
  std::string done;
  one.on_done = [&](const auto& c) { done += " one " + std::to_string(c.last / 1000); };
  two.on_done = [&](const auto& c) { done += " two " + std::to_string(c.last / 1000); };
  sc_core::sc_start(ps_time(100'000));
  one.read(kRegisters, 4);
  two.read(kRegisters + 4, 4);
  sc_core::sc_start(ps_time(10 * kPsPerUs));
  return board.slave.came + done;
}

/// What a master gets of a read and of a write that fail.
std::string failed_data() {
  SlowBoard board(true);
  board.slave.fails = true;
  BurstMaster reader("reader", Master::kEdmaTc0Read, 1), writer("writer", Master::kEdmaTc0Write, 1);
  reader.socket.bind(*board.scr.target[index(Master::kEdmaTc0Read)]);
  writer.socket.bind(*board.scr.target[index(Master::kEdmaTc0Write)]);
  std::string done;
  const auto note = [&](const BurstMaster::Completion& c) {
    done += c.write ? " written" : " read";
    for (const std::uint8_t byte : c.data) done += " " + std::to_string(byte);
    if (c.error) done += " error";
  };
  reader.on_done = writer.on_done = note;
  const std::array<std::uint8_t, 4> data{1, 2, 3, 4};
  sc_core::sc_start(ps_time(100'000));
  reader.read(kRegisters, 4);
  writer.write(kRegisters + 4, data);
  sc_core::sc_start(ps_time(10 * kPsPerUs));
  return done;
}

// A slave may have put something there before it found the error.
TEST(TransportTest, AReadThatFailsHasZerosForData) {
  EXPECT_EQ(in_child(0, failed_data), " read 0 0 0 0 error written 1 2 3 4 error");
}

/// Decisions that are left when all up to the present time were asked for, at the time of the next one.
std::string settled() {
  MemorySystem system({}, true, Frequency(250'000'000), Frequency(125'000'000));
  BurstMaster one("one", Master::kEdmaTc0Read, 1);
  one.socket.bind(*system.scr.target[index(Master::kEdmaTc0Read)]);
  sc_core::sc_start(ps_time(100'000));
  one.read(kSdram, 16);
  unsigned times = 0, wrong = 0;
  for (Picoseconds next; times < 20 && (next = system.scr.memory().next_event()) != kNever; ++times) {
    if (next > kernel_time()) sc_core::sc_start(ps_time(next - kernel_time()));
    system.scr.settle();
    wrong += system.scr.memory().next_event() <= kernel_time();
  }
  return std::to_string(wrong) + " of " + std::to_string(times);
}

// What is decided at the present time is part of the figures of the present time.
TEST(TransportTest, SettlingTakesTheDecisionsOfThePresentTime) {
  const std::string result = in_child(0, settled);
  EXPECT_TRUE(result.starts_with("0 of ")) << result;
  EXPECT_NE(result, "0 of 0");
}

// The second request follows when the slave has room, not when it has answered the first.
TEST(TransportTest, ASlaveThatHasNoRoomGetsTheNextRequestWhenItHas) {
  const std::string strict = in_child(0, [] { return at_a_slow_slave(true); });
  EXPECT_EQ(strict, in_child(0, [] { return at_a_slow_slave(false); }));
  // Granted at the edge (each 8 ns) behind the 528 ns at which there is room, there one later; the outcome takes
  // two edges back.
  EXPECT_EQ(strict, "128 544 one 3144 two 3560");
}

}  // namespace
}  // namespace fovea::sync

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
