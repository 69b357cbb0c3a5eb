#include "tb/fuzz/guests.h"

#include <algorithm>
#include <array>
#include <deque>
#include <stdexcept>
#include <string>

#include "model/dma/core/channel_controller.h"
#include "tb/engine/model_bench.h"
#include "tb/fuzz/planted.h"

namespace fovea::fuzz {
namespace {

/// Takes steps from an input, little-endian.
class Steps {
 public:
  explicit Steps(std::string_view bytes) : bytes_(bytes) {}
  bool has(std::size_t bytes) const { return bytes_.size() >= bytes; }
  std::uint32_t take(std::size_t bytes) {
    std::uint32_t value = 0;
    for (std::size_t n = 0; n < bytes; ++n) value |= std::uint32_t{static_cast<std::uint8_t>(bytes_[n])} << 8 * n;
    bytes_.remove_prefix(bytes);
    return value;
  }

 private:
  std::string_view bytes_;
};

class ChannelControllerHost : public dma::ChannelController::Host {
 public:
  std::array<bool, kTransferControllers> ready{true, true, true, true};
  std::deque<TransferRequest> under_way;

  bool can_submit(unsigned controller) const override { return ready.at(controller); }
  void submit(unsigned controller, const TransferRequest& r) override {
    if (controller >= kTransferControllers || !ready[controller] || r.acnt == 0 || r.bcnt == 0 || r.fifo_bytes == 0 ||
        r.tcc >= dma::kChannels)
      throw std::logic_error("a request that no transfer controller can execute");
    under_way.push_back(r);
  }
  bool forms_request() const override { return false; }
  void pulse_completion(unsigned region) override {
    if (region >= dma::kShadowRegions) throw std::logic_error("an interrupt of no region");
  }
  void pulse_error() override {}
  void work_arrived() override {}
  void events_enabled(std::uint64_t) override {}
  void warn(const std::string& what) override {
    if (what.empty() || what.find('\n') != std::string::npos) throw std::logic_error("a warning that is no line");
  }
};

/// What QSTAT shows of each queue. @return entries of all
unsigned queued(dma::EdmaRegs& regs) {
  unsigned all = 0;
  for (unsigned q = 0; q < dma::kQueues; ++q) {
    std::uint32_t status = 0;
    regs.read(0x600 + 4 * q, 4, status);
    const unsigned entries = status >> 8 & 31, most = status >> 16 & 31;
    if (entries > dma::kQueueDepth || most < entries) throw std::logic_error("a queue shows what it cannot hold");
    all += entries;
  }
  return all;
}

}  // namespace

Result edma(std::string_view bytes) {
  dma::EdmaRegs regs{7};
  ChannelControllerHost host;
  dma::ChannelController core{regs, host};
  Picoseconds now = 0;
  for (Steps steps(bytes); steps.has(7); now += 1000) {
    const std::uint32_t what = steps.take(1) % 8, offset = steps.take(2), value = steps.take(4);
    std::uint32_t read = 0;
    switch (what) {
      case 0: regs.write(offset & 0x7FFC, 4, value); break;
      case 1: regs.write(offset & 0x7FFE, 2, value & 0xFFFF); break;
      case 2: regs.read(offset & 0x7FFC, 4, read); break;
      case 3: core.event(offset % dma::kChannels, now); break;
      case 4: core.prioritise(now); break;
      case 5: core.process(now); break;
      case 6: {
        if (host.under_way.empty()) break;
        const TransferRequest done = host.under_way.front();
        host.under_way.pop_front();
        value % 8 == 0 ? core.dropped(done) : core.completed(done, now);
        break;
      }
      default: host.ready.at(offset % kTransferControllers) = value % 2;
    }
    if ((queued(regs) == 0) != (core.next_turn() == kNever)) throw std::logic_error("QSTAT is not what is queued");
  }
  planted(core.counts().links > 2 && core.counts().missed > 0);
  return Result::kRead;
}

Result engine(std::string_view bytes) {
  engine::ModelBench bench(1u << 18);
  unsigned clocks = 0;
  bool read_error = false;
  for (Steps steps(bytes); steps.has(6) && clocks < 50'000;) {
    const std::uint32_t what = steps.take(1), offset = steps.take(1), value = steps.take(4);
    switch (what % 8) {
      case 5: {
        bench.advance(value % 2000);
        clocks += value % 2000;
        break;
      }
      case 6: bench.memory.latency = 1 + value % 64; break;
      case 7:
        (value % 2 ? bench.memory.read_fault : bench.memory.write_fault) =
            engine::ModelBench::kBase + (value & 0x3FFC0);
        break;
      default: {
        bench.backend.run(bench.now());
        bench.backend.write(offset & 0xFC, value, what < 200 ? 15 : what % 16, bench.now());
        bench.advance(1);
      }
    }
    read_error |= (bench.get(bench.regs.events) & engine::kReadError) != 0;
  }
  bench.set(bench.regs.ctrl, 2);  // abort
  bench.finish();
  if (bench.get(bench.regs.status) & 1) throw std::logic_error("busy after all has ended");
  planted(read_error);
  return Result::kRead;
}

}  // namespace fovea::fuzz
