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

#include "sw/fovea/cli/command_row.h"
#include "sw/fovea/cli/help.h"
#include "sw/fovea/console/console.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/child_process.h"

namespace fovea::app {
namespace {

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
  const std::vector<Command> commands = add_commands(app);
  for (const Command& c : commands)
    if (c.add_tools) c.add_tools(context.tools);
  std::vector<std::string> own = args;
  for (const Command& c : commands)
    if (c.take_foreign && !own.empty() && own[0] == c.options->get_name()) c.take_foreign(own);
  check_command(app, args);
  try {
    app.parse(std::vector<std::string>(own.rbegin(), own.rend()));
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e, context.out, context.err);
    throw UserError(one_line(e.what()) + "; 'fovea --help' shows the commands");
  }
  for (const Command& c : commands)
    if (c.options->parsed()) return c.run({app, args, context});
  FOVEA_CHECK(false, "a command was read that has no row");
  return kExitOwnDefect;
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
