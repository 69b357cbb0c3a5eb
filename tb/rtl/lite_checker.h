// Rules of AXI4-Lite (ARM IHI 0022) that a slave has to keep, checked clock by clock.
#pragma once
#include <cstdint>
#include <stdexcept>
#include <string>

namespace fovea::rtl {

/// What was taken in a clock, and the channels of the answers.
struct LiteClock {
  bool aw = false, w = false, ar = false;
  bool b_valid = false, b_ready = false, r_valid = false, r_ready = false;
  unsigned b_response = 0, r_response = 0;
  std::uint32_t r_data = 0;
};

/// @throws std::runtime_error that names the rule
class LiteChecker {
 public:
  void clock(const LiteClock& c) {
    const bool b_waits = before_.b_valid && !before_.b_ready,
               r_waits = before_.r_valid && !before_.r_ready;
    if (b_waits && !c.b_valid) fail("BVALID taken back");
    if (r_waits && !c.r_valid) fail("RVALID taken back");
    if (b_waits && c.b_response != before_.b_response) fail("B changed while it waited");
    if (r_waits && (c.r_response != before_.r_response || c.r_data != before_.r_data))
      fail("R changed while it waited");
    if (c.b_valid && (addresses_ == 0 || data_ == 0)) fail("an answer to no write");
    if (c.r_valid && reads_ == 0) fail("an answer to no read");
    if (c.b_valid && c.b_ready) --addresses_, --data_;
    if (c.r_valid && c.r_ready) --reads_;
    addresses_ += c.aw;
    data_ += c.w;
    reads_ += c.ar;
    before_ = c;
  }

 private:
  [[noreturn]] static void fail(const std::string& what) {
    throw std::runtime_error("AXI4-Lite: " + what);
  }
  unsigned addresses_ = 0, data_ = 0, reads_ = 0;  ///< taken and not answered
  LiteClock before_;
};

}  // namespace fovea::rtl
