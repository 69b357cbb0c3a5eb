// What a register set of a transfer controller shows of a request (SPRUH82C, SPRUH73H: "EDMA3TC Channel
// Registers"). For software and debuggers that read it; the transfer controller itself does not use it.
#pragma once
#include <bit>
#include <cstdint>

#include "model/common/transfer_request.h"

namespace fovea::dma {

/// A request, and how much of one of its sides is left. After the last command the counts are 0 and the
/// current array is the last one.
struct RegisterSet {
  TransferRequest request;  ///< of ACNT 0: there was none since the reset
  std::uint32_t left = 0;   ///< bytes whose commands are not issued

  /// Arrays left, with the current one.
  std::uint32_t bcnt() const {
    return left ? (left + request.acnt - 1u) / request.acnt : 0;
  }
  /// Bytes left of the current array.
  std::uint32_t acnt() const { return left ? left - (bcnt() - 1) * request.acnt : 0; }
  /// xxCNT: BCNT above ACNT.
  std::uint32_t counts() const { return bcnt() << 16 | acnt(); }
  /// xxBREF: where the current array of a side begins.
  std::uint32_t reference(const TransferRequest::Side& side) const {
    const std::uint32_t array = left ? request.bcnt - bcnt() : request.bcnt - (request.bcnt > 0);
    return side.address + array * static_cast<std::uint32_t>(side.index);
  }
  /// xxSRC, xxDST: the next command's address; constant addressing goes round within the FIFO's width.
  std::uint32_t address(const TransferRequest::Side& side) const {
    const std::uint32_t offset = request.acnt - acnt();
    return reference(side) + (side.constant ? offset % request.fifo_bytes : offset);
  }
  /// xxBIDX: the destination's above the source's.
  std::uint32_t indices() const {
    return static_cast<std::uint32_t>(request.destination.index) << 16 |
           (static_cast<std::uint32_t>(request.source.index) & 0xFFFF);
  }
  /// xxOPT. @param priority on the crossbar, 0 to 7
  std::uint32_t options(std::uint32_t priority) const {
    const auto width = static_cast<std::uint32_t>(std::countr_zero(request.fifo_bytes));
    return std::uint32_t{request.source.constant} | std::uint32_t{request.destination.constant} << 1 |
           priority << 4 | width << 8 | std::uint32_t{request.tcc} << 12 |
           std::uint32_t{request.interrupt} << 20 | std::uint32_t{request.chain} << 22;
  }
};

}  // namespace fovea::dma
