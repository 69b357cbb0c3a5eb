#include "model/mem/ddr_check.h"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <stdexcept>

#include "model/mem/check/command_checker.h"
#include "model/mem/check/part_checker.h"
#include "model/mem/check/programming.h"

namespace fovea::mem {
namespace {

/// Copied field by field: the checker shares no types with the controller, so that one error cannot hide in both.
check::DataSheet as_programmed(const DdrConfig& c) {
  check::DataSheet s;
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
  s.tXP = c.timing.nXP;
  s.tXSNR = c.timing.nXSNR;
  s.tXSRD = c.timing.nXSRD;
  s.tCKE = c.timing.nCKE;
  s.tREFI = c.refresh_interval;
  s.tRASmax = std::uint64_t{c.row_intervals} * c.refresh_interval;
  s.banks = c.timing.banks;
  s.mobile = c.timing.mobile;
  s.refresh_after_sleep = c.timing.mobile;
  return s;
}

check::Command word(Cmd c) {
  using enum check::Command;
  switch (c) {
    case Cmd::kAct: return kAct;
    case Cmd::kPre: return kPre;
    case Cmd::kPreAll: return kPreAll;
    case Cmd::kRd: return kRd;
    case Cmd::kWr: return kWr;
    case Cmd::kRda: return kRda;
    case Cmd::kWra: return kWra;
    case Cmd::kPde: return kPde;
    case Cmd::kPdx: return kPdx;
    case Cmd::kSre: return kSre;
    case Cmd::kSrx: return kSrx;
    default: return kRef;
  }
}

check::Part part_of(const DdrParams& params) {
  try {
    return check::find_part(params.part(), params.grade());
  } catch (const std::out_of_range&) {
    throw UserError("key 'ddr.grade': '" + params.grade() + "' is not allowed; ddr.part = " +
                    params.part() + " comes in " +
                    (params.mobile() ? "5, 6, 75" : "37e, 3, 25e, 25"));
  }
}

std::string seconds(Picoseconds at) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9f s", static_cast<double>(at) * 1e-12);
  return text;
}

/// How long a row that is due may stay open: a burst under way goes on, up to eight rows become due
/// together, the scheduler may see no request yet, and what its bank did last takes its time.
unsigned closing_time(const check::DataSheet& s) {
  constexpr unsigned kBurst = 16, kRows = 8, kLatency = 32;
  return kBurst + kRows + kLatency + s.tRAS + s.CL + 4 + std::max(s.tWR, s.tRTP);
}
/// The thresholds are the user's, so the interval's programmed value bounds nothing by itself.
constexpr unsigned kNoRefreshRule = 0;

}  // namespace

struct DdrCheck::Sheet {
  check::Part part;
};

struct DdrCheck::Stream {
  DdrController& controller;
  check::CommandChecker programmed;
  const check::Part& part;
  DiagnosticsRef diagnostics;
  std::optional<check::PartChecker> sheet;
  bool used = false;  // before its first ACT the part holds nothing, however it is programmed
  bool in_reset = false;
  std::map<std::string, std::string> said;  // kind of warning: with the time of its first
  Subscription listening;

  Stream(DdrController& c, const check::Part& of, const DiagnosticsRef& d)
      : controller(c), programmed(rules({})), part(of), diagnostics(d) {
    begin_sheet();
    programmed.on_complaint = [this](const check::Complaint& complaint) {
      FOVEA_CHECK(false, "SDRAM command against the programmed timing: " + complaint.rule +
                             ", bank " + std::to_string(complaint.bank) + ", " +
                             std::to_string(complaint.missing) + " clocks, at " +
                             seconds(controller.ddr_clock().edge(complaint.clock)));
    };
    listening = controller.observe_commands(
        [](void* self, Cmd cmd, unsigned bank, std::uint32_t row, std::uint64_t clock) {
          auto& s = *static_cast<Stream*>(self);
          s.programmed.command(word(cmd), bank, row, clock);
          if (!s.used) {
            if (cmd != Cmd::kAct || s.in_reset) return;
            s.used = true;
            s.sheet->change(s.controller.ddr_clock().frequency(), s.controller.config().timing.CL,
                           clock);
          }
          s.sheet->command(word(cmd), bank, row, clock);
        },
        this);
  }

  void begin_sheet() {
    sheet.emplace(part, Frequency(243'000'000), DdrConfig{}.timing.CL);
    sheet->on_warning = [this](const check::Complaint& complaint, const std::string& kind) {
      const auto [line, first] = said.try_emplace(kind);
      if (first)
        line->second = "SDRAM command bus: " + kind + ", first at " +
                       seconds(controller.ddr_clock().edge(complaint.clock)) + ", bank " +
                       std::to_string(complaint.bank);
      diagnostics.guest(line->second);
    };
  }

  static check::DataSheet rules(const DdrConfig& config) {
    check::DataSheet s = as_programmed(config);
    s.tREFI = kNoRefreshRule;
    if (s.tRASmax) s.tRASmax += closing_time(s);
    return s;
  }
};

DdrCheck::DdrCheck(const DdrParams& params, DdrController& controller, const DiagnosticsRef& diagnostics)
    : diagnostics_(diagnostics), sheet_(new Sheet{part_of(params)}) {
  if (!params.check.is("commands")) return;
  stream_ = std::make_unique<Stream>(controller, sheet_->part, diagnostics_);
  controller.on_change = [this, &controller](Picoseconds at) {
    expect(controller.config(), controller.ddr_clock().frequency(), at);
  };
  controller.on_change(0);
}

DdrCheck::~DdrCheck() {
  if (stream_) stream_->controller.on_change = nullptr;
}

void DdrCheck::expect(const DdrConfig& config, Frequency clock, Picoseconds at) {
  if (!stream_ || clock.stopped()) return;
  const std::uint64_t now = stream_->controller.ddr_clock().edge_after(at);
  stream_->programmed.change(Stream::rules(config), now);
  stream_->sheet->change(clock, config.timing.CL, now);
}

void DdrCheck::restart() {
  if (!stream_) return;
  stream_->begin_sheet();
  stream_->used = false;
  stream_->in_reset = true;
}

void DdrCheck::begin() {
  if (stream_) stream_->in_reset = false;
}

std::vector<std::string> DdrCheck::violations(const DdrConfig& config, Frequency clock) const {
  return check::violations({as_programmed(config), config.low_power != LowPower::kOff},
                           sheet_->part, clock);
}

void DdrCheck::warn(const DdrConfig& config, Frequency clock) const {
  for (const std::string& line : violations(config, clock)) diagnostics_.guest(line);
}

}  // namespace fovea::mem
