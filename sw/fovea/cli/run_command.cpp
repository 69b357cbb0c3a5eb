// `fovea run`: options, and the run of one experiment into a folder of results.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <optional>
#include <ostream>
#include <string_view>

#include "sw/fovea/cli/command_row.h"
#include "sw/fovea/cli/report_command.h"
#include "sw/fovea/cli/shared_options.h"
#include "sw/fovea/cli/tool_options.h"
#include "sw/fovea/config/experiment.h"
#include "sw/fovea/config/run_until.h"
#include "sw/fovea/console/host_console.h"
#include "sw/fovea/debug/gdb_server.h"
#include "sw/fovea/explain/command.h"
#include "sw/fovea/explain/last_words.h"
#include "sw/fovea/files/png.h"
#include "sw/fovea/files/side_output.h"
#include "sw/fovea/files/warnings.h"
#include "sw/fovea/machine/effective.h"
#include "sw/fovea/machine/progress.h"
#include "sw/fovea/replay/replay_params.h"
#include "sw/fovea/results/names.h"
#include "sw/fovea/results/row_files.h"
#include "sw/fovea/results/run_dir.h"
#include "sw/fovea/results/run_writer.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;

struct RunOptions {
  std::string experiment;
  std::vector<std::string> sets;
  std::string out_dir;
  bool out_given = false;
  std::string sync = "default";
  bool strict = false;
  bool no_frames = false;
  bool mp4 = false;
  std::string gdb;
  ToolOptions tools;
  LimitOptions limits;
  bool console = false;
  bool report = false;
};

/// Adds the keys that only `fovea replay` has, so that an error message can say so.
void add_replay_keys(ParamSet& params) {
  ReplayParams replay;
  ParamSet set;
  replay.declare(set);
  for (const auto* p : set.all()) {
    if (params.find(p->key())) continue;
    const bool clock = p->key() == "ddr.clock" || p->key() == "bus.clock";
    params.add_foreign(p->key(), std::string("is a key of 'fovea replay'; here ") +
                                     (clock ? "clocks.ddr sets the SDRAM's clock, and the crossbar has half of it"
                                            : "the firmware programs it"));
  }
  for (const char* core : {"cpu.clock", "arm.clock", "core.clock"})
    params.add_foreign(core, "does not exist; the core's clock is clocks.arm");
}

/// Loads the experiment and the overrides of the command line into `params`.
void load_experiment(const RunOptions& options, ParamSet& params, Experiment& experiment) {
  experiment.load(options.experiment);
  for (const auto& set : options.sets) experiment.override_with(set);
  options.tools.set_keys(params, experiment);
}

/// Standard input and output as the board's UART0, with --console.
struct RunConsole {
  RunConsole(const RunOptions& options, const std::atomic<bool>& stop, const CliContext& context) {
    if (!options.console) return;
    stream.emplace(context.out, STDIN_FILENO, stop);
    if (!stream->interactive()) return;
    context.err << kConsoleHelp << std::flush;
    raw.emplace(STDIN_FILENO);
  }
  std::optional<ConsoleStream> stream;
  std::optional<RawTerminal> raw;
};

/// The pictures that a run writes: what was displayed, and what the camera sent of it.
class PictureFiles : public FrameSink {
 public:
  PictureFiles(const RunOptions& options, RunDir& dir, const std::atomic<bool>& stop)
      : wanted_(!options.no_frames || options.mp4), displayed_(of_display(options, dir, stop)) {
    if (!options.no_frames)
      sent_.emplace(FrameWriterOptions{.folder = dir.folder() / "camera",
                                       .folder_fd = dir.make_folder("camera")});
  }
  void displayed(const video::Frame& f, PixelShape pixel) override {
    if (wanted_) push(displayed_, f.times.index, f.picture, pixel);
  }
  bool wants_sent() const override { return sent_.has_value(); }
  void sent(std::uint64_t index, const video::Picture& picture, PixelShape pixel) override {
    push(*sent_, index, picture, pixel);
  }
  /// @param lost receives why there is no film
  void close(LostOutputs& lost) {
    displayed_.close();
    if (sent_) sent_->close();
    if (!displayed_.lost_video().empty()) lost.push_back(displayed_.lost_video());
  }

 private:
  static FrameWriterOptions of_display(const RunOptions& options, RunDir& dir, const std::atomic<bool>& stop) {
    FrameWriterOptions out;
    // An encoder that works is waited for also after a signal, since the film belongs to the partial results.
    out.patience = {.stop = &stop, .silence_after_stop = std::chrono::seconds(3)};
    if (!options.no_frames) {
      out.folder = dir.folder() / "frames";
      out.folder_fd = dir.make_folder("frames");
    }
    if (options.mp4) out.mp4 = dir.file("display.mp4");
    return out;
  }
  static void push(FrameWriter& writer, std::uint64_t index, const video::Picture& p, PixelShape pixel) {
    writer.push(index, p.width, p.height, p.uyvy, pixel);
  }

  bool wanted_;
  FrameWriter displayed_;
  std::optional<FrameWriter> sent_;
};

/// What is said at the end of a run.
void report_run(const RunOptions& options, const Result& result, const std::vector<StatRow>& host,
                const RunDir& dir, std::ostream& report) {
  report << run_words(result.stats, host, result.slowest);
  if (find(result.stats, names::kRemapTimeMean))
    report << fmt::format("what binds: {}\n", explain::binds_command(options.experiment, options.sets));
  report << result.table;
  for (const auto& note : result.notes) report << one_line(note) << "\n";
  if (!result.ended.empty()) report << fmt::format("ended by {}\n", result.ended);
  report << fmt::format("results in {}\n", one_line(dir.folder().string(), std::string::npos));
  const StatRow* shown = find(result.stats, names::kDisplayed);
  if (!options.no_frames && shown && shown->value != StatBase::Value(std::uint64_t{0}))
    report << "pictures in its frames/ (displayed) and camera/ (what the camera sent)\n";
  if (const fs::path page = dir.folder() / "report.html"; options.report && fs::exists(page))
    report << fmt::format("report in {}\n", one_line(page.string(), std::string::npos));
  report << std::flush;
}

/// The exit status of a run whose results are written. @throws ModelsDiffer, GuestFailure, UserError
int run_status(const RunOptions& options, const Result& result, bool quit, const CliContext& context) {
  if (!result.untyped.empty())
    context.err << fmt::format("fovea: warning: uart0.input is not over: {}\n", result.untyped);
  if (!result.difference.empty()) throw ModelsDiffer(result.difference);
  if (!result.guest_failure.empty()) throw GuestFailure(result.guest_failure);
  if (options.strict && !result.fault.empty()) throw GuestFailure(result.fault);
  if (!context.out) throw UserError("the program's output cannot be written");
  if (result.complete && result.exit_code.value_or(0) != 0)
    throw GuestFailure(fmt::format("the program ended with status {}", *result.exit_code));
  if (result.complete) return result.lost.empty() ? kExitDone : kExitWrongInput;
  const int signal = context.signal ? context.signal->load() : 0;
  context.err << "fovea: stopped before the end; the figures cover what was simulated\n";
  if (quit) return 128 + SIGINT;
  return signal ? 128 + signal : kExitGuestFailed;
}

Result run_machine(Machine& machine, const Request& request, ProgressMeter& meter) {
  try {
    return machine.run(request);
  } catch (...) {
    meter.finish();
    throw;
  }
}

/// Writes the results and makes the folder the valid one. @return what was measured of the host
std::vector<StatRow> write_results(RunDir& dir, Result& result, const ProgressMeter& meter,
                                   const std::vector<std::string>& args, const RunOptions& options,
                                   const std::string& experiment, const CliContext& context) {
  const bool complete = result.complete && result.guest_failure.empty();
  FinishedRun run{.stats = result.stats,
                  .host = result.host,
                  .complete = complete,
                  .words = {result.ended_by, result.kernel},
                  .warnings = collect_warnings(DiagnosticsRef::current())};
  meter.add_host_rows(run.host);
  std::vector<ResultFile> files = {{"stalls.csv", stalls_csv(result.stalls)},
                                   {"latency.csv", latency_csv(result.latency)},
                                   {"slowest.csv", slowest_csv(result.slowest)},
                                   {"uart.log", result.uart}};
  if (!result.typed.empty()) files.push_back({"uart0.input", result.typed});
  std::ranges::move(result.files, std::back_inserter(files));
  write_run(dir, run, files, args);
  if (options.report)
    side_output("the report", result.lost, [&] {
      write_report(dir, options.out_given ? fs::path(options.out_dir).filename().string() : experiment);
    });
  say_note(dir.commit(complete), context);
  say_lost(result.lost, context);
  context.out.flush();
  return run.host;
}

void take_options(Request& request, const RunOptions& options, const CliContext& context) {
  request.strict_sync = options.sync == "strict";
  if (options.gdb.empty()) return;
  request.gdb_port = parse_gdb_port(options.gdb);
  request.notes = &context.err;
}

CLI::App* add_options(CLI::App& app, RunOptions& run) {
  CLI::App* c = app.add_subcommand("run", "Simulate an experiment");
  c->add_option("experiment", run.experiment, "Experiment: a YAML file, or the name of a shipped one")
      ->required()
      ->type_name("FILE");
  add_set_option(*c, run.sets);
  c->add_option("-o,--out", run.out_dir, "Folder for the results")
      ->type_name("DIR")
      ->default_str("out/EXPERIMENT");
  c->add_option("--sync", run.sync,
                "strict: slow reference mode, same results; default: fast mode")
      ->type_name("MODE")
      ->check(CLI::IsMember({"default", "strict"}))
      ->default_str("default");
  c->add_flag("--strict", run.strict,
              "Stop with an error when the firmware uses a feature that is not modelled, or a parameter that "
              "is set has no effect");
  c->add_flag("--no-frames", run.no_frames, "Write no pictures");
  c->add_flag("--mp4", run.mp4, "Also write the displayed frames as display.mp4");
  c->add_option("--gdb", run.gdb, "Wait for GDB on this port of this host; :0 takes a free one")
      ->type_name(":PORT");
  add_limit_options(*c, run.limits);
  c->add_flag("--report", run.report, "Also make report.html: see 'fovea report'");
  c->add_flag("--console", run.console,
              "Show UART0 on the output and type the input on it; see run.until");
  return c;
}

int run(const RunOptions& options, const std::vector<std::string>& args, const CliContext& context) {
  static const std::atomic<bool> kNeverStops{false};
  std::vector<AskedTool> tools = options.tools.asked(tools_of(MachineKind::kBoard), !options.gdb.empty());
  const WarningScope warnings(context.err, options.strict);  // outlives the machine, whose blocks warn
  const auto machine = context.make_machine(MachineKind::kBoard);
  ParamSet params;
  machine->declare(params);
  add_replay_keys(params);
  Experiment experiment(params);
  load_experiment(options, params, experiment);
  // A condition that is refused has nothing to say about keys that need it.
  if (const ParamBase* until = params.find("run.until")) check_run_until(until->text());
  warn_without_effect(params, experiment);
  say_note(complete_experiment(params, experiment), context);
  const RunLimits limits = limits_of(options.limits);
  const std::optional<ElfImage> symbols = symbols_of(options.limits);

  RunDir dir(options.out_given ? fs::path(options.out_dir)
                               : fs::path("out") / experiment.name(),
             "run");
  options.tools.refuse_inside(dir);
  // First, so that an unfinished folder can be recognised as Fovea's and shows what was tried, and a full disk is
  // noticed before the simulation.
  dir.write("config.json", config_json(params, experiment, provenance_of(params, machine->input_files())));

  const auto& stop = context.stop ? *context.stop : kNeverStops;
  HostConsole semihosting(context.out, context.err, context.stop);
  RunConsole console(options, stop, context);
  // A progress line that is updated in place would overwrite the console's output.
  ProgressMeter meter(context.err, context.terminal && !options.console);
  PictureFiles pictures(options, dir, stop);
  RowFiles rows(dir);
  Request request{.params = params,
                  .stop = stop,
                  .progress = meter,
                  .tools = std::move(tools),
                  .frames = {&rows, &pictures},
                  .timeline_row = [&rows](std::span<const std::string> masters,
                                          const TimelineRow& row) { rows.timeline(masters, row); },
                  .limits = limits,
                  .symbols = symbols ? &*symbols : nullptr,
                  .console = console.stream ? &*console.stream : nullptr,
                  .semihosting = &semihosting};
  take_options(request, options, context);
  Result result = run_machine(*machine, request, meter);
  console.raw.reset();
  meter.finish();
  pictures.close(result.lost);

  rows.finish(result.timeline_masters, result.timeline);
  const std::vector<StatRow> host =
      write_results(dir, result, meter, args, options, experiment.name(), context);
  // With --console the output stream is reserved for UART0.
  report_run(options, result, host, dir, options.console ? context.err : context.out);
  return run_status(options, result, console.stream && console.stream->quit(), context);
}

}  // namespace

std::vector<OfferedKey> keys_of_run(const CliContext& context) {
  ParamSet params;
  const auto machine = context.make_machine(MachineKind::kBoard);
  machine->declare(params);
  return keys_of(params);
}

Command add_run(CLI::App& app) {
  const auto o = std::make_shared<RunOptions>();
  CLI::App* const c = add_options(app, *o);
  return {c,
          [o, c](const Call& call) {
            o->out_given = c->count("--out") > 0;
            return run(*o, call.args, call.context);
          },
          keys_of_run, [o, c](std::span<const ToolRow> rows) { o->tools.add_to(*c, rows); }};
}

}  // namespace fovea::app
