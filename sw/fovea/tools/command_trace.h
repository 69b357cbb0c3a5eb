// `--command-trace FILE`: the commands on the SDRAM's bus, as CSV text.
#pragma once
#include <cstdint>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>

#include "model/mem/core/ddr_controller.h"
#include "sw/fovea/files/output_file.h"

namespace fovea::app {

/// Lines `clock,command,bank,row`. Clock k is the k-th edge of the SDRAM's clock since that clock
/// started. Commands are ACT, PRE, PREA, RD, WR, RDA, WRA (with auto-precharge), REF, PDE, PDX
/// (power-down), SRE, SRX (self-refresh); bank and row are empty where a command has none. OPEN is no
/// command: a row that is open when the trace begins.
class CommandTrace {
 public:
  static constexpr std::string_view kHeader = "clock,command,bank,row\n";

  /// Opens the file. @throws UserError
  explicit CommandTrace(const std::filesystem::path& file);
  CommandTrace(const CommandTrace&) = delete;
  CommandTrace& operator=(const CommandTrace&) = delete;

  /// Traces the commands from time `at` on, up to which the controller has caught up.
  void begin(mem::DdrController& controller, Picoseconds at);
  /// Traces no further ones.
  void end();
  /// Gives the complete file its name. @throws UserError, for lines that could not be written too
  void finish();

 private:
  void line(std::uint64_t clock, std::string_view command, bool bank, unsigned bank_number, bool row,
            std::uint32_t row_number);
  static void hook(void* self, mem::Cmd cmd, unsigned bank, std::uint32_t row, std::uint64_t clock);

  OutputFile file_;
  Subscription listening_;
  std::exception_ptr failure_;  // an error must not unwind through the simulation
};

}  // namespace fovea::app
