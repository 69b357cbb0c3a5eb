#include "model/dma/core/param_set.h"

#include <algorithm>

namespace fovea::dma {
namespace {

/// Indices are signed: -32768 .. 32767.
std::int32_t low_index(std::uint32_t word) { return static_cast<std::int16_t>(word); }
std::int32_t high_index(std::uint32_t word) { return static_cast<std::int16_t>(word >> 16); }

}  // namespace

TransferRequest ParamSet::request() const {
  TransferRequest r;
  r.source = {word[kSrc], low_index(word[kBidx]), opt(kSourceConstant)};
  r.destination = {word[kDst], high_index(word[kBidx]), opt(kDestinationConstant)};
  r.acnt = static_cast<std::uint16_t>(acnt());
  r.bcnt = static_cast<std::uint16_t>(opt(kSyncAb) ? bcnt() : 1);
  r.fifo_bytes = static_cast<std::uint8_t>(1u << std::min(width(), kWidest));
  r.tcc = static_cast<std::uint8_t>(tcc());
  r.interrupt = opt(final() ? kFinalInterrupt : kIntermediateInterrupt);
  r.chain = opt(final() ? kFinalChain : kIntermediateChain);
  return r;
}

void ParamSet::move(ParamWord index) {
  word[kSrc] += static_cast<std::uint32_t>(low_index(word[index]));
  word[kDst] += static_cast<std::uint32_t>(high_index(word[index]));
}

void ParamSet::advance() {
  if (!opt(kSyncAb) && bcnt() > 1) {
    move(kBidx);
    word[kAbCnt] -= 1u << 16;
    return;
  }
  move(kCidx);
  word[kCcnt] = (word[kCcnt] & 0xFFFF'0000u) | (ccnt() - 1);
  if (!opt(kSyncAb)) word[kAbCnt] = acnt() | bcnt_reload() << 16;
}

}  // namespace fovea::dma
