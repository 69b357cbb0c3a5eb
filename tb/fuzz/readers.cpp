#include "tb/fuzz/readers.h"

#include <sqlite3.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "model/common/check.h"
#include "model/trace/core/foreign_trace.h"
#include "model/trace/core/text_trace.h"
#include "model/trace/core/trace_file.h"
#include "sw/fovea/config/calibration.h"
#include "sw/fovea/config/experiment.h"
#include "sw/fovea/console/dialogue.h"
#include "sw/fovea/debug/gdb_packet.h"
#include "sw/fovea/debug/gdb_server.h"
#include "sw/fovea/files/png.h"
#include "sw/fovea/files/safe_json.h"
#include "sw/fovea/program/source_lines.h"
#include "sw/fovea/regression/baseline.h"
#include "sw/fovea/regression/check.h"
#include "sw/fovea/regression/trend.h"
#include "sw/fovea/replay/replay_params.h"
#include "sw/fovea/results/table_file.h"
#include "tb/fuzz/guests.h"
#include "tb/fuzz/input_file.h"
#include "tb/fuzz/planted.h"
#include "tb/own_diagnostics.h"
#include "tb/unit/gdb_fake_target.h"

namespace fovea::fuzz {
namespace {

Result experiment(std::string_view bytes) {
  app::ReplayParams params;
  ParamSet set;
  params.declare(set);
  app::Experiment e(set);
  const InputFile file(bytes);
  e.load(file.name());
  for (const ParamBase* p : set.all()) p->text();
  planted(e.rank("ddr.tRP") >= 0 && e.rank("ddr.tRCD") >= 0);
  return Result::kRead;
}

Result calibration(std::string_view bytes) {
  const app::Calibration c = app::read_calibration(InputFile(bytes).name());
  if (c.width > 8192 || c.height > 8192) throw std::logic_error("a size that is not allowed");
  planted(c.width == 0);
  return Result::kRead;
}

/// Also what is written on top of it: blessing it gives a baseline again.
Result baseline(std::string_view bytes) {
  const regression::Baseline b = regression::parse_baseline("b.yaml", std::string(bytes));
  regression::RunFigures run;
  run.version = "1";
  run.commit = "2";
  run.subject = b.subject;
  for (const auto& e : b.metrics) run.metrics[e.name] = {17, e.unit, true};
  const std::string blessed = regression::blessed_text(run, b, "why: #1");
  std::string again;
  try {
    regression::parse_baseline("b.yaml", blessed);
  } catch (const UserError& e) {
    throw std::logic_error(std::string("blessing makes what is no baseline: ") + e.what());
  }
  regression::unified_diff("b.yaml", b.text, blessed);
  planted(b.metrics.size() > 2);
  return Result::kRead;
}

Result json(std::string_view bytes) {
  const nlohmann::json value = app::parse_json(bytes);
  if (value.is_discarded()) return Result::kRefused;
  const nlohmann::json copy = value;
  if (app::parse_json(copy.dump()) != value) throw std::logic_error("JSON is not what was written");
  for (const auto& [name, member] : app::json_member(value, "params").items()) app::json_text(member, "value");
  planted(value.is_object() && value.size() > 5);
  return Result::kRead;
}

Result table(std::string_view bytes) {
  const results::TableFile t(InputFile(bytes).name(), {"function", "clocks"});
  std::uint64_t sum = 0;
  for (std::size_t row = 0; row < t.rows(); ++row) sum += t.text(row, "function").size() + t.count(row, "clocks");
  planted(t.rows() > 3 && sum > 0);
  return Result::kRead;
}

/// All records of all streams, up to a number that no file of this size has.
void take_all(trace::RecordSource& source, std::size_t streams) {
  trace::Record record;
  for (unsigned s = 0; s < streams; ++s)
    for (std::uint64_t n = 0; source.next(s, record); ++n)
      if (n > 100'000'000) throw std::logic_error("a trace without end");
}

Result text_trace(std::string_view bytes) {
  trace::TextTrace t("t", std::string(bytes));
  take_all(t, t.info().streams.size());
  planted(t.info().masters.size() > 3);
  return Result::kRead;
}

Result binary_trace(std::string_view bytes) {
  trace::TraceFile t("t", std::string(bytes));
  take_all(t, t.info().streams.size());
  planted(t.records() != 4);
  return Result::kRead;
}

Result foreign_trace(std::string_view bytes) {
  const auto format = trace::recognise_foreign(bytes);
  if (!format) {
    trace::refuse_foreign(bytes);
    return Result::kRefused;
  }
  trace::ForeignReading reading;
  reading.format = *format;
  reading.clock = Frequency(1'000'000'000);
  trace::ForeignTrace t("t", std::make_unique<trace::MemoryBytes>(std::string(bytes)), reading);
  take_all(t, 1);
  planted(*format == trace::ForeignFormat::kDramsim3);
  return Result::kRead;
}

/// The program, and its debug information at the entry and at each function.
Result elf(std::string_view bytes) {
  const InputFile file(bytes);
  const app::ElfImage image = app::ElfImage::load(file.name());
  app::SourceLines lines;
  lines.add(image);
  lines.at(image.entry());
  for (const app::ElfSymbol& s : image.symbols()) {
    image.describe(s.address);
    if (s.function)
      for (const app::SourceFrame& f : lines.at(s.address)) planted(f.line > 60'000);
  }
  return Result::kRead;
}

Result png(std::string_view bytes) {
  const app::RgbImage image = app::read_png(InputFile(bytes).name());
  if (image.rgb.size() != std::size_t{3} * image.width * image.height)
    throw std::logic_error("a picture without its pixels");
  planted(image.width == 3);
  return Result::kRead;
}

/// SQLite wants a folder for its journal.
Result trend(std::string_view bytes) {
  static const std::string file = "/dev/shm/fovea-fuzz-" + std::to_string(::getpid()) + ".db";
  const struct Remover {
    ~Remover() { std::filesystem::remove(file); }
  } remover;
  std::ofstream(file, std::ios::binary) << bytes;
  std::size_t figures = 0;
  regression::TrendFile t(file);
  for (const auto& name : t.experiments())
    for (const auto& line : t.lines(name)) figures += line.figures.size();
  planted(figures > 1);
  return Result::kRead;
}

/// The packets are handled as those of a debugger, and what comes back is a packet again. Behind a first line feed each
/// line is the contents of a packet: a fuzzer hardly ever makes a right sum.
Result gdb(std::string_view bytes) {
  app::test::FakeGdbTarget target;
  app::GdbProtocol protocol(target);
  app::GdbFramer framer, back;
  if (bytes.starts_with('\n'))
    for (bytes.remove_prefix(1); !bytes.empty();) framer.feed(app::gdb_frame(app::take_until(bytes, '\n')));
  else
    framer.feed(bytes);
  while (const auto event = framer.next()) {
    if (event->kind != app::GdbFramer::Event::Kind::kPacket) continue;
    auto answer = protocol.handle(event->payload);
    planted(target.values[1] != 1);
    if (answer.payload) answer.output.push_back(*answer.payload);
    for (const std::string& text : answer.output) {
      back.feed(app::gdb_frame(text));
      const auto packet = back.next();
      if (!packet || packet->payload != text) throw std::logic_error("an answer is no packet");
    }
  }
  return Result::kRead;
}

/// The lines of uart0.input, typed to the end.
Result console(std::string_view bytes) {
  app::Dialogue d = app::Dialogue::parse("d", std::string(bytes));
  Picoseconds now = 0;
  std::size_t typed = 0;
  for (std::uint64_t n = 0; !d.over(); ++n) {
    if (n > 100'000'000) throw std::logic_error("a dialogue without end");
    if (const auto byte = d.next(now)) {
      ++typed;
      continue;
    }
    if (const auto at = d.waits_until()) now = std::max(now, *at) + 1;
    else if (!d.over()) break;  // it waits for the program
  }
  d.position();
  planted(typed > 9);
  return Result::kRead;
}

constexpr Reader kReaders[] = {
    {"experiment", "sw/fovea/(config/experiment|files/safe_yaml)", experiment},
    {"calibration", "sw/fovea/(config/calibration|files/safe_yaml)", calibration},
    {"baseline", "sw/fovea/(regression/(baseline|bless)|compare/tolerance)\\.", baseline},
    {"json", "sw/fovea/files/safe_json", json},
    {"table", "sw/fovea/results/(table_file|csv)", table},
    {"text_trace", "model/trace/core/(text_trace|line_reader)", text_trace},
    {"binary_trace", "model/trace/core/(trace_file|trace_code)", binary_trace},
    {"foreign_trace", "model/trace/core/(foreign_trace|line_reader)", foreign_trace},
    {"elf", "sw/fovea/program/(elf_image|elf_target|source_lines|die_names)", elf},
    {"png", "sw/fovea/files/png", png},
    {"trend", "sw/fovea/regression/trend\\.", trend},
    {"gdb", "sw/fovea/debug/(gdb_packet|gdb_protocol)", gdb},
    {"console", "sw/fovea/console/dialogue", console},
    {"edma", "model/dma/core/(channel_controller|commands|edma_registers|param_set)", edma},
    {"engine", "model/engine/core/(engine_registers|tlm_backend|remap_job|remap_model|map_reader|packer)", engine},
};

}  // namespace

std::span<const Reader> readers() { return kReaders; }

Result run(const Reader& reader, std::string_view bytes) {
  const OwnDiagnostics diagnostics;
  try {
    return reader.read(bytes);
  } catch (const UserError& e) {
    if (std::string_view(e.what()).find('\n') != std::string_view::npos)
      throw std::logic_error(std::string("a refusal of several lines: ") + e.what());
    return Result::kRefused;
  }
}

}  // namespace fovea::fuzz
