// What the core counts. Every cycle has one cause.
#pragma once
#include <array>
#include <cstdint>

#include "model/common/stats.h"

namespace fovea::cpu {

enum class Cause : std::uint8_t {
  kInterlock, kIcache, kDcache, kWriteBuffer, kUncached, kTlb, kTcm, kCacheOp, kDrain, kBusSync,
  kCount
};
inline constexpr std::size_t kCauses = static_cast<std::size_t>(Cause::kCount);

/// Plain numbers, counted since reset; the window is a difference of two copies.
struct Counts {
  std::uint64_t instructions = 0, cycles = 0, issue = 0, idle = 0;
  std::array<std::uint64_t, kCauses> stall{};
  std::uint64_t icache_accesses = 0, icache_fills = 0;
  std::uint64_t dcache_reads = 0, dcache_read_fills = 0, dcache_writes = 0,
                dcache_write_misses = 0, dcache_writebacks = 0;
  std::uint64_t exceptions = 0, unpredictable = 0;
};

/// The window's figures under their public names.
struct CoreStats : StatGroup {
  Counts from, to;
  using V = StatBase::Value;
  template <class F>
  struct Delta : Formula {
    Delta(CoreStats& g, const char* name, const char* unit, const char* sentence, F f)
        : Formula(g, name, unit, sentence, [&g, f] { return V(f(g.to) - f(g.from)); }) {}
  };
#define FOVEA_CPU_STAT(member, name, unit, field, sentence)                              \
  Formula member {                                                                       \
    *this, name, unit, sentence, [this] { return V(to.field - from.field); }             \
  }
  FOVEA_CPU_STAT(instructions, "instructions", "1", instructions, "instructions executed");
  FOVEA_CPU_STAT(cycles, "cycles", "cycles", cycles, "core clocks of the window");
  FOVEA_CPU_STAT(issue, "issue", "cycles", issue, "clocks in which instructions issue");
  FOVEA_CPU_STAT(idle, "idle", "cycles", idle, "clocks in wait-for-interrupt");
  FOVEA_CPU_STAT(interlock, "stall.interlock", "cycles", stall[0], "waiting for a register");
  FOVEA_CPU_STAT(icache, "stall.icache", "cycles", stall[1], "waiting for instructions");
  FOVEA_CPU_STAT(dcache, "stall.dcache", "cycles", stall[2], "waiting for data line fills");
  FOVEA_CPU_STAT(write_buffer, "stall.write_buffer", "cycles", stall[3],
                 "waiting for room in the write or victim buffer");
  FOVEA_CPU_STAT(uncached, "stall.uncached", "cycles", stall[4],
                 "waiting for uncached reads and unbuffered writes");
  FOVEA_CPU_STAT(tlb, "stall.tlb", "cycles", stall[5], "waiting for page walks");
  FOVEA_CPU_STAT(tcm, "stall.tcm", "cycles", stall[6], "wait states of internal RAM");
  FOVEA_CPU_STAT(cache_op, "stall.cache_op", "cycles", stall[7], "cache maintenance");
  FOVEA_CPU_STAT(drain, "stall.drain", "cycles", stall[8], "draining the write buffer");
  FOVEA_CPU_STAT(bus_sync, "stall.bus_sync", "cycles", stall[9], "waiting for an AHB clock edge");
  FOVEA_CPU_STAT(icache_accesses, "icache.accesses", "1", icache_accesses,
                 "look-ups of the I-cache: by line, by branch, and by a word decoded first");
  FOVEA_CPU_STAT(icache_fills, "icache.line_fills", "1", icache_fills, "lines read");
  FOVEA_CPU_STAT(dcache_reads, "dcache.reads", "1", dcache_reads, "cacheable loads looked up");
  FOVEA_CPU_STAT(dcache_fills, "dcache.read_line_fills", "1", dcache_read_fills, "lines read");
  FOVEA_CPU_STAT(dcache_writes, "dcache.writes", "1", dcache_writes, "cacheable stores looked up");
  FOVEA_CPU_STAT(dcache_write_misses, "dcache.write_misses", "1", dcache_write_misses,
                 "cacheable stores that missed");
  FOVEA_CPU_STAT(dcache_writebacks, "dcache.writebacks", "1", dcache_writebacks,
                 "dirty half or whole lines written back");
  FOVEA_CPU_STAT(exceptions, "exceptions", "1", exceptions, "exceptions taken");
  FOVEA_CPU_STAT(unpredictable, "unpredictable", "1", unpredictable,
                 "instructions with an UNPREDICTABLE encoding");
#undef FOVEA_CPU_STAT
  CoreStats() : StatGroup("cpu") {}
};

}  // namespace fovea::cpu
