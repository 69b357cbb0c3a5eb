// The command stream against the data sheet of the part on the board. Software may program less than
// the part asks for, and the controller obeys the software: that is a warning about the software,
// with parameter, margin and time, not a defect of the model.
#pragma once
#include <functional>
#include <map>
#include <string>

#include "model/mem/check/command_checker.h"
#include "model/mem/check/data_sheet.h"

namespace fovea::mem::check {

class PartChecker {
 public:
  struct Warning {
    std::uint64_t count = 0;
    std::uint64_t worst_clocks = 0;  ///< missing at the worst place
  };
  PartChecker(const Part& part, Frequency clock, unsigned CL);
  PartChecker(const PartChecker&) = delete;
  /// Another clock or CL from this clock number on.
  void change(Frequency clock, unsigned CL, std::uint64_t from);
  void command(Command c, unsigned bank, std::uint32_t row, std::uint64_t clock) {
    checker_.command(c, bank, row, clock);
  }
  /// By parameter: "tRRD", ...; "tCK" if the clock is too fast for the part at this CL.
  const std::map<std::string, Warning>& warnings() const { return warnings_; }
  /// One line a parameter: how often, by how much, against which part and clock.
  std::string text() const;
  /// Called with each complaint and the line that describes its kind, without the time.
  std::function<void(const Complaint&, const std::string&)> on_warning;

 private:
  void complained(const Complaint& complaint);
  void check_clock(unsigned CL);
  std::string margin(std::uint64_t clocks) const;

  Part part_;
  Frequency clock_;
  CommandChecker checker_;
  std::map<std::string, Warning> warnings_;
};

}  // namespace fovea::mem::check
