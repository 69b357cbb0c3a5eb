// Rules of AXI4 and AXI4-Lite (ARM IHI 0022) that the answering side has to keep, and those of a register port's
// master, checked clock by clock. AxiChecker has those of the engine as master.
#pragma once
#include <array>
#include <deque>
#include <stdexcept>
#include <string>

#include "model/engine/rtl/axi_wires.h"

namespace fovea::rtl {

/// Shared by both checkers. @throws std::runtime_error that names the rule
class RuleChecker {
 protected:
  explicit RuleChecker(std::string bus) : bus_(std::move(bus)) {}
  [[noreturn]] void fail(const std::string& what) const { throw std::runtime_error(bus_ + ": " + what); }
  /// A channel that stood unheard at the last edge stays as it was.
  template <class Channel>
  void stable(const Channel& now, const Channel& before, bool same, const char* name) const {
    if (!before.valid || before.ready) return;
    if (!now.valid) fail(std::string(name) + "VALID taken back");
    if (!same) fail(std::string(name) + " changed while it waited");
  }

 private:
  std::string bus_;
};

/// The memory side of an AXI4 port: its answers.
class AxiAnswerChecker : RuleChecker {
 public:
  AxiAnswerChecker() : RuleChecker("AXI answers") {}
  void clock(const AxiWires& c) {
    stable(c.r, before_.r, c.r.id == before_.r.id && c.r.data == before_.r.data &&
                               c.r.response == before_.r.response && c.r.last == before_.r.last, "R");
    stable(c.b, before_.b, c.b.response == before_.b.response, "B");
    // An answer on the wires belongs to a request from an earlier clock.
    if (c.r.valid) {
      if (c.r.id >= reads_.size()) fail("RID that is no identifier of the master");
      if (reads_[c.r.id].empty()) fail("read data that nobody asked for");
      if (c.r.last != (reads_[c.r.id].front() == 1)) fail("RLAST not at the last beat");
      if (c.r.ready && reads_[c.r.id].front()-- == 1) reads_[c.r.id].pop_front();
    }
    if (c.b.valid) {
      if (complete_ == 0 || requested_ == 0) fail("an answer to a write before its request and its last data");
      if (c.b.ready) --complete_, --requested_;
    }
    if (c.ar.valid && c.ar.ready && c.ar.id < reads_.size())
      reads_[c.ar.id].push_back(c.ar.length + 1);
    if (c.aw.valid && c.aw.ready) ++requested_;
    if (c.w.valid && c.w.ready && c.w.last) ++complete_;
    before_ = c;
  }
  bool quiet() const {
    return reads_[0].empty() && reads_[1].empty() && complete_ == 0 && requested_ == 0;
  }

 private:
  std::array<std::deque<unsigned>, 2> reads_;  // beats that are left, by identifier
  unsigned requested_ = 0, complete_ = 0;      // writes whose request, and whose last data, were taken
  AxiWires before_;
};

/// Both sides of a register port.
class RegisterPortChecker : RuleChecker {
 public:
  /// @param words addresses are those of words; AXI4-Lite itself allows others
  RegisterPortChecker() : RegisterPortChecker(true) {}
  explicit RegisterPortChecker(bool words) : RuleChecker("AXI4-Lite"), words_(words) {}
  void clock(const LiteWires& c) {
    stable(c.aw, before_.aw, c.aw.address == before_.aw.address, "AW");
    stable(c.ar, before_.ar, c.ar.address == before_.ar.address, "AR");
    stable(c.w, before_.w, c.w.data == before_.w.data && c.w.strobes == before_.w.strobes, "W");
    stable(c.r, before_.r, c.r.data == before_.r.data && c.r.response == before_.r.response, "R");
    stable(c.b, before_.b, c.b.response == before_.b.response, "B");
    if (words_ && ((c.aw.valid && c.aw.address % 4) || (c.ar.valid && c.ar.address % 4)))
      fail("an address that is not that of a word");
    if (c.r.valid && reads_ == 0) fail("read data that nobody asked for");
    if (c.b.valid && (addresses_ == 0 || data_ == 0))
      fail("an answer to a write before its address and its data");
    if ((c.r.valid && c.r.response == 1) || (c.b.valid && c.b.response == 1))
      fail("EXOKAY, which AXI4-Lite does not have");
    if (c.r.valid && c.r.ready) --reads_;
    if (c.b.valid && c.b.ready) --addresses_, --data_;
    reads_ += c.ar.valid && c.ar.ready;
    addresses_ += c.aw.valid && c.aw.ready;
    data_ += c.w.valid && c.w.ready;
    before_ = c;
  }
  bool quiet() const { return reads_ == 0 && addresses_ == 0 && data_ == 0; }

 private:
  bool words_;
  unsigned reads_ = 0, addresses_ = 0, data_ = 0;  // taken, and not answered
  LiteWires before_;
};

}  // namespace fovea::rtl
