// A DDR controller core on the test bench: records its commands and outcomes, and has the
// independent checker listen to every command.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "model/mem/core/ddr_controller.h"
#include "tb/dram/command_checker.h"

namespace fovea::dram {

/// Own generator: results must not depend on a library's distribution.
class Rng {
 public:
  explicit Rng(std::uint64_t seed) : s_(seed * 0x9E3779B97F4A7C15ull + 0x1234567) { next(); }
  std::uint64_t next() {
    s_ ^= s_ << 13;
    s_ ^= s_ >> 7;
    s_ ^= s_ << 17;
    return s_;
  }
  std::uint64_t below(std::uint64_t n) { return (next() >> 11) % n; }

 private:
  std::uint64_t s_;
};

/// The bench's DDR clock has a whole number of ps, so clock k is at k * kTck exactly.
inline constexpr Picoseconds kTck = 4'000;  // 250 MHz
inline const Frequency kDdr{250'000'000};

struct Logged {
  mem::Cmd cmd;
  unsigned bank;
  std::uint32_t row;
  std::uint64_t clock;
  friend bool operator==(const Logged&, const Logged&) = default;
};

/// One request and what became of it.
struct Request {
  MemRequest path;  // as the controller gets it
  Master master = Master::kLoad;
  unsigned priority = 0;
  bool write = false;
  std::uint32_t address = 0;
  unsigned bytes = 16;
  std::uint32_t critical = 0;
  std::array<std::uint8_t, 64> data{};
  // outcome
  bool accepted = false;
  std::optional<Master> unblocked_by;  // who made room for it; none: it did not wait
  unsigned done = 0;  // times a read was answered
  Picoseconds accepted_at = 0, first = 0, last = 0;
};

struct BenchOptions {
  Frequency ddr = kDdr, scr = kDdr;
  std::vector<std::pair<std::string, std::string>> params;  // key without "ddr.", value
  mem::DdrConfig config{};
  unsigned tFAW = 0;
};

/// The data sheet a controller configured so must obey; copied field by field, no table shared.
inline DataSheet sheet_of(const mem::DdrConfig& c) {
  DataSheet s;
  s.CL = c.timing.CL;
  s.tRCD = c.timing.nRCD;
  s.tRP = c.timing.nRP;
  s.tRAS = c.timing.nRAS;
  s.tRC = c.timing.nRC;
  s.tRRD = c.timing.nRRD;
  s.tWR = c.timing.nWR;
  s.tWTR = c.timing.nWTR;
  s.tRTP = c.timing.nRTP;
  s.tRFC = c.timing.nRFC;
  s.tREFI = c.refresh_interval;
  s.tXP = c.timing.nXP;
  s.tXSNR = c.timing.nXSNR;
  s.tXSRD = c.timing.nXSRD;
  s.tCKE = c.timing.nCKE;
  s.banks = c.timing.banks;
  s.mobile = s.refresh_after_sleep = c.timing.mobile;
  return s;
}

/// The controller's command in the checker's words.
inline Command translate(mem::Cmd c) {
  switch (c) {
    case mem::Cmd::kAct:
      return Command::kAct;
    case mem::Cmd::kPre:
      return Command::kPre;
    case mem::Cmd::kPreAll:
      return Command::kPreAll;
    case mem::Cmd::kRd:
      return Command::kRd;
    case mem::Cmd::kWr:
      return Command::kWr;
    case mem::Cmd::kRda:
      return Command::kRda;
    case mem::Cmd::kWra:
      return Command::kWra;
    case mem::Cmd::kPde:
      return Command::kPde;
    case mem::Cmd::kPdx:
      return Command::kPdx;
    case mem::Cmd::kSre:
      return Command::kSre;
    case mem::Cmd::kSrx:
      return Command::kSrx;
    default:
      return Command::kRef;
  }
}

class DdrBench {
 public:
  explicit DdrBench(const BenchOptions& o = {})
      : params_(o),
        store_(params_.size_bytes()),
        ddr(params_, store_, diagnostics),
        checker(with_faw(sheet_of(o.config), o.tFAW)) {
    listening = ddr.observe_commands(&DdrBench::hook, this);
    ddr.set_clocks(o.ddr, o.scr, 0);
    ddr.configure(o.config, 0);
  }
  DdrBench(const DdrBench&) = delete;

  /// Hands the request over at clock edge `clock` of the bench's DDR clock: the controller sees it
  /// at clock + 1 and schedules it from clock + 1 + request_latency.
  bool submit(Request& r, std::uint64_t clock) { return submit_at(r, clock * kTck); }
  bool submit_at(Request& r, Picoseconds at) {
    run_before(at);
    const bool taken = hand_over(r, at);
    if (taken) accept(r, at);
    input_ = !taken;
    return taken;
  }
  /// The same without the bench's bookkeeping: `at` may lie ahead.
  bool hand_over(Request& r, Picoseconds at) {
    r.path.owner = &r;
    r.path.master = r.master;
    r.path.in_path.priority = static_cast<std::uint8_t>(r.priority);
    r.path.write = r.write;
    r.path.bytes = static_cast<std::uint8_t>(r.bytes);
    r.path.critical = r.critical;
    r.path.data = r.data.data();
    return ddr.submit(r.path, r.address, at);
  }
  bool input_taken() const { return input_; }

  /// Takes all decisions strictly before `at`.
  void run_before(Picoseconds at) {
    while (ddr.next_decision() < at) step();
  }
  void drain() {
    while (ddr.next_decision() != kNever) step();
  }
  void step() {
    const Picoseconds t = ddr.next_decision();
    if (t < latest_) went_back = true;
    latest_ = t;
    ddr.step();
    for (const auto& read : ddr.news().reads) done(read);
    if (const auto& accepted = ddr.news().accepted) {
      input_ = false;
      auto& r = *static_cast<Request*>(accepted->request->owner);
      r.unblocked_by = accepted->unblocked_by;
      accept(r, accepted->at);
    }
    ddr.news().clear();
  }
  Picoseconds now() const { return latest_; }

  /// Clock of the n-th (from 0) command of this kind; bank -1: any. ~0 if there is none.
  std::uint64_t clock_of(mem::Cmd cmd, int bank = -1, unsigned n = 0) const {
    for (const Logged& l : log)
      if (l.cmd == cmd && (bank < 0 || l.bank == static_cast<unsigned>(bank)) && n-- == 0)
        return l.clock;
    return ~std::uint64_t{0};
  }
  unsigned count(mem::Cmd cmd) const {
    unsigned n = 0;
    for (const Logged& l : log) n += l.cmd == cmd;
    return n;
  }
  mem::BackingStore& store() { return store_; }

  Diagnostics diagnostics;  ///< of the controller
  std::vector<Logged> log;
  std::vector<Request*> read_order;    // as answered
  std::vector<Request*> accept_order;  // as taken
  bool went_back = false;              // a decision before an earlier one
  bool keep_log = true;

 private:
  struct Params : mem::DdrParams {
    explicit Params(const BenchOptions& o) {
      ParamSet set;
      set.add(*this);
      for (const auto& [key, value] : o.params) set.set("ddr." + key, value);
    }
  };
  static DataSheet with_faw(DataSheet s, unsigned tFAW) {
    s.tFAW = tFAW;
    return s;
  }
  static void hook(void* self, mem::Cmd c, unsigned bank, std::uint32_t row, std::uint64_t clock) {
    auto& b = *static_cast<DdrBench*>(self);
    b.checker.command(translate(c), bank, row, clock);
    if (b.keep_log) b.log.push_back({c, bank, row, clock});
  }
  void accept(Request& r, Picoseconds at) {
    r.accepted = true;
    r.accepted_at = at;
    accept_order.push_back(&r);
  }
  void done(const mem::DdrController::ReadOutcome& read) {
    auto& r = *static_cast<Request*>(read.request->owner);
    ++r.done;
    r.first = read.first;
    r.last = read.last;
    if (r.first <= latest_ || r.last < r.first) went_back = true;
    read_order.push_back(&r);
  }

  Params params_;
  mem::BackingStore store_;
  Picoseconds latest_ = 0;
  bool input_ = false;

 public:
  mem::DdrController ddr;
  CommandChecker checker;
  Subscription listening;  ///< reset(): the controller has no observer
};

/// Byte address of a row and bank with the default map (row : bank : column, 2 KiB rows).
inline std::uint32_t at(std::uint32_t row, unsigned bank, std::uint32_t column = 0,
                        unsigned banks = 8) {
  return (row * banks + bank) * 2048u + column;
}

}  // namespace fovea::dram
