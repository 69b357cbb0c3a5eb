// A tool looks at a run and writes something beside the figures: its row, what it may look at, what it leaves.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model/common/masters.h"
#include "model/common/observers.h"
#include "model/common/param.h"
#include "model/common/units.h"
#include "sw/fovea/results/outputs.h"
#include "sw/fovea/results/run_writer.h"

namespace fovea {
class MemObserver;
namespace board {
class Board;
}
namespace cpu {
class Core;
struct Counts;
}
namespace mem {
class DdrController;
}
namespace memsys {
class MemorySystem;
}
namespace video {
struct Frame;
}
}  // namespace fovea

namespace fovea::app {

class ElfImage;
class Experiment;
class RegisterLog;
class Symbols;

/// What a tool needs of the machine. Each is more than the one before, but for the replay, which has kMemory alone.
enum class ToolNeeds : std::uint8_t { kCore, kMemory, kRegisters, kBoard };

/// An option on the command line. A flag has no type; a number has bounds.
struct ToolOption {
  const char* name;  ///< "--around"
  const char* type;  ///< "TIME"; "": a flag; "FILE": a file that the tool writes
  const char* help;
  const char* missing = "";               ///< what is said of an empty value; "": it may be empty
  const char* fallback = "";              ///< what holds without the option, for the help
  std::vector<std::string> allowed = {};  ///< empty: not a choice
  std::uint64_t least = 0, most = 0;      ///< most = 0: no number
};

/// The options of one tool that were given.
class ToolValues {
 public:
  void set(const std::string& name, std::string text) { values_[name] = std::move(text); }
  bool given(const std::string& name) const { return values_.contains(name); }
  /// @return `otherwise` if the option was not given
  std::string text(const std::string& name, const std::string& otherwise = "") const {
    const auto found = values_.find(name);
    return found == values_.end() ? otherwise : found->second;
  }
  std::uint64_t number(const std::string& name, std::uint64_t otherwise) const {
    return given(name) ? std::stoull(text(name)) : otherwise;
  }

 private:
  std::map<std::string, std::string> values_;
};

/// What a tool may look at. All of it outlives the tool; null: the machine has none.
struct ToolParts {
  const ParamSet& params;
  cpu::Core* core = nullptr;
  std::string program = {};  ///< its file name
  const Symbols* symbols = nullptr;
  std::array<const ElfImage*, 2> programs = {};  ///< the program, and that of --symbols
  bool whole_run = true;     ///< the measured window is the whole run
  mem::DdrController* controller = nullptr;
  std::function<Subscription(MemObserver&)> observe = {};  ///< the requests to the SDRAM
  std::function<std::string(Master)> name_of = {};         ///< of a master, in the figures of this machine
  std::function<Picoseconds()> now = {};  ///< the present time; in a replay, that of its first request
  RegisterLog* log = nullptr;
  memsys::MemorySystem* memory = nullptr;
  board::Board* board = nullptr;
};

/// What tools leave.
struct ToolOutput {
  std::vector<ResultFile> files;
  std::vector<StatRow> stats;      ///< for stats.json, in any order
  std::vector<std::string> notes;  ///< sentences for the user, shown below the figures
  std::string table;               ///< lines for the user, shown behind the figures
  std::string fault;               ///< why a run with --strict fails; empty: nothing was found
};

/// Made before the simulation starts, and gone after it.
class Tool {
 public:
  virtual ~Tool() = default;
  /// The measured window begins, or ends, at the present time.
  virtual void open_window() {}
  virtual void close_window() {}
  /// On the board, now and then, with a time up to which all is decided.
  virtual void settle(Picoseconds) {}
  /// A frame of the window was displayed. May throw UserError.
  virtual void frame(const video::Frame&) {}
  /// After the simulation. @param end the core's counters at the end of the window, or of the run
  /// @throws UserError for an output that cannot be written
  virtual void finish(const cpu::Counts& end, ToolOutput& output) = 0;
};

struct ToolRow {
  const char* what;   ///< its output in a sentence: "the bus trace"
  ToolNeeds needs;
  const char* lacks;  ///< what a machine does not have that cannot give that: "there is no DMA"
  std::vector<ToolOption> options;
  /// @return null if it has nothing to do @throws UserError
  std::unique_ptr<Tool> (*make)(const ToolValues&, const ToolParts&);
  /// Refuses values before anything is begun; may be null. @param debugger --gdb was given @throws UserError
  void (*check)(const ToolValues&, bool debugger) = nullptr;
  /// Sets the keys that stand for an option; may be null. @throws UserError
  void (*keys)(const ToolValues&, const ParamSet&, Experiment&) = nullptr;
};

/// A tool that was asked for.
struct AskedTool {
  const ToolRow* row;
  ToolValues values;
};

/// The tools of one run.
class Tools {
 public:
  /// Makes them in their order. @throws UserError
  void make(std::span<const AskedTool> asked, const ToolParts& parts);
  void open_window();
  /// In reverse order, as finish().
  void close_window();
  void settle(Picoseconds until);
  void frame(const video::Frame& frame);
  /// What cannot be written goes to `lost`.
  void finish(const cpu::Counts& end, ToolOutput& output, std::vector<std::string>& lost);

 private:
  struct Made {
    const char* what;
    std::unique_ptr<Tool> tool;
  };
  std::vector<Made> made_;
};

}  // namespace fovea::app
