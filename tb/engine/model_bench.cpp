#include "tb/engine/model_bench.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace fovea::engine {

void ModelBench::set(const Reg& reg, std::uint32_t value, unsigned strobes) {
  backend.run(now_);
  backend.write(reg.offset(), value, strobes, now_);
  call_ = backend.run(now_);
}

void ModelBench::window(const rtl::Job& job, std::uint32_t map_base, std::uint32_t map_words, std::uint32_t border) {
  set(regs.mode, static_cast<unsigned>(job.mode) | job.bilinear << 2 | job.grid_log2 << 8 | job.pieces << 16 |
                     job.piece_log2 << 24);
  set(regs.size, job.pairs | job.rows << 16);
  set(regs.src_base, job.src_base * 4);
  set(regs.src_pitch, job.src_pitch * 4);
  set(regs.src_size, job.src_width | job.src_height << 16);
  set(regs.dst_base, job.dst_base * 4);
  set(regs.dst_pitch, job.dst_pitch * 4);
  set(regs.map_base, map_base);
  set(regs.map_words, map_words);
  set(regs.border, border);
  set(regs.radius_limit, job.radius_limit);
  set(regs.centre_x, static_cast<std::uint32_t>(job.centre_x));
  set(regs.centre_y, static_cast<std::uint32_t>(job.centre_y));
  const Reg* const forms[] = {&regs.a0, &regs.a1, &regs.a2, &regs.b0, &regs.b1, &regs.b2, &regs.c0, &regs.c1, &regs.c2};
  for (unsigned n = 0; n < 9; ++n)
    set(*forms[n], static_cast<std::uint32_t>((n < 3 ? job.a : n < 6 ? job.b : job.c)[n % 3]));
}

void ModelBench::issue(const Burst& burst, Picoseconds at) {
  if (at % kPeriod || at < now_ || (!asked.empty() && at < asked.back().at))
    throw std::runtime_error("a request at a wrong time");
  asked.push_back({burst.write, burst.id, burst.address, burst.bytes, at});
  const std::uint64_t due = at / kPeriod + std::max(memory.latency, 1u);
  Pending p{burst, {}, 0, 0, false};
  const auto& fault = burst.write ? memory.write_fault : memory.read_fault;
  const std::uint32_t first = burst.address / 4 - kBase / 4;
  const bool outside = first >= words_.size() || words_.size() - first < burst.bytes / 4;
  p.fault = outside || (fault && *fault / 64 == burst.address / 64);
  std::uint32_t* const words = p.fault ? nullptr : &words_[first];
  if (burst.write) {
    p.first = p.last = write_free_ = std::max(due, write_free_ + 1);
    if (words) std::memcpy(words, burst.data.data(), burst.bytes);
    writes_.push_back(p);
    return;
  }
  p.first = std::max(due, read_free_ + 1);
  p.last = read_free_ = p.first + burst.bytes / 8 - 1;
  if (words) std::memcpy(p.data.data(), words, burst.bytes);
  reads_.push_back(p);
}

/// Answers are told as late as allowed: just before the clock of their first beat.
void ModelBench::go_until(Picoseconds limit) {
  for (;;) {
    Picoseconds t = call_;
    for (const auto* queue : {&reads_, &writes_})
      if (!queue->empty()) t = std::min(t, queue->front().first * kPeriod - 1);
    if (t == kNever || t > limit) break;
    now_ = std::max(now_, t);
    for (auto* queue : {&reads_, &writes_})
      while (!queue->empty() && queue->front().first * kPeriod - 1 <= now_) {
        const Pending p = queue->front();
        queue->pop_front();
        backend.answer({p.burst.tag,
                        p.burst.write,
                        p.fault,
                        {p.data.data(), p.burst.write ? 0 : p.burst.bytes},
                        p.first * kPeriod - 1,
                        p.last * kPeriod - 1});
      }
    call_ = backend.run(now_);
    ++calls;
  }
}

void ModelBench::advance(std::uint64_t clocks) {
  const Picoseconds limit = now_ + clocks * kPeriod;
  go_until(limit);
  now_ = limit;
  call_ = backend.run(now_);
}

void ModelBench::finish() {
  go_until(kNever - 1);
  if (backend.busy()) throw std::runtime_error("the engine stands still");
}

std::uint32_t ModelBench::run(const rtl::Job& job, std::uint32_t map_base, std::uint32_t border, Memory how,
                              std::optional<unsigned> abort_after) {
  memory = how;
  asked.clear();
  calls = 0;
  window(job, map_base, static_cast<std::uint32_t>(rtl::map_words(job)), border);
  set(regs.ctrl, 1);
  set(regs.submit, 0x5A);
  if (abort_after) {
    advance(*abort_after);
    set(regs.ctrl, 3);
  }
  finish();
  advance(1);
  if (!reads_.empty() || !writes_.empty()) throw std::runtime_error("something is under way after the end of a job");
  return get(regs.ended) >> 8 & 0xFF;
}

}  // namespace fovea::engine
