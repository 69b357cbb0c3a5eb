// A master that the table does not have: its row stands in row.inc, and all that the table gives rise to
// is compiled again with it (CMakeLists.txt). Nothing else is changed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <systemc>

#include "model/bus/wait_stats.h"
#include "model/common/block.h"
#include "model/common/burst_master.h"
#include "model/trace/core/recorder.h"
#include "tb/sync/memory_system.h"

namespace fovea::examples {
namespace {

static_assert(index(Master::kUsb) + 1 == kMasterCount, "a new master goes to the end");

constexpr unsigned kBursts = 32, kBytes = 64, kOutstanding = 4;
constexpr std::uint32_t kSdram = 0x8000'0000;

/// Writes kBursts, and then reads them back.
class UsbController : public sc_core::sc_module, public Block {
 public:
  explicit UsbController(sc_core::sc_module_name name) : sc_module(name) {
    add_master(Master::kUsb, memory_.socket, kOutstanding);
    memory_.on_done = [this](const BurstMaster::Completion& c) {
      errors += c.error;
      (c.write ? written : read) += 1;
      took[c.write] += (c.write ? c.last : c.first) - c.issued;
      if (!c.write) wrong += std::count(c.data.begin(), c.data.end(), data_of(c.address)) != kBytes;
      issue();
    };
  }
  void start() { issue(); }
  unsigned written = 0, read = 0, errors = 0, wrong = 0;
  std::array<Picoseconds, 2> took{};  // reads to their first beat, writes

 private:
  static std::uint8_t data_of(std::uint32_t address) { return static_cast<std::uint8_t>(address / kBytes); }
  void issue() {
    for (; issued_ < 2 * kBursts && memory_.can_issue(); ++issued_) {
      if (issued_ >= kBursts && written < kBursts) return;
      const std::uint32_t address = kSdram + issued_ % kBursts * kBytes;
      std::array<std::uint8_t, kBytes> data;
      data.fill(data_of(address));
      if (issued_ < kBursts) memory_.write(address, data);
      else memory_.read(address, kBytes);
    }
  }
  BurstMaster memory_{"memory", Master::kUsb, kOutstanding};
  unsigned issued_ = 0;
};

/// Crossbar and SDRAM with the new master and the display beside it, bound by what the blocks declare.
struct Chip : sync::MemorySystem {
  UsbController usb{"usb"};
  BurstMaster display{"display", Master::kVpbe, 4};
  bus::WaitStats waits{Master::kUsb, {&scr.crossbar().waits, &ddr.controller().waits()}};
  Timer end;

  Chip() : MemorySystem({}, false, Frequency(243'000'000), Frequency(121'500'000)) {
    for (const MasterPort& p : usb.masters()) p.socket->bind(*scr.target[index(p.id)]);
    display.socket.bind(*scr.target[index(Master::kVpbe)]);
    priority[index(Master::kUsb)].write(7);  // the display goes first
    display.on_done = [this](const BurstMaster::Completion&) { refresh_picture(); };
  }
  void refresh_picture() {
    while (display.can_issue()) display.read(kSdram + (next_++ % 256) * 4096, kBytes);
  }
  void run(Picoseconds t) {
    end.at(kernel_time() + t);
    sc_core::sc_start(ps_time(t));
  }

 private:
  std::uint32_t next_ = 0;
};

std::map<std::string, StatBase::Value> values(const Chip& chip) {
  std::map<std::string, StatBase::Value> out;
  const auto add = [&](const StatGroup& g) {
    for (const StatBase* s : g.stats()) out[s->name()] = s->value();
  };
  for (const StatGroup* g : chip.scr.statistics()) add(*g);
  add(chip.waits);
  return out;
}
std::uint64_t count(const std::map<std::string, StatBase::Value>& of, const std::string& key) {
  const auto found = of.find(key);
  if (found == of.end()) {
    ADD_FAILURE() << "no statistic " << key;
    return 0;
  }
  return std::get<std::uint64_t>(found->second);
}

TEST(NewMasterTest, ItsRowGivesItParametersStatisticsWaitsAndAStreamInTraces) {
  Chip chip;
  ParamSet params;
  params.add(chip.xbar_params);
  EXPECT_NE(params.find("bus.usb.request_latency"), nullptr);
  EXPECT_NE(params.find("bus.usb.width"), nullptr);

  trace::BusRecorder recorder({{Master::kUsb, master_info(Master::kUsb).pace, kOutstanding, kOutstanding, true},
                               {Master::kVpbe, Pace::kLines, 2, 2, true}},
                              1, [](const MemRequest*) { return trace::CoreState{}; });
  const Subscription recording = chip.scr.crossbar().observe(recorder);
  chip.run(kPsPerUs);
  recorder.open(kernel_time(), Frequency(243'000'000), 0);
  chip.refresh_picture();
  chip.usb.start();
  chip.run(kPsPerMs);
  recorder.close(kernel_time());
  ASSERT_EQ(chip.usb.written, kBursts);
  ASSERT_EQ(chip.usb.read, kBursts);
  EXPECT_EQ(chip.usb.errors, 0u);
  EXPECT_EQ(chip.usb.wrong, 0u) << "the SDRAM has what it wrote";

  // Its bytes are counted under its own name and under no other.
  chip.scr.settle();
  const auto stats = values(chip);
  EXPECT_EQ(count(stats, "bus.usb.write_bytes"), kBursts * kBytes);
  EXPECT_EQ(count(stats, "bus.usb.read_bytes"), kBursts * kBytes);
  EXPECT_EQ(count(stats, "bus.usb.transactions"), 2 * kBursts);
  EXPECT_GT(count(stats, "bus.vpbe.read_bytes"), 100 * kBytes);
  for (const std::string_view name : kStatNames)
    if (name != "usb" && name != "vpbe") {
      EXPECT_EQ(count(stats, "bus." + std::string(name) + ".transactions"), 0u) << name;
    }

  // Every picosecond of its requests has a culprit, and the display is one of those of its writes.
  for (const bool write : {false, true}) {
    const auto direction = write ? &MasterWaits::write : &MasterWaits::read;
    Picoseconds sum = 0;
    for (std::size_t c = 0; c < kCulprits; ++c) sum += chip.waits.total(direction, static_cast<Culprit>(c));
    EXPECT_EQ(sum, chip.usb.took[write]) << write;
  }
  EXPECT_GT(chip.waits.total(&MasterWaits::write, culprit(Master::kVpbe)), 0u);
  EXPECT_TRUE(stats.contains("ddr.usb.wait.read.vpbe"));
  EXPECT_EQ(culprit_name(culprit(Master::kUsb)), "usb");

  // A trace has a stream of its requests.
  std::string bytes;
  trace::TraceInfo info;
  info.scr = {Frequency(121'500'000), 0};
  info.ddr = {Frequency(243'000'000), 0};
  recorder.finish(std::move(info), [&](std::string_view part) { bytes += part; });
  trace::TraceFile file("usb", bytes);
  ASSERT_EQ(file.info().masters.size(), 2u);
  const trace::MasterInfo& in_file = file.info().masters.back().id == Master::kUsb
                                         ? file.info().masters.back()
                                         : file.info().masters.front();
  EXPECT_EQ(in_file.id, Master::kUsb);
  EXPECT_EQ(in_file.label, "usb");
  unsigned records = 0;
  for (trace::Record r; file.next(in_file.stream, r);) records += r.master == Master::kUsb;
  EXPECT_EQ(records, 2 * kBursts);
}

}  // namespace
}  // namespace fovea::examples

int sc_main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
