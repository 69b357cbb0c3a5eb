// Registers of the EDMA3 channel controller. Offsets and fields: Linux drivers/dma/ti/edma.c and
// arch/arm/mach-davinci/dma.c; meaning: SPRUEE4A (DM35x), SPRUH82C (AM1808).
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "model/common/regbank.h"
#include "model/dma/core/param_set.h"

namespace fovea::dma {

inline constexpr unsigned kChannels = 64, kQdmaChannels = 8, kParamSets = 256, kQueues = 4,
                          kQueueDepth = 16, kShadowRegions = 4;

/// Two registers for 64 channels: the low one at the offset, the high one behind it.
struct RegPair {
  Reg lo, hi;
  RegPair(RegBank& bank, const std::string& name, std::uint32_t offset, Mode mode,
          const std::string& sentence)
      : lo(bank, name, offset, mode, sentence),
        hi(bank, name + "H", offset + 4, mode, sentence + ", upper half") {}
  std::uint64_t get() const { return lo.get() | std::uint64_t{hi.get()} << 32; }
  void set(std::uint64_t value) {
    lo.set(static_cast<std::uint32_t>(value));
    hi.set(static_cast<std::uint32_t>(value >> 32));
  }
};

/// The registers of channels and interrupts: once in the global region and once in each shadow region,
/// where DRAE and QRAE hide what does not belong to the region.
struct ChannelRegs {
  RegPair er, ecr, esr, cer, eer, eecr, eesr, ser, secr, ier, iecr, iesr, ipr, icr;
  Reg ieval, qer, qeer, qeecr, qeesr, qser, qsecr;
  /// `prefix`: "" or such as "S0_".
  ChannelRegs(RegBank& bank, const std::string& prefix, std::uint32_t base);
};

struct EdmaRegs : RegBank {
  struct PerQueue : Reg {
    PerQueue(RegBank& bank, const std::string& name, std::uint32_t offset,
             const std::string& sentence, std::uint32_t reset);
    std::vector<std::unique_ptr<Field>> queue;
  };
  /// Fields of 3 bits at a pitch of 4 bits: the queue of each channel.
  struct QueueNumbers : Reg {
    QueueNumbers(RegBank& bank, const std::string& name, std::uint32_t offset, unsigned first,
                 const std::string& sentence);
    std::vector<std::unique_ptr<Field>> channel;
  };
  struct QdmaMap : Reg {
    using Reg::Reg;
    Field trigger{*this, "TRWORD", 2, 3, Mode::kRw, "word of the set whose write triggers"};
    Field set{*this, "PAENTRY", 5, 9, Mode::kRw, "parameter set"};
  };
  struct Errors : Reg {
    using Reg::Reg;
    Field threshold{*this, "QTHRXCD", 0, 4, Mode::kRo, "queues that exceeded their threshold"};
    Field codes{*this, "TCCERR", 16, 1, Mode::kRo, "more than 63 completion codes outstanding"};
  };
  struct ErrorClear : Reg {
    using Reg::Reg;
    Field threshold{*this, "QTHRXCD", 0, 4, Mode::kWo, "clears CCERR.QTHRXCD, WM and THRXCD"};
    Field codes{*this, "TCCERR", 16, 1, Mode::kWo, "clears CCERR.TCCERR"};
  };
  struct Evaluate : Reg {
    using Reg::Reg;
    Field eval{*this, "EVAL", 0, 1, Mode::kWo, "pulses the interrupt if one is pending"};
  };
  struct QueueStatus : Reg {
    using Reg::Reg;
    Field start{*this, "STRTPTR", 0, 4, Mode::kRo, "entry at the head"};
    Field count{*this, "NUMVAL", 8, 5, Mode::kRo, "entries in the queue"};
    Field mark{*this, "WM", 16, 5, Mode::kRo, "most entries so far"};
    Field exceeded{*this, "THRXCD", 24, 1, Mode::kRo, "the threshold was exceeded"};
  };
  struct Thresholds : Reg {
    using Reg::Reg;
    Field q0{*this, "Q0", 0, 5, Mode::kRw, "threshold of queue 0; 17 disables"};
    Field q1{*this, "Q1", 8, 5, Mode::kRw, "of queue 1"};
    Field q2{*this, "Q2", 16, 5, Mode::kRw, "of queue 2"};
    Field q3{*this, "Q3", 24, 5, Mode::kRw, "of queue 3"};
  };
  struct Status : Reg {
    using Reg::Reg;
    Field events{*this, "EVTACTV", 0, 1, Mode::kRo, "a DMA event is pending or queued"};
    Field qdma_events{*this, "QEVTACTV", 1, 1, Mode::kRo, "a QDMA event is pending or queued"};
    Field request{*this, "TRACTV", 2, 1, Mode::kRo, "a transfer request is being formed"};
    Field active{*this, "ACTV", 4, 1, Mode::kRo, "anything of the others"};
    Field codes{*this, "COMPACTV", 8, 6, Mode::kRo, "completion codes outstanding"};
    Field queues{*this, "QUEACTV", 16, 4, Mode::kRo, "queues with entries"};
  };
  /// One set: eight plain words.
  struct Param {
    std::vector<std::unique_ptr<Reg>> word;
  };

  /// Value for the DM365: 64 DMA and 8 QDMA channels, 64 completion codes, 256 sets, 4 queues,
  /// 4 regions; no mapping of DMA channels to sets, no memory protection. Linux decodes the fields so.
  static constexpr std::uint32_t kConfiguration = 0x0023'4445;

  Reg cccfg{*this, "CCCFG", 0x004, Mode::kRo, "configuration", kConfiguration};
  std::vector<std::unique_ptr<QdmaMap>> qchmap;
  std::vector<std::unique_ptr<QueueNumbers>> dmaqnum;
  QueueNumbers qdmaqnum{*this, "QDMAQNUM", 0x260, 0, "event queue of each QDMA channel"};
  PerQueue quetcmap{*this, "QUETCMAP", 0x280, "transfer controller of the queue", 0x3210};
  PerQueue quepri;
  RegPair emr{*this, "EMR", 0x300, Mode::kRo, "missed events"};
  RegPair emcr{*this, "EMCR", 0x308, Mode::kWo, "clears missed events"};
  Reg qemr{*this, "QEMR", 0x310, Mode::kRo, "missed QDMA events"};
  Reg qemcr{*this, "QEMCR", 0x314, Mode::kWo, "clears missed QDMA events"};
  Errors ccerr{*this, "CCERR", 0x318, "errors of the controller"};
  ErrorClear ccerrclr{*this, "CCERRCLR", 0x31C, "clears errors of the controller"};
  Evaluate eeval{*this, "EEVAL", 0x320, "error interrupt"};
  std::vector<std::unique_ptr<RegPair>> drae;
  std::vector<std::unique_ptr<Reg>> qrae;
  std::vector<std::unique_ptr<Reg>> entry;  ///< event queue entries, 16 for each queue
  std::vector<std::unique_ptr<QueueStatus>> qstat;
  Thresholds qwmthra{*this, "QWMTHRA", 0x620, "watermark thresholds", 0x1010'1010};
  Status ccstat{*this, "CCSTAT", 0x640, "status"};
  ChannelRegs global{*this, "", 0x1000};
  std::vector<std::unique_ptr<ChannelRegs>> shadow;
  std::vector<Param> param;

  explicit EdmaRegs(unsigned reset_priority);

  unsigned queue_of(unsigned channel) const { return dmaqnum[channel / 8]->channel[channel % 8]->get(); }
  unsigned queue_of_qdma(unsigned channel) const { return qdmaqnum.channel[channel]->get(); }
  unsigned threshold(unsigned queue) const { return qwmthra.fields()[queue]->get(); }
  ParamSet load(unsigned set) const;
  void store(unsigned set, const ParamSet& value);
};

}  // namespace fovea::dma
