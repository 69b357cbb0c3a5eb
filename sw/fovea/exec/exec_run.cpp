// The machines: which one a kind is, and the core with its memory.
#include <sys/resource.h>

#include <bit>
#include <chrono>

#include "model/board/board_params.h"
#include "model/common/host_time_slicer.h"
#include "sw/fovea/board/board_debug.h"
#include "sw/fovea/board/board_machine.h"
#include "sw/fovea/board/loader.h"
#include "sw/fovea/exec/exec_board.h"
#include "sw/fovea/exec/exec_caches.h"
#include "sw/fovea/exec/flat_machine.h"
#include "sw/fovea/results/figures.h"

namespace fovea::app {
namespace {

using Wall = std::chrono::steady_clock;

struct ExecParams : ParamGroup {
  TextParam ram_base{
      *this, "ram_base", "auto",
      "where RAM begins, a multiple of 0x100000; auto: the multiple of its size below "
      "the program's lowest segment"};
  ExecParams() : ParamGroup("exec") {}
};

/// Core, crossbar and SDRAM, or the core alone.
class CoreMachine final : public Machine {
 public:
  explicit CoreMachine(bool flat) : flat_(flat) {}
  void declare(ParamSet& set) override {
    set.add(cpu_);
    set.add_alone(crossbar_);
    for (const MasterInfo& m : kMasters.rows)
      if (is_core(m.id)) set.add(*crossbar_.ports[stat_index(m.id)]);
    set.add(config_bus_);
    set.add(ddr_);
    set.add(clocks_);
    set.add(exec_);
  }
  Result run(const Request& request) override;

 private:
  Result run_board(const Request& request, const ExecMap& map, const ExecClocks& clocks);
  void collect_memory(std::vector<StatRow>& rows) const;

  bool flat_;
  cpu::CpuParams cpu_;
  bus::CrossbarParams crossbar_;
  bus::ConfigBusParams config_bus_;
  mem::DdrParams ddr_;
  board::ClockParams clocks_;
  ExecParams exec_;
  std::unique_ptr<ExecBoard> board_;
};

Result CoreMachine::run_board(const Request& request, const ExecMap& map,
                                    const ExecClocks& clocks) {
  board_ = std::make_unique<ExecBoard>("exec", ExecBoardParams{cpu_, crossbar_, config_bus_, ddr_},
                                       map, clocks,
                                       map.table ? preamble_entry(map) : request.program->image.entry());
  auto& arm = board_->arm;
  // The console belongs to the program, so suppress the kernel's message at the end of the
  // simulation.
  sc_core::sc_report_handler::set_actions("/OSCI/SystemC", sc_core::SC_INFO,
                                          sc_core::SC_DO_NOTHING);
  ExecSession session(arm.core(), *board_, request, map, ExecBoard::register_regions());
  session.load(board_->ram(), board_->tcm());
  const std::vector<RegisterBlock> blocks = register_blocks(board_->platform);
  const auto log = register_log(blocks, board_->config, arm.core(),
                                [&](std::uint32_t pc) { return session.describe(pc); });
  session.attach_tools({.params = request.params,
                        .controller = &board_->ddr.controller(),
                        .observe = [this](MemObserver& o) { return board_->scr.crossbar().observe(o); },
                        .name_of = [](Master m) { return std::string(stat_name(m)); },
                        .now = [] { return kernel_time(); },
                        .log = log.get(),
                        .memory = &board_->scr.memory()});
  session.attach(*board_, [&](GdbViews& v) {
    v.blocks = blocks;
    v.log = log.get();
    v.stats = [this, core = std::move(v.stats)] {
      auto rows = core();
      collect_memory(rows);
      return rows;
    };
    join_bus(v, board_->scr, board_->ddr, board_->arm, board_->end_of_instant, map.ram_base);
  });
  // Slices only give control to the host now and then; no instruction takes as long as a slice.
  const Picoseconds slice = 10 * kPsPerMs;
  HostTimeSlicer slicer;
  std::string failure;
  for (std::uint64_t before = ~std::uint64_t{0};;) {
    slicer.run(request.limits.next_slice(slice, kernel_time(),
                                         arm.core().instructions_executed()));
    failure = arm.failure();
    if (!failure.empty() || session.over()) break;
    if (const auto option = session.look(kernel_time()); !option.empty()) {
      failure = option + " reached";
      break;
    }
    GdbSession* const gdb = session.gdb();
    if (gdb && gdb->killed()) break;
    const std::uint64_t now = arm.core().instructions_executed();
    if (gdb) gdb->look();
    if (now == before && arm.asleep()) {
      failure = "the program waits for an interrupt, and none can come";
      break;
    }
    before = now;
  }
  board_->scr.settle();
  board_->ddr.settle(kernel_time());
  Result result = session.result(failure);
  collect_memory(result.stats);
  return result;
}

void CoreMachine::collect_memory(std::vector<StatRow>& rows) const {
  board_->platform.each_statistics([&](const StatGroup& group) { collect(group, rows); });
}

Result CoreMachine::run(const Request& request) {
  const auto started = Wall::now();
  if (!flat_) refuse_mobile_memory(ddr_, "exec");
  for (const auto* cache : {&cpu_.icache, &cpu_.dcache})
    if (!std::has_single_bit(cache->size()))
      throw UserError("key '" + cache->size.key() + "': '" + cache->size.text() +
                      "' is not allowed; allowed: powers of two");
  const ExecMap map =
      request.program->image.map(ddr_.size_bytes(), parse_ram_base(exec_.ram_base(), ddr_.size_bytes()),
                                 request.program->caches);
  ExecClocks clocks = ExecClocks::of({clocks_.preset(), clocks_.arm(), clocks_.ddr()});
  if (clocks_.crossbar() != 0) clocks.scr = Frequency(clocks_.crossbar());
  Result result = flat_ ? run_flat(request, cpu_, map, clocks.core) : run_board(request, map, clocks);
  result.core_clock = clocks.core;
  const std::chrono::duration<double> wall = Wall::now() - started;
  result.host.push_back(wall_time(wall.count(), "the run"));
  result.host.push_back(peak_rss());
  return result;
}

}  // namespace

std::unique_ptr<Machine> make_machine(MachineKind kind) {
  switch (kind) {
    case MachineKind::kBoard:
    case MachineKind::kProgramBoard: return make_board(kind == MachineKind::kProgramBoard);
    case MachineKind::kCore:
    case MachineKind::kFlat: break;
  }
  return std::make_unique<CoreMachine>(kind == MachineKind::kFlat);
}

}  // namespace fovea::app
