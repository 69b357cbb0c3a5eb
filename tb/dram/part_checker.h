// The command stream against the data sheet of the part on the board. Software may program less
// than the part asks for, and the controller obeys the software: that is a warning, with its
// parameter and margin, not an error of the model. Numbers are typed in from dram.md 1, 2 and 4.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "model/common/units.h"
#include "tb/dram/command_checker.h"

namespace fovea::dram {

/// Minima in ps unless said.
struct Part {
  std::string name;
  bool mobile = false;
  unsigned banks = 8;
  std::array<Picoseconds, 8> tCK{};  ///< shortest clock period by CL; 0: CL not offered
  Picoseconds tRCD = 0, tRP = 0, tRAS = 0, tRC = 0, tRRD = 0, tWR = 0, tRFC = 0;
  Picoseconds tWTR = 0, tRTP = 0, tFAW = 0;
  unsigned tWTR_clocks = 0;  ///< mobile parts give it in clocks
  Picoseconds tREFI = 7'800'000;
};

const std::vector<Part>& parts();
/// @throws std::out_of_range
const Part& part(const std::string& name);

/// The part's numbers in clocks of this frequency: minima rounded up, tREFI down.
DataSheet in_clocks(const Part& part, Frequency clock, unsigned CL);

class PartChecker {
 public:
  struct Warning {
    std::uint64_t count = 0;
    std::uint64_t worst_clocks = 0;  ///< missing at the worst place
  };
  PartChecker(const Part& part, Frequency clock, unsigned CL);
  void command(Command c, unsigned bank, std::uint32_t row, std::uint64_t clock);
  /// By parameter: "tRRD", ...; "tCK" if the clock is too fast for the part at this CL.
  const std::map<std::string, Warning>& warnings() const { return warnings_; }
  /// One line a parameter: how often, by how much, against which part and clock.
  std::string text() const;

 private:
  std::string name_;
  Frequency clock_;
  CommandChecker checker_;
  std::map<std::string, Warning> warnings_;
};

}  // namespace fovea::dram
