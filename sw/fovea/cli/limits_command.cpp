// `fovea limits`: how far an experiment can be stretched, and what binds.
#include "sw/fovea/cli/command_row.h"
#include "sw/fovea/cli/shared_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <bit>
#include <ostream>
#include <set>
#include <thread>

#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/own_program.h"
#include "sw/fovea/files/warnings.h"
#include "sw/fovea/limits/answers.h"
#include "sw/fovea/limits/figure_names.h"

namespace fovea::limits {
namespace {

namespace fs = std::filesystem;

struct LimitsOptions {
  std::string experiment;
  std::vector<std::string> sets;
  std::string out_dir;
  unsigned jobs = 0;  ///< 0: one for each processor
  std::string find, binds;
  std::vector<std::string> over, require, relax, ports, priorities;
  bool load = false, retry_failed = false, larger_is_better = false;
  unsigned probes = 2;
  unsigned load_bytes = 64, load_slots = 4;
  std::string load_kind = "read", load_pattern = "sequential";
  double load_step = 20, load_most = 1400;
};

constexpr const char* kFooter =
    "Conditions: no frame is dropped, none is shown again unless the decoder has to find a camera's syncs, no capture "
    "overflow, no display underflow in the window (run.frames frames); --require adds others. Without --find, --binds "
    "and --over it searches the largest additional load.\n"
    "A resource binds if relaxing it alone improves the figure by more than 2 %; each is run again for that.\n"
    "DIR keeps every run (points/), limits.csv, binds.csv, points.csv and answer.txt. The same command goes on "
    "where it was interrupted, and runs nothing twice.\n"
    "Exit status: 0 found; 1 the conditions are not met at any value; 2 wrong use, or a run had wrong input; 3 the "
    "firmware failed where a figure was asked for; 4 a defect; 130 or 143 stopped.";

std::vector<std::string> words(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    out.push_back(text.substr(from, comma - from));
    from = comma + 1;
  }
  return out;
}

/// All combinations of the values of --over, the last one varying first.
std::vector<Settings> combinations(const std::vector<std::string>& over) {
  std::vector<Settings> out = {{}};
  std::vector<std::string> seen;
  for (const std::string& o : over) {
    const auto equals = o.find('=');
    if (equals == o.npos || equals == 0 || equals + 1 == o.size())
      throw UserError(fmt::format("--over '{}': allowed: KEY=VALUE,VALUE...", app::one_line(o)));
    const std::string key = o.substr(0, equals);
    if (std::find(seen.begin(), seen.end(), key) != seen.end())
      throw UserError(fmt::format("--over '{}': the key is given twice", app::one_line(o)));
    seen.push_back(key);
    std::vector<Settings> more;
    for (const Settings& s : out)
      for (const std::string& value : words(o.substr(equals + 1))) {
        more.push_back(s);
        more.back().push_back(key + "=" + value);
      }
    out = std::move(more);
  }
  return out;
}

/// The words that the port of a load allows.
std::vector<std::string> ports_of(const ParamSet& params) {
  const ParamBase* port = params.find("load.port");
  if (!port) throw UserError("--load: this program has no synthetic load");
  std::vector<std::string> out = words(port->allowed());
  for (std::string& w : out) w.erase(0, w.find_first_not_of(' '));
  return out;
}

std::vector<LoadPlace> places(const LimitsOptions& o, const ParamSet& params) {
  std::vector<std::string> ports = o.ports.empty() ? std::vector<std::string>{"load"} : o.ports;
  const std::vector<std::string> all = ports_of(params);
  if (ports == std::vector<std::string>{"all"}) ports = all;
  std::vector<std::string> priorities = o.priorities;
  if (priorities.empty())
    for (char c = '0'; c <= '7'; ++c) priorities.push_back(std::string(1, c));
  std::vector<LoadPlace> out;
  for (const std::string& port : ports) {
    if (std::find(all.begin(), all.end(), port) == all.end())
      throw UserError(fmt::format("--ports '{}': allowed: all, or some of {}", app::one_line(port),
                                  fmt::join(all, ", ")));
    for (const std::string& p : priorities) {
      if (p.size() != 1 || p[0] < '0' || p[0] > '7')
        throw UserError(fmt::format("--priorities '{}': allowed: 0 to 7", app::one_line(p)));
      out.push_back({port, static_cast<unsigned>(p[0] - '0')});
    }
  }
  return out;
}

Question question_of(const LimitsOptions& o, const ParamSet& params) {
  Question q;
  q.find = o.find;
  q.binds = o.binds;
  q.load = o.load || (o.find.empty() && o.binds.empty() && o.over.empty());
  q.higher_is_better = o.larger_is_better;
  q.relax = o.relax;
  if (!(o.load_step > 0) || !(o.load_most >= o.load_step) || o.load_most / o.load_step > 1e6)
    throw UserError("--load-step, --load-most: a step above 0, and at least one of them up to the most, are needed");
  if (!std::has_single_bit(o.load_bytes))
    throw UserError("--load-bytes '" + std::to_string(o.load_bytes) + "': allowed: 4, 8, 16, 32 or 64");
  if (!o.relax.empty() && o.binds.empty()) throw UserError("--relax: it needs --binds");
  q.shape = {o.load_bytes, o.load_slots, o.load_pattern, o.load_kind, o.load_step, o.load_most};
  if (q.load) q.places = places(o, params);
  return q;
}

/// Those of --binds and --require.
std::vector<AskedFigure> asked_figures(const LimitsOptions& o) {
  std::vector<AskedFigure> out;
  if (!o.binds.empty()) out.push_back({o.binds, "--binds"});
  for (const std::string& r : o.require) out.push_back({r.substr(0, r.find_first_of("<>")), "--require"});
  return out;
}

void warn_of_settings(const Session& session, const Settings& sets, const app::CliContext& context) {
  const app::WarningScope warnings(context.err, false);
  const auto run = session.effective(sets);
  app::warn_without_effect(run->params, run->experiment);
}

/// A failure counts most; without one, a single answer is enough.
int status_of(const std::vector<std::unique_ptr<Study>>& studies) {
  int worst = 0;
  bool found = false;
  for (const auto& study : studies) {
    const int status = study->status();
    found = found || status == 0;
    if (status > 1) worst = std::max(worst, status);
  }
  return worst ? worst : found ? 0 : 1;
}

CLI::App* add_options(CLI::App& app, LimitsOptions& o) {
  CLI::App* c = app.add_subcommand(
      "limits", "Run an experiment over settings (--over), search how far it can be stretched, find out what binds");
  c->footer(kFooter);
  c->add_option("experiment", o.experiment, "Experiment: a YAML file, or the name of a shipped one")
      ->required()
      ->type_name("FILE");
  app::add_set_option(*c, o.sets);
  c->add_option("--find", o.find, "Largest or smallest value of a numeric key that meets the conditions, in steps of "
                                  "1, of a 64th of the range, or of S with KEY=LOW..HIGH:S")
      ->type_name("KEY=LOW..HIGH");
  c->add_option("--binds", o.binds, "What binds this figure, such as frame.remap_time.mean; with --find, at the "
                                    "value found")
      ->type_name("FIGURE");
  c->add_flag("--load", o.load, "Largest additional load on a port of the crossbar, and whether a USB port or an H.264 "
                                "encoder can run beside the experiment");
  c->add_option("--over", o.over, "All of it for each of these values; may be repeated, for every combination")
      ->type_name("KEY=A,B")
      ->allow_extra_args(false);
  c->add_option("--require", o.require, "A further condition: a figure <= or >= a number; may be repeated")
      ->type_name("CONDITION")
      ->allow_extra_args(false);
  c->add_option("--probes", o.probes, "Values that a search tries besides, to notice that good and bad ones alternate")
      ->type_name("N")
      ->check(CLI::Range(0u, 1000u))
      ->capture_default_str();
  c->add_option("--relax", o.relax, "Only these resources, by their names in binds.csv")
      ->type_name("A,B")
      ->delimiter(',');
  c->add_flag("--larger-is-better", o.larger_is_better,
              "A larger figure of --binds is the better one (known of rates)");
  c->add_option("--ports", o.ports, "Ports of the load; all: every port that a load may use")
      ->type_name("A,B")->delimiter(',')->default_str("load");
  c->add_option("--priorities", o.priorities, "Priorities of the load, 0 highest")
      ->type_name("A,B")->delimiter(',')->default_str("0,1,2,3,4,5,6,7");
  c->add_option("--load-bytes", o.load_bytes, "Bytes of a burst of the load, a power of two")
      ->type_name("N")->check(CLI::Range(4u, 64u))->capture_default_str();
  c->add_option("--load-slots", o.load_slots, "Bursts of the load under way at once")
      ->type_name("N")->check(CLI::Range(1u, 16u))->capture_default_str();
  c->add_option("--load-kind", o.load_kind, "Direction of the load")
      ->type_name("WORD")->check(CLI::IsMember({"read", "write", "mixed", "copy"}))->capture_default_str();
  c->add_option("--load-pattern", o.load_pattern, "Addresses of the load")
      ->type_name("WORD")->check(CLI::IsMember({"sequential", "random"}))->capture_default_str();
  c->add_option("--load-step", o.load_step, "Distance of two loads, in 10^6 bytes/s")
      ->type_name("MB/s")
      ->capture_default_str();
  c->add_option("--load-most", o.load_most, "From there on the load has no pauses, in 10^6 bytes/s")
      ->type_name("MB/s")->capture_default_str();
  c->add_option("-o,--out", o.out_dir, "Folder for points and answers")
      ->type_name("DIR")
      ->default_str("out/EXPERIMENT-limits");
  c->add_option("-j,--jobs", o.jobs, "Runs at once")
      ->type_name("N")
      ->check(CLI::Range(1u, 1024u))
      ->default_str("processors");
  c->add_flag("--retry-failed", o.retry_failed, "Run points again that an earlier call found to fail");
  return c;
}

/// @return the exit status: 0 found, 1 not met at any value, 2 a run had wrong input, 3 the guest failed
/// where a figure was asked for, 4 a run met a defect; 128 + the signal if stopped
int find_limits(const LimitsOptions& o, const app::CliContext& context) {
  // Everything wrong with the question that shows without a run is said before a folder is made.
  const auto plain = app::effective_run(context.make_machine, o.experiment, o.sets);
  const Question question = question_of(o, plain->params);
  const std::vector<Settings> over = combinations(o.over);
  const fs::path dir = o.out_dir.empty()
                           ? fs::path("out") / (fs::path(o.experiment).stem().string() + "-limits")
                           : fs::path(o.out_dir);
  const std::vector<Condition> conditions = conditions_with(o.require);
  std::set<std::string> shared;
  for (const Settings& s : over) {
    Settings all = o.sets;
    all.insert(all.end(), s.begin(), s.end());
    check_question(question, all, [&](const Settings& settings) {
      auto run = app::effective_run(context.make_machine, o.experiment, settings);
      shared.insert(run->shared);
      return run;
    });
  }
  for (const std::string& note : shared) app::say_note(note, context);
  points::PointStore store(dir);
  points::Runner runner(store, {.program = app::own_program(),
                                .jobs = o.jobs ? o.jobs : std::max(1u, std::thread::hardware_concurrency()),
                                .retry_failed = o.retry_failed,
                                .stop = context.stop,
                                .progress = &context.err});
  Session session(context, o.experiment, runner, conditions, o.probes);
  warn_of_settings(session, o.sets, context);
  check_figures(session, o.sets, asked_figures(o));
  std::vector<std::unique_ptr<Study>> studies;
  for (const Settings& s : over) studies.push_back(std::make_unique<Study>(session, question, o.sets, s));
  runner.may_follow = [&] {
    std::size_t left = 0;
    for (const auto& study : studies) left += study->at_most_left();
    return left;
  };
  for (const auto& study : studies) study->start();
  const bool complete = runner.run();
  store.write("points.csv", points_csv(runner.entries(), conditions));
  if (!complete) {
    context.err << fmt::format("fovea: stopped; {} finished, and the same command goes on\n",
                               runner.ran() + runner.reused() == 1 ? "1 point is"
                               : fmt::format("{} points are", runner.ran() + runner.reused()));
    const int signal = context.signal ? context.signal->load() : 0;
    return signal ? 128 + signal : app::kExitGuestFailed;
  }
  store.write("limits.csv", limits_csv(studies));
  if (!question.binds.empty()) store.write("binds.csv", binds_csv(studies));
  const std::string text = answers_text(studies, question, conditions);
  store.write("answer.txt", text);
  context.out << text;
  context.out << fmt::format("{} runs made, {} taken from earlier ones; results in {}\n", runner.ran(),
                             runner.reused(), dir.string())
              << std::flush;
  return status_of(studies);
}

}  // namespace
}  // namespace fovea::limits

namespace fovea::app {

Command add_limits(CLI::App& app) {
  const auto o = std::make_shared<limits::LimitsOptions>();
  CLI::App* const c = limits::add_options(app, *o);
  return {c, [o](const Call& call) { return limits::find_limits(*o, call.context); }, keys_of_run};
}

}  // namespace fovea::app
