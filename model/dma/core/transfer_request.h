// What the channel controller hands to a transfer controller.
#pragma once
#include <cstdint>

namespace fovea::dma {

/// One transfer: `bcnt` arrays of `acnt` bytes. Addresses are in bytes; an index is the distance from
/// the start of an array to the start of the next one.
struct TransferRequest {
  /// Constant addressing: every access goes to the array's first bytes, `fifo_bytes` of them.
  struct Side {
    std::uint32_t address = 0;
    std::int32_t index = 0;
    bool constant = false;
  };
  Side source, destination;
  std::uint16_t acnt = 0, bcnt = 0;   ///< both at least 1
  std::uint8_t fifo_bytes = 1;        ///< width of the port that constant addressing accesses
  std::uint8_t tcc = 0;               ///< completion code
  bool interrupt = false;             ///< the code sets a bit of IPR
  bool chain = false;                 ///< the code sets a bit of CER

  std::uint32_t bytes() const { return std::uint32_t{acnt} * bcnt; }
};

}  // namespace fovea::dma
