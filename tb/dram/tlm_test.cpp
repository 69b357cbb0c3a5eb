// An initiator and a target written from the TLM-2.0 standard alone work on the memory system: right
// data, and times that are counted by hand here, alike in default and in strict synchronisation.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <string>

#include "model/bus/scr.h"
#include "model/bus/tlm_master_port.h"
#include "model/bus/tlm_slave_port.h"
#include "model/common/end_of_instant.h"
#include "model/mem/ddr_module.h"
#include "tb/dram/bench.h"
#include "tb/dram/foreign.h"

namespace fovea::dram {
namespace {

constexpr std::uint32_t kSdram = 0x8000'0000, kRam = 0x1'0000;
constexpr std::size_t kRamBytes = 0x1000;
constexpr std::uint64_t kLatency = 37;  // of the target, ns

/// No other slave answers: what goes to registers is refused. The SDRAM controller's are written directly.
struct NoRegisters : sc_core::sc_module, MemTargetIf {
  MemTargetSocket<32> socket{"socket"};
  tlm_utils::simple_initiator_socket<NoRegisters> sdram{"sdram"};
  explicit NoRegisters(sc_core::sc_module_name name) : sc_module(name) { socket.bind(*this); }
  tlm::tlm_sync_enum nb_transport_fw(MemRequest&, MemPhase&, sc_core::sc_time&) override {
    return tlm::TLM_COMPLETED;
  }
};

/// Sends requests with annotated delays to a slave port by itself, and notes when each answer comes.
struct DirectMaster : sc_core::sc_module, MemInitiatorIf {
  struct Access {
    std::uint64_t at, delay;  // ns
    std::uint32_t address;
    std::uint64_t answered = 0;  // ps
    bool error = false;
  };
  MemInitiatorSocket<32> socket{"socket"};
  std::vector<Access> accesses;

  SC_HAS_PROCESS(DirectMaster);
  explicit DirectMaster(sc_core::sc_module_name name) : sc_module(name) {
    socket.bind(*this);
    SC_THREAD(run);
  }

 private:
  void run() {
    requests_.resize(accesses.size());
    for (std::size_t i = 0; i < accesses.size(); ++i) {
      const sc_core::sc_time at(static_cast<double>(accesses[i].at), sc_core::SC_NS);
      if (at > sc_core::sc_time_stamp()) wait(at - sc_core::sc_time_stamp());
      requests_[i].address = accesses[i].address;
      requests_[i].bytes = 4;
      requests_[i].data = data_;
      MemPhase phase = MemPhase::kRequest;
      sc_core::sc_time delay(static_cast<double>(accesses[i].delay), sc_core::SC_NS);
      socket->nb_transport_fw(requests_[i], phase, delay);
    }
  }
  tlm::tlm_sync_enum nb_transport_bw(MemRequest& r, MemPhase& phase, sc_core::sc_time&) override {
    Access& a = accesses[static_cast<std::size_t>(&r - requests_.data())];
    if (phase == MemPhase::kResponse) a.answered = sc_core::sc_time_stamp().value();
    a.error = r.error;
    return tlm::TLM_ACCEPTED;
  }
  std::vector<MemRequest> requests_;
  std::uint8_t data_[4] = {};
};

/// Crossbar at 100 MHz, SDRAM at 200 MHz: edges at whole 10 and 5 ns.
struct Board {
  bus::CrossbarParams xbar_params;
  mem::DdrParams ddr_params;
  bus::Scr scr;
  mem::DdrModule ddr{"ddr", ddr_params, scr.memory()};
  NoRegisters registers{"registers"};
  bus::TlmMasterPort port{"port", Master::kLoad};
  bus::TlmSlavePort slave{"slave"};
  foreign::AtInitiator initiator{"initiator"};
  foreign::LtTarget target{"target", kRamBytes, sc_core::sc_time(kLatency, sc_core::SC_NS)};
  DirectMaster direct{"direct"};
  bus::TlmSlavePort direct_slave{"direct_slave"};
  foreign::LtTarget direct_target{"direct_target", kRamBytes, sc_core::sc_time(kLatency, sc_core::SC_NS)};
  ClockSignal ddr_clk{"ddr_clk", Frequency(200'000'000)}, scr_clk{"scr_clk", Frequency(100'000'000)};
  sc_core::sc_signal<bool> on{"on", true};
  sc_core::sc_vector<sc_core::sc_signal<std::uint32_t>> priority{"priority", kMasterCount};

  explicit Board(bool strict)
      : scr("scr", xbar_params, ddr_params, {.ram_size = 2 * kRamBytes}, strict) {
    scr.clk(scr_clk);
    scr.config_socket.bind(registers.socket);
    registers.sdram.bind(ddr.reg_socket);
    scr.ram_socket.bind(slave.memory);
    ddr.ddr_clk(ddr_clk);
    ddr.scr_clk(scr_clk);
    ddr.enabled(on);
    for (std::size_t i = 0; i < kMasterCount; ++i) scr.priority[i](priority[i]);
    port.memory().bind(*scr.target[index(Master::kLoad)]);
    initiator.socket.bind(port.socket);
    slave.socket.bind(target.socket);
    direct.socket.bind(direct_slave.memory);
    direct_slave.socket.bind(direct_target.socket);
    ddr.regs.write(0x0C, 4, 1560);        // a refresh each 7.8 us
    ddr.regs.write(0x08, 4, 0x00D34A32);
    ddr.regs.write(0x08, 4, 0x00534A32);  // as the boot loader ends the initialisation
  }
  void job(std::uint64_t ns, tlm::tlm_command command, std::uint64_t address, unsigned bytes) {
    foreign::Job j;
    j.at = sc_core::sc_time(static_cast<double>(ns), sc_core::SC_NS);
    j.command = command;
    j.address = address;
    j.data.assign(bytes, 0xA5);
    initiator.jobs.push_back(j);
  }
};

enum : unsigned { kShortWrite, kLongWrite, kOpen, kRead, kTargetRead, kTargetWaits, kOutside, kNowhere,
                  kEnables, kIgnored, kTimed };
constexpr unsigned kRandom = 400;

std::vector<DirectMaster::Access> direct;

/// Runs the whole program. @return a line for each transaction, then what is wrong
std::string simulate(bool strict, std::vector<std::uint64_t>& ends, unsigned& read_clocks) {
  Board b(strict);
  constexpr auto kRd = tlm::TLM_READ_COMMAND, kWr = tlm::TLM_WRITE_COMMAND;
  b.job(1'003, kWr, kSdram + 8, 8);
  b.job(2'003, kWr, kSdram + 64, 64);
  b.job(3'003, kRd, kSdram + 0x10'0000, 8);  // opens the row
  b.job(4'003, kRd, kSdram + 0x10'0008, 8);
  b.job(5'003, kRd, kRam + 4, 4);
  b.job(6'003, kRd, kRam + 4, 4);
  b.job(6'503, kRd, kRam + kRamBytes, 4);
  b.job(7'003, kRd, 0x0200'0000, 4);
  b.job(7'503, kRd, kSdram, 4);
  b.initiator.jobs.back().byte_enables = true;
  b.job(7'603, tlm::TLM_IGNORE_COMMAND, kSdram, 4);
  // The second is sent while the first is served, and comes after its end; the third comes while the second is
  // served; the fourth is no word of the target; the fifth comes to an idle port, 5 ns after it was sent.
  b.direct.accesses = {{1'000, 0, 0}, {1'010, 100, 4}, {1'010, 110, 8}, {1'200, 0, kRamBytes}, {1'300, 5, 0}};
  std::map<std::uint64_t, std::uint8_t> shadow;
  std::vector<std::vector<unsigned char>> expected(kTimed);
  Rng rng(7);
  for (unsigned i = 0; i < kRandom; ++i) {
    const std::uint64_t base = rng.below(3) ? kSdram + 0x4000 : kRam;
    const auto bytes = static_cast<unsigned>(1 + rng.below(200));
    const std::uint64_t address = base + rng.below(0x400);
    const bool write = rng.below(2);
    b.job(10'000 + 50 * i, write ? kWr : kRd, address, bytes);
    b.initiator.jobs.back().ends_at_once = i % 3 == 2;
    auto& data = b.initiator.jobs.back().data;
    expected.emplace_back();
    for (unsigned k = 0; k < bytes; ++k) {
      if (write) data[k] = static_cast<unsigned char>(rng.below(256));
      if (write) shadow[address + k] = data[k];
      expected.back().push_back(shadow[address + k]);
    }
  }
  sc_core::sc_start(1, sc_core::SC_MS);
  std::string record;
  unsigned wrong = 0;
  for (std::size_t i = 0; i < b.initiator.jobs.size(); ++i) {
    const foreign::Job& j = b.initiator.jobs[i];
    ends.push_back(j.begin_resp.value() / 1'000);
    record += std::to_string(j.end_req.value()) + ' ' + std::to_string(j.begin_resp.value()) + ' ' +
              std::to_string(j.status) + '\n';
    wrong += i >= kTimed && (j.status != tlm::TLM_OK_RESPONSE || j.data != expected[i]);
  }
  direct = b.direct.accesses;
  for (const DirectMaster::Access& a : direct)
    record += "direct " + std::to_string(a.answered) + (a.error ? " error\n" : "\n");
  const mem::DdrConfig c = b.ddr.programmed();
  read_clocks = std::max(c.read_latency, c.timing.CL) +
                static_cast<unsigned>(b.ddr_params.return_latency()) + 2;
  record += "ended " + std::to_string(b.initiator.ended) + " open " +
            std::to_string(b.initiator.not_released) + " protocol errors " +
            std::to_string(b.initiator.protocol_errors) + " wrong data " + std::to_string(wrong) + '\n';
  // Without time, over the bounds of bursts; then beyond the end of the memory.
  std::vector<unsigned char> data(150), back(150);
  for (unsigned k = 0; k < data.size(); ++k) data[k] = static_cast<unsigned char>(k + 1);
  const auto debug = [&b](tlm::tlm_command command, std::uint32_t address, std::vector<unsigned char>& bytes) {
    tlm::tlm_generic_payload p;
    p.set_command(command);
    p.set_address(address);
    p.set_data_ptr(bytes.data());
    p.set_data_length(static_cast<unsigned>(bytes.size()));
    return std::to_string(b.initiator.socket->transport_dbg(p)) + ' ';
  };
  record += "debug " + debug(kWr, kSdram + 0x9003, data);
  record += debug(kRd, kSdram + 0x9003, back);
  record += back == data ? "equal " : "different ";
  record += debug(kRd, kSdram + (1u << 31) - 16, back) + '\n';
  return record;
}

std::string records[2];  // default, strict
std::vector<std::uint64_t> ends;
unsigned read_clocks = 0;

/// The status, the last word of a line.
std::string status(unsigned line) {
  std::size_t from = 0;
  for (; line; --line) from = records[0].find('\n', from) + 1;
  const std::string text = records[0].substr(from, records[0].find('\n', from) - from);
  return text.substr(text.rfind(' ') + 1);
}
std::string word(tlm::tlm_response_status s) { return std::to_string(s); }

TEST(ForeignTlmTest, DataArriveAndPhasesFollowTheStandard) {
  const std::string n = std::to_string(kTimed + kRandom);
  EXPECT_NE(records[0].find("ended " + n + " open 0 protocol errors 0 wrong data 0\n"),
            std::string::npos)
      << records[0].substr(records[0].find("ended"));
}

TEST(ForeignTlmTest, DebugTransportMovesAllBytes) {
  EXPECT_EQ(records[0].substr(records[0].find("debug")), "debug 150 150 equal 0 \n");
}

TEST(ForeignTlmTest, StrictAndDefaultSynchronisationGiveTheSameTimes) {
  ASSERT_GT(records[0].size(), 1'000u);
  EXPECT_EQ(records[0], records[1]);
}

// Two clocks through the bridge from the first edge after the request, a clock for each 8 bytes, two
// clocks back.
TEST(ForeignTlmTest, WritesToTheSdramEndWithTheirAcknowledgement) {
  EXPECT_EQ(ends[kShortWrite], 1'010u + 20 + 10 + 20);
  EXPECT_EQ(ends[kLongWrite], 2'010u + 20 + 80 + 20);
}

// At the controller at 4040: seen at the next edge, 8 clocks through its pipeline, then RD; the data are on
// the crossbar at its first edge after they have come, and two clocks later at the port.
TEST(ForeignTlmTest, ReadOfAnOpenRowEndsWithItsData) {
  const std::uint64_t data = 4'045 + 8 * 5 + 5 * read_clocks;
  EXPECT_EQ(ends[kRead], (data / 10 + 1) * 10 + 20);
}

// There at 5040; its latency ends at 5077, whether it is annotated or waited out.
TEST(ForeignTlmTest, TargetsLatencyCountsFromTheRequestsArrival) {
  EXPECT_EQ(ends[kTargetRead], 5'080u + 20);
  EXPECT_EQ(ends[kTargetWaits], 6'080u + 20);
}

// One request is served at a time, from its own arrival or the end of the one before, whichever is later.
TEST(ForeignTlmTest, RequestsToASlaveAreServedInOrderAndNotBeforeTheyCome) {
  ASSERT_EQ(direct.size(), 5u);
  EXPECT_EQ(direct[0].answered, (1'000 + kLatency) * 1'000);
  EXPECT_EQ(direct[1].answered, (1'110 + kLatency) * 1'000);
  EXPECT_EQ(direct[2].answered, (1'110 + 2 * kLatency) * 1'000);
  EXPECT_EQ(direct[3].answered, 1'200'000u) << "refused at once";
  EXPECT_EQ(direct[4].answered, (1'305 + kLatency) * 1'000);
  for (std::size_t i = 0; i < direct.size(); ++i) EXPECT_EQ(direct[i].error, i == 3) << i;
}

TEST(ForeignTlmTest, ErrorsAreResponsesOfTheStandard) {
  EXPECT_EQ(status(kRead), word(tlm::TLM_OK_RESPONSE));
  EXPECT_EQ(status(kOutside), word(tlm::TLM_ADDRESS_ERROR_RESPONSE)) << "the target's own refusal";
  EXPECT_EQ(status(kNowhere), word(tlm::TLM_ADDRESS_ERROR_RESPONSE));
  EXPECT_EQ(status(kEnables), word(tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE));
  EXPECT_EQ(status(kIgnored), word(tlm::TLM_OK_RESPONSE));
}

/// A second elaboration in one process fails, so the strict run has a process of its own.
bool run_both() {
  int fd[2];
  if (pipe(fd) != 0) return false;
  const pid_t pid = fork();
  if (pid == 0) {
    close(fd[0]);
    std::vector<std::uint64_t> times;
    unsigned clocks = 0;
    const std::string text = simulate(true, times, clocks);
    for (std::size_t at = 0; at < text.size();) {
      const ssize_t n = write(fd[1], text.data() + at, text.size() - at);
      if (n <= 0) _exit(1);
      at += static_cast<std::size_t>(n);
    }
    _exit(0);
  }
  close(fd[1]);
  char buffer[65536];
  for (ssize_t n; (n = read(fd[0], buffer, sizeof buffer)) > 0;)
    records[1].append(buffer, static_cast<std::size_t>(n));
  close(fd[0]);
  int child = 0;
  waitpid(pid, &child, 0);
  records[0] = simulate(false, ends, read_clocks);
  return WIFEXITED(child) && WEXITSTATUS(child) == 0;
}

}  // namespace
}  // namespace fovea::dram

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (!fovea::dram::run_both()) {
    std::fprintf(stderr, "the strict run failed\n");
    return 1;
  }
  return RUN_ALL_TESTS();
}
