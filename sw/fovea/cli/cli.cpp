#include "sw/fovea/cli/cli.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <ctime>
#include <new>
#include <ostream>
#include <system_error>

#include "sw/fovea/cli/cli_exec.h"
#include "sw/fovea/cli/cli_help.h"
#include "sw/fovea/cli/cli_limits.h"
#include "sw/fovea/cli/cli_perfetto.h"
#include "sw/fovea/cli/cli_run.h"
#include "sw/fovea/cli/limits_command.h"
#include "sw/fovea/cli/params_table.h"
#include "sw/fovea/cli/regression_command.h"
#include "sw/fovea/cli/replay_command.h"
#include "sw/fovea/cli/report_command.h"
#include "sw/fovea/cli/trace_command.h"
#include "sw/fovea/console/host_console.h"
#include "sw/fovea/files/child_process.h"
#include "sw/fovea/replay/replay_params.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;

int command_params(const std::vector<std::string>& patterns, bool markdown, bool of_replay,
                   const CliContext& context) {
  ParamSet params;
  ReplayParams replay;
  const auto simulation = context.make_simulation();
  if (of_replay)
    replay.declare(params);
  else
    simulation->declare(params);
  context.out << params_table(params, patterns, markdown) << std::flush;
  return kExitDone;
}

/// The message of a NotModelled that was thrown inside a process of the simulation: SystemC wraps
/// it in an exception of its own. Empty for any other exception.
std::string missing_feature(const std::exception& e) {
  const std::string what = e.what(), mark = "uncaught exception: not modelled: ";
  const auto at = what.find(mark);
  if (at == what.npos) return {};
  const auto from = at + mark.find("not");
  return what.substr(from, what.find('\n', from) - from);
}

/// What the host could not provide (memory, a thread), if that is the reason of the exception;
/// otherwise empty. From inside a SystemC process it arrives as a report that quotes the
/// exception's name.
std::string host_shortage(const std::exception& e) {
  const std::string_view what = e.what();
  if (dynamic_cast<const std::bad_alloc*>(&e) || what.find("std::bad_alloc") != what.npos)
    return "out of memory: the host gives this process no more; allowed: a smaller run, or a "
           "higher limit (ulimit -v, container)";
  if (const auto* refused = dynamic_cast<const std::system_error*>(&e))
    return fmt::format("the host refused: {}", one_line(refused->what()));
  return "";
}

std::atomic<int> g_signal{0};
std::atomic<bool> g_stop{false};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free,
              "a signal handler may only touch lock-free atomics");

/// Signals within this time, in ms, are one: timeout(1) sends each to the program and then to its group.
constexpr std::int64_t kOneSignalMs = 250;
std::atomic<std::int64_t> g_first_ms{0};

/// The first signal asks to stop. A second Ctrl-C ends a program that does not react any more.
void on_signal(int signal) {
  RawTerminal::restore();
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  const std::int64_t ms = std::int64_t{now.tv_sec} * 1000 + now.tv_nsec / 1'000'000;
  if (!g_stop) {
    g_first_ms = ms;
    g_signal = signal;
    g_stop = true;
  } else if (ms - g_first_ms >= kOneSignalMs) {
    kill_children();
    ::signal(signal, SIG_DFL);
    ::raise(signal);  // acts when this handler returns
  }
}

}  // namespace

void install_signals(CliContext& context) {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);
  context.signal = &g_signal;
  context.stop = &g_stop;
}

namespace {

/// Variables that receive the values of the options.
struct Options {
  RunOptions run;
  ReplayOptions replay;
  ExecOptions exec;
  TraceOptions trace;
  ReportOptions report;
  limits::LimitsOptions limits;
  RegressionOptions regression;
  std::vector<std::string> patterns;
  std::string shell;
  bool markdown = false, of_replay = false;
};

constexpr const char* kSet = "Set a parameter; may be repeated";
constexpr const char* kStrict =
    "Stop with an error when the firmware uses a feature that is not modelled, or a parameter that "
    "is set has no effect";

/// Takes one value for each -s, because the name of the experiment may follow it.
void add_set_option(CLI::App& command, std::vector<std::string>& sets) {
  command.add_option("-s,--set", sets, kSet)->type_name("KEY=VALUE")->allow_extra_args(false);
}

void add_around_option(CLI::App& command, std::string& time) {
  command
      .add_option("--around", time,
                  "List all requests to the SDRAM within 2 us of this time (\"80.153412ms\", as slowest.csv has it) in "
                  "requests.csv")
      ->type_name("TIME")
      ->check(CLI::Validator([](const std::string& s) { return s.empty() ? "a time is needed" : std::string(); }, ""));
}

void add_command_trace_option(CLI::App& command, std::string& file) {
  command
      .add_option("--command-trace", file,
                  "Write the commands on the SDRAM's bus to this file: clock,command,bank,row")
      ->type_name("FILE")
      ->check(CLI::Validator([](const std::string& s) { return s.empty() ? "a file name is needed" : std::string(); },
                             ""));
}

void add_run_command(CLI::App& app, RunOptions& run) {
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
  c->add_flag("--strict", run.strict, kStrict);
  add_hazards_option(*c, run.hazards);
  add_profile_option(*c, run.profile);
  c->add_flag("--no-frames", run.no_frames, "Write no pictures");
  c->add_flag("--mp4", run.mp4, "Also write the displayed frames as display.mp4");
  c->add_option("--bus-trace", run.bus_trace,
                "Write all requests to the SDRAM in the measured window to this file")
      ->type_name("FILE");
  c->add_option("--waves", run.waves,
                "Write the waveforms of the RTL remap engine (engine = rtl, both, both_tlm) to this FST file; "
                "the keys waves.* choose which part")
      ->type_name("FILE");
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
}

void add_replay_command(CLI::App& app, ReplayOptions& replay) {
  CLI::App* c =
      app.add_subcommand("replay", "Play a bus trace on crossbar and SDRAM, without the core");
  c->add_option("trace", replay.trace, "File of 'run --bus-trace', or text ('# dramtrace 1')")
      ->required()
      ->type_name("FILE");
  add_set_option(*c, replay.sets);
  c->add_option("-o,--out", replay.out_dir, "Folder for the results")
      ->type_name("DIR")
      ->default_str("out/TRACE");
  add_command_trace_option(*c, replay.command_trace);
  add_around_option(*c, replay.around);
  c->add_flag("--memory-only", replay.memory_only, "Leave the crossbar out");
  c->add_flag("--wrap", replay.wrap,
              "Take addresses beyond the memory (ddr.part) modulo its size");
  c->add_option("--without", replay.without, "Leave out the requests of this master; may be repeated")
      ->type_name("MASTER")
      ->allow_extra_args(false);
}

void add_other_commands(CLI::App& app, Options& options) {
  CLI::App* params =
      app.add_subcommand("params", "List parameters: default, allowed values, source");
  params->add_option("pattern", options.patterns,
                     "Part of a key, or a pattern with * and ?; of several, the keys of each")
      ->type_name("TEXT");
  params->add_flag("--markdown", options.markdown, "As a Markdown table");
  params->add_flag("--replay", options.of_replay, "Those of 'fovea replay'");
  app.add_subcommand("version", "Print version and commit");
  app.add_subcommand("completion", "Print a script that completes commands, options and keys")
      ->add_option("shell", options.shell, "The shell")
      ->required()
      ->check(CLI::IsMember({"bash"}));
  app.add_subcommand("man", "Print the manual page (for 'man -l -')");
}

std::vector<std::string> keys_of(const ParamSet& params) {
  std::vector<std::string> out;
  for (const auto* p : params.all()) out.push_back(p->key());
  return out;
}

int command_completion(const CLI::App& app, const CliContext& context) {
  std::map<std::string, std::vector<std::string>> keys;
  ParamSet run, replay, exec;
  const auto simulation = context.make_simulation();
  simulation->declare(run);
  keys["run"] = keys_of(run);
  keys["limits"] = keys["run"];
  ReplayParams replay_params;
  replay_params.declare(replay);
  keys["replay"] = keys_of(replay);
  if (const auto executor = context.make_executor ? context.make_executor() : nullptr) {
    executor->declare(exec);
    keys["exec"] = keys_of(exec);
  }
  context.out << bash_completion(app, keys) << std::flush;
  return kExitDone;
}

int run_command(const CLI::App& app, Options& o, const std::vector<std::string>& args,
                const CliContext& context) {
  const CLI::App* c = app.get_subcommands().front();
  const std::string name = c->get_name();
  o.run.out_given = name == "run" && c->get_option("--out")->count() > 0;
  o.replay.out_given = name == "replay" && c->get_option("--out")->count() > 0;
  if (name == "run" && c->get_option("--bus-trace")->count() > 0 && o.run.bus_trace.empty())
    throw UserError("--bus-trace '': a file name is needed");
  if (name == "run" && c->get_option("--waves")->count() > 0 && o.run.waves.empty())
    throw UserError("--waves '': a file name is needed");
  if (name == "replay") return command_replay(o.replay, args, context);
  if (name == "run") return command_run(o.run, args, context);
  if (name == "exec") return command_exec(o.exec, args, context);
  if (name == "report") return command_report(o.report, context);
  if (name == "limits") return limits::command_limits(o.limits, context);
  if (is_regression_command(name)) return command_regression(name, o.regression, context);
  if (name == "trace") return command_trace(*c, o.trace, context);
  if (name == "params") return command_params(o.patterns, o.markdown, o.of_replay, context);
  if (name == "completion") return command_completion(app, context);
  if (name == "man")
    context.out << man_page(app, version_text()) << std::flush;
  else
    context.out << "fovea " << version_text() << std::endl;
  return kExitDone;
}

/// CLI11's own message would be that a command is missing.
void check_command(const CLI::App& app, const std::vector<std::string>& args) {
  if (args.empty() || args[0].starts_with("-")) return;
  std::vector<std::string> names;
  for (const auto* c : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (c->check_name(args[0])) return;
    names.push_back(c->get_name());
  }
  throw UserError(
      fmt::format("unknown command '{}'; allowed: {}", one_line(args[0]), fmt::join(names, ", ")));
}

int parse_and_run(const std::vector<std::string>& args, const CliContext& context) {
  Options options;
  CLI::App app("Co-simulation of a fish-eye correction system: DM365 board and its firmware",
               "fovea");
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_version_flag("--version", [] { return "fovea " + version_text(); },
                       "Print version and commit");
  app.require_subcommand(1);
  app.footer(
      "Exit status: 0 done; 1 a comparison or check failed; 2 wrong input, or a result that cannot "
      "be written; 3 the firmware failed; 4 a defect of fovea; 130 or 143 stopped by a signal, with a valid "
      "partial result.");
  add_run_command(app, options.run);
  add_replay_command(app, options.replay);
  limits::add_limits_command(app, options.limits);
  const CLI::App* const exec = add_exec_command(app, options.exec);
  add_trace_command(app, options.trace);
  add_report_command(app, options.report);
  add_regression_commands(app, options.regression);
  add_other_commands(app, options);
  std::vector<std::string> own = args;
  if (!own.empty() && own[0] == exec->get_name())
    options.exec.arguments = take_program_arguments(*exec, own);
  check_command(app, args);
  try {
    app.parse(std::vector<std::string>(own.rbegin(), own.rend()));
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e, context.out, context.err);
    throw UserError(one_line(e.what()) + "; 'fovea --help' shows the commands");
  }
  return run_command(app, options, args, context);
}

/// Says what the exception that is being handled means to the user. Returns the exit status.
int report_failure(const CliContext& context) {
  try {
    throw;
  } catch (const UserError& e) {
    context.err << "fovea: error: " << one_line(e.what(), 2000) << std::endl;
    return kExitWrongInput;
  } catch (const Stopped& e) {
    context.err << "fovea: " << e.what() << "; there are no results" << std::endl;
    return context.signal && context.signal->load() ? 128 + context.signal->load()
                                                    : kExitGuestFailed;
  } catch (const ModelsDiffer& e) {
    context.err << "fovea: " << printable(e.what()) << std::endl;
    return kExitCheckFailed;
  } catch (const GuestFailure& e) {
    context.err << "fovea: the guest failed: " << printable(e.what()) << std::endl;
    return kExitGuestFailed;
  } catch (const NotModelled& e) {
    context.err << "fovea: " << printable(e.what()) << std::endl;
    return kExitGuestFailed;
  } catch (const std::exception& e) {
    if (const std::string why = host_shortage(e); !why.empty()) {
      context.err << "fovea: error: " << why << std::endl;
      return kExitWrongInput;
    }
    if (const std::string what = missing_feature(e); !what.empty()) {
      context.err << "fovea: " << printable(what) << std::endl;
      return kExitGuestFailed;
    }
    context.err << "fovea: own defect: " << printable(e.what()) << std::endl;
    return kExitOwnDefect;
  }
}

}  // namespace

int run_cli(const std::vector<std::string>& args, const CliContext& context) {
  try {
    return parse_and_run(args, context);
  } catch (...) {
    return report_failure(context);
  }
}

}  // namespace fovea::app
