#include "tb/rtl/engine_bench.h"

#include "Vremap_top.h"
#include "tb/rtl/coverage.h"

namespace fovea::rtl {

EngineBench::EngineBench(std::size_t bytes, std::uint32_t seed)
    : dut_(std::make_unique<Vremap_top>()), random_(seed), words_(bytes / 4) {
  reset();
}

EngineBench::~EngineBench() { keep_coverage(); }

void EngineBench::reset(unsigned clocks) {
  Vremap_top& d = *dut_;
  d.rst_ni = 0;
  d.s_aw_valid_i = d.s_w_valid_i = d.s_ar_valid_i = d.r_valid_i = d.b_valid_i = 0;
  d.eval();
  if (d.ar_valid_o || d.aw_valid_o || d.w_valid_o || d.s_b_valid_o || d.s_r_valid_o || d.irq_o || d.busy_o)
    throw std::runtime_error("something is on offer in reset");
  reads_.clear();
  addresses_.clear();
  beats_.clear();
  answers_.clear();
  checker_ = AxiChecker{4 + 8, 4};
  port_checker_ = RegisterPortChecker{false};
  while (clocks-- > 0) tick();
  d.rst_ni = 1;
  tick();
}

void EngineBench::tick() {
  dut_->clk_i = 1;
  dut_->eval();
  dut_->clk_i = 0;
  dut_->eval();
  ++now_;
}

std::uint32_t& EngineBench::word(std::uint32_t word_address) {
  std::uint32_t at = word_address - kBase / 4;
  if (repeats) at = (at & 0x3FFF'FFFF) % words_.size();
  if (at >= words_.size()) throw std::runtime_error("an access beyond the memory");
  return words_[at];
}

void EngineBench::drive() {
  Vremap_top& d = *dut_;
  d.ar_ready_i = chance();
  d.aw_ready_i = chance() && now_ >= writes_from_;
  d.w_ready_i = chance() && now_ >= writes_from_;
  // The oldest read of one identifier or of the other; only beats of one identifier have to be in
  // order.
  d.r_valid_i = 0;
  if (!reads_.empty() && chance()) {
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
      d.r_resp_i = r.fault ? 2 + random_() % 2 : 0;  // SLVERR or DECERR
    }
  }
  d.b_valid_i = !answers_.empty() && answers_.front().due <= now_;
  d.b_resp_i = d.b_valid_i && answers_.front().fault ? 2 + random_() % 2 : 0;
  d.eval();
}

void EngineBench::sample() {
  Vremap_top& d = *dut_;
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
  LiteWires port;
  port.aw = {d.s_aw_valid_i != 0, d.s_aw_ready_o != 0, d.s_aw_addr_i};
  port.ar = {d.s_ar_valid_i != 0, d.s_ar_ready_o != 0, d.s_ar_addr_i};
  port.w = {d.s_w_valid_i != 0, d.s_w_ready_o != 0, d.s_w_data_i, d.s_w_strb_i, 0};
  port.r = {d.s_r_valid_o != 0, d.s_r_ready_i != 0, d.s_r_data_o, 0, d.s_r_resp_o};
  port.b = {d.s_b_valid_o != 0, d.s_b_ready_i != 0, d.s_b_resp_o};
  port_checker_.clock(port);
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

void EngineBench::clock() {
  drive();
  sample();
  tick();
}

RegisterAnswer EngineBench::access(std::optional<RegisterWrite> write,
                                   std::optional<unsigned> read) {
  Vremap_top& d = *dut_;
  RegisterAnswer answer;
  bool address = !write, data = !write, written = !write, asked = !read, had = !read;
  const auto soon = [this] { return random_() % 16 < bus_willing; };
  for (unsigned n = 0; !written || !had; ++n) {
    if (n == 10'000) throw std::runtime_error("the registers do not answer");
    if (!address && soon()) {
      d.s_aw_valid_i = 1;
      d.s_aw_addr_i = write->offset;
    }
    if (!data && soon()) {
      d.s_w_valid_i = 1;
      d.s_w_data_i = write->value;
      d.s_w_strb_i = write->strobes;
    }
    if (!asked && soon()) {
      d.s_ar_valid_i = 1;
      d.s_ar_addr_i = *read;
    }
    d.s_b_ready_i = !written && soon();
    d.s_r_ready_i = !had && soon();
    drive();
    const bool took_address = d.s_aw_valid_i && d.s_aw_ready_o,
               took_data = d.s_w_valid_i && d.s_w_ready_o,
               took_read = d.s_ar_valid_i && d.s_ar_ready_o;
    if (d.s_b_valid_o && d.s_b_ready_i) {
      written = true;
      answer.write_response = d.s_b_resp_o;
    }
    if (d.s_r_valid_o && d.s_r_ready_i) {
      had = true;
      answer.read_response = d.s_r_resp_o;
      answer.data = d.s_r_data_o;
    }
    sample();
    tick();
    if (took_address) address = true, d.s_aw_valid_i = 0;
    if (took_data) data = true, d.s_w_valid_i = 0;
    if (took_read) asked = true, d.s_ar_valid_i = 0;
  }
  d.s_b_ready_i = d.s_r_ready_i = 0;
  return answer;
}

std::array<RegisterAnswer, 2> EngineBench::read_two(unsigned first, unsigned second, unsigned hold) {
  Vremap_top& d = *dut_;
  std::array<RegisterAnswer, 2> answers;
  unsigned asked = 0, had = 0, held = 0;
  for (unsigned n = 0; had < 2; ++n) {
    if (n == 1'000 + hold) throw std::runtime_error("the registers do not answer");
    d.s_ar_valid_i = asked < 2;
    d.s_ar_addr_i = asked == 0 ? first : second;
    d.s_r_ready_i = had == 1 || held == hold;
    drive();
    const bool took = d.s_ar_valid_i && d.s_ar_ready_o;
    if (d.s_r_valid_o) {
      RegisterAnswer& answer = answers.at(had);
      if (had == 0 && held > 0 && (answer.data != d.s_r_data_o || answer.read_response != d.s_r_resp_o))
        throw std::runtime_error("an answer changed before it was taken");
      answer.data = d.s_r_data_o;
      answer.read_response = d.s_r_resp_o;
      had += d.s_r_ready_i != 0;
      held += d.s_r_ready_i == 0;
    }
    sample();
    tick();
    asked += took;
  }
  d.s_ar_valid_i = d.s_r_ready_i = 0;
  return answers;
}

std::array<RegisterAnswer, 2> EngineBench::write_two(const RegisterWrite& first, const RegisterWrite& second,
                                                     unsigned hold) {
  Vremap_top& d = *dut_;
  std::array<RegisterAnswer, 2> answers;
  unsigned sent = 0, had = 0, held = 0;
  for (unsigned n = 0; had < 2; ++n) {
    if (n == 1'000 + hold) throw std::runtime_error("the registers do not answer");
    const RegisterWrite& w = sent == 0 ? first : second;
    d.s_aw_valid_i = d.s_w_valid_i = sent < 2;
    d.s_aw_addr_i = w.offset;
    d.s_w_data_i = w.value;
    d.s_w_strb_i = w.strobes;
    d.s_b_ready_i = had == 1 || held == hold;
    drive();
    const bool took = d.s_aw_valid_i && d.s_aw_ready_o;
    if (took != (d.s_w_valid_i && d.s_w_ready_o)) throw std::runtime_error("an address is taken without its data");
    if (d.s_b_valid_o) {
      RegisterAnswer& answer = answers.at(had);
      if (had == 0 && held > 0 && answer.write_response != d.s_b_resp_o)
        throw std::runtime_error("an answer changed before it was taken");
      answer.write_response = d.s_b_resp_o;
      had += d.s_b_ready_i != 0;
      held += d.s_b_ready_i == 0;
    }
    sample();
    tick();
    sent += took;
  }
  d.s_aw_valid_i = d.s_w_valid_i = d.s_b_ready_i = 0;
  return answers;
}

void EngineBench::write(unsigned offset, std::uint32_t value, unsigned strobes) {
  if (access(RegisterWrite{offset, value, strobes}, {}).write_response != 0)
    throw std::runtime_error("a write to a register was answered with an error");
}

std::uint32_t EngineBench::read(unsigned offset) {
  const RegisterAnswer answer = access({}, offset);
  if (answer.read_response != 0)
    throw std::runtime_error("a read of a register was answered with an error");
  return answer.data;
}

void EngineBench::submit(const Job& job, std::uint32_t map_base, std::uint32_t border,
                         std::uint8_t tag) {
  const std::uint32_t window[] = {
      static_cast<unsigned>(job.mode) | (job.bilinear ? 4u : 0u) | job.grid_log2 << 8 |
          job.pieces << 16 | job.piece_log2 << 24,
      job.pairs | job.rows << 16,
      job.src_base * 4,
      job.src_pitch * 4,
      job.src_width | job.src_height << 16,
      job.dst_base * 4,
      job.dst_pitch * 4,
      map_base,
      static_cast<std::uint32_t>(map_words(job)) + more_map_words,
      border,
      job.radius_limit,
      static_cast<std::uint32_t>(job.centre_x),
      static_cast<std::uint32_t>(job.centre_y)};
  unsigned offset = Offset::kMode;
  for (const std::uint32_t value : window) {
    write(offset, value);
    offset += 4;
  }
  for (const auto* form : {&job.a, &job.b, &job.c})
    for (const std::int32_t coefficient : *form) {
      write(offset, static_cast<std::uint32_t>(coefficient));
      offset += 4;
    }
  write(Offset::kSubmit, tag);
}

bool EngineBench::interrupt() const { return dut_->irq_o != 0; }
bool EngineBench::busy() const { return dut_->busy_o != 0; }

void EngineBench::until_interrupt(std::uint64_t most_clocks) {
  for (const std::uint64_t begin = now_; !interrupt(); clock())
    if (now_ - begin > most_clocks) throw std::runtime_error("the engine stands still");
}

Result EngineBench::run(const Job& job, std::uint32_t map_base, std::uint32_t border, Memory how,
                        std::optional<unsigned> abort_after) {
  constexpr std::uint32_t kEnable = 1, kAbort = 2;
  result_ = {};
  reads_asked.clear();
  read_clocks.clear();
  writes_asked.clear();
  memory = {};
  write(Offset::kCtrl, kEnable);
  write(Offset::kEnables, 0x1F);
  memory = how;
  submit(job, map_base, border, static_cast<std::uint8_t>(random_()));
  writes_from_ = now_ + how.writes_from;
  if (abort_after) {
    for (unsigned n = 0; n < *abort_after; ++n) clock();
    write(Offset::kCtrl, kEnable | kAbort);
  }
  until_interrupt(200'000 + std::uint64_t{job.pairs} * job.rows * 200);
  if (!checker_.quiet()) throw std::runtime_error("something is under way after the end of a job");
  const std::uint32_t events = read(Offset::kEvents);
  if ((read(Offset::kEnded) >> 8 & 0xFF) != events)
    throw std::runtime_error("ENDED has other events than EVENTS");
  if (((events & 1) != 0) != ((events & 0x1E) == 0))
    throw std::runtime_error("a job ended as it should and otherwise, or neither");
  write(Offset::kEvents, events);
  result_.refused = events & 2;
  result_.read_error = events & 4;
  result_.write_error = events & 8;
  result_.aborted = events & 16;
  result_.clocks = read(Offset::kClocks);
  result_.lines = read(Offset::kLines);
  result_.writes = read(Offset::kWrites);
  result_.bad = read(Offset::kBad);
  return result_;
}

}  // namespace fovea::rtl
