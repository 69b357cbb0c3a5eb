#include "tb/rtl/addrgen_bench.h"

#include "Vbench_top.h"
#include "tb/rtl/coverage.h"
#include "tb/rtl/job_ports.h"

namespace fovea::rtl {

AddrgenBench::AddrgenBench(std::uint32_t seed)
    : dut_(std::make_unique<Vbench_top>()), random_(seed) {
  reset();
}

AddrgenBench::~AddrgenBench() { keep_coverage(); }

void AddrgenBench::clock() {
  dut_->clk_i = 1;
  dut_->eval();
  dut_->clk_i = 0;
  dut_->eval();
}

/// Asserted between two clock edges.
void AddrgenBench::reset() {
  dut_->rst_ni = 0;
  dut_->eval();
  if (dut_->ag_busy_o || dut_->ag_beat_valid_o) throw std::runtime_error("busy in reset");
  clock();
  clock();
  dut_->rst_ni = 1;
  clock();
}

void AddrgenBench::clear() {
  dut_->ag_clear_i = 1;
  clock();
  dut_->ag_clear_i = 0;
  dut_->eval();
}

void AddrgenBench::offer(const Job& job) {
  Vbench_top& d = *dut_;
  set_job(d, job);
  d.ag_job_valid_i = 1;
  d.eval();
  for (unsigned waited = 0; !d.ag_job_ready_o; ++waited) {
    if (waited == 10'000) throw std::runtime_error("the address generator does not take a job");
    clock();
  }
  clock();
  d.ag_job_valid_i = 0;
  // The job is the engine's now; what is on the wires must not matter any more.
  d.ag_pairs_i = 0;
  d.ag_src_pitch_i = 0;
  d.ag_a1_i = 0x5A5A5A5A;
  d.eval();
}

bool AddrgenBench::refused(const Job& job) {
  offer(job);
  const bool no = dut_->ag_job_refused_o;
  clock();
  if (no && dut_->ag_busy_o) throw std::runtime_error("busy with a job that was refused");
  clear();
  return no;
}

Beat AddrgenBench::beat() const {
  const Vbench_top& d = *dut_;
  Beat b;
  b.last = d.ag_last_o;
  b.border = d.ag_border_o;
  b.bad = d.ag_bad_o;
  b.edge_x = d.ag_edge_x_o;
  b.edge_y = d.ag_edge_y_o;
  b.odd = d.ag_odd_o;
  b.frac_x = d.ag_frac_x_o;
  b.frac_y = d.ag_frac_y_o;
  b.src = d.ag_src_o;
  b.dst = d.ag_dst_o;
  return b;
}

Outcome AddrgenBench::run(const Job& job, std::span<const std::uint32_t> map, Pace pace,
                          std::size_t limit, End end) {
  Vbench_top& d = *dut_;
  Outcome out;
  offer(job);
  bool stalled = false, offered = false;
  Beat before;
  for (unsigned idle = 0; idle < 10'000; ++idle) {
    if (out.beats.size() == limit) {
      end == End::kReset ? reset() : clear();
      return out;
    }
    // A word that was offered stays on offer, as the rule of the handshake says. Behind the last
    // one there are words of something else, which must not be taken.
    if (!offered) offered = random_() % 16 < pace.map;
    d.ag_map_valid_i = offered;
    d.ag_map_i = out.map_taken < map.size() ? map[out.map_taken] : 0xDEADBEEF;
    d.ag_beat_ready_i = random_() % 16 < pace.beat;
    d.eval();
    if (stalled && (!d.ag_beat_valid_o || beat() != before))
      throw std::runtime_error("a stalled beat changed");
    stalled = d.ag_beat_valid_o && !d.ag_beat_ready_i;
    before = beat();
    if (d.ag_map_valid_i && d.ag_map_ready_o) {
      ++out.map_taken;
      offered = false;
      idle = 0;
    }
    const bool got = d.ag_beat_valid_o && d.ag_beat_ready_i;
    if (got) {
      out.beats.push_back(before);
      idle = 0;
    }
    ++out.clocks;
    clock();
    if (got && before.last) {
      d.ag_beat_ready_i = 0;
      d.ag_map_valid_i = 0;
      d.eval();
      return out;
    }
  }
  throw std::runtime_error("the address generator stands still");
}

}  // namespace fovea::rtl
