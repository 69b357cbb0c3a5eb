// `fovea replay`: a bus trace played on crossbar and SDRAM.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <future>
#include <ostream>
#include <set>

#include "model/cpu/core/stats.h"
#include "model/trace/core/bounds.h"
#include "sw/fovea/cli/command_row.h"
#include "sw/fovea/cli/shared_options.h"
#include "sw/fovea/cli/tool_options.h"
#include "sw/fovea/config/experiment.h"
#include "sw/fovea/explain/last_words.h"
#include "sw/fovea/files/side_output.h"
#include "sw/fovea/files/warnings.h"
#include "sw/fovea/replay/ddr_presets.h"
#include "sw/fovea/replay/open_trace.h"
#include "sw/fovea/replay/replay_clocks.h"
#include "sw/fovea/replay/replay_path.h"
#include "sw/fovea/results/figures.h"
#include "sw/fovea/results/names.h"
#include "sw/fovea/results/run_dir.h"
#include "sw/fovea/results/run_writer.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;
using Wall = std::chrono::steady_clock;

struct ReplayOptions {
  std::string trace;
  std::vector<std::string> sets;
  std::string out_dir;
  bool out_given = false;
  bool memory_only = false;
  ToolOptions tools;
  bool wrap = false;  ///< addresses beyond ddr.part are taken modulo its size
  std::vector<std::string> without;  ///< labels of masters whose requests are left out
};

/// What of the command line does nothing because there is no crossbar.
std::vector<std::string> without_crossbar(const std::vector<std::string>& sets) {
  std::vector<std::string> lines;
  for (const auto& s : sets) {
    const std::string key = s.substr(0, s.find('='));
    if (key.starts_with("bus.") || key == "ddr.read_fifo")
      lines.push_back(fmt::format("warning: key '{}' has no effect with --memory-only", key));
  }
  return lines;
}

/// As `fovea run` has them, from the phases that the trace keeps.
void add_remap_rows(const ReplayPath& path, std::vector<StatRow>& rows) {
  const auto times = path.remap_times();
  if (times.empty()) return;
  double sum = 0;
  for (const Picoseconds t : times) sum += static_cast<double>(t) * 1e-12;
  const auto [min, max] = std::minmax_element(times.begin(), times.end());
  rows.push_back({names::kRemapped, std::uint64_t{times.size()}, "1",
                  "frames corrected (remap finished) in the trace"});
  add_remap_times(rows, static_cast<double>(*min) * 1e-12,
                  sum / static_cast<double>(times.size()), static_cast<double>(*max) * 1e-12);
}

/// The streams of masters that are left out. A master's requests must not hold up those of others, as the core's do,
/// whose two ports are one stream, and transfers do, whose ends the core waits for. @throws UserError
std::set<unsigned> streams_of(const trace::TraceInfo& info, const std::vector<std::string>& without) {
  std::set<unsigned> out;
  std::set<std::string> allowed;
  const auto holds_up = [&](const trace::MasterInfo& m) {
    return master_info(m.id).bridge == Bridge::kCore ||
           (info.edma.request_clocks != 0 && master_info(m.id).pace == Pace::kTransfers);
  };
  for (const auto& m : info.masters)
    if (!holds_up(m)) allowed.insert(m.label);
  for (const std::string& label : without) {
    if (!allowed.contains(label))
      throw UserError(fmt::format("--without '{}': allowed here, as no other master waits for them: {}",
                                  one_line(label), fmt::join(allowed, ", ")));
    for (const auto& m : info.masters)
      if (m.label == label) out.insert(m.stream);
  }
  return out;
}

/// Hands on the records of all but some streams.
class SomeStreams final : public trace::RecordSource {
 public:
  SomeStreams(trace::RecordSource& source, std::set<unsigned> without)
      : source_(source), without_(std::move(without)) {}
  bool next(unsigned stream, trace::Record& record) override {
    return !without_.contains(stream) && source_.next(stream, record);
  }
  std::string place(unsigned stream) const override { return source_.place(stream); }

 private:
  trace::RecordSource& source_;
  std::set<unsigned> without_;
};

/// The keys of the trace, then those of the command line, then what follows from them.
/// @return what is to be said about it @throws UserError
std::vector<std::string> set_replay_keys(const ReplayOptions& options, const trace::TraceInfo& info,
                                         ReplayParams& params, Experiment& experiment) {
  for (const auto& [key, value] : info.params)
    if (!ReplayParams::without_effect(key)) experiment.preset(key, value, options.trace);
  for (const auto& s : options.sets) {
    const std::string key = s.substr(0, s.find('='));
    if (ReplayParams::without_effect(key))
      throw UserError(
          fmt::format("key '{}' has no effect in a replay, which plays no contents", key));
    experiment.override_with(s);
  }
  apply_clock_preset(params, experiment);
  std::vector<std::string> lines = choose_ddr_preset(params, !info.params.empty(), experiment);
  apply_ddr_preset(params, info.ddr.frequency, experiment);
  std::ranges::copy(options.memory_only ? without_crossbar(options.sets) : follow_clocks(params, info, experiment),
                    std::back_inserter(lines));
  return lines;
}

/// What was replayed, for config.json: the options that decide the result.
Provenance origin_of(const ParamSet& set, const ReplayOptions& options) {
  Provenance out = provenance_of(set, {}, {{"trace", options.trace}});
  out.command = "replay";
  out.input = fs::path(options.trace).filename().string();
  if (options.memory_only) out.options.push_back("--memory-only");
  if (options.wrap) out.options.push_back("--wrap");
  for (const auto& master : options.without) out.options.insert(out.options.end(), {"--without", master});
  return out;
}

/// False: a signal has ended it.
bool replay_to_end(ReplayPath& path, Picoseconds start, const CliContext& context) {
  // Slices only let a signal in.
  const Picoseconds slice = 10 * kPsPerMs;
  for (Picoseconds until = start + slice; !path.run_before(until); until += slice)
    if (context.stop && context.stop->load()) return false;
  return true;
}

CLI::App* add_options(CLI::App& app, ReplayOptions& replay) {
  CLI::App* c =
      app.add_subcommand("replay", "Play a bus trace on crossbar and SDRAM, without the core");
  c->add_option("trace", replay.trace, "File of 'run --bus-trace', or text ('# dramtrace 1')")
      ->required()
      ->type_name("FILE");
  add_set_option(*c, replay.sets);
  c->add_option("-o,--out", replay.out_dir, "Folder for the results")
      ->type_name("DIR")
      ->default_str("out/TRACE");
  c->add_flag("--memory-only", replay.memory_only, "Leave the crossbar out");
  c->add_flag("--wrap", replay.wrap,
              "Take addresses beyond the memory (ddr.part) modulo its size");
  c->add_option("--without", replay.without, "Leave out the requests of this master; may be repeated")
      ->type_name("MASTER")
      ->allow_extra_args(false);
  return c;
}

int replay(const ReplayOptions& options, const std::vector<std::string>& args, const CliContext& context) {
  const auto started = Wall::now();
  const std::vector<AskedTool> asked = options.tools.asked(ToolNeeds::kMemory, false);
  const WarningScope warnings(context.err, false, true);
  const OpenTrace trace = open_own_trace(options.trace);
  ReplayParams params;
  ParamSet set;
  params.declare(set);
  Experiment experiment(set);
  const std::vector<std::string> said = set_replay_keys(options, *trace.info, params, experiment);
  warn_without_effect(set, experiment);
  params.check();
  const std::set<unsigned> left_out = streams_of(*trace.info, options.without);
  for (const std::string& line : said) context.err << "fovea: " << one_line(line) << "\n";
  if (const std::string kept = words_of_kept(*trace.info); !kept.empty())
    context.err << "fovea: warning: " << kept << "\n";

  RunDir dir(options.out_given ? fs::path(options.out_dir)
                               : fs::path("out") / fs::path(options.trace).stem(),
             "replay");
  options.tools.refuse_inside(dir);
  // The hash of a long trace takes as long as a part of the replay; nothing but config.json needs it.
  std::future<Provenance> provenance = std::async(std::launch::async, [&] { return origin_of(set, options); });

  trace::BoundedSource wrapped(one_line(options.trace), *trace.source,
                               {params.ddr.size_bytes(), true});
  SomeStreams source(options.wrap ? wrapped : *trace.source, left_out);
  ReplayPath path(one_line(options.trace), *trace.info, source, params, options.memory_only);
  path.end_with_window();
  Tools tools;
  tools.make(asked, {.params = set,
                     .controller = &path.controller(),
                     .observe = [&path](MemObserver& o) { return path.observe(o); },
                     .name_of = [&path](Master m) { return path.label(m); },
                     .now = [&path] { return path.start(); }});
  tools.open_window();
  const bool complete = replay_to_end(path, trace.info->start, context);
  path.finish();
  LostOutputs lost;
  ToolOutput output;
  tools.close_window();
  tools.finish(cpu::Counts{}, output, lost);
  if (!options.sets.empty() && path.waited_in_ram())
    DiagnosticsRef::current().configuration(fmt::format(
        "bursts of the EDMA waited {} core clocks in internal RAM for the core: as in the recorded run, which a run "
        "with these settings need not do; its figures may differ (replay.ram_waits)",
        path.waited_in_ram()));
  const double wall = std::chrono::duration<double>(Wall::now() - started).count();

  std::vector<StatRow> stats = path.stats();
  add_remap_rows(path, stats);
  stats.insert(stats.end(), output.stats.begin(), output.stats.end());
  const std::vector<StatRow> host = {
      wall_time(wall, "the whole replay"),
      {"requests_per_second", wall > 0 ? static_cast<double>(path.requests()) / wall : 0.0, "1/s",
       "requests played per host second"},
      peak_rss()};
  dir.write("config.json", config_json(set, experiment, provenance.get()));
  const std::vector<SlowestRow> slowest = path.slowest_rows();
  std::vector<ResultFile> files = {{"timeline.csv", timeline_csv(path.labels(), path.timeline())},
                                   {"latency.csv", latency_csv(path.latency_rows())},
                                   {"slowest.csv", slowest_csv(slowest)}};
  std::ranges::move(output.files, std::back_inserter(files));
  write_run(dir,
            {.stats = stats,
             .host = host,
             .complete = complete,
             .warnings = collect_warnings(DiagnosticsRef::current(), true)},
            files, args);
  say_note(dir.commit(complete), context);
  context.out << replay_words(stats, host, slowest);
  for (const std::string& note : output.notes) context.out << one_line(note) << "\n";
  context.out << fmt::format("results in {}\n", one_line(dir.folder().string(), std::string::npos)) << std::flush;
  say_lost(lost, context);
  if (complete) return lost.empty() ? kExitDone : kExitWrongInput;
  const int signal = context.signal ? context.signal->load() : 0;
  context.err << "fovea: stopped before the end; the figures cover what was replayed\n";
  return signal ? 128 + signal : kExitGuestFailed;
}

}  // namespace

Command add_replay(CLI::App& app) {
  const auto o = std::make_shared<ReplayOptions>();
  CLI::App* const c = add_options(app, *o);
  return {c,
          [o, c](const Call& call) {
            o->out_given = c->count("--out") > 0;
            return replay(*o, call.args, call.context);
          },
          [](const CliContext&) {
            ReplayParams replay;
            ParamSet params;
            replay.declare(params);
            return keys_of(params);
          },
          [o, c](std::span<const ToolRow> rows) {
            for (const ToolRow& row : rows)
              if (row.needs == ToolNeeds::kMemory) o->tools.add_to(*c, {&row, 1});
          }};
}

}  // namespace fovea::app
