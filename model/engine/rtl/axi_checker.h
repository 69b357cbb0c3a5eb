// Rules of AXI4 (ARM IHI 0022) that a master has to keep, checked clock by clock.
#pragma once
#include <cstdint>
#include <deque>
#include <stdexcept>
#include <string>

namespace fovea::rtl {

struct Request {
  bool valid = false, ready = false;
  unsigned id = 0;
  std::uint32_t address = 0;
  unsigned length = 0;  ///< beats - 1
};
struct WriteData {
  bool valid = false, ready = false, last = false;
  std::uint64_t data = 0;
  unsigned strobes = 0;
};
/// The master's channels in a clock, and how many answers came.
struct AxiClock {
  Request ar, aw;
  WriteData w;
  bool r_last = false, b = false;  ///< a read or a write was completed
};

/// @throws std::runtime_error that names the rule
class AxiChecker {
 public:
  AxiChecker(unsigned most_reads, unsigned most_writes)
      : most_reads_(most_reads), most_writes_(most_writes) {}
  void clock(const AxiClock& c) {
    request(c.ar, before_.ar, "AR");
    request(c.aw, before_.aw, "AW");
    stable(c.w.valid, before_.w.valid && !before_.w.ready,
           c.w.data == before_.w.data && c.w.strobes == before_.w.strobes &&
               c.w.last == before_.w.last,
           "W");
    if (c.ar.valid && c.ar.ready && ++reads_ > most_reads_)
      fail("more reads under way than allowed");
    if (c.aw.valid && c.aw.ready) {
      if (++writes_ > most_writes_) fail("more writes under way than allowed");
      lengths_.push_back(c.aw.length);
    }
    if (c.w.valid && c.w.ready) {
      ++beats_of_this_;
      if (c.w.last) {
        bursts_.push_back(beats_of_this_);
        beats_of_this_ = 0;
      } else if (beats_of_this_ == 256) {
        fail("a write of more than 256 beats");
      }
    }
    while (!bursts_.empty() && !lengths_.empty()) {
      if (bursts_.front() != lengths_.front() + 1) fail("WLAST not at the last beat");
      bursts_.pop_front();
      lengths_.pop_front();
    }
    if (c.r_last) {
      if (reads_ == 0) fail("an answer to no read");
      --reads_;
    }
    if (c.b) {
      if (writes_ == 0) fail("an answer to no write");
      --writes_;
    }
    before_ = c;
  }
  bool quiet() const {
    return reads_ == 0 && writes_ == 0 && bursts_.empty() && lengths_.empty() &&
           beats_of_this_ == 0 && !before_.ar.valid && !before_.aw.valid && !before_.w.valid;
  }

 private:
  [[noreturn]] static void fail(const std::string& what) {
    throw std::runtime_error("AXI: " + what);
  }
  static void stable(bool valid, bool stalled, bool same, const char* channel) {
    if (stalled && !valid) fail(std::string(channel) + "VALID taken back");
    if (stalled && !same) fail(std::string(channel) + " changed while it waited");
  }
  static void request(const Request& now, const Request& before, const char* channel) {
    stable(now.valid, before.valid && !before.ready,
           now.id == before.id && now.address == before.address && now.length == before.length,
           channel);
    if (!now.valid) return;
    if (now.address % 8) fail(std::string(channel) + " not aligned to the width of the bus");
    if (now.address / 4096 != (now.address + now.length * 8 + 7) / 4096)
      fail(std::string(channel) + " crosses 4 KiB");
  }
  unsigned most_reads_, most_writes_, reads_ = 0, writes_ = 0, beats_of_this_ = 0;
  std::deque<unsigned> lengths_, bursts_;
  AxiClock before_;
};

}  // namespace fovea::rtl
