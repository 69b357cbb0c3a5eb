#include "sw/fovea/cli.h"

#include <fmt/format.h>
#include <fnmatch.h>
#include <signal.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <new>
#include <ostream>
#include <system_error>

#include "sw/fovea/cli_exec.h"
#include "sw/fovea/experiment.h"
#include "sw/fovea/ffmpeg.h"
#include "sw/fovea/gdb_server.h"
#include "sw/fovea/png.h"
#include "sw/fovea/progress.h"
#include "sw/fovea/remarks.h"
#include "sw/fovea/replay_command.h"
#include "sw/fovea/replay_params.h"
#include "sw/fovea/row_files.h"
#include "sw/fovea/run_dir.h"

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
  std::string bus_trace;
  std::string gdb;
  RegisterLogRequest registers;
};

void write_results(RunDir& dir, const RunResult& result, const ProgressMeter& meter,
                   const std::vector<std::string>& args, std::vector<StatRow>& host, bool log) {
  host = result.host;
  meter.add_host_rows(host);
  dir.write("stalls.csv", stalls_csv(result.stalls));
  dir.write("uart.log", result.uart);
  if (log) dir.write("registers.log", result.registers);
  dir.write("host.json", host_json(host, args, version_text()));
  // Last: who finds stats.json finds all the rest.
  dir.write("stats.json", stats_json(result.stats, result.complete && result.guest_failure.empty(),
                                     collect_remarks(Diagnostics::instance())));
}

int command_run(const RunOptions& options, const std::vector<std::string>& args,
                const CliContext& context) {
  static const std::atomic<bool> kNeverStops{false};
  check_register_log(options.registers, options.gdb);
  const auto simulation = context.make_simulation();
  ParamSet params;
  simulation->declare(params);
  Experiment experiment(params);
  experiment.load(options.experiment);
  for (const auto& set : options.sets) experiment.override_with(set);

  RunDir dir(options.out_given ? fs::path(options.out_dir)
                               : fs::path("out") / experiment.name(),
             "run");
  if (!options.bus_trace.empty() && dir.covers(options.bus_trace))
    throw UserError(fmt::format("--bus-trace '{}': it lies in the output folder, which holds the "
                                "files of a run only; choose a place beside it",
                                one_line(options.bus_trace)));
  // First, so that an unfinished folder is known as ours and says what was tried, and a full disk
  // shows before the simulation.
  dir.write("config.json", config_json(params, experiment, version_text()));

  const RemarkScope remarks(context.err, options.strict);
  ProgressMeter meter(context.err, context.terminal);
  FrameWriterOptions writer_options;
  if (!options.no_frames) {
    writer_options.folder = dir.folder() / "frames";
    writer_options.folder_fd = dir.make_folder("frames");
  }
  if (options.mp4) writer_options.mp4 = dir.file("display.mp4");
  FrameWriter writer(writer_options);
  RunRequest request{.params = params,
                     .folder = dir.folder(),
                     .strict_sync = options.sync == "strict",
                     .stop = context.stop ? *context.stop : kNeverStops,
                     .progress = meter,
                     .frame = {},
                     .bus_trace = options.bus_trace,
                     .gdb_port = {},
                     .registers = options.registers};
  if (!options.no_frames || options.mp4)
    request.frame = [&](const DisplayedFrame& f) {
      writer.push(f.index, f.width, f.height, f.uyvy);
    };
  if (!options.gdb.empty()) {
    request.gdb_port = parse_gdb_port(options.gdb);
    request.notes = &context.err;
  }
  RowFiles rows(dir);
  rows.attach(request);
  RunResult result;
  try {
    result = simulation->run(request);
  } catch (...) {
    meter.finish();
    throw;
  }
  meter.finish();
  writer.close();

  std::vector<StatRow> host;
  rows.finish(result);
  write_results(dir, result, meter, args, host, !options.registers.pattern.empty());
  report_earlier(dir.commit(result.complete && result.guest_failure.empty()), context);
  context.out << summary_table(result.stats, host);
  context.out << fmt::format("  results in {}\n", dir.folder().string());
  if (!options.no_frames)
    context.out << fmt::format("  pictures in {}\n", (dir.folder() / "frames").string());
  context.out << std::flush;
  if (!result.guest_failure.empty()) throw GuestFailure(result.guest_failure);
  if (result.complete) return kExitDone;
  const int signal = context.signal ? context.signal->load() : 0;
  context.err << "fovea: stopped before the end; the figures cover what was simulated\n";
  return signal ? 128 + signal : kExitGuestFailed;
}

int command_params(const std::string& pattern, bool markdown, bool of_replay,
                   const CliContext& context) {
  ParamSet params;
  ReplayParams replay;
  const auto simulation = context.make_simulation();
  if (of_replay)
    replay.declare(params);
  else
    simulation->declare(params);
  context.out << params_table(params, pattern, markdown) << std::flush;
  return kExitDone;
}

/// What the host refused (memory, a thread), if that is what the exception says; else empty. From
/// within a process of SystemC it comes as a report that quotes the exception's name.
std::string lack_of_host(const std::exception& e) {
  const std::string_view what = e.what();
  if (dynamic_cast<const std::bad_alloc*>(&e) || what.find("std::bad_alloc") != what.npos)
    return "out of memory: the host gives this process no more; allowed: a smaller run, or a higher "
           "limit (ulimit -v, container)";
  if (const auto* refused = dynamic_cast<const std::system_error*>(&e))
    return fmt::format("the host refused: {}", one_line(refused->what()));
  return "";
}

/// "A | B" would end a cell of a table.
std::string markdown_cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

std::atomic<int> g_signal{0};
std::atomic<bool> g_stop{false};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free,
              "a signal handler may only touch lock-free atomics");

void on_signal(int signal) {
  g_signal = signal;
  g_stop = true;
}

}  // namespace

void report_earlier(const std::string& note, const CliContext& context) {
  if (!note.empty()) context.err << "fovea: " << note << std::endl;
}

std::string version_text() { return FOVEA_VERSION; }

std::string params_table(const ParamSet& params, const std::string& pattern, bool markdown) {
  const bool glob = pattern.find_first_of("*?[") != std::string::npos;
  std::vector<const ParamBase*> rows;
  for (const auto* p : params.all()) {
    const bool match = glob ? ::fnmatch(pattern.c_str(), p->key().c_str(), 0) == 0
                            : p->key().find(pattern) != std::string::npos;
    if (match) rows.push_back(p);
  }
  if (rows.empty()) {
    const std::string near = params.nearest(pattern);
    throw UserError(fmt::format(
        "no parameter matches '{}'{}", one_line(pattern),
        near.empty() ? "; 'fovea params' lists all keys" : "; did you mean '" + near + "'?"));
  }
  std::sort(rows.begin(), rows.end(),
            [](const ParamBase* a, const ParamBase* b) { return a->key() < b->key(); });
  std::vector<std::array<std::string, 6>> cells = {
      {"key", "default", "allowed", "belief", "tag", "meaning"}};
  for (const auto* p : rows) {
    std::string tag(to_string(p->origin()));
    if (!p->source().empty()) tag += " (" + p->source() + ")";
    if (!p->belief().empty()) tag += "; belief: " + p->belief().reason;
    const std::string belief =
        p->belief().empty() ? "-" : p->belief().low + " .. " + p->belief().high;
    const std::string value = p->default_text().empty() ? "-" : p->default_text();
    cells.push_back({p->key(), value, p->allowed(), belief, tag, p->sentence()});
  }
  std::string out;
  if (markdown) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      for (const auto& cell : cells[i]) out += "| " + markdown_cell(cell) + " ";
      out += "|\n";
      if (i == 0) out += "|---|---|---|---|---|---|\n";
    }
    return out;
  }
  // A few long cells (lists, sources) must not push all others off the screen.
  constexpr std::size_t kMaxWidth = 44;
  std::array<std::size_t, 6> width{};
  for (const auto& row : cells)
    for (std::size_t c = 0; c < row.size(); ++c)
      width[c] = std::max(width[c], std::min(kMaxWidth, row[c].size()));
  for (const auto& row : cells) {
    for (std::size_t c = 0; c + 1 < row.size(); ++c)
      out += fmt::format("{:<{}}  ", row[c], width[c]);
    out += row.back() + "\n";
  }
  return out;
}

void install_signals(CliContext& context) {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  // One shot: a second Ctrl-C ends a program that does not react any more.
  action.sa_flags = SA_RESETHAND | SA_RESTART;
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);
  context.signal = &g_signal;
  context.stop = &g_stop;
}

int run_cli(const std::vector<std::string>& args, const CliContext& context) {
  std::vector<std::string> own = args;
  ExecOptions exec;
  CLI::App app("Co-simulation of a fish-eye correction system: DM365 board and its firmware.",
               "fovea");
  app.require_subcommand(1);
  app.footer(
      "Exit status: 0 done, 1 a comparison failed, 2 wrong input, 3 the guest failed,\n"
      "4 a defect of fovea; 130 or 143 stopped by a signal, with a valid partial result.");

  RunOptions run;
  CLI::App* run_command = app.add_subcommand("run", "Simulate an experiment");
  run_command->add_option("experiment", run.experiment, "Experiment file (YAML)")->required();
  // One value per -s: the experiment's name may follow it.
  run_command->add_option("-s,--set", run.sets, "Set a parameter, key=value; may be repeated")
      ->allow_extra_args(false);
  const CLI::Option* out_option =
      run_command->add_option("-o,--out", run.out_dir, "Folder for the results (out/EXPERIMENT)");
  run_command
      ->add_option("--sync", run.sync,
                   "strict: every bus access goes through the queue and the kernel")
      ->check(CLI::IsMember({"default", "strict"}));
  run_command->add_flag("--strict", run.strict,
                        "A feature that the guest uses and the model lacks is an error");
  run_command->add_flag("--no-frames", run.no_frames, "Write no pictures");
  run_command->add_flag("--mp4", run.mp4, "Also write the displayed frames as display.mp4");

  const CLI::Option* trace_option = run_command->add_option(
      "--bus-trace", run.bus_trace, "Write all requests to the SDRAM in the window to this file");

  ReplayOptions replay;
  CLI::App* replay_command =
      app.add_subcommand("replay", "Play a bus trace on crossbar and SDRAM, without the core");
  replay_command
      ->add_option("trace", replay.trace, "File of 'run --bus-trace', or text ('# dramtrace 1')")
      ->required();
  replay_command
      ->add_option("-s,--set", replay.sets,
                   "Set a parameter of crossbar or SDRAM, key=value; may be repeated")
      ->allow_extra_args(false);
  const CLI::Option* replay_out = replay_command->add_option(
      "-o,--out", replay.out_dir, "Folder for the results (out/TRACE)");
  replay_command->add_flag("--memory-only", replay.memory_only, "Leave the crossbar out");
  run_command->add_option("--gdb", run.gdb,
                          "Wait for GDB on this port of this host, :PORT; :0 takes a free one");
  add_register_log_options(*run_command, run.registers);
  CLI::App* exec_command = add_exec_command(app, exec);
  if (!own.empty() && own[0] == "exec") exec.arguments = take_program_arguments(own);

  std::string pattern;
  bool markdown = false;
  CLI::App* params_command =
      app.add_subcommand("params", "List parameters: default, allowed values, source");
  params_command->add_option("pattern", pattern, "Part of a key, or a pattern with * and ?");
  params_command->add_flag("--markdown", markdown, "As a Markdown table");
  bool of_replay = false;
  params_command->add_flag("--replay", of_replay, "Those of 'fovea replay'");
  CLI::App* version_command = app.add_subcommand("version", "Print the version");

  try {
    // CLI11 alone would say that a command is missing.
    const auto commands = app.get_subcommands([](CLI::App*) { return true; });
    if (!args.empty() && !args[0].starts_with("-") &&
        std::none_of(commands.begin(), commands.end(),
                     [&](CLI::App* c) { return c->check_name(args[0]); }))
      throw UserError(
          fmt::format("unknown command '{}'; allowed: run, exec, replay, params, version",
                      one_line(args[0])));
    try {
      app.parse(std::vector<std::string>(own.rbegin(), own.rend()));
    } catch (const CLI::ParseError& e) {
      if (e.get_exit_code() == 0) return app.exit(e, context.out, context.err);
      throw UserError(one_line(e.what()) + "; 'fovea --help' shows the commands");
    }
    run.out_given = out_option->count() > 0;
    replay.out_given = replay_out->count() > 0;
    if (trace_option->count() > 0 && run.bus_trace.empty())
      throw UserError("--bus-trace '': a file name is needed");
    if (*replay_command) return command_replay(replay, args, context);
    if (*run_command) return command_run(run, args, context);
    if (*exec_command) return command_exec(exec, args, context);
    if (*params_command) return command_params(pattern, markdown, of_replay, context);
    if (*version_command) context.out << "fovea " << version_text() << std::endl;
    return kExitDone;
  } catch (const UserError& e) {
    context.err << "fovea: error: " << one_line(e.what(), 2000) << std::endl;
    return kExitWrongInput;
  } catch (const Stopped& e) {
    context.err << "fovea: " << e.what() << "; there are no results" << std::endl;
    return context.signal && context.signal->load() ? 128 + context.signal->load()
                                                    : kExitGuestFailed;
  } catch (const GuestFailure& e) {
    context.err << "fovea: the guest failed: " << printable(e.what()) << std::endl;
    return kExitGuestFailed;
  } catch (const NotModelled& e) {
    context.err << "fovea: " << printable(e.what()) << std::endl;
    return kExitGuestFailed;
  } catch (const std::exception& e) {
    if (const std::string why = lack_of_host(e); !why.empty()) {
      context.err << "fovea: error: " << why << std::endl;
      return kExitWrongInput;
    }
    context.err << "fovea: own defect: " << printable(e.what()) << std::endl;
    return kExitOwnDefect;
  }
}

}  // namespace fovea::app
