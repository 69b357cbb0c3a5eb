#include "model/dma/core/commands.h"

#include <algorithm>
#include <bit>

#include "model/common/mem_request.h"

namespace fovea::dma {

Commands::Commands(const TransferRequest& request, const TransferRequest::Side& side,
                   unsigned burst)
    : start_(side.address),
      length_(request.acnt),
      arrays_(request.bcnt),
      index_(side.index),
      burst_(burst),
      fifo_bytes_(side.constant ? request.fifo_bytes : 0) {
  constexpr unsigned kMostArrays = 1023;
  const bool joined = !side.constant && request.acnt <= burst && std::has_single_bit(request.acnt) &&
                      side.index == request.acnt && request.bcnt <= kMostArrays;
  if (!joined) return;
  length_ *= arrays_;
  arrays_ = 1;
}

/// Bytes that the next command may have by its address. An array that fits into one command is one,
/// wherever it begins.
unsigned Commands::room() const {
  if (fifo_bytes_) return std::min(fifo_bytes_ - offset_ % fifo_bytes_, burst_);
  if (length_ <= burst_) return burst_;
  return burst_ - (start_ + offset_) % burst_;
}

Command Commands::next() const {
  const std::uint32_t address = start_ + (fifo_bytes_ ? offset_ % fifo_bytes_ : offset_);
  const unsigned inside = kMaxBurstBytes - address % kMaxBurstBytes;
  return {address, std::min({room(), inside, length_ - offset_})};
}

void Commands::pop() {
  offset_ += next().bytes;
  if (offset_ < length_) return;
  offset_ = 0;
  --arrays_;
  start_ += static_cast<std::uint32_t>(index_);
}

}  // namespace fovea::dma
