// How a transfer controller divides one side of a transfer into commands on the bus.
#pragma once
#include <cstdint>

#include "model/common/transfer_request.h"

namespace fovea::dma {

/// One access on the bus.
struct Command {
  std::uint32_t address;
  unsigned bytes;
};

/// The commands of one side of a request, in order. Rules of SPRUH82C (command fragmentation): no
/// command is larger than the default burst size; the first one of a longer array ends where the
/// rest is aligned to that size; arrays that lie one behind the other, of a power of two of bytes up to the
/// default burst size and at most 1023 of them, become one. The memory path takes no burst across a
/// multiple of 64 bytes, so a command that crosses one counts as two here.
class Commands {
 public:
  Commands() = default;
  Commands(const TransferRequest& request, const TransferRequest::Side& side, unsigned burst);

  bool done() const { return arrays_ == 0; }
  /// The next command; not if done().
  Command next() const;
  void pop();
  /// Bytes of all commands that are left.
  std::uint32_t bytes() const { return done() ? 0 : arrays_ * length_ - offset_; }

 private:
  unsigned room() const;

  std::uint32_t start_ = 0;    // of the current array
  std::uint32_t length_ = 0;   // of an array
  std::uint32_t offset_ = 0;   // bytes of the current array that are done
  std::uint32_t arrays_ = 0;   // left, with the current one
  std::int32_t index_ = 0;
  unsigned burst_ = 1;
  unsigned fifo_bytes_ = 0;    // 0: incrementing
};

}  // namespace fovea::dma
