#include "model/mem/check/programming.h"

#include <algorithm>

namespace fovea::mem::check {
namespace {

std::string number(std::uint64_t n) { return std::to_string(n); }
std::string clocks(std::uint64_t n) { return number(n) + (n == 1 ? " clock" : " clocks"); }

class Comparison {
 public:
  Comparison(const Part& part, Frequency clock) : part_(part), at_(" at " + megahertz(clock)) {}

  /// `given` clocks are programmed; the part wants `least`, which its sheet gives as `why`.
  void at_least(const char* field, const char* parameter, unsigned given, unsigned least,
                const std::string& why) {
    if (given >= least) return;
    add(std::string(field) + ": " + clocks(given) + " programmed", parameter,
        why + number(least) + at_, number(least - given) + " short");
  }
  void at_most(const std::string& what, const char* parameter, std::uint64_t given,
               std::uint64_t most, Picoseconds limit) {
    if (given <= most) return;
    add(what, parameter, "at most " + nanoseconds(limit) + " = " + number(most) + at_,
        number(given - most) + " over");
  }
  void add(const std::string& what, const char* parameter, const std::string& need,
           const std::string& margin) {
    out.push_back(what + ", " + part_.name + " needs " + parameter + " " + need + ": " + margin);
  }
  std::vector<std::string> out;

 private:
  const Part& part_;
  std::string at_;
};

}  // namespace

std::vector<std::string> violations(const Programmed& programmed, const Part& part,
                                    Frequency clock) {
  const DataSheet& p = programmed.clocks;
  const DataSheet need = in_clocks(part, clock, p.CL);
  Comparison c(part, clock);
  const auto time = [](Picoseconds t) { return nanoseconds(t) + " = "; };
  if (!offers(part, clock, p.CL)) {
    const Picoseconds shortest = p.CL < part.tCK.size() ? part.tCK[p.CL] : 0;
    const std::string limit = shortest ? "CL " + number(p.CL) + " has tCK " +
                                             nanoseconds(shortest) + " at least"
                                       : "CL " + number(p.CL) + " is not offered";
    c.out.push_back("SDBCR CL: " + number(p.CL) + " programmed at " + megahertz(clock) + ", " +
                    part.name + ": " + limit);
  }
  c.at_least("SDTIMR T_RFC", "tRFC", p.tRFC, need.tRFC, time(part.tRFC));
  c.at_least("SDTIMR T_RP", "tRP", p.tRP, need.tRP, time(part.tRP));
  c.at_least("SDTIMR T_RCD", "tRCD", p.tRCD, need.tRCD, time(part.tRCD));
  c.at_least("SDTIMR T_WR", "tWR", p.tWR, need.tWR, time(part.tWR));
  c.at_least("SDTIMR T_RAS", "tRAS", p.tRAS, need.tRAS, time(part.tRAS));
  c.at_least("SDTIMR T_RC", "tRC", p.tRC, need.tRC, time(part.tRC));
  c.at_least("SDTIMR T_RRD", "tRRD", p.tRRD, need.tRRD, time(part.tRRD));
  // The controller has no field for tFAW: five ACT take four times T_RRD.
  if (4 * p.tRRD < need.tFAW)
    c.add("SDTIMR T_RRD: " + clocks(p.tRRD) + " programmed (4 tRRD = " + number(4 * p.tRRD) + ")", "tFAW",
          time(part.tFAW) + number(need.tFAW) + " at " + megahertz(clock),
          number(need.tFAW - 4 * p.tRRD) + " short");
  c.at_least("SDTIMR T_WTR", "tWTR", p.tWTR, need.tWTR, part.tWTR ? time(part.tWTR) : "");
  // tRTP below two clocks counts as two.
  if (!part.mobile)
    c.at_least("SDTIMR2 T_RTP", "tRTP", std::max(p.tRTP, 2u), need.tRTP, time(part.tRTP));
  if (programmed.sleeps) {
    c.at_least("SDTIMR2 T_XP", "tXP", p.tXP, need.tXP, "");
    c.at_least("SDTIMR2 T_CKE", "tCKE", p.tCKE, need.tCKE, "");
    c.at_least("SDTIMR2 T_XSNR", "tXSNR", p.tXSNR, need.tXSNR, time(part.tXSNR));
    c.at_least("SDTIMR2 T_XSRD", "tXSRD", p.tXSRD, need.tXSRD, "");
  }
  c.at_most("SDRCR RR: " + clocks(p.tREFI) + " programmed", "tREFI", p.tREFI, need.tREFI,
            part.tREFI);
  if (p.tREFI)
    c.at_most("SDTIMR2 T_RASMAX: " + number(p.tRASmax / p.tREFI) + " x " + number(p.tREFI) +
                  " clocks programmed",
              "tRASmax", p.tRASmax, need.tRASmax, part.tRASmax);
  return c.out;
}

}  // namespace fovea::mem::check
