// What the comparison with the reference sees of a run, and how the command checkers read it.
#pragma once
#include <cstdint>
#include <vector>

#include "tb/dram/command_checker.h"
#include "tb/dram/reference_controller.h"

namespace fovea::dram {

/// What an observer sees of a run.
struct Event {
  std::uint64_t what, a, b, c;
  friend bool operator==(const Event&, const Event&) = default;
};
enum What : std::uint64_t { kCommand, kAccepted, kRead, kTaken, kSample };

/// @return how many commands the checker was given
template <class Checker>
std::uint64_t feed(Checker& checker, const std::vector<Event>& seen) {
  std::uint64_t commands = 0;
  for (const Event& e : seen) {
    if (e.what != kCommand) continue;
    ++commands;
    checker.command(static_cast<Command>(e.a), static_cast<unsigned>(e.b >> 32), static_cast<std::uint32_t>(e.b), e.c);
  }
  return commands;
}

/// Refreshes may be postponed up to the level at which the controller must give them, and that one.
inline DataSheet sheet_of(const ReferenceConfig& c, const ReferenceLimits& limits) {
  DataSheet s;
  s.CL = c.CL;
  s.tRCD = c.tRCD;
  s.tRP = c.tRP;
  s.tRAS = c.tRAS;
  s.tRC = c.tRC;
  s.tRRD = c.tRRD;
  s.tWR = c.tWR;
  s.tWTR = c.tWTR;
  s.tRTP = c.tRTP;
  s.tRFC = c.tRFC;
  s.tREFI = c.refresh_interval;
  s.postponed_max = limits.must + 1;
  s.tXP = c.tXP;
  s.tXSNR = c.tXSNR;
  s.tXSRD = c.tXSRD;
  s.tCKE = c.tCKE;
  s.banks = c.banks;
  s.mobile = s.refresh_after_sleep = c.mobile;
  return s;
}

}  // namespace fovea::dram
