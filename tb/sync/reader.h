// A master that runs ahead of the kernel and reads once.
#pragma once
#include <array>

#include "model/bus/lookahead_initiator.h"

namespace fovea::sync {

/// Reads 16 bytes at a given time; asks for them so much earlier.
class Reader : public bus::LookaheadInitiator<Reader> {
 public:
  Picoseconds first = 0;  ///< when the first byte came; 0: not yet
  Reader(sc_core::sc_module_name name, std::uint32_t address, Picoseconds at, Picoseconds early = 0)
      : LookaheadInitiator(name, 1), address_(address), at_(at), early_(early) {
    SC_HAS_PROCESS(Reader);
    SC_THREAD(run);
  }

 private:
  friend bus::LookaheadInitiator<Reader>;
  void run() {
    enter();
    sleep_until(at_ - early_);
    std::array<std::uint8_t, 16> data{};
    Transaction tx;
    tx.address = address_;
    tx.data = data.data();
    tx.bytes = static_cast<std::uint8_t>(data.size());
    submit(tx, at_);
    finish(tx);
    first = tx.first;
    leave();
  }
  std::uint32_t address_;
  Picoseconds at_, early_;
};

}  // namespace fovea::sync
