#include "tb/sync/traffic.h"

#include <algorithm>
#include <cstdio>

#include "tb/sync/edma_block.h"
#include "tb/sync/flat_ram.h"
#include "tb/sync/memory_system.h"

namespace fovea::sync {
namespace {

std::uint64_t hash(const std::uint8_t* p, std::size_t n) {
  std::uint64_t h = 0xcbf29ce484222325ull;
  for (std::size_t i = 0; i < n; ++i) h = (h ^ p[i]) * 0x100000001b3ull;
  return h;
}

std::string text(const char* format, auto... values) {
  char buffer[200];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

constexpr std::uint32_t kRegs = 0x01C0'0000;
constexpr std::uint32_t kDdr = 0x8000'0000;
constexpr std::uint32_t kRam = 0x1'0000, kRamBytes = 0x4000;
constexpr Picoseconds kMeeting = 64 * kPsPerNs;  // timers and masters meet at multiples of it
constexpr Picoseconds kSlot = 60 * kPsPerUs;  // time set aside for one program

}  // namespace

std::string Log::sorted() const {
  auto lines = lines_;
  std::sort(lines.begin(), lines.end());
  std::string out;
  for (const auto& l : lines) out += l + "\n";
  return out;
}

TestBlock::TestBlock(sc_core::sc_module_name name, Log& log) : BusTarget(name, regs), log_(log) {
  SC_HAS_PROCESS(TestBlock);
  SC_METHOD(expire);
  sensitive << due_.event();
  dont_initialize();
  regs.timer.on_write([this](std::uint32_t ns) {
    Picoseconds delay = (ns & 0xFFF) * kPsPerNs + 1;
    if (ns & 1) delay += kMeeting - 1 - (kernel_time() + delay - 1) % kMeeting;
    due_.move_to(kernel_time() + delay);
  });
  regs.copy.on_write([this](std::uint32_t address) {
    if (dma.can_issue()) dma.read(address & ~63u, 64, address & ~63u);
  });
  regs.priority.on_write([this](std::uint32_t w) {
    priority[(w >> 8) % kMasterCount].write(w & 7);
  });
  regs.stream.on_write([this](std::uint32_t address) {
    if (stream_left_ > 0 || stream.outstanding() > 0) return;
    stream_left_ = 12;
    stream_address_ = address & ~63u;
    stream_no_side_effects_ = (address & 64u) != 0;
    stream_start_ = kernel_time();
    move_stream();
  });
  regs.transfer.on_write([this](std::uint32_t random) { on_transfer(random); });
  stream.on_done = [this](const BurstMaster::Completion& c) {
    log_.add(text("%015llu stream %s %08x %llu %016llx", static_cast<unsigned long long>(c.last),
                  c.write ? "w" : "r", c.address, static_cast<unsigned long long>(c.issued),
                  static_cast<unsigned long long>(hash(c.data.data(), c.data.size()))));
    if (c.tag == 0 && !stream_no_side_effects_) stream_end_.at(c.last);
    move_stream();
  };
  SC_METHOD(raise);
  sensitive << stream_end_.event();
  dont_initialize();
  dma.on_done = [this](const BurstMaster::Completion& c) {
    log_.add(text("%015llu dma %s %08x %016llx", static_cast<unsigned long long>(c.last),
                  c.write ? "w" : "r", c.address,
                  static_cast<unsigned long long>(hash(c.data.data(), c.data.size()))));
    if (!c.write)
      dma.write(c.address + 4096, c.data);
    else
      raise();
  };
}

/// Bursts follow each other's last beats; every third waits for a time of its own, as captured data
/// wait for their last byte.
void TestBlock::move_stream() {
  static constexpr std::array<std::uint8_t, 64> kData{1, 2, 3};
  while (stream_left_ > 0) {
    const Picoseconds place = stream.free_from();
    if (place == kNever) return;
    const unsigned n = --stream_left_;
    Picoseconds at = std::max(stream_start_, place);
    if (n % 3 == 0) at = std::max(at, stream_start_ + (12 - n) * 150 * kPsPerNs);
    const std::uint32_t address = stream_address_ + n * 64;
    if (n % 2)
      stream.write(address, kData, n, at, stream_no_side_effects_);
    else
      stream.read(address, 64, n, at, stream_no_side_effects_);
  }
}

void TestBlock::expire() {
  regs.count.set(regs.count.get() + 1);
  raise();
}

void TestBlock::raise() {
  const Picoseconds now = kernel_time();
  if (irq_at != now) irq_before = irq_at;
  irq_at = now;
  log_.add(text("%015llu irq", static_cast<unsigned long long>(now)));
}

TrafficMaster::TrafficMaster(sc_core::sc_module_name name, unsigned number, unsigned ports,
                             Log& log, TestBlock& block)
    : LookaheadInitiator(name, ports), number_(number), ports_(ports), log_(log), block_(block) {
  SC_HAS_PROCESS(TrafficMaster);
  SC_THREAD(run);
}

void TrafficMaster::run() {
  enter();
  for (const Program& p : programs) {
    sleep_until(p.start);
    execute(p);
  }
  finished = true;
  leave();
}

void TrafficMaster::retire(Op& op, std::uint64_t seed, Picoseconds& now) {
  finish(op.tx);
  now = std::max(now, op.tx.last);
  op.used = false;
  log_.add(text("%015llu seed %llu master %u op %u %s%s %08x first %llu data %016llx",
                static_cast<unsigned long long>(op.tx.last),
                static_cast<unsigned long long>(seed), number_, op.serial,
                op.tx.write ? "w" : "r", op.tx.error ? "!" : "", op.tx.address,
                static_cast<unsigned long long>(op.tx.first),
                static_cast<unsigned long long>(hash(op.data.data(), op.tx.bytes))));
}

void TrafficMaster::execute(const Program& p) {
  Rng rng(p.seed * 16 + number_);
  Picoseconds now = p.start;
  const Picoseconds end = p.start + kSlot - 10 * kPsPerUs;
  const unsigned window = 1 + static_cast<unsigned>(rng.below(kSlots));
  Picoseconds seen_irq = p.start;
  for (unsigned i = 0; i < p.operations && now < end; ++i) {
    // Gaps: often none, so that masters meet at equal times; sometimes a clock, or longer than a
    // register access and what follows from it take.
    switch (rng.below(7)) {
      case 0: break;
      case 1: break;
      case 2: now += 8230; break;
      case 3: now += rng.below(p.seed % 2 ? 50 : 3000) * kPsPerNs; break;
      case 4: now += 1; break;
      case 5: now += kMeeting - now % kMeeting + 1; break;
      default: now += (now % 8230 == 0) ? 0 : 8230 - now % 8230; break;
    }
    // An interrupt is seen strictly after its time, and changes what comes next. So everything before
    // `now` must have happened: it may be the horizon itself, but not beyond.
    if (now > horizon()) sleep_until(now);
    const Picoseconds irq = block_.irq_at < now ? block_.irq_at : block_.irq_before;
    if (irq > seen_irq && irq < now) {
      seen_irq = irq;
      log_.add(text("%015llu seed %llu master %u takes irq of %llu",
                    static_cast<unsigned long long>(now), static_cast<unsigned long long>(p.seed),
                    number_, static_cast<unsigned long long>(irq)));
      now += 100 * kPsPerNs;
    }
    unsigned busy = 0;
    for (Op& o : ops_) busy += o.used;
    while (busy >= window) {
      Op* oldest = nullptr;
      for (Op& o : ops_)
        if (o.used && (!oldest || o.serial < oldest->serial)) oldest = &o;
      retire(*oldest, p.seed, now);
      --busy;
    }
    Op* op = nullptr;
    for (Op& o : ops_)
      if (!o.used) { op = &o; break; }
    op->used = true;
    op->serial = i;
    op->tx.port = static_cast<unsigned>(rng.below(ports_));
    const bool reg = rng.below(12) == 0;
    unsigned bytes = 4;
    std::uint32_t address;
    if (reg) {
      address = kRegs + 4 * static_cast<std::uint32_t>(rng.below(6));
      op->tx.write = rng.below(3) != 0;
    } else {
      bytes = 4u << rng.below(5);
      // A few rows in a few banks, shared by all masters: hits, conflicts and true sharing.
      address = kDdr + static_cast<std::uint32_t>(rng.below(3)) * 0x4000 +
                static_cast<std::uint32_t>(rng.below(3)) * 0x800 +
                static_cast<std::uint32_t>(rng.below(512 / bytes)) * bytes;
      op->tx.write = rng.below(2) != 0;
    }
    for (unsigned k = 0; k < bytes; ++k) op->data[k] = static_cast<std::uint8_t>(rng.next());
    if (reg && (address == kRegs + 4 || address == kRegs + 16)) {
      // COPY and STREAM want an address inside the SDRAM.
      const std::uint32_t target = kDdr + static_cast<std::uint32_t>(rng.below(8)) * 64;
      std::memcpy(op->data.data(), &target, 4);
    }
    op->tx.address = address;
    op->tx.data = op->data.data();
    op->tx.bytes = static_cast<std::uint8_t>(bytes);
    op->tx.critical = 0;
    submit(op->tx, now);
    if (rng.below(4) == 0) {
      // A look without waiting, as the core does with its write buffer. A transaction whose outcome
      // is known may be taken back now; one that is not stays out.
      const Picoseconds until = now + rng.below(200) * kPsPerNs;
      const bool done = poll(op->tx, until);
      log_.add(text("%015llu seed %llu master %u op %u poll %d",
                    static_cast<unsigned long long>(until),
                    static_cast<unsigned long long>(p.seed), number_, i, done ? 1 : 0));
      now = until;
    }
  }
  for (Op& o : ops_)
    if (o.used) retire(o, p.seed, now);
}

Outcome run_programs(std::uint64_t first_seed, unsigned programs, bool strict) {
  Log log;
  EndOfInstant end_of_instant("end_of_instant");
  bus::CrossbarParams xp;
  bus::ConfigBusParams cp;
  mem::DdrParams dp;
  dp.check.set("commands");
  bus::AddressMap map;
  map.ram_size = kRamBytes;
  bus::Scr scr("scr", xp, dp, map, strict);
  using Speed = bus::ConfigBus::Speed;
  bus::ConfigBus config("config", cp, end_of_instant,
                        {{"block", kRegs, 0x1000, Speed::kFast},
                         {"ddr", 0x2000'0000, 0x8000, Speed::kFast},
                         {"edma", EdmaBlock::kBase, 0x8000, Speed::kFast},
                         {"edma_tc2", EdmaBlock::kTcBase, EdmaBlock::kTcPitch, Speed::kFast},
                         {"edma_tc3", EdmaBlock::kTcBase + EdmaBlock::kTcPitch, EdmaBlock::kTcPitch, Speed::kFast}});
  mem::DdrModule ddr("ddr", dp, scr.memory());
  TestBlock block("block", log);
  ClockSignal ddr_clk{"ddr_clk", Frequency(243'000'000)};
  ClockSignal scr_clk{"scr_clk", Frequency(121'500'000)};
  sc_core::sc_signal<bool> on{"on", true};
  scr.clk(scr_clk);
  scr.config_socket.bind(config.socket);
  ddr.ddr_clk(ddr_clk);
  ddr.scr_clk(scr_clk);
  ddr.enabled(on);
  config.to("block").bind(block.reg_socket);
  config.to("ddr").bind(ddr.reg_socket);
  for (std::size_t i = 0; i < kMasterCount; ++i) scr.priority[i](block.priority[i]);
  block.dma.socket.bind(*scr.target[index(Master::kEdmaTc0Read)]);
  block.stream.socket.bind(*scr.target[index(Master::kLoad)]);

  EdmaBlock edma(scr, config, scr_clk, on);
  FlatRam ram("ram", kRamBytes, end_of_instant);
  scr.ram_socket.bind(ram.socket);
  edma.on_interrupt = [&block] { block.raise(); };
  block.on_transfer = [&edma](std::uint32_t random) { edma.start(kDdr, kRam, random); };
  for (unsigned n = 0; n < edma.tcs.size(); ++n) {
    const auto note = [&log, n](const char* what) {
      return [&log, n, what](const TransferRequest& r, Picoseconds at) {
        log.add(text("%015llu tc%u %s %08x to %08x", static_cast<unsigned long long>(at), n + 2, what,
                     r.source.address, r.destination.address));
      };
    };
    edma.tcs[n]->on_request = note("begins");
    edma.tcs[n]->on_ended = note("ends");
  }

  // Six masters on the remaining ports; the first has two ports, as the core does.
  std::vector<std::unique_ptr<TrafficMaster>> masters;
  const std::vector<std::vector<Master>> ports = {
      {Master::kArmI, Master::kArmD}, {Master::kEdmaTc1Read}, {Master::kEdmaTc1Write},
      {Master::kVpfe}, {Master::kVpbe}, {Master::kRemapEngine}};
  for (unsigned i = 0; i < ports.size(); ++i) {
    masters.push_back(std::make_unique<TrafficMaster>(
        ("master" + std::to_string(i)).c_str(), i, static_cast<unsigned>(ports[i].size()), log,
        block));
    masters[i]->path(scr.path);
    for (unsigned k = 0; k < ports[i].size(); ++k)
      masters[i]->sockets[k]->bind(*scr.target[index(ports[i][k])]);
  }
  Picoseconds start = kPsPerUs;
  for (unsigned n = 0; n < programs; ++n, start += kSlot) {
    Rng rng(first_seed + n);
    const unsigned count = 2 + static_cast<unsigned>(rng.below(5));
    const unsigned operations = 10 + static_cast<unsigned>(rng.below(50));
    for (unsigned i = 0; i < count; ++i)
      masters[i]->programs.push_back({first_seed + n, start, operations});
  }
  start_sdram(ddr);
  sc_core::sc_start(ps_time(start + kSlot));
  scr.settle();
  for (auto& m : masters)
    if (!m->finished) log.add("a master did not finish");
  for (auto* s : ddr.controller().stats.stats()) {
    const StatBase::Value value = s->value();
    if (const auto* count = std::get_if<std::uint64_t>(&value))
      log.add(text("stat %s %llu", s->name().c_str(), static_cast<unsigned long long>(*count)));
    else
      log.add(text("stat %s %a", s->name().c_str(), std::get<double>(value)));
  }
  log.add(text("memory %016llx", static_cast<unsigned long long>(hash(ddr.store().at(0), 0x20000))));
  log.add(text("ram %016llx", static_cast<unsigned long long>(hash(ram.bytes.data(), ram.bytes.size()))));
  return {log.sorted(), scr.memory().decided_ahead(), scr.memory().decided_at_present()};
}

}  // namespace fovea::sync
