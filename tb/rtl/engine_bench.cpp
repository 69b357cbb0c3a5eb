#include "tb/rtl/engine_bench.h"

#include "tb/rtl/job_ports.h"

namespace fovea::rtl {

EngineBench::EngineBench(std::size_t bytes, std::uint32_t seed)
    : dut_(std::make_unique<Vbench_top>()), random_(seed), words_(bytes / 4) {
  dut_->rst_ni = 0;
  clock();
  clock();
  dut_->rst_ni = 1;
  clock();
}

EngineBench::~EngineBench() = default;

void EngineBench::clock() {
  dut_->clk_i = 1;
  dut_->eval();
  dut_->clk_i = 0;
  dut_->eval();
  ++now_;
}

std::uint32_t& EngineBench::word(std::uint32_t word_address) {
  const std::uint32_t at = word_address - kBase / 4;
  if (at >= words_.size()) throw std::runtime_error("an access beyond the memory");
  return words_[at];
}

void EngineBench::drive(const Memory& memory) {
  Vbench_top& d = *dut_;
  d.ar_ready_i = chance(memory);
  d.aw_ready_i = chance(memory);
  d.w_ready_i = chance(memory);
  // The oldest read of one identifier or of the other; only beats of one identifier have to be in
  // order.
  d.r_valid_i = 0;
  if (!reads_.empty() && chance(memory)) {
    reading_ = 0;
    if (memory.swaps && random_() % 2) {
      while (reading_ < reads_.size() && reads_[reading_].id == reads_[0].id) ++reading_;
      if (reading_ == reads_.size()) reading_ = 0;
    }
    const Read& r = reads_[reading_];
    if (r.due <= now_) {
      d.r_valid_i = 1;
      d.r_id_i = r.id;
      d.r_data_i = r.fault ? 0xBAD0BAD0BAD0BAD0u
                           : word(r.address / 4) | std::uint64_t{word(r.address / 4 + 1)} << 32;
      d.r_resp_i = r.fault ? 2 : 0;
    }
  }
  d.b_valid_i = !answers_.empty() && answers_.front().due <= now_;
  d.b_resp_i = d.b_valid_i && answers_.front().fault ? 2 : 0;
  d.eval();
}

void EngineBench::sample(const Memory& memory) {
  Vbench_top& d = *dut_;
  AxiClock c;
  c.ar = {d.ar_valid_o != 0, d.ar_ready_i != 0, d.ar_id_o, d.ar_addr_o, d.ar_len_o};
  c.aw = {d.aw_valid_o != 0, d.aw_ready_i != 0, 0, d.aw_addr_o, d.aw_len_o};
  c.w = {d.w_valid_o != 0, d.w_ready_i != 0, d.w_last_o != 0, d.w_data_o, d.w_strb_o};
  if (!d.r_ready_o || !d.b_ready_o) throw std::runtime_error("an answer is not taken");
  if (d.r_valid_i) {
    Read& r = reads_[reading_];
    r.address += 8;
    c.r_last = r.left-- == 0;
    result_.read_bytes += 8;
    if (c.r_last) reads_.erase(reads_.begin() + static_cast<std::ptrdiff_t>(reading_));
  }
  if (d.b_valid_i) {
    c.b = true;
    answers_.pop_front();
  }
  checker_.clock(c);
  const std::uint64_t due =
      now_ + memory.latency + (memory.spread ? random_() % (memory.spread + 1) : 0);
  if (c.ar.valid && c.ar.ready) {
    reads_asked.push_back(c.ar);
    read_clocks.push_back(now_);
  }
  if (c.aw.valid && c.aw.ready) writes_asked.push_back(c.aw);
  if (c.ar.valid && c.ar.ready)
    reads_.push_back({c.ar.id, c.ar.length, c.ar.address, due,
                      memory.read_fault && *memory.read_fault / 64 == c.ar.address / 64});
  if (c.aw.valid && c.aw.ready) addresses_.push_back(c.aw);
  if (c.w.valid && c.w.ready) beats_.push_back(c.w);
  while (!addresses_.empty() && beats_.size() > addresses_.front().length) {
    const Request a = addresses_.front();
    const bool fault = memory.write_fault && *memory.write_fault / 64 == a.address / 64;
    for (unsigned n = 0; n <= a.length; ++n, beats_.pop_front())
      for (unsigned half = 0; half < 2; ++half) {
        const unsigned strobes = beats_.front().strobes >> 4 * half & 15;
        if (strobes == 0) continue;
        if (strobes != 15) throw std::runtime_error("a write of a part of a word");
        result_.written_bytes += 4;
        std::uint32_t& target = word(a.address / 4 + 2 * n + half);
        if (!fault) target = static_cast<std::uint32_t>(beats_.front().data >> 32 * half);
      }
    addresses_.pop_front();
    answers_.push_back({due, fault});
  }
}

Result EngineBench::run(const Job& job, std::uint32_t map_base, std::uint32_t border, Memory memory,
                        std::optional<unsigned> abort_after) {
  Vbench_top& d = *dut_;
  result_ = {};
  reads_asked.clear();
  read_clocks.clear();
  writes_asked.clear();
  set_job(d, job);
  d.en_map_base_i = map_base / 64;
  d.en_map_words_i = static_cast<std::uint32_t>(map_words(job));
  d.en_border_i = border;
  d.en_job_valid_i = 1;
  d.eval();
  if (!d.en_job_ready_o) throw std::runtime_error("the engine does not take a job");
  clock();
  d.en_job_valid_i = 0;
  set_job(d, Job{});
  const std::uint64_t begin = now_, most = 200'000 + std::uint64_t{job.pairs} * job.rows * 200;
  for (bool done = false; !done;) {
    d.en_abort_i = abort_after && now_ - begin == *abort_after;
    drive(memory);
    sample(memory);
    done = d.en_done_o;
    if (now_ - begin > most) throw std::runtime_error("the engine stands still");
    clock();
  }
  d.ar_ready_i = d.aw_ready_i = d.w_ready_i = d.r_valid_i = d.b_valid_i = d.en_abort_i = 0;
  d.eval();
  if (!checker_.quiet()) throw std::runtime_error("something is under way after the end of a job");
  result_.refused = d.en_refused_o;
  result_.read_error = d.en_read_error_o;
  result_.write_error = d.en_write_error_o;
  result_.aborted = d.en_aborted_o;
  result_.clocks = d.en_clocks_o;
  result_.lines = d.en_lines_o;
  result_.writes = d.en_writes_o;
  result_.bad = d.en_bad_o;
  return result_;
}

}  // namespace fovea::rtl
