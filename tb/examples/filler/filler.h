// An example memory master: fills memory with a pattern.
#pragma once
#include "model/common/burst_master.h"
#include "model/common/bus_target.h"

namespace fovea::examples {

struct FillerRegs : RegBank {
  Reg address{*this, "ADDRESS", 0x00, Mode::kRw, "where to begin, a multiple of 32"};
  Reg pattern{*this, "PATTERN", 0x04, Mode::kRw, "the word to write"};
  Reg bursts{*this, "BURSTS", 0x08, Mode::kRw, "how many times 32 bytes; a write starts"};
  Reg left{*this, "LEFT", 0x0C, Mode::kRo, "bursts that have not ended"};
  FillerRegs() : RegBank("FILLER") {}
};

/// Writes bursts of 32 bytes, at most kOutstanding of them at once.
class Filler : public WithRegs<FillerRegs>, public BusTarget {
 public:
  static constexpr unsigned kBurstBytes = 32, kOutstanding = 4;
  explicit Filler(sc_core::sc_module_name name);
  bool idle() const override { return memory_.idle(); }

 private:
  void on_reset(ResetKind) override { to_issue_ = 0; }
  void fill();

  BurstMaster memory_;
  std::array<std::uint8_t, kBurstBytes> data_{};
  std::uint32_t next_ = 0, to_issue_ = 0;
};

}  // namespace fovea::examples
