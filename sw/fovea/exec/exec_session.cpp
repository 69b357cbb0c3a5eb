#include "sw/fovea/exec/exec_session.h"

#include <fmt/format.h>
#include <signal.h>

#include <array>
#include <cstring>
#include <numeric>

#include "sw/fovea/exec/exec_caches.h"
#include "sw/fovea/results/names.h"
#include "sw/fovea/tools/stall_regions.h"

namespace fovea::app {
namespace {

/// UDF #0, undefined in all architecture versions. An exception without a handler ends the run
/// here.
constexpr std::uint32_t kUndefinedWord = 0xE7F000F0u;
constexpr unsigned kVectors = 8;

SemihostingSettings settings(const Request& request, const ExecMap& map) {
  SemihostingSettings s;
  s.root = request.program->root;
  std::vector<std::string> line = {request.program->image.name()};
  line.insert(line.end(), request.program->arguments.begin(), request.program->arguments.end());
  s.command_line = guest_command_line(line);
  s.heap_base = map.free_base;
  s.heap_limit = s.stack_limit = map.heap_limit();
  s.stack_base = map.free_end;
  return s;
}

}  // namespace

ExecClocks ExecClocks::of(const WantedClocks& wanted) {
  const board::ClockSetting s = clock_setting(wanted);
  return {s.core(), s.ddr(), s.scr()};
}

ExecSession::ExecSession(cpu::Core& core, cpu::DebugMemory& memory, const Request& request,
                         const ExecMap& map, std::span<const MemoryRegion> registers)
    : core_(core),
      request_(request),
      program_(request.program->image),
      symbols_(request.program->image.image(), request.symbols),
      map_(map),
      semihosting_(core, memory, settings(request, map), *request.semihosting,
                   [this] { return over(); }) {
  core_.set_regions(exec_regions(program_, map_, registers));
}

ExecSession::~ExecSession() { request_.semihosting->go_on = nullptr; }

void ExecSession::load(std::span<std::uint8_t> ram, std::span<std::uint8_t> tcm) {
  const auto put = [&](std::uint32_t address, std::span<const std::uint8_t> bytes) {
    if (bytes.empty()) return;  // a segment without zeros at its end, perhaps at the end of RAM
    std::uint8_t* to = address - map_.ram_base < ram.size() ? &ram[address - map_.ram_base]
                                                            : &tcm[address & (tcm.size() - 1)];
    std::memcpy(to, bytes.data(), bytes.size());
  };
  std::array<std::uint8_t, 4> word;
  std::memcpy(word.data(), &kUndefinedWord, 4);
  for (std::uint32_t k = 0; k < kVectors; ++k) put(4 * k, word);
  for (const auto& s : program_.segments()) {
    put(s.address, s.data);
    put(s.address + static_cast<std::uint32_t>(s.data.size()),
        std::vector<std::uint8_t>(s.memory_size - s.data.size()));
  }
  if (map_.table) put(map_.table, cache_preamble(map_, program_.entry()));
  core_.set_reg(13, map_.free_end);
  core_.describe = [this](std::uint32_t address) { return program_.describe(address); };
}

std::string ExecSession::failure_text(const std::string& what) const {
  const auto at = [this](std::uint32_t pc) { return "pc " + symbols_.place(pc); };
  std::string text = fmt::format("{} at {}, {:.6f} s after the start", what, at(core_.current_pc()),
                                 static_cast<double>(semihosting_.now()) * 1e-12);
  for (const auto& a : core_.last_accesses())
    text += fmt::format("\n  {} {} bytes at 0x{:08x} from {}", a.write ? "wrote" : "read", a.bytes,
                        a.address, at(a.pc));
  return text;
}

std::string ExecSession::look(Picoseconds now) {
  const std::uint64_t executed = core_.instructions_executed();
  request_.progress.update({now, 0, 0, executed});
  return request_.limits.reached(now, executed);
}

std::vector<StatRow> ExecSession::core_stats() const {
  cpu::CoreStats stats;
  stats.to = core_.counts();
  // The first edge of the clock after time 0 has number 1; a core that has not run has no clocks at
  // all.
  stats.to.cycles = core_.clock_count() ? core_.clock_count() - 1 : 0;
  std::vector<StatRow> rows;
  collect(stats, rows);
  return rows;
}

void ExecSession::attach(cpu::DebugMemory& memory, const std::function<void(GdbViews&)>& add) {
  if (!request_.gdb_port) return;
  GdbViews views;
  views.params = &request_.params;
  views.stats = [this] { return core_stats(); };
  views.memory = {{map_.ram_base, map_.ram_base + map_.ram_size}};
  if (add) add(views);
  gdb_ = std::make_unique<GdbSession>(*request_.gdb_port, core_, memory, std::move(views),
                                      request_.stop, *request_.notes);
  request_.semihosting->go_on = [this] {
    gdb_->poll_during_input();
    return !gdb_->killed();
  };
}

void ExecSession::attach_tools(ToolParts parts) {
  parts.core = &core_;
  parts.program = program_.name();
  parts.symbols = &symbols_;
  parts.programs = {program_.image(), request_.symbols};
  tools_.make(request_.tools, parts);
  tools_.open_window();
}

Result ExecSession::result(const std::string& failure) {
  Result out;
  out.complete = ended();
  out.exit_code = semihosting_.exit_code();
  if (!failure.empty()) out.guest_failure = failure_text(failure);
  if (gdb_ && !failure.empty()) gdb_->failed(out.guest_failure);
  out.killed = gdb_ && gdb_->killed();
  if (gdb_) {
    const bool stopped = !out.complete && failure.empty();
    gdb_->exited(stopped ? SIGTERM : failure.empty() ? out.exit_code.value_or(0) : 3, stopped);
  }
  out.stats = core_stats();
  const cpu::Counts& c = core_.counts();
  FOVEA_CHECK(std::accumulate(c.stall.begin(), c.stall.end(), c.issue + c.idle) ==
                  std::get<std::uint64_t>(find(out.stats, names::kCpuCycles)->value),
              "every clock of the core has one cause");
  out.stalls = stall_rows({}, c, core_.regions());
  tools_.close_window();
  tools_.finish(c, out, out.lost);
  return out;
}

}  // namespace fovea::app
