#include "sw/fovea/cli/exec_command.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <optional>
#include <ostream>

#include "sw/fovea/cli/command_row.h"
#include "sw/fovea/config/experiment.h"
#include "sw/fovea/console/console.h"
#include "sw/fovea/console/host_console.h"
#include "sw/fovea/debug/gdb_server.h"
#include "sw/fovea/explain/last_words.h"
#include "sw/fovea/files/warnings.h"
#include "sw/fovea/machine/progress.h"
#include "sw/fovea/results/run_dir.h"
#include "sw/fovea/results/run_writer.h"

namespace fovea::app {
namespace {

constexpr const char* kMemoryHelp =
    "Memory: RAM of the SDRAM's size (ddr.part), from the multiple of that size at or below the "
    "program's lowest address, which is 0 for newlib's default link address; -s exec.ram_base=ADDR "
    "moves it. RAM at 0 hides the chip's internal RAM; other programs find it at 0x0 and 0x10000. "
    "Heap and stack share the largest part that the program leaves free; the stack starts at its "
    "end. There are no peripherals (UART, timers, ...): accesses to them are bus errors. With RAM "
    "above 0x20000000 the SDRAM controller's registers exist. --board uses the chip's own memory "
    "map with all its peripherals instead: RAM at 0x80000000.\n"
    "Unknown options and everything after '--' are passed to the program, and so is everything "
    "after the program that is not an option of exec.\n"
    "Exit status: the program's own; 2 wrong input; 3 the program failed; 4 a defect of fovea, "
    "each with a line that begins with 'fovea:'; 130 or 143 stopped by a signal.";

ExecProgram program_of(const ExecOptions& o) {
  const bool flat = !o.load.empty() || !o.entry.empty() || o.thumb;
  if (!flat) return ExecProgram::elf(o.program);
  if (o.load.empty() || o.entry.empty())
    throw UserError("a flat binary needs both --load ADDR and --entry ADDR; an ELF file none");
  const std::uint32_t entry = parse_address("--entry", o.entry);
  if (entry & (o.thumb ? 1u : 3u))
    throw UserError(fmt::format("--entry '{}' is not aligned; allowed: multiples of {}", o.entry,
                                o.thumb ? 2 : 4));
  return ExecProgram::flat(o.program, parse_address("--load", o.load), entry | (o.thumb ? 1u : 0u));
}

}  // namespace

CLI::App* add_exec_command(CLI::App& app, ExecOptions& o) {
  CLI::App* c = app.add_subcommand("exec", "Run a program on core and memory, with semihosting");
  c->add_option("program", o.program, "ELF file, or a flat binary with --load and --entry")
      ->required()
      ->type_name("FILE");
  c->add_option("--load", o.load, "Address of a flat binary's first byte")->type_name("ADDR");
  c->add_option("--entry", o.entry, "Address of a flat binary's first instruction")
      ->type_name("ADDR");
  c->add_flag("--thumb", o.thumb, "A flat binary begins in Thumb state");
  c->add_flag("--caches", o.caches,
              "Begin with MMU and caches on: RAM cacheable and write-back, everything else not");
  c->add_flag("--fast-memory", o.fast_memory, "Memory without wait states; no bus and no SDRAM");
  c->add_flag("--board", o.board,
              "On the whole board, with peripherals; UART0 is shown on the output");
  c->add_flag("--console", o.console, "With --board: the input is typed on UART0");
  c->add_option("--root", o.root, "Folder of the program's files; without it there are none")
      ->type_name("DIR");
  add_set_option(*c, o.sets);
  c->add_option("-o,--out", o.out_dir,
                "Folder for stats.json, stalls.csv, config.json and host.json")
      ->type_name("DIR");
  c->add_option("--gdb", o.gdb, "Wait for GDB on this port of this host; :0 takes a free one")
      ->type_name(":PORT");
  add_limit_options(*c, o.limits);
  c->add_flag("--strict", o.strict,
              "Stop with an error when the program uses a feature that is not modelled, or a "
              "parameter that is set has no effect");
  c->add_flag("-q,--quiet", o.quiet, "Print no figures, hints and warnings; errors only");
  c->footer(kMemoryHelp);
  return c;
}

std::vector<std::string> take_program_arguments(const CLI::App& exec,
                                                std::vector<std::string>& args) {
  // CLI11's prefix_command() is not enough: version 2.1 refuses the '--' of `exec PROGRAM -- ARGS`
  // and reverses the arguments behind it.
  const auto option_of = [&](const std::string& a) -> const CLI::Option* {
    if (!a.starts_with('-') || a == "-") return nullptr;
    const bool with_value = a.starts_with("--") && a.find('=') != a.npos;
    return exec.get_option_no_throw(with_value ? a.substr(0, a.find('=')) : a);
  };
  std::vector<std::string> own, guest;
  bool program = false, value = false, all = false;
  for (std::size_t i = 0; i < args.size(); ++i) {
    const std::string& a = args[i];
    if (i == 0 || value) {  // the command, or the value of an option
      own.push_back(a);
      value = false;
    } else if (all) {
      guest.push_back(a);
    } else if (a == "--" && program) {
      all = true;
    } else if (const CLI::Option* option = option_of(a)) {
      own.push_back(a);
      value = option->get_items_expected_max() > 0 && a.find('=') == a.npos;
    } else if (!program) {
      own.push_back(a);
      program = !a.starts_with('-');
    } else {
      guest.push_back(a);
    }
  }
  args = std::move(own);
  return guest;
}

namespace {

bool caches_unused(std::span<const StatRow> stats) {
  const StatRow* row = find(stats, "cpu.icache.accesses");
  return row && row->value == StatBase::Value{std::uint64_t{0}};
}

/// Options that do not go together. @throws UserError
void refuse_combinations(const ExecOptions& o) {
  if (o.console && !o.board) throw UserError("--console: there is no UART; allowed: with --board");
  if (o.board && (o.fast_memory || o.caches || !o.load.empty() || !o.entry.empty() || o.thumb))
    throw UserError(
        "--board: not with --fast-memory or --caches, nor with a flat binary; allowed: an ELF "
        "file");
}

/// What ran, for config.json: the options that decide the result.
Provenance origin_of(const ParamSet& params, const ExecOptions& o) {
  Provenance out = provenance_of(params, {}, {{"program", o.program}});
  out.command = "exec";
  out.input = std::filesystem::path(o.program).filename().string();
  out.arguments = o.arguments;
  for (const auto& [set, word] :
       {std::pair(o.board, "--board"), {o.caches, "--caches"}, {o.fast_memory, "--fast-memory"}, {o.thumb, "--thumb"}})
    if (set) out.options.push_back(word);
  for (const auto& [word, value] : {std::pair("--load", o.load), {"--entry", o.entry}})
    if (!value.empty()) out.options.insert(out.options.end(), {word, value});
  return out;
}

/// The keys that a program sets by running on the board, and those of the command line.
void set_keys(const ExecOptions& o, Experiment& experiment) {
  if (o.board) {
    experiment.preset("camera.kind", "chart", "exec --board");
    experiment.preset("camera.stamp", "false", "exec --board");
    experiment.preset("run.until", "[exit, halt]", "exec --board");
  }
  for (const auto& set : o.sets) experiment.override_with(set);
  if (o.board) experiment.preset("firmware.elf", o.program, "command line");
}

void warn_of_fast_memory(const ParamSet& params, const Experiment& experiment) {
  for (const auto* p : params.all())
    if (experiment.rank(p->key()) >= 0 && p->key() != "ddr.part" &&
        (p->key().starts_with("bus.") || p->key().starts_with("ddr.")))
      DiagnosticsRef::current().configuration(
          fmt::format("'{}' is set but has no effect with --fast-memory, which has no bus and no SDRAM", p->key()));
}

/// What is said after a program has ended.
void report_program(const ExecOptions& o, const Result& result, std::ostream& err) {
  err << exec_words(result.stats, result.core_clock);
  if (!o.caches && !o.fast_memory && !o.board && caches_unused(result.stats))
    err << "The program ran with MMU and caches off. 'fovea exec --caches' turns them on.\n";
  if (!result.ended.empty() && !result.exit_code) err << "ended by " << result.ended << "\n";
  for (const std::string& note : result.notes) err << one_line(note) << "\n";
  err << std::flush;
}

void write_results(const Result& result, const std::vector<std::string>& args, RunDir& dir,
                   const CliContext& context) {
  const bool complete = result.complete && result.guest_failure.empty();
  std::vector<ResultFile> files = {{"stalls.csv", stalls_csv(result.stalls)}};
  files.insert(files.end(), result.files.begin(), result.files.end());
  write_run(dir,
            {.stats = result.stats,
             .host = result.host,
             .complete = complete,
             .warnings = collect_warnings(DiagnosticsRef::current())},
            files, args);
  say_note(dir.commit(complete), context);
}

/// How the run ended that is not in its result.
struct Ended {
  bool left = false;         ///< the user left the console
  bool output_lost = false;  ///< the program's output could not be written
};

/// The exit status. @throws ModelsDiffer, GuestFailure, UserError
int program_status(const ExecOptions& o, const Result& result, const Ended& how, const CliContext& context) {
  if (!result.difference.empty()) throw ModelsDiffer(result.difference);
  if (!result.guest_failure.empty()) throw GuestFailure(result.guest_failure);
  if (o.strict && !result.fault.empty()) throw GuestFailure(result.fault);
  if (how.output_lost) throw UserError("the program's output cannot be written");
  if (result.complete) return result.lost.empty() ? result.exit_code.value_or(0) : kExitWrongInput;
  const int signal = context.signal ? context.signal->load() : 0;
  context.err << fmt::format("fovea: stopped {}; the figures cover what was simulated\n",
                             result.killed && !signal ? "by the debugger" : "before the end");
  if (how.left) return 128 + SIGINT;
  return signal ? 128 + signal : kExitGuestFailed;
}

MachineKind kind_of(const ExecOptions& o) {
  return o.board ? MachineKind::kProgramBoard : o.fast_memory ? MachineKind::kFlat : MachineKind::kCore;
}

/// UART0 of the board on the output and, with --console, the input. The core alone has none.
struct Uart {
  Uart(const ExecOptions& o, const std::atomic<bool>& stop, const CliContext& context) {
    if (!o.board) return;
    stream.emplace(context.out, o.console ? STDIN_FILENO : -1, stop);
    if (!stream->interactive()) return;
    context.err << kConsoleHelp << std::flush;
    raw.emplace(STDIN_FILENO);
  }
  std::optional<ConsoleStream> stream;
  std::optional<RawTerminal> raw;
};

int exec(const ExecOptions& o, const std::vector<std::string>& args, const CliContext& context) {
  static const std::atomic<bool> kNeverStops{false};
  refuse_combinations(o);
  const MachineKind kind = kind_of(o);
  std::vector<AskedTool> tools =
      o.tools.asked(tools_of(kind), !o.gdb.empty(), o.fast_memory ? "without --fast-memory" : "with --board");
  const auto machine = context.make_machine(kind);
  ParamSet params;
  machine->declare(params);
  Experiment experiment(params);
  set_keys(o, experiment);
  o.tools.set_keys(params, experiment);
  const RunLimits limits = limits_of(o.limits);
  const std::optional<ElfImage> symbols = symbols_of(o.limits);
  std::ostream nowhere(nullptr);
  const WarningScope warnings(o.quiet ? nowhere : context.err, o.strict);
  warn_without_effect(params, experiment);
  if (o.fast_memory) warn_of_fast_memory(params, experiment);
  const ExecProgram program = program_of(o);
  std::optional<std::uint16_t> gdb_port;
  if (!o.gdb.empty()) gdb_port = parse_gdb_port(o.gdb);

  std::optional<RunDir> dir;
  if (!o.out_dir.empty()) {
    dir.emplace(o.out_dir, "exec");
    o.tools.refuse_inside(*dir);
    dir->write("config.json", config_json(params, experiment, origin_of(params, o)));
  }
  const std::atomic<bool>& stop = context.stop ? *context.stop : kNeverStops;
  HostConsole semihosting(context.out, context.err, context.stop);
  // Never updated in place, because the program writes to the same terminal.
  ProgressMeter meter(o.quiet ? nowhere : context.err, false);
  Uart uart(o, stop, context);
  const Result result = machine->run({.params = params,
                                      .stop = stop,
                                      .progress = meter,
                                      .tools = std::move(tools),
                                      .gdb_port = gdb_port,
                                      .notes = &context.err,
                                      .limits = limits,
                                      .symbols = symbols ? &*symbols : nullptr,
                                      .console = uart.stream ? &*uart.stream : nullptr,
                                      .semihosting = &semihosting,
                                      .program = UserProgram{program, o.root, o.arguments, o.caches}});
  uart.raw.reset();
  context.out.flush();
  const Ended how{uart.stream && uart.stream->quit(), !context.out};
  if (!o.quiet) report_program(o, result, context.err);
  context.err << result.table;
  if (dir)
    write_results(result, args, *dir, context);
  else
    for (const ResultFile& f : result.files)
      if (f.shown) context.err << f.text << std::flush;
  say_lost(result.lost, context);
  return program_status(o, result, how, context);
}

}  // namespace

Command add_exec(CLI::App& app) {
  const auto o = std::make_shared<ExecOptions>();
  CLI::App* const c = add_exec_command(app, *o);
  return {c, [o](const Call& call) { return exec(*o, call.args, call.context); },
          [](const CliContext& context) {
            ParamSet params;
            const auto machine = context.make_machine(MachineKind::kCore);
            machine->declare(params);
            return keys_of(params);
          },
          [o, c](std::span<const ToolRow> rows) { o->tools.add_to(*c, rows); },
          [o, c](std::vector<std::string>& args) { o->arguments = take_program_arguments(*c, args); }};
}

}  // namespace fovea::app
