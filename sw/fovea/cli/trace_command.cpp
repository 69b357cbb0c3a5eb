// `fovea trace convert` and `fovea trace info`: bus traces between formats.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <bit>
#include <map>
#include <ostream>
#include <tuple>
#include <utility>
#include <vector>

#include "model/common/check.h"
#include "model/contract/memory_map.h"
#include "model/dma/core/commands.h"
#include "model/trace/core/bounds.h"
#include "model/trace/core/text_trace.h"
#include "model/trace/core/trace_file.h"
#include "sw/fovea/cli/command_row.h"
#include "sw/fovea/config/experiment.h"
#include "sw/fovea/files/ffmpeg.h"
#include "sw/fovea/files/output_file.h"
#include "sw/fovea/replay/open_trace.h"
#include "sw/fovea/replay/replay_params.h"
#include "sw/fovea/replay/replay_path.h"
#include "sw/fovea/replay/trace_writers.h"

namespace fovea::app {
namespace {

struct TraceOptions {
  std::string in, out;
  std::string from, to;  ///< formats; `from` empty: by the file's content
  std::string clock;     ///< frequency or period of the cycles
  std::optional<std::string> master;
  std::optional<unsigned> bytes, window;
  std::optional<std::string> size;
  bool wrap = false;
};

constexpr unsigned kDefaultBytes = 64;

bool has_cycles(TraceFormat f) { return foreign(f) && trace::has_cycles(*foreign(f)); }

/// DRAMSys takes a request for a block of its size, so that one here may become several.
bool has_sizes(TraceFormat f) { return f == TraceFormat::kDramsysStl || f == TraceFormat::kDramsysRstl; }

TraceFormat format_named(std::string_view name) {
  const auto format = trace_format(name);
  FOVEA_CHECK(format, "a format that the command line let through");
  return *format;
}

/// Quantities of the command line, parsed as those of experiments are.
struct Quantities : ParamGroup {
  using U = IntParam::Unit;
  IntParam frequency{*this, "frequency",     U::kHertz, 1'000'000, 1'000, 1'000'000'000'000,
                     "",    Origin::kChoice, ""};
  IntParam period{*this, "period", U::kTime, 1'000, 1, kPsPerMs, "", Origin::kChoice, ""};
  IntParam size{*this, "size",          U::kBytes, 1 << 20, 1 << 10, std::uint64_t{1} << 32,
                "",    Origin::kChoice, ""};
  Quantities() : ParamGroup("trace") {}
};

bool parses(Quantities& quantities, const IntParam& one, const std::string& text) {
  try {
    ParamSet set;
    set.add(quantities);
    set.set(one.key(), text);
    return true;
  } catch (const UserError&) {
    return false;
  }
}

Frequency parse_clock(const std::string& text) {
  Quantities q;
  if (parses(q, q.frequency, text)) return Frequency(q.frequency());
  if (parses(q, q.period, text)) return Frequency(kPsPerSecond, q.period());
  throw UserError(
      fmt::format("--clock '{}' is not allowed; allowed: a frequency of 1kHz to 1000GHz "
                  "(800MHz) or a period of 1ps to 1ms (1250ps)",
                  one_line(text)));
}

std::uint64_t parse_size(const std::string& text) {
  Quantities q;
  if (parses(q, q.size, text) && std::has_single_bit(q.size())) return q.size();
  throw UserError(fmt::format(
      "--size '{}' is not allowed; allowed: a power of two from 1KiB to 4096MiB", one_line(text)));
}

/// Parameters of a replay with the recorded values.
struct RecordedParams {
  ReplayParams params;
  ParamSet set;
  explicit RecordedParams(const trace::TraceInfo* info, const std::string& file) {
    params.declare(set);
    Experiment experiment(set);
    if (info)
      for (const auto& [key, value] : info->params)
        if (!ReplayParams::without_effect(key)) experiment.preset(key, value, file);
  }
};

/// What a trace holds, by master of its description.
struct Census {
  struct Count {
    std::uint64_t requests[2] = {}, bytes[2] = {};  // reads, writes
  };
  std::vector<Count> masters;
  std::uint64_t marks = 0;
  Picoseconds first = 0, last = 0;  // earliest of what can go out, latest of the times
  bool timed = true;     // each record has a time, and none depends on another
  bool plain = true;     // nothing that text cannot say: priority, lock, critical word
};

unsigned master_of(const trace::TraceInfo& info, const trace::Record& r) {
  const auto at = std::find_if(info.masters.begin(), info.masters.end(),
                               [&](const auto& m) { return m.id == r.master; });
  return static_cast<unsigned>(at - info.masters.begin());
}

/// Calls `each` with the records of all streams: those with times in the order of time, and with
/// the time at which the records before it in its stream let it go.
template <typename Each>
void in_order(const trace::TraceInfo& info, trace::RecordSource& source, const Each& each) {
  struct Head {
    trace::Record record;
    Picoseconds ready = 0;
    bool valid = false;
  };
  std::vector<Head> heads(info.streams.size());
  const auto fetch = [&](unsigned s) {
    heads[s].valid = source.next(s, heads[s].record);
    if (heads[s].valid && heads[s].record.release == trace::Release::kAt)
      heads[s].ready = std::max(heads[s].ready, heads[s].record.at);
  };
  for (unsigned s = 0; s < heads.size(); ++s) fetch(s);
  for (;;) {
    unsigned next = static_cast<unsigned>(heads.size());
    for (unsigned s = 0; s < heads.size(); ++s)
      if (heads[s].valid && (next == heads.size() || heads[s].ready < heads[next].ready)) next = s;
    if (next == heads.size()) return;
    each(next, heads[next].record, heads[next].ready);
    fetch(next);
  }
}

/// Adds the bursts of a transfer to the masters of its stream.
void count_transfer(const trace::TraceInfo& info, const trace::Record& r, unsigned stream,
                    std::vector<Census::Count>& masters) {
  if (r.transfer.bytes() == 0) return;
  for (std::size_t i = 0; i < masters.size(); ++i) {
    if (info.masters[i].stream != stream) continue;
    const bool write = master_info(info.masters[i].id).side == Side::kWrites;
    dma::Commands commands(r.transfer, write ? r.transfer.destination : r.transfer.source, r.burst);
    for (; !commands.done(); commands.pop()) {
      const dma::Command c = commands.next();
      if (c.address < DDR_BASE) continue;
      ++masters[i].requests[write];
      masters[i].bytes[write] += c.bytes;
    }
  }
}

Census take_census(const trace::TraceInfo& info, trace::RecordSource& source) {
  Census c;
  c.masters.resize(info.masters.size());
  bool begun = false;
  in_order(info, source, [&](unsigned stream, const trace::Record& r, Picoseconds ready) {
    if (!std::exchange(begun, true)) c.first = ready;
    c.timed &= r.release == trace::Release::kAt && r.kind == trace::Kind::kRequest;
    if (r.release == trace::Release::kAt) c.last = std::max(c.last, r.at);
    c.marks += r.kind == trace::Kind::kMark;
    if (r.kind == trace::Kind::kTransfer) count_transfer(info, r, stream, c.masters);
    if (r.kind != trace::Kind::kRequest) return;
    c.plain &= r.priority == trace::Record{}.priority && !r.locked && r.critical == 0;
    Census::Count& m = c.masters[master_of(info, r)];
    ++m.requests[r.write];
    m.bytes[r.write] += r.bytes;
  });
  return c;
}

/// Plays a recorded trace with the recorded parameters; `each` gets the requests in the order of their times, those
/// of a time in that of the masters.
template <typename Each>
void in_played_order(const std::string& file, const trace::TraceInfo& info,
                     trace::RecordSource& source, const CliContext& context, const Each& each) {
  struct Sent final : MemObserver {
    void submitted(const MemRequest& r, bool to_sdram) override {
      if (!to_sdram) return;
      trace::Record record;
      record.write = r.write;
      record.bytes = r.bytes;
      record.master = r.master;
      record.address = r.address - DDR_BASE;
      requests.emplace(std::tuple(r.issued, r.master, ++number), record);
    }
    void responded(const MemRequest&) override {}
    std::map<std::tuple<Picoseconds, Master, std::uint64_t>, trace::Record> requests;
    std::uint64_t number = 0;
  } sent;
  RecordedParams recorded(&info, file);
  recorded.params.check();
  ReplayPath path(one_line(file), info, source, recorded.params, false);
  const Subscription observing = path.observe(sent);
  const auto hand_on = [&](Picoseconds until) {
    while (!sent.requests.empty() && std::get<0>(sent.requests.begin()->first) < until) {
      const auto first = sent.requests.extract(sent.requests.begin());
      each(first.mapped(), std::get<0>(first.key()));
    }
  };
  const Picoseconds slice = kPsPerMs;
  for (Picoseconds until = info.start + slice; !path.run_before(until); until += slice) {
    hand_on(path.progress());
    if (context.stop && context.stop->load()) throw Stopped();
  }
  hand_on(kNever);
}

/// Labels as a text trace has them: both sides of a transfer controller have one in a recording.
std::vector<std::string> labels_of(const trace::TraceInfo& info) {
  std::vector<std::string> labels;
  for (const auto& m : info.masters) {
    const auto same = std::count_if(info.masters.begin(), info.masters.end(),
                                    [&](const auto& o) { return o.label == m.label; });
    labels.push_back(same > 1 ? std::string(kMasterNames[index(m.id)]) : m.label);
  }
  return labels;
}

class Conversion {
 public:
  Conversion(const TraceOptions& options, const CliContext& context)
      : o_(options), context_(context) {
    from_ = o_.from.empty() ? format_of(o_.in) : format_named(o_.from);
    to_ = format_named(o_.to);
    check_options();
  }

  void run() {
    Census census;
    OpenTrace counted = open(true);
    census = take_census(*counted.info, *counted.source);
    const std::uint64_t aligned = counted.foreign ? counted.foreign->aligned() : 0;
    counted = {};
    OutputFile file(o_.out, "-o", "a trace", is_any_trace);
    OpenTrace trace = open(false);
    trace::BoundedSource source(one_line(o_.in), *trace.source, bounds_);
    const auto put = [&file](std::string_view bytes) { file.write(bytes); };
    if (to_ == TraceFormat::kBinary)
      write_binary(*trace.info, source, census, put);
    else
      write_lines(*trace.info, source, census, put);
    file.commit();
    if (aligned != 0)
      say(fmt::format("{} addresses are no multiples of the request's size: their low bits do not count, as in the "
                      "program that {} is of",
                      aligned, name_of(from_)));
    context_.out << fmt::format("{} requests, {} to {}, in {}\n", requests_, name_of(from_),
                                name_of(to_), one_line(o_.out))
                 << std::flush;
  }

 private:
  void refuse(const char* option, const std::string& why) const {
    throw UserError(fmt::format("{} has no effect: {}", option, why));
  }

  void check_options() {
    const bool in_foreign = foreign(from_).has_value();
    const bool cycles = has_cycles(from_) || has_cycles(to_);
    if (cycles && o_.clock.empty())
      throw UserError(
          fmt::format("--clock is needed, as {} counts cycles: a frequency (800MHz) or a "
                      "period (1250ps)",
                      name_of(has_cycles(from_) ? from_ : to_)));
    if (!cycles && !o_.clock.empty())
      refuse("--clock",
             fmt::format("neither {} nor {} counts cycles", name_of(from_), name_of(to_)));
    if (cycles) clock_ = parse_clock(o_.clock);
    if (o_.bytes && !in_foreign && !foreign(to_))
      refuse("--bytes",
             fmt::format("{} and {} say the size of each request", name_of(from_), name_of(to_)));
    if (o_.master && !in_foreign)
      refuse("--master", fmt::format("{} names its masters", name_of(from_)));
    if (o_.window && !in_foreign) refuse("--window", fmt::format("{} has windows", name_of(from_)));
    if (o_.master && !trace::TextTrace::is_label(*o_.master))
      throw UserError(fmt::format("--master '{}' is not allowed; allowed: {}", one_line(*o_.master),
                                  trace::TextTrace::kLabelRule));
    const auto in_range = [](const char* option, std::optional<unsigned> v, unsigned most) {
      if (v && (*v == 0 || *v > most))
        throw UserError(fmt::format("{} {} is not allowed; allowed: 1 to {}", option, *v, most));
    };
    in_range("--window", o_.window, trace::TextTrace::kMaxReads);
    in_range("--bytes", o_.bytes, trace::TextTrace::kMaxBytes);
    if (o_.bytes && !std::has_single_bit(*o_.bytes))
      throw UserError(
          fmt::format("--bytes {} is not allowed for {}; allowed: powers of two up to {}",
                      *o_.bytes, name_of(in_foreign ? from_ : to_), trace::TextTrace::kMaxBytes));
    bounds_.wrap = o_.wrap;
  }

  /// Of the file to be read. The memory's size: --size, else that of the recorded or default part.
  OpenTrace open(bool first) {
    trace::ForeignReading reading;
    reading.clock = clock_;
    reading.bytes = o_.bytes.value_or(kDefaultBytes);
    if (o_.master) reading.label = *o_.master;
    if (o_.window) reading.window = *o_.window;
    if (first) {
      if (o_.size)
        bounds_.size = parse_size(*o_.size);
      else if (foreign(from_))
        bounds_.size = RecordedParams(nullptr, o_.in).params.ddr.size_bytes();
    }
    reading.bounds = bounds_;
    OpenTrace trace = open_trace(o_.in, from_, reading);
    if (first && !o_.size && !foreign(from_))
      bounds_.size = RecordedParams(trace.info, o_.in).params.ddr.size_bytes();
    return trace;
  }

  void say(const std::string& line) const { context_.err << "fovea: " << line << "\n"; }

  /// A text trace is played with the defaults.
  void say_lost_settings(const trace::TraceInfo& info) const {
    const RecordedParams recorded(&info, o_.in), plain(nullptr, o_.in);
    std::vector<std::string> differ;
    for (const ParamBase* p : recorded.set.all())
      if (std::string text = p->text(); text != plain.set.find(p->key())->text()) {
        std::erase(text, ' ');
        differ.push_back(p->key() + "=" + text);
      }
    if (!differ.empty())
      say(fmt::format("text has no settings: to play it as recorded takes -s {}", fmt::join(differ, " -s ")));
  }

  void write_binary(trace::TraceInfo info, trace::RecordSource& source, const Census& census,
                    const LineWriter::Put& put) {
    trace::TraceWriter writer(static_cast<unsigned>(info.streams.size()));
    in_order(info, source, [&](unsigned stream, const trace::Record& r, Picoseconds) {
      requests_ += r.kind == trace::Kind::kRequest;
      writer.add(stream, r);
    });
    if (from_ != TraceFormat::kBinary) {
      info.start = census.first;
      info.end = census.last;
    }
    writer.finish(info, put);
  }

  /// Records without dependences are written with their times; others are played for their times.
  void write_lines(const trace::TraceInfo& info, trace::RecordSource& source, const Census& census,
                   const LineWriter::Put& put) {
    const bool is_text = to_ == TraceFormat::kText;
    LineWriter writer({to_, clock_, o_.bytes.value_or(kDefaultBytes)}, put);
    // A recording also lists masters that asked for nothing.
    std::vector<unsigned> number(info.masters.size());
    std::vector<std::pair<std::string, unsigned>> masters;
    const std::vector<std::string> labels = labels_of(info);
    bool same_windows = true;
    for (std::size_t i = 0; i < info.masters.size(); ++i) {
      const trace::MasterInfo& m = info.masters[i];
      const auto& c = census.masters[i];
      if (from_ == TraceFormat::kBinary && c.requests[0] + c.requests[1] == 0) continue;
      number[i] = static_cast<unsigned>(masters.size());
      const unsigned window = std::min(m.reads, trace::TextTrace::kMaxReads);
      same_windows &= !m.shared && m.reads == window && m.writes == trace::TextTrace::kWrites;
      masters.emplace_back(labels[i], window);
    }
    if (is_text && masters.size() > trace::TextTrace::kMaxMasters)
      throw UserError(fmt::format("trace '{}': {} masters have requests; text has at most {}",
                                  one_line(o_.in), masters.size(), trace::TextTrace::kMaxMasters));
    writer.begin(masters);
    const auto add = [&](const trace::Record& r, Picoseconds at, Picoseconds ready) {
      ++requests_;
      writer.add({at, ready, number[master_of(info, r)], r.write, r.address, r.bytes});
    };
    if (census.timed)
      in_order(info, source,
               [&](unsigned, const trace::Record& r, Picoseconds ready) { add(r, r.at, ready); });
    else
      in_played_order(o_.in, info, source, context_,
                      [&](const trace::Record& r, Picoseconds at) { add(r, at, at); });
    writer.end();
    if (!census.timed)
      say(fmt::format("dependences are lost: {} has none, and the times are those of a replay with the recorded "
                      "settings",
                      name_of(to_)));
    if (from_ == TraceFormat::kBinary && is_text) say_lost_settings(info);
    const bool plain = census.plain && (same_windows || !is_text);
    if (!plain)
      say(
          fmt::format("{} cannot hold priorities, locks, critical words and all windows; these are "
                      "left out",
                      name_of(to_)));
    if (!is_text && masters.size() > 1)
      say(fmt::format("{} does not tell masters apart: the {} of the trace became one",
                      name_of(to_), masters.size()));
    if (writer.resized() != 0 && has_sizes(to_))
      say(fmt::format("{} has blocks of a power of two only: {} requests became {}", name_of(to_), writer.resized(),
                      writer.pieces()));
    else if (writer.resized() != 0)
      say(fmt::format("{} has no sizes: {} requests became {} of {} bytes", name_of(to_),
                      writer.resized(), writer.pieces(), o_.bytes.value_or(kDefaultBytes)));
    const bool times_lost = foreign(to_) && !has_cycles(to_) && census.last != 0;
    if (times_lost || (foreign(to_) && !has_cycles(to_) && !census.timed))
      say(fmt::format("{} has no times; only the order is kept", name_of(to_)));
  }

  const TraceOptions& o_;
  const CliContext& context_;
  TraceFormat from_, to_;
  Frequency clock_;
  trace::Bounds bounds_;
  std::uint64_t requests_ = 0;
};

std::string milliseconds(Picoseconds t) {
  return fmt::format("{:.6f} ms", static_cast<double>(t) * 1e-9);
}

void print_info(const TraceOptions& options, std::ostream& out) {
  const TraceFormat format = format_of(options.in);
  if (foreign(format)) {
    out << fmt::format("{}, a foreign format; 'fovea trace convert' reads it\n", name_of(format));
    return;
  }
  OpenTrace trace = open_trace(options.in, format, {});
  const trace::TraceInfo& info = *trace.info;
  const Census c = take_census(info, *trace.source);
  out << name_of(format);
  if (trace.version) out << ", version " << trace.version;
  out << "\n";
  if (info.end > info.start)
    out << fmt::format("{} of simulated time\n", milliseconds(info.end - info.start));
  else
    out << fmt::format("requests from {} to {}\n", milliseconds(c.first), milliseconds(c.last));
  if (!c.timed) out << "requests wait for others\n";
  if (const std::string kept = words_of_kept(info); !kept.empty()) out << kept << "\n";
  if (!info.scr.frequency.stopped())
    out << fmt::format("crossbar {:.6g} MHz, SDRAM {:.6g} MHz\n", info.scr.frequency.hertz() * 1e-6,
                       info.ddr.frequency.hertz() * 1e-6);
  if (!info.params.empty()) out << fmt::format("{} recorded parameters\n", info.params.size());
  if (!info.interrupts.empty()) out << fmt::format("{} interrupts\n", info.interrupts.size());
  if (c.marks) out << fmt::format("{} marks of phases\n", c.marks);
  const auto labels = labels_of(info);
  out << fmt::format("\n{:<32} {:>6} {:>9} {:>9} {:>11} {:>8}\n", "master", "window", "reads",
                     "writes", "read bytes", "written");
  for (std::size_t i = 0; i < info.masters.size(); ++i) {
    const auto& m = c.masters[i];
    out << fmt::format("{:<32} {:>6} {:>9} {:>9} {:>11} {:>8}\n", labels[i], info.masters[i].reads,
                       m.requests[0], m.requests[1], m.bytes[0], m.bytes[1]);
  }
}

CLI::App* add_options(CLI::App& app, TraceOptions& o) {
  CLI::App* c = app.add_subcommand("trace", "Convert bus traces, or show what one holds");
  c->require_subcommand(1);
  CLI::App* convert = c->add_subcommand(
      "convert", "Write a bus trace in another format, or read one of another simulator");
  const CLI::IsMember formats(
      std::vector<std::string>(std::begin(kTraceFormats), std::end(kTraceFormats)));
  convert->add_option("in", o.in, "The trace to read")->required()->type_name("FILE");
  convert->add_option("-o,--out", o.out, "The trace to write")->required()->type_name("FILE");
  convert->add_option("--to", o.to, "Format to write")
      ->required()
      ->type_name("FORMAT")
      ->check(formats);
  convert->add_option("--from", o.from, "Format to read")
      ->type_name("FORMAT")
      ->check(formats)
      ->default_str("what the file holds");
  convert
      ->add_option("--clock", o.clock,
                   "Clock of the cycles in a DRAMSys or DRAMsim3 trace: frequency (800MHz) or "
                   "period (1250ps)")
      ->type_name("CLOCK");
  convert->add_option("--bytes", o.bytes, "Size of a request where the format does not say it")
      ->type_name("N")
      ->default_str(std::to_string(kDefaultBytes));
  convert->add_option("--master", o.master, "Master to book the requests of a foreign trace under")
      ->type_name("NAME")
      ->default_str(trace::ForeignReading{}.label);
  convert->add_option("--window", o.window, "Reads that this master may have in flight, 1 to 48")
      ->type_name("N")
      ->default_str(std::to_string(trace::ForeignReading{}.window));
  convert->add_option("--size", o.size, "Size of the memory that the trace is for, such as 64MiB")
      ->type_name("SIZE")
      ->default_str("the recorded part's, else 128MiB");
  convert->add_flag("--wrap", o.wrap, "Take addresses beyond the memory modulo its size");
  CLI::App* info = c->add_subcommand("info", "Show format, length and masters of a trace");
  info->add_option("in", o.in, "The trace")->required()->type_name("FILE");
  return c;
}

}  // namespace

Command add_trace(CLI::App& app) {
  const auto o = std::make_shared<TraceOptions>();
  CLI::App* const c = add_options(app, *o);
  return {c, [o, c](const Call& call) {
            if (c->get_subcommands().front()->get_name() == "info") {
              print_info(*o, call.context.out);
              call.context.out << std::flush;
            } else {
              Conversion(*o, call.context).run();
            }
            return int{kExitDone};
          }};
}

}  // namespace fovea::app
