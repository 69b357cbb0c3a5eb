#include "model/engine/rtl/rtl_backend.h"

#include <array>
#include <optional>
#include <stdexcept>

#include "Vremap_top.h"
#include "model/common/check.h"
#include "model/engine/core/engine_offsets.h"
#include "model/engine/rtl/axi_checker.h"
#include "model/engine/rtl/axi_lite.h"
#include "model/engine/rtl/axi_memory.h"
#include "model/engine/rtl/slave_checker.h"
#include "model/engine/rtl/wave_file.h"

namespace fovea::rtl {
namespace {

using engine::Burst;

/// Bursts of the map, lines of the source; writes (rtl/README.md).
constexpr unsigned kReads = 4 + 8, kWrites = AxiMemory::kWrites;
static_assert(kReads + kWrites == engine::kSlots);
/// The owner of the backend holds back what its port does not take. More than there can be: a request for each
/// run of words of each write.
constexpr unsigned kNoLimit = kReads + 8 * kWrites;

struct Checkers {
  AxiChecker master{kReads, kWrites};
  AxiAnswerChecker answers;
  RegisterPortChecker registers;
};

}  // namespace

struct RtlBackend::State {
  State(Host& h, const Clock& c, const Options& o)
      : host(h), clock(c), options(o), context(started(o)), top(context.get(), "remap_top"),
        memory(kNoLimit, [this](const AxiMemory::Burst& b, Picoseconds at) {
          host.issue({b.tag, b.write, b.id, b.address, b.bytes, b.data}, at);
        }) {
    if (!o.waves.file.empty()) waves.emplace(o.waves, top);
    reset();
  }
  ~State() { top.final(); }

  static std::unique_ptr<VerilatedContext> started(const Options& o) {
    auto c = std::make_unique<VerilatedContext>();
    c->randReset(o.random_start ? 2 : 0);
    if (o.random_start) c->randSeed(static_cast<int>(o.random_start));
    c->traceEverOn(!o.waves.file.empty());
    return c;
  }

  void reset();
  void edge(Picoseconds at);
  void drive(Picoseconds at);
  void sample(Picoseconds at);
  void next_edge() { edge(clock.next_edge_after(done)); }
  bool busy() const { return top.busy_o || !lite.idle() || !memory.idle(); }
  WaveFile::Events events() const;
  void finish_access();
  void defect(const std::string& what) {
    if (options.on_defect) {
      options.on_defect(what);
      return;
    }
    if (waves) waves->close();  // the process ends without destructors
    FOVEA_CHECK(false, what);
  }

  Host& host;
  const Clock& clock;
  const Options options;
  std::unique_ptr<VerilatedContext> context;
  Vremap_top top;
  AxiMemory memory;
  AxiLite lite;
  AxiWires axi;
  LiteWires registers;
  Checkers check;
  std::optional<WaveFile> waves;
  Picoseconds done = 0;       // no edge up to here is left to do
  bool level = false;         // of the interrupt, as the host knows it
  std::uint64_t clocks = 0;
};

/// Takes no time. Two edges with rst_ni low, as a chip would see them.
void RtlBackend::State::reset() {
  memory.reset();
  lite.reset();
  check = Checkers{};
  axi = {};
  registers = {};
  const auto quiet = [this] {
    top.s_aw_valid_i = top.s_w_valid_i = top.s_ar_valid_i = top.r_valid_i = top.b_valid_i = 0;
    top.s_b_ready_i = top.s_r_ready_i = 1;
    top.ar_ready_i = top.aw_ready_i = top.w_ready_i = 0;
  };
  quiet();
  top.rst_ni = 0;
  for (unsigned n = 0; n < 4; ++n) {
    top.clk_i = n % 2;
    top.eval();
  }
  top.rst_ni = 1;
  top.clk_i = 0;
  top.eval();
  if (level) host.interrupt(level = false);
}

void RtlBackend::State::drive(Picoseconds at) {
  memory.drive(at, axi);
  lite.drive(registers);
  top.ar_ready_i = axi.ar.ready;
  top.aw_ready_i = axi.aw.ready;
  top.w_ready_i = axi.w.ready;
  top.r_valid_i = axi.r.valid;
  top.r_id_i = static_cast<CData>(axi.r.id);
  top.r_data_i = axi.r.data;
  top.r_resp_i = static_cast<CData>(axi.r.response);
  top.b_valid_i = axi.b.valid;
  top.b_resp_i = static_cast<CData>(axi.b.response);
  top.s_aw_valid_i = registers.aw.valid;
  top.s_aw_addr_i = static_cast<SData>(registers.aw.address);
  top.s_w_valid_i = registers.w.valid;
  top.s_w_data_i = registers.w.data;
  top.s_w_strb_i = static_cast<CData>(registers.w.strobes);
  top.s_b_ready_i = registers.b.ready;
  top.s_ar_valid_i = registers.ar.valid;
  top.s_ar_addr_i = static_cast<SData>(registers.ar.address);
  top.s_r_ready_i = registers.r.ready;
}

void RtlBackend::State::sample(Picoseconds at) {
  axi.ar = {top.ar_valid_o != 0, axi.ar.ready, top.ar_id_o, top.ar_addr_o, top.ar_len_o};
  axi.aw = {top.aw_valid_o != 0, axi.aw.ready, 0, top.aw_addr_o, top.aw_len_o};
  axi.w = {top.w_valid_o != 0, axi.w.ready, top.w_last_o != 0, top.w_data_o, top.w_strb_o};
  axi.r.ready = top.r_ready_o;
  axi.b.ready = top.b_ready_o;
  registers.aw.ready = top.s_aw_ready_o;
  registers.w.ready = top.s_w_ready_o;
  registers.b.valid = top.s_b_valid_o;
  registers.b.response = top.s_b_resp_o;
  registers.ar.ready = top.s_ar_ready_o;
  registers.r.valid = top.s_r_valid_o;
  registers.r.data = top.s_r_data_o;
  registers.r.response = top.s_r_resp_o;
  try {
    AxiClock c{axi.ar, axi.aw, axi.w};
    c.r_last = axi.r.valid && axi.r.ready && axi.r.last;
    c.b = axi.b.valid && axi.b.ready;
    check.answers.clock(axi);
    check.master.clock(c);
    check.registers.clock(registers);
  } catch (const std::runtime_error& broken) {
    defect(std::string("remap engine in RTL: ") + broken.what());
  }
  memory.sample(at, axi);
  lite.sample(registers);
}

void RtlBackend::State::edge(Picoseconds at) {
  drive(at);
  top.clk_i = 0;
  top.eval();
  if (waves) waves->low(at);
  sample(at);
  top.clk_i = 1;
  top.eval();
  if (waves) waves->high(at, events());
  done = at;
  ++clocks;
  if (level != (top.irq_o != 0)) host.interrupt(level = !level);
}

/// What the waveforms may wait for.
WaveFile::Events RtlBackend::State::events() const {
  WaveFile::Events e;
  e.job = registers.aw.valid && registers.aw.ready && registers.aw.address == engine::at::kSubmit;
  e.interrupt = top.irq_o && !level;
  e.error = (axi.r.valid && axi.r.response & 2u) || (axi.b.valid && axi.b.response & 2u);
  return e;
}

/// An access begins when the one before has ended.
void RtlBackend::State::finish_access() {
  for (unsigned most = 16; !lite.idle(); --most) {
    if (most == 0) return defect("remap engine in RTL: a register does not answer");
    next_edge();
  }
  if (lite.error()) defect("remap engine in RTL: a register answers with an error");
}

RtlBackend::RtlBackend(Host& host, const Clock& clock, const Options& options)
    : s_(std::make_unique<State>(host, clock, options)) {}
RtlBackend::~RtlBackend() = default;

Picoseconds RtlBackend::run(Picoseconds now) {
  State& s = *s_;
  while (s.clock.running() && s.busy()) {
    const Picoseconds at = s.clock.next_edge_after(s.done);
    if (at > now) return at;
    s.edge(at);
  }
  s.done = std::max(s.done, now);
  return kNever;
}

std::uint32_t RtlBackend::read(std::uint32_t offset, Picoseconds now) {
  State& s = *s_;
  s.done = std::max(s.done, now);
  s.finish_access();
  s.lite.read(offset);
  s.next_edge();
  // The answer stands on the wires; it is taken at the edge after, in its own time.
  if (!s.top.s_r_valid_o || s.top.s_r_resp_o & 2) s.defect("remap engine in RTL: a register cannot be read");
  return s.top.s_r_data_o;
}

void RtlBackend::write(std::uint32_t offset, std::uint32_t word, unsigned strobes, Picoseconds now) {
  State& s = *s_;
  s.done = std::max(s.done, now);
  s.finish_access();
  s.lite.write(offset, word, strobes);
}

void RtlBackend::answer(const engine::Answer& a) {
  s_->memory.answered(a.tag, a.error, a.data, a.first, a.last);
}

bool RtlBackend::busy() const { return s_->busy(); }
void RtlBackend::reset() { s_->reset(); }
std::uint64_t RtlBackend::clocks() const { return s_->clocks; }
void RtlBackend::finish() {
  if (s_->waves) s_->waves->close();
}
void RtlBackend::finish_at(Picoseconds at) {
  if (s_->waves) s_->waves->close_at(at);
}

}  // namespace fovea::rtl
