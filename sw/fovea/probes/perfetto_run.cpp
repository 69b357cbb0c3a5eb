#include "sw/fovea/probes/perfetto_run.h"

#include <fmt/format.h>
#include <re2/re2.h>

#include <algorithm>

#include "model/common/check.h"
#include "sw/fovea/config/run_until.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::app {
namespace {

/// Of the counters. Bandwidths are means over it.
constexpr Picoseconds kSample = 100 * kPsPerUs;

const char* phase_text(board::Phase phase) {
  switch (phase) {
    case board::Phase::kReset: return "";
    case board::Phase::kBoot: return "boot";
    case board::Phase::kLut: return "look-up table";
    case board::Phase::kIdle: return "waiting for lock";
    case board::Phase::kRemapStart: return "remap";
    case board::Phase::kRemapEnd: return "remap done";
    case board::Phase::kFlip: return "flip asked for";
    case board::Phase::kFailed: return "failed";
  }
  return "";
}

std::function<bool(const std::string&)> matcher(const std::string& expression) {
  const auto re = std::make_shared<re2::RE2>(expression, re2::RE2::Quiet);
  if (!re->ok())
    throw UserError(fmt::format("--perfetto-tracks '{}': {}", one_line(expression), one_line(re->error())));
  return [re](const std::string& name) { return re2::RE2::PartialMatch(name, *re); };
}

}  // namespace

PerfettoRun::PerfettoRun(const PerfettoRequest& request, board::Board& board)
    : request_(request), board_(board) {
  std::optional<Picoseconds> from;
  if (request.from != "window") from = parse_time("--perfetto-from", request.from);
  file_ = std::make_unique<PerfettoFile>(
      request.file, request.megabytes << 20,
      request.trigger.empty() ? PerfettoFile::Keep::kOldest : PerfettoFile::Keep::kNewest, matcher(request.tracks));
  capture_ = file_->track("frames", "1 capture");
  remap_ = file_->track("frames", "2 remap");
  display_ = file_->track("frames", "3 display");
  phases_ = file_->track("firmware", "phases");
  for (std::size_t m = 0; m < kMasterCount; ++m)
    masters_[m] = std::make_unique<PerfettoLanes>(*file_, "masters", std::string(kMasterNames[m]));
  queue_ = file_->counter("SDRAM", "queue", "requests");
  owed_ = file_->counter("SDRAM", "refreshes owed", "refreshes");
  hits_ = file_->counter("SDRAM", "column commands without a new row", "%");
  for (std::size_t i = 0; i < kStatCount; ++i)
    for (const unsigned write : {0u, 1u})
      bandwidth_[i][write] = file_->counter(
          "bandwidth", fmt::format("{} {}", kStatNames[i], write ? "writes" : "reads"), "MB/s");
  outputs_ = board.dm365.gpio.observe_outputs([this](unsigned bank, std::uint32_t out, Picoseconds at) {
    if (bank == PHASE_BANK) pins(out, at);
  });
  watch_interrupts();
  watch_transfers();
  if (from) begin_at(*from);
}

bool PerfettoRun::wants_functions() const { return file_->wants("firmware", "functions 01"); }

void PerfettoRun::watch_functions(cpu::ClockProfile& profile, PerfettoFunctions::Name name) {
  const cpu::Core& core = board_.dm365.arm.core();
  functions_ = std::make_unique<PerfettoFunctions>(
      *file_, std::move(name), [&core](std::uint64_t cycle) { return core.time(cycle); },
      [&profile](std::uint64_t cycle) { profile.stacks.count(cycle, profile.counts_stacks()); });
  watching_ = profile.stacks.watch(*functions_);
}

void PerfettoRun::watch_interrupts() {
  auto& aintc = board_.dm365.aintc;
  const auto watch = [this](auto& port, const std::string& name, unsigned input) {
    Line& line = lines_.emplace_back(Line{name, input, std::nullopt});
    sc_core::sc_spawn_options options;
    options.spawn_method();
    options.set_sensitivity(&port);
    options.dont_initialize();
    sc_core::sc_spawn([this, &line, &port] { line_changed(line, port.read()); },
                      sc_core::sc_gen_unique_name("perfetto"), &options);
  };
  watch(aintc.irq, "IRQ of the core", 0);
  watch(aintc.fiq, "FIQ of the core", 0);
  for (std::size_t i = 0; i < aintc.source.size(); ++i) watch(aintc.source[i], "", static_cast<unsigned>(i));
}

void PerfettoRun::line_changed(Line& line, bool level) {
  const Picoseconds now = kernel_time();
  if (level) {
    line.since = now;
    line.what = line.name.empty() ? board_.dm365.interrupt_source(line.input).name : line.name;
    const std::string track = line.name.empty() ? fmt::format("{:02} {}", line.input, line.what) : line.name;
    const auto [found, unknown] = line_tracks_.try_emplace(track, PerfettoFile::kNone);
    if (unknown) found->second = file_->track("interrupts", track);
    line.track = found->second;
  } else if (line.since) {
    if (on_) line_slice(line, now);
    line.since.reset();
  }
}

void PerfettoRun::line_slice(const Line& line, Picoseconds end) {
  file_->slice(line.track, line.what, std::max(*line.since, from_), end);
}

/// A request is under way from the program register on until its last write is acknowledged; those of a
/// controller may overlap.
void PerfettoRun::watch_transfers() {
  for (std::size_t i = 0; i < controllers_.size(); ++i) {
    controllers_[i] = std::make_unique<PerfettoLanes>(*file_, "DMA", fmt::format("TC{}", i));
    dma::EdmaTc& tc = *board_.dm365.edma_tcs[i];
    tc.on_request = [this, i](const TransferRequest& r, Picoseconds at) {
      transfers_[i].push_back({r, at});
    };
    tc.on_ended = [this, i](const TransferRequest& r, Picoseconds at) {
      auto& list = transfers_[i];
      const auto t = std::find_if(list.begin(), list.end(), [&](const Transfer& other) {
        const auto& o = other.request;
        return o.source.address == r.source.address && o.destination.address == r.destination.address &&
               o.acnt == r.acnt && o.bcnt == r.bcnt;
      });
      if (t == list.end()) return;
      if (on_ && t->at >= from_ && t->at < until_)
        controllers_[i]->slice(fmt::format("{} x {} B, code {}", r.bcnt, r.acnt, r.tcc), t->at, at);
      list.erase(t);
    };
  }
}

void PerfettoRun::begin_at(Picoseconds at) {
  board_.dm365.end_of_instant.at(at, InstantRank::kObservers, [this, at] { begin(at); });
}

void PerfettoRun::end_at(Picoseconds at) {
  until_ = std::min(until_, at);
  board_.dm365.end_of_instant.at(std::max(at, kernel_time()), InstantRank::kObservers, [this] { end(); });
}

void PerfettoRun::window_opened() {
  activates_ = bursts_ = 0;  // the statistics begin anew
  bytes_ = {};
  sampled_ = kernel_time();
  if (request_.from == "window") begin(kernel_time());
}

void PerfettoRun::window_closed() {
  until_ = std::min(until_, kernel_time());
  end();
}

void PerfettoRun::begin(Picoseconds at) {
  if (on_ || over_ || at >= until_) return;
  on_ = true;
  from_ = at;
  if (request_.trigger.empty() && request_.duration != kNever) end_at(at + request_.duration);
  requests_ = board_.dm365.scr.crossbar().observe(*this);
  if (functions_) functions_->start(at);
  sample();
}

void PerfettoRun::end() {
  if (!on_) return;
  const Picoseconds at = std::min(kernel_time(), until_);
  close_phase(at);
  for (const Line& l : lines_)
    if (l.since && at > from_) line_slice(l, at);
  if (functions_) functions_->finish(at);
  requests_.reset();
  on_ = false;
  over_ = true;
}

void PerfettoRun::sample() {
  if (!on_) return;
  auto& soc = board_.dm365;
  const Picoseconds now = kernel_time();
  if (functions_) functions_->flush(std::min(now, until_));
  soc.scr.settle();
  soc.ddr.settle(now);
  const mem::DdrController& ddr = soc.ddr.controller();
  const bool first = now == from_;
  for (std::size_t i = 0; i < kStatCount; ++i) {
    const bus::MasterStats& stats = *soc.scr.crossbar().stats[i];
    const std::array<std::uint64_t, 2> bytes{stats.read_bytes.count(), stats.write_bytes.count()};
    for (const unsigned write : {0u, 1u})
      if (!first && now > sampled_ && (bytes[write] || bytes_[i][write]))
        file_->value(bandwidth_[i][write], now,
                     static_cast<double>(bytes[write] - std::min(bytes_[i][write], bytes[write])) /
                         static_cast<double>(now - sampled_) * 1e6);
    bytes_[i] = bytes;
  }
  file_->value(queue_, now, std::int64_t{ddr.requests_queued()});
  file_->value(owed_, now, std::int64_t{ddr.refreshes_owed()});
  const std::uint64_t activates = ddr.stats.activates.count(), bursts = ddr.stats.bursts.count();
  if (!first && bursts > bursts_)
    file_->value(hits_, now, 100 * (1 - static_cast<double>(activates - activates_) /
                                            static_cast<double>(bursts - bursts_)));
  activates_ = activates;
  bursts_ = bursts;
  sampled_ = now;
  soc.end_of_instant.at(now + kSample, InstantRank::kObservers, [this] { sample(); });
}

void PerfettoRun::pins(std::uint32_t levels, Picoseconds at) {
  close_phase(at);
  const board::Phase phase = board::phase_of(levels);
  std::string name = phase_text(phase);
  // Between frames too.
  if (phase == board::Phase::kIdle && board_.log.first(board::Phase::kRemapStart)) name = "idle";
  if (phase == board::Phase::kRemapStart) name += fmt::format(" {}", PHASE_SEQUENCE(levels));
  if (!name.empty()) phase_ = {name, at};
}

void PerfettoRun::close_phase(Picoseconds at) {
  if (phase_ && on_ && at > from_) file_->slice(phases_, phase_->first, std::max(phase_->second, from_), at);
  phase_.reset();
}

void PerfettoRun::frame(const video::Frame& shown) {
  const video::FrameTimes& r = shown.times;
  if (on_) {
    // Frame 0 has a flow too.
    const std::uint64_t flow = r.captured ? *r.captured + 1 : 0;
    const std::string name = r.captured ? fmt::format("frame {}", *r.captured) : "no frame";
    if (!r.repeated && r.capture_start && r.capture_end)
      file_->slice(capture_, name, *r.capture_start, *r.capture_end, flow);
    if (!r.repeated && r.remap_start && r.remap_end)
      file_->slice(remap_, name, *r.remap_start, *r.remap_end, flow);
    file_->slice(display_, name, r.display_start, r.display_end, flow);
  }
  const bool met = (request_.trigger == "dropped" && r.dropped) || (request_.trigger == "repeated" && r.repeated) ||
                   (request_.trigger == "underflow" && shown.underflows);
  if (on_ && met && until_ == kNever)
    end_at(kernel_time() + (request_.duration == kNever ? 0 : request_.duration));
}

void PerfettoRun::request(const MemRequest& r, const char* what) {
  if (r.issued < from_ || r.issued >= until_) return;
  char text[48];
  const auto end = fmt::format_to_n(text, sizeof text, "{} {} B at {:#010x}", what, r.bytes, r.address);
  masters_[index(r.master)]->slice(std::string_view(text, std::min(end.size, sizeof text)), r.issued, r.last);
}

void PerfettoRun::responded(const MemRequest& r) {
  request(r, r.write ? "write" : "read");
}

void PerfettoRun::register_done(const MemRequest& r) {
  if (r.in_path.slave == static_cast<std::uint8_t>(bus::Slave::kInternalRam))
    request(r, r.write ? "RAM write" : "RAM read");
  else
    request(r, r.write ? "register write" : "register read");
}

std::string PerfettoRun::finish() {
  end();
  file_->finish();
  if (!over_) return "the Perfetto trace is empty: the recording never began (--perfetto-from)";
  if (!file_->dropped()) return "";
  const double at = static_cast<double>(file_->dropped_at()) * 1e-12;
  const std::string lacks =
      request_.trigger.empty()
          ? fmt::format("requests, transfers and functions from {:.6f} s on ({} packets)", at, file_->dropped())
          : fmt::format("{} older packets, up to {:.6f} s", file_->dropped(), at);
  return fmt::format("the Perfetto trace lacks {}; about --perfetto-size {} holds all, --perfetto-for 100ms a part, "
                     "and --perfetto-tracks '^frames/|^firmware/phases|^interrupts/' is small",
                     lacks, (file_->bytes_wanted() >> 20) + 1);
}

}  // namespace fovea::app
