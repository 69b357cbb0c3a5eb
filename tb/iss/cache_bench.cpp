#include "tb/iss/cache_bench.h"

#include <array>
#include <cstring>
#include <iostream>
#include <random>

#include "tb/iss/access_stream.h"

namespace fovea::cpu::test {
namespace {

/// Lets the buffers empty after the program's end.
void empty_buffers(NotingMachine& m) {
  while (m.core.next_act() != kNever) m.core.act();
}

/// Sections of the identity map and those that the test has set, as they lie in memory.
CacheOracle::Page page_of(NotingMachine& m, std::uint32_t a) {
  const std::uint32_t d = m.port.word(kTables + 4 * (a >> 20));
  return {(d & 0xFFF0'0000u) | (a & 0xF'FFFFu), (d >> 3 & 1u) != 0, (d >> 2 & 1u) != 0};
}

std::string compare_counts(const NotingMachine& m, const CacheOracle& o) {
  const Counts& is = m.core.counts();
  const CacheCounts& want = o.counts();
  const std::pair<const char*, std::array<std::uint64_t, 2>> rows[] = {
      {"icache.accesses", {o.words(), is.icache_accesses()}},
      {"icache.line_fills", {want.icache_fills, is.icache_fills}},
      {"dcache.reads", {want.dcache_reads, is.dcache_reads}},
      {"dcache.read_line_fills", {want.dcache_fills, is.dcache_read_fills}},
      {"dcache.writes", {want.dcache_writes, is.dcache_writes}},
      {"dcache.write_misses", {want.dcache_write_misses, is.dcache_write_misses}},
      {"dcache.writebacks", {want.dcache_writebacks, is.dcache_writebacks}}};
  for (const auto& [name, value] : rows)
    if (value[0] != value[1])
      return std::string(name) + ": expected " + std::to_string(value[0]) + ", is " +
             std::to_string(value[1]);
  return {};
}

std::string compare_contents(NotingMachine& m, CacheOracle& o) {
  if (std::memcmp(m.port.at(kMemory), o.memory().data(), o.memory().size()) != 0)
    return "memory differs at the end";
  for (const auto& set : o.dcache().sets)
    for (const auto& line : set)
      for (unsigned k = 0; line.valid && k < 32; ++k) {
        std::uint8_t byte = 0;
        if (!m.core.peek(line.mva + k, byte) || byte != line.bytes[k])
          return "a cached byte differs at the end, at " + std::to_string(line.mva + k);
      }
  return {};
}

/// What does not hang on the ways that were given up: accesses, and what a program can see in the
/// first two megabytes.
std::string compare_visible(NotingMachine& m, CacheOracle& o) {
  const Counts& is = m.core.counts();
  if (is.dcache_reads != o.counts().dcache_reads || is.dcache_writes != o.counts().dcache_writes)
    return "other numbers of loads or stores";
  for (std::uint32_t a = kMemory; a < kMemory + 0x20'0000; ++a) {
    const auto* line = o.dcache().find(a);
    const std::uint8_t want = line ? line->bytes[a % 32] : o.memory()[a - kMemory];
    std::uint8_t byte = 0;
    if (!m.core.peek(a, byte)) byte = *m.port.at(a);
    if (byte != want) return "a byte differs at the end, at " + std::to_string(a);
  }
  return {};
}

/// Who stops the core on its way changes nothing that it counts.
std::string compare_runs(const Counts& a, const Counts& b) {
  if (!(a == b))
    return "counters differ between a stepped and a free run";
  return {};
}
}  // namespace

Outcome compare(const std::function<std::unique_ptr<NotingMachine>()>& make,
                CacheOracle::Fault fault, bool victims) {
  Outcome out;
  const auto stepped = make();
  CacheOracle oracle(
      kMemory, {stepped->port.at(kMemory), stepped->port.at(kMemory) + kMemoryBytes},
      [&](std::uint32_t a) { return page_of(*stepped, a); }, 16384, 8192);
  oracle.fault = fault;
  AccessStream stream(stepped->core, stepped->tcm, oracle);
  stepped->port.at_boundary = [&] { stream.boundary(); };
  stepped->run();
  stream.check();
  const auto free = make(), uneven = make();
  free->run();
  std::mt19937 random(7);
  uneven->port.extra = [&random] { return Picoseconds{random() % 200'000}; };
  uneven->run();
  out.accesses = stream.accesses();
  out.line_changes = oracle.line_changes();
  out.operations = oracle.operations();
  out.counts = oracle.counts();
  out.difference = stream.complaint();
  if (out.difference.empty())
    out.difference = compare_runs(stepped->core.counts(), free->core.counts());
  for (NotingMachine* m : {stepped.get(), free.get(), uneven.get()}) {
    empty_buffers(*m);
    if (!out.difference.empty()) return out;
    if (victims) out.difference = difference(oracle.traffic(), m->port.seen);
    if (out.difference.empty())
      out.difference = victims ? compare_counts(*m, oracle) : compare_visible(*m, oracle);
    if (victims && out.difference.empty()) out.difference = compare_contents(*m, oracle);
  }
  return out;
}

void print(const std::string& name, const Outcome& o) {
  std::cout << name << ": " << o.accesses << " data accesses, " << o.line_changes
            << " line lookups, " << o.operations << " operations; " << o.counts.icache_fills
            << " + " << o.counts.dcache_fills << " fills, " << o.counts.dcache_writebacks
            << " write-backs\n";
}

}  // namespace fovea::cpu::test
