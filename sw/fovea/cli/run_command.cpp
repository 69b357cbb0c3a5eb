// `fovea run`: options, and the run of one experiment into a folder of results.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <optional>
#include <ostream>
#include <string_view>

#include "sw/fovea/cli/command_row.h"
#include "sw/fovea/cli/perfetto_options.h"
#include "sw/fovea/cli/report_command.h"
#include "sw/fovea/cli/shared_options.h"
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
#include "sw/fovea/machine/row_files.h"
#include "sw/fovea/replay/replay_params.h"
#include "sw/fovea/results/names.h"
#include "sw/fovea/results/run_dir.h"
#include "sw/fovea/tools/command_trace.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;

struct RunOptions {
  std::string experiment;
  std::vector<std::string> sets;
  std::string out_dir;
  bool out_given = false;
  std::string sync = "default";
  bool strict = false, hazards = false, profile = false;
  bool no_frames = false;
  bool mp4 = false;
  std::string bus_trace, command_trace, waves, around;
  std::string gdb;
  RegisterLogRequest registers;
  PerfettoOptions perfetto;
  LimitOptions limits;
  bool console = false;
  bool report = false;
};

void write_results(RunDir& dir, const RunResult& result, const ProgressMeter& meter,
                   const std::vector<std::string>& args, std::vector<StatRow>& host, bool log) {
  host = result.host;
  meter.add_host_rows(host);
  dir.write("stalls.csv", stalls_csv(result.stalls));
  dir.write("latency.csv", latency_csv(result.latency));
  dir.write("slowest.csv", slowest_csv(result.slowest));
  if (!result.around.empty()) dir.write("requests.csv", result.around);
  for (const ResultFile& f : result.profile.files) dir.write(f.name, f.text);
  dir.write("uart.log", result.uart);
  if (!result.typed.empty()) dir.write("uart0.input", result.typed);
  if (log) dir.write("registers.log", result.registers);
  dir.write("host.json", host_json(host, args, version_text()));
  // Written last: if stats.json exists, all other files do.
  dir.write("stats.json", stats_json(result.stats, result.complete && result.guest_failure.empty(),
                                     collect_warnings(Diagnostics::instance()), {result.ended_by, result.kernel}));
}

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

/// --waves is the key waves.file, for which there must be an RTL.
void set_waves(const std::string& file, const ParamSet& params, Experiment& experiment) {
  experiment.override_with("waves.file=" + file);
  const ParamBase* engine = params.find("engine");
  if (!engine || engine->text() == "none" || engine->text() == "tlm")
    throw UserError(fmt::format("--waves '{}': it records the RTL of the remap engine, and key 'engine' is {}; "
                                "allowed: rtl, both, both_tlm",
                                one_line(file), engine ? engine->text() : "unknown"));
}

/// Loads the experiment and the overrides of the command line into `params`.
void load_experiment(const RunOptions& options, ParamSet& params, Experiment& experiment) {
  experiment.load(options.experiment);
  for (const auto& set : options.sets) experiment.override_with(set);
  if (!options.waves.empty()) set_waves(options.waves, params, experiment);
}

/// A file that is kept apart from the results must not lie among them. @throws UserError
void refuse_inside(const RunDir& dir, const char* option, const fs::path& file) {
  if (file.empty() || !dir.covers(file)) return;
  throw UserError(fmt::format("{} '{}': it lies in the output folder, which holds the files of a run only; "
                              "choose a place beside it",
                              option, one_line(file.string())));
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
void report_run(const RunOptions& options, const RunResult& result, const std::vector<StatRow>& host,
                const RunDir& dir, std::ostream& report) {
  report << run_words(result.stats, host, result.slowest);
  if (find(result.stats, names::kRemapTimeMean))
    report << fmt::format("what binds: {}\n", explain::binds_command(options.experiment, options.sets));
  report << result.profile.table;
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
int run_status(const RunOptions& options, const RunResult& result, bool quit, const CliContext& context) {
  if (!result.untyped.empty())
    context.err << fmt::format("fovea: warning: uart0.input is not over: {}\n", result.untyped);
  if (!result.difference.empty()) throw ModelsDiffer(result.difference);
  if (!result.guest_failure.empty()) throw GuestFailure(result.guest_failure);
  if (options.strict && !result.hazards.empty()) throw GuestFailure(result.hazards);
  if (!context.out) throw UserError("the program's output cannot be written");
  if (result.complete && result.exit_code.value_or(0) != 0)
    throw GuestFailure(fmt::format("the program ended with status {}", *result.exit_code));
  if (result.complete) return result.lost.empty() ? kExitDone : kExitWrongInput;
  const int signal = context.signal ? context.signal->load() : 0;
  context.err << "fovea: stopped before the end; the figures cover what was simulated\n";
  if (quit) return 128 + SIGINT;
  return signal ? 128 + signal : kExitGuestFailed;
}

RunResult run_simulation(Simulation& simulation, const RunRequest& request, ProgressMeter& meter) {
  try {
    return simulation.run(request);
  } catch (...) {
    meter.finish();
    throw;
  }
}

/// Folder, `config.json` first, so that an unfinished folder can be recognised as Fovea's and shows what was tried,
/// and a full disk is noticed before the simulation.
void begin_folder(RunDir& dir, const RunOptions& options, const PerfettoRequest& perfetto,
                  std::string_view config) {
  refuse_inside(dir, "--bus-trace", options.bus_trace);
  refuse_inside(dir, "--waves", options.waves);
  refuse_inside(dir, "--perfetto", perfetto.file);
  if (!options.command_trace.empty()) check_command_trace(options.command_trace, dir);
  dir.write("config.json", config);
}

/// Writes the results and makes the folder the valid one. @return what was measured of the host
std::vector<StatRow> write_run(RunDir& dir, RunResult& result, ProgressMeter& meter,
                               const std::vector<std::string>& args, const RunOptions& options,
                               const std::string& experiment, const CliContext& context) {
  std::vector<StatRow> host;
  write_results(dir, result, meter, args, host, !options.registers.pattern.empty());
  if (options.report)
    side_output("the report", result.lost, [&] {
      write_report(dir, options.out_given ? fs::path(options.out_dir).filename().string() : experiment);
    });
  say_note(dir.commit(result.complete && result.guest_failure.empty()), context);
  say_lost(result.lost, context);
  context.out.flush();
  return host;
}

void take_options(RunRequest& request, const RunOptions& options, const CliContext& context) {
  request.strict_sync = options.sync == "strict";
  request.profile = options.profile;
  request.hazards = options.hazards;
  request.command_trace = options.command_trace;
  request.bus_trace = options.bus_trace;
  request.registers = options.registers;
  if (!options.around.empty()) request.around = parse_time("--around", options.around);
  if (options.gdb.empty()) return;
  request.gdb_port = parse_gdb_port(options.gdb);
  request.notes = &context.err;
}

/// Adds an option for the name of a file, which is not empty.
void add_file_option(CLI::App& command, const char* name, std::string& file, const char* help) {
  command.add_option(name, file, help)
      ->type_name("FILE")
      ->each([name](const std::string& s) {
        if (s.empty()) throw UserError(std::string(name) + " '': a file name is needed");
      });
}

CLI::App* add_options(CLI::App& app, RunOptions& run) {
  CLI::App* c = app.add_subcommand("run", "Simulate an experiment");
  c->add_option("experiment", run.experiment, "Experiment file (YAML)")
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
  add_hazards_option(*c, run.hazards);
  add_profile_option(*c, run.profile);
  c->add_flag("--no-frames", run.no_frames, "Write no pictures");
  c->add_flag("--mp4", run.mp4, "Also write the displayed frames as display.mp4");
  add_file_option(*c, "--bus-trace", run.bus_trace,
                  "Write all requests to the SDRAM in the measured window to this file");
  add_file_option(*c, "--waves", run.waves,
                  "Write the waveforms of the RTL remap engine (engine = rtl, both, both_tlm) to this FST file; "
                  "the keys waves.* choose which part");
  add_command_trace_option(*c, run.command_trace);
  add_around_option(*c, run.around);
  add_perfetto_options(*c, run.perfetto);
  c->add_option("--gdb", run.gdb, "Wait for GDB on this port of this host; :0 takes a free one")
      ->type_name(":PORT");
  add_register_log_options(*c, run.registers);
  add_limit_options(*c, run.limits);
  c->add_flag("--report", run.report, "Also make report.html: see 'fovea report'");
  c->add_flag("--console", run.console,
              "Show UART0 on the output and type the input on it; see run.until");
  return c;
}

int run(const RunOptions& options, const std::vector<std::string>& args, const CliContext& context) {
  static const std::atomic<bool> kNeverStops{false};
  check_register_log(options.registers, options.gdb);
  const auto simulation = context.make_simulation();
  ParamSet params;
  simulation->declare(params);
  add_replay_keys(params);
  Experiment experiment(params);
  load_experiment(options, params, experiment);
  const WarningScope warnings(context.err, options.strict);
  // A condition that is refused has nothing to say about keys that need it.
  if (const ParamBase* until = params.find("run.until")) check_run_until(until->text());
  warn_without_effect(params, experiment);
  say_note(complete_experiment(params, experiment), context);
  const RunLimits limits = limits_of(options.limits);
  const std::optional<ElfImage> symbols = symbols_of(options.limits);

  RunDir dir(options.out_given ? fs::path(options.out_dir)
                               : fs::path("out") / experiment.name(),
             "run");
  const PerfettoRequest perfetto = perfetto_of(options.perfetto);
  begin_folder(dir, options, perfetto,
               config_json(params, experiment, provenance_of(params, simulation->input_files())));

  const auto& stop = context.stop ? *context.stop : kNeverStops;
  HostConsole semihosting(context.out, context.err, context.stop);
  RunConsole console(options, stop, context);
  // A progress line that is updated in place would overwrite the console's output.
  ProgressMeter meter(context.err, context.terminal && !options.console);
  PictureFiles pictures(options, dir, stop);
  RunRequest request{.params = params,
                     .folder = dir.folder(),
                     .stop = stop,
                     .progress = meter,
                     .perfetto = perfetto,
                     .limits = limits,
                     .symbols = symbols ? &*symbols : nullptr,
                     .console = console.stream ? &*console.stream : nullptr,
                     .semihosting = &semihosting};
  take_options(request, options, context);
  RowFiles rows(dir);
  rows.attach(request);
  request.frames.push_back(&pictures);
  RunResult result = run_simulation(*simulation, request, meter);
  console.raw.reset();
  meter.finish();
  pictures.close(result.lost);

  rows.finish(result);
  const std::vector<StatRow> host =
      write_run(dir, result, meter, args, options, experiment.name(), context);
  // With --console the output stream is reserved for UART0.
  report_run(options, result, host, dir, options.console ? context.err : context.out);
  return run_status(options, result, console.stream && console.stream->quit(), context);
}

}  // namespace

std::vector<std::string> keys_of_run(const CliContext& context) {
  ParamSet params;
  const auto simulation = context.make_simulation();
  simulation->declare(params);
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
          keys_of_run};
}

}  // namespace fovea::app
