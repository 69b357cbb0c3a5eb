#include "model/dma/core/edma_registers.h"

namespace fovea::dma {

ChannelRegs::ChannelRegs(RegBank& bank, const std::string& prefix, std::uint32_t base)
    : er(bank, prefix + "ER", base + 0x00, Mode::kRo, "events"),
      ecr(bank, prefix + "ECR", base + 0x08, Mode::kWo, "clears events"),
      esr(bank, prefix + "ESR", base + 0x10, Mode::kRo, "sets events: manual trigger"),
      cer(bank, prefix + "CER", base + 0x18, Mode::kRo, "chained events"),
      eer(bank, prefix + "EER", base + 0x20, Mode::kRo, "enabled events"),
      eecr(bank, prefix + "EECR", base + 0x28, Mode::kWo, "disables events"),
      eesr(bank, prefix + "EESR", base + 0x30, Mode::kWo, "enables events"),
      ser(bank, prefix + "SER", base + 0x38, Mode::kRo, "events that are queued"),
      secr(bank, prefix + "SECR", base + 0x40, Mode::kWo, "clears queued events"),
      ier(bank, prefix + "IER", base + 0x50, Mode::kRo, "enabled interrupts"),
      iecr(bank, prefix + "IECR", base + 0x58, Mode::kWo, "disables interrupts"),
      iesr(bank, prefix + "IESR", base + 0x60, Mode::kWo, "enables interrupts"),
      ipr(bank, prefix + "IPR", base + 0x68, Mode::kRo, "pending interrupts"),
      icr(bank, prefix + "ICR", base + 0x70, Mode::kWo, "clears pending interrupts"),
      ieval(bank, prefix + "IEVAL", base + 0x78, Mode::kWo, "bit 0: pulses the interrupt if one is pending"),
      qer(bank, prefix + "QER", base + 0x80, Mode::kRo, "QDMA events"),
      qeer(bank, prefix + "QEER", base + 0x84, Mode::kRo, "enabled QDMA events"),
      qeecr(bank, prefix + "QEECR", base + 0x88, Mode::kWo, "disables QDMA events"),
      qeesr(bank, prefix + "QEESR", base + 0x8C, Mode::kWo, "enables QDMA events"),
      qser(bank, prefix + "QSER", base + 0x90, Mode::kRo, "QDMA events that are queued"),
      qsecr(bank, prefix + "QSECR", base + 0x94, Mode::kWo, "clears QDMA events, queued or not") {}

EdmaRegs::PerQueue::PerQueue(RegBank& bank, const std::string& name, std::uint32_t offset,
                             const std::string& sentence, std::uint32_t reset)
    : Reg(bank, name, offset, sentence, reset) {
  for (unsigned q = 0; q < kQueues; ++q)
    queue.push_back(std::make_unique<Field>(*this, "Q" + std::to_string(q), 4 * q, 3, Mode::kRw,
                                            "of queue " + std::to_string(q)));
}

EdmaRegs::QueueNumbers::QueueNumbers(RegBank& bank, const std::string& name, std::uint32_t offset,
                                     unsigned first, const std::string& sentence)
    : Reg(bank, name, offset, sentence) {
  for (unsigned i = 0; i < 8; ++i)
    channel.push_back(std::make_unique<Field>(*this, "E" + std::to_string(first + i), 4 * i, 3,
                                              Mode::kRw,
                                              "of channel " + std::to_string(first + i)));
}

EdmaRegs::EdmaRegs(unsigned reset_priority)
    : RegBank("EDMACC"),
      quepri(*this, "QUEPRI", 0x284, "priority on the crossbar, 0 highest", 0x1111u * reset_priority) {
  const auto numbered = [](const std::string& name, unsigned n) { return name + std::to_string(n); };
  for (unsigned i = 0; i < kQdmaChannels; ++i)
    qchmap.push_back(std::make_unique<QdmaMap>(*this, numbered("QCHMAP", i), 0x200 + 4 * i,
                                               "parameter set and trigger word"));
  for (unsigned i = 0; i < kChannels / 8; ++i)
    dmaqnum.push_back(std::make_unique<QueueNumbers>(*this, numbered("DMAQNUM", i), 0x240 + 4 * i,
                                                     8 * i, "event queue of each channel"));
  for (unsigned r = 0; r < kShadowRegions; ++r) {
    drae.push_back(std::make_unique<RegPair>(*this, numbered("DRAE", r), 0x340 + 8 * r, Mode::kRw,
                                             "channels and codes of the region"));
    qrae.push_back(std::make_unique<Reg>(*this, numbered("QRAE", r), 0x380 + 4 * r, Mode::kRw,
                                         "QDMA channels of the region"));
    shadow.push_back(std::make_unique<ChannelRegs>(*this, "S" + std::to_string(r) + "_",
                                                   0x2000 + 0x200 * r));
  }
  for (unsigned q = 0; q < kQueues; ++q) {
    for (unsigned e = 0; e < kQueueDepth; ++e)
      entry.push_back(std::make_unique<Reg>(
          *this, "Q" + std::to_string(q) + "E" + std::to_string(e), 0x400 + 0x40 * q + 4 * e,
          Mode::kRo, "type (7:6) and number (5:0) of the event"));
    qstat.push_back(
        std::make_unique<QueueStatus>(*this, numbered("QSTAT", q), 0x600 + 4 * q, "event queue"));
  }
  static constexpr std::array<const char*, kParamWords> kWords{
      "OPT", "SRC", "A_B_CNT", "DST", "SRC_DST_BIDX", "LINK_BCNTRLD", "SRC_DST_CIDX", "CCNT"};
  for (unsigned s = 0; s < kParamSets; ++s) {
    Param& p = param.emplace_back();
    for (unsigned w = 0; w < kParamWords; ++w)
      p.word.push_back(std::make_unique<Reg>(*this, numbered(std::string("PARAM_") + kWords[w], s),
                                             0x4000 + 0x20 * s + 4 * w, Mode::kRw,
                                             "parameter RAM"));
  }
}

ParamSet EdmaRegs::load(unsigned set) const {
  ParamSet out;
  for (unsigned w = 0; w < kParamWords; ++w) out.word[w] = param[set].word[w]->get();
  return out;
}

void EdmaRegs::store(unsigned set, const ParamSet& value) {
  for (unsigned w = 0; w < kParamWords; ++w) param[set].word[w]->set(value.word[w]);
}

}  // namespace fovea::dma
