// What the caches of an ARM926EJ-S do with a stream of accesses, written from the manual and
// independent of the core's code: no time, no packed tags, no hints.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fovea::cpu::test {

/// An AHB transaction caused by the state of the caches.
struct Transfer {
  std::uint32_t address = 0;  ///< physical; of a line fill: the requested word
  std::vector<std::uint8_t> data;
  bool operator==(const Transfer&) const = default;
};

/// Transactions in the order in which they leave their part of the core. The order between the
/// lists depends on timing.
struct Traffic {
  std::vector<Transfer> instruction_fills, data_fills, reads, unbuffered;
  std::vector<Transfer> write_backs;  ///< of half or whole lines, through the victim buffer
  std::vector<Transfer> buffered;     ///< through the main write buffer
};

/// Counters of the core that have the same meaning.
struct CacheCounts {
  std::uint64_t icache_fills = 0, dcache_reads = 0, dcache_fills = 0, dcache_writes = 0,
                dcache_write_misses = 0, dcache_writebacks = 0;
};

/// One cache: four ways, 32-byte lines, virtual index and tag. Assumed, since the manual does not
/// say: the lowest invalid way is filled first; one round-robin counter serves all sets;
/// test-and-clean begins at the first set.
class OracleCache {
 public:
  struct Line {
    bool valid = false;
    std::uint32_t mva = 0, pa = 0;  ///< of the first byte
    bool dirty[2] = {false, false};
    std::array<std::uint8_t, 32> bytes{};
  };
  explicit OracleCache(unsigned bytes) : sets(bytes / 128) {}
  /// The line that holds an address, or nullptr.
  Line* find(std::uint32_t mva);
  Line& at(unsigned set, unsigned way) { return sets[set][way]; }
  /// The line to replace for an address.
  Line& victim(std::uint32_t mva);
  std::uint32_t locked = 0;  ///< one bit for each way
  unsigned next_way = 0;
  std::vector<std::array<Line, 4>> sets;
};

class CacheOracle {
 public:
  /// Errors that a test plants in the oracle, to check that they are found.
  enum class Fault { kNone, kVictimOneOff, kDirtyHalfLost, kInvalidateMissed, kWriteAllocates };
  struct Page {
    std::uint32_t pa = 0;
    bool cacheable = false, bufferable = false;
  };

  /// @param memory a copy of the whole memory, which begins at `base`
  /// @param pages translates an address
  CacheOracle(std::uint32_t base, std::vector<std::uint8_t> memory,
              std::function<Page(std::uint32_t)> pages, unsigned icache, unsigned dcache);

  Fault fault = Fault::kNone;
  std::uint32_t control = 0x0005'0078;  ///< CP15 c1
  std::uint32_t cache_debug = 0;        ///< CP15 c15: bit 2 forces write-through

  /// The aligned word at an address as an instruction fetch reads it.
  std::uint32_t fetch(std::uint32_t mva, bool thumb = false);
  /// The program does not continue after the last instruction.
  void flow_changes() { end_run(); }
  std::uint32_t load(std::uint32_t mva, unsigned bytes);
  /// A store of 1, 2 or 4 bytes, or consecutive words of an STM or STRD.
  void store(std::uint32_t mva, unsigned bytes, const std::vector<std::uint32_t>& values);
  void lock(bool instruction, std::uint32_t ways) {
    (instruction ? icache_ : dcache_).locked = ways & 15u;
  }
  /// MCR p15, 0, value, c7, crm, op2. @return false if there is no such operation
  bool operate(unsigned crm, unsigned op2, std::uint32_t value);
  /// MRC c7, c10 or c14, 3. @return true if no line was dirty
  bool test_and_clean(bool invalidate);

  const Traffic& traffic() const { return traffic_; }
  const CacheCounts& counts() const { return counts_; }
  std::uint64_t line_changes() const { return line_changes_; }
  /// Words requested from the I-cache: one for each ARM instruction and for two Thumb instructions.
  /// After each change of flow, two words that are not executed, or one and a half on average.
  std::uint64_t words() const { return words_ + half_words_ / 2; }
  std::uint64_t operations() const { return operations_; }
  const std::vector<std::uint8_t>& memory() const { return memory_; }
  OracleCache& dcache() { return dcache_; }

 private:
  void end_run();
  bool mmu() const { return control & 1u; }
  bool data_cached(const Page& p) const { return p.cacheable && (control & 5u) == 5u; }
  std::uint8_t* at(std::uint32_t pa) { return memory_.data() + (pa - base_); }
  std::vector<std::uint8_t> copy(std::uint32_t pa, unsigned n) { return {at(pa), at(pa) + n}; }
  OracleCache::Line& fill(OracleCache& cache, std::uint32_t mva, std::uint32_t pa);
  void clean(OracleCache::Line& line);
  void send(std::uint32_t pa, const std::vector<std::uint8_t>& bytes);

  std::uint32_t base_;
  std::vector<std::uint8_t> memory_;
  std::function<Page(std::uint32_t)> pages_;
  OracleCache icache_, dcache_;
  Traffic traffic_;
  CacheCounts counts_;
  std::uint64_t line_changes_ = 0, words_ = 0, half_words_ = 0, operations_ = 0,
                invalidates_ = 0;
  std::optional<std::uint32_t> fetch_line_;
  std::optional<std::uint32_t> run_end_;  ///< address after the last instruction fetched here
  bool run_cached_ = false, run_thumb_ = false;
};

/// @return a description of the first difference; empty if there is none. In what was observed,
/// `buffered` contains everything from both buffers, in the order of the bus.
std::string difference(const Traffic& expected, const Traffic& seen);

}  // namespace fovea::cpu::test
