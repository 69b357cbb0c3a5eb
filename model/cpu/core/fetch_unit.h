// The fetch unit: I-cache, line fills, fetches past the cache, and the decoded form of each line.
#pragma once
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "model/cpu/core/access_log.h"
#include "model/cpu/core/bus_interface.h"
#include "model/cpu/core/cache.h"
#include "model/cpu/core/clock_profile.h"
#include "model/cpu/core/data_bus.h"
#include "model/cpu/core/decoded_line.h"
#include "model/cpu/core/stall_ledger.h"
#include "model/cpu/core/system_registers.h"

namespace fovea::cpu {

/// An instruction's place: where the program wants it and how it is decoded.
struct FetchTarget {
  std::uint32_t pc = 0, mva = 0;
  bool thumb = false;
  unsigned shift() const { return thumb ? 1 : 2; }         // log2 of the instruction size
  unsigned index() const { return (mva & 31u) >> shift(); }  // in its line
};

class FetchUnit {
 public:
  struct Sizes {
    std::uint64_t cache_bytes;
    std::size_t ram_bytes;
    unsigned fill_latency;
    bool shifted_cycle;
  };
  FetchUnit(const Sizes& sizes, BusInterface& interface, StallLedger& ledger, DataBus& data_bus,
            AccessLog& log, const SystemRegisters& registers);
  FetchUnit(const FetchUnit&) = delete;
  FetchUnit& operator=(const FetchUnit&) = delete;

  // Settings in force for fetches. After a change of the process ID, or one that turns the MMU or
  // the I-cache on or off, two instructions are already in the pipeline.
  bool mmu_on() const { return control_ & kMmuOn; }
  bool cached() const { return control_ & kIcacheOn; }
  std::uint32_t modified(std::uint32_t va) const { return va < 0x0200'0000u ? va | process_ : va; }
  /// The old settings are still in force for some instructions.
  bool lagging() const { return lag_ != 0; }
  /// @param next_pc the first instruction after the change
  void settings_changed(std::uint32_t next_pc);
  /// To be called after an instruction while lagging(). @return true: the new settings are in force
  /// from now on, and what was remembered of fetches has to be forgotten
  bool instruction_done(std::uint32_t pc, bool thumb);
  void reset();

  /// The record at `pc` if it is in the current line and decoded; waits for its word of a fill.
  [[gnu::always_inline]] const Instruction* in_current_line(std::uint32_t pc, std::uint32_t cpsr) {
    if ((pc & ~31u) != line_va || (cpsr & 0x20u) != line_thumb) return nullptr;
    if (ledger_.cycle < fill.last && fill.line == (modified(pc) & ~31u)) [[unlikely]]
      ledger_.stall_to(fill.word(pc), Cause::kIcache, fill.pa, kService);
    const unsigned at = (pc & 31u) >> (line_thumb ? 1 : 2);
    const bool known = current->valid && current->records[at].body;
    return known ? &current->records[at] : nullptr;
  }
  /// Finds a line in the I-cache, or fills it, and waits for its word of a fill. @return index; -1 after a bus error
  int find_line(std::uint32_t mva, std::uint32_t pa);
  void fill_line(std::uint32_t mva, std::uint32_t pa);
  /// Reads the four words around `pa` past the cache, unless the last read has them and the program
  /// has come here without a change of flow. @return false after a bus error
  bool read_ahead(std::uint32_t pa);
  /// Decodes an instruction of a line and makes it the current line.
  /// @param ram the line is in internal RAM: others may write it, so its records must not rely on
  ///        each other
  const Instruction* decode(DecodedLine& d, const std::uint8_t* bytes, const FetchTarget& target,
                            bool ram);
  /// Decodes an instruction that read_ahead() has read.
  const Instruction* decode_uncached(std::uint32_t pa, const FetchTarget& target);

  /// Forgets under which addresses lines were found.
  void forget();
  /// A line of internal RAM may be found without a lookup.
  bool knows_ram() const { return knows_ram_; }
  /// Forgets all decoded lines.
  void forget_lines();
  void leave_line() { line_va = kNoLine; }
  /// A chain of records has gone to another line, which is `current`, unless the line was left for
  /// another reason since the chain began.
  void move_to_line(std::uint32_t va) {
    if (line_va != kNoLine) line_va = va;
  }
  void invalidate_line(unsigned index) {
    icache_.invalidate(index);
    decoded_[index].valid = 0;
    leave_line();
  }
  void invalidate_all();
  /// Drops decoded instructions of internal RAM.
  void drop_ram(std::uint32_t offset) { ram_decoded_[offset >> 5].valid = 0; }
  void drop_ram(std::uint32_t offset, std::uint32_t bytes) {
    for (std::uint32_t line = offset >> 5; line <= (offset + bytes - 1) >> 5; ++line)
      ram_decoded_[line].valid = 0;
    if (in_ram()) leave_line();
  }
  /// Lets the handlers of all instructions keep the tallies of their lines. Before the first fetch.
  void keep_tallies(ClockProfile& profile) {
    profile_ = &profile;
    current = &no_line_;
  }
  void collect_tallies();
  /// What handlers of an instruction at `pc` must do for a profile.
  RecordContext context(const Instruction& decoded, std::uint32_t pc) const;
  DecodedLine& ram_line(std::uint32_t offset) { return ram_decoded_[offset >> 5]; }
  DecodedLine& cache_line(unsigned index) { return decoded_[index]; }
  /// The last line found is in internal RAM; current_ram_offset() is its offset there.
  bool in_ram() const { return epoch & kInRam; }
  void set_in_ram(bool ram) { epoch = ram ? epoch | kInRam : epoch & ~kInRam; }
  std::uint32_t current_ram_offset() const {
    return static_cast<std::uint32_t>(current - ram_decoded_.data()) * Cache::kLineBytes;
  }

  const Cache& icache() const { return icache_; }
  /// Changes the bytes of a debugger's write wherever the unit holds them.
  void patch(std::uint32_t mva, std::uint32_t pa, std::span<const std::uint8_t> bytes);

  /// Identifies a line's address and the translation under which it was found; never 0. Bit 0 is
  /// the Thumb state, bit 2 internal RAM. A chain never leaves one of these (Counts::fetch_from).
  std::uint64_t key(std::uint32_t va, bool thumb) const { return epoch | (va & ~31u) | thumb; }

  // Used by the handlers of records and by the main loop.
  static constexpr unsigned kJumps = 1024;
  static constexpr std::uint32_t kNoLine = 1;
  std::uint32_t line_va = kNoLine;  // line of the current records; behind while a chain runs
  std::uint32_t line_thumb = 0;  // the CPSR's T bit in that line
  DecodedLine* current = nullptr;
  std::uint64_t epoch = kEpoch | 2u;  // changes at each forget()
  LineFill fill;
  std::array<DecodedLine*, kJumps> jumps;  // targets found last, by address
  bool branched = false;  // the last instruction changed the flow
  bool used_bus = false;  // the last fetch used the bus: time has passed since the boundary

 private:
  static constexpr std::uint64_t kEpoch = std::uint64_t{1} << 32;
  static constexpr std::uint64_t kInRam = 4;
  static constexpr std::uint32_t kFetchBits = kIcacheOn | kMmuOn;

  void use_new_settings();
  void read(BusAccess::Kind kind, std::uint32_t wanted, std::uint32_t pa, unsigned bytes);

  BusInterface& interface_;
  StallLedger& ledger_;
  DataBus& data_bus_;
  AccessLog& log_;
  const SystemRegisters& registers_;
  unsigned fill_latency_;
  bool shifted_cycle_;
  ClockProfile* profile_ = nullptr;

  Cache icache_;
  std::vector<DecodedLine> decoded_;      // one per line of the I-cache
  std::vector<DecodedLine> ram_decoded_;  // one per 32 bytes of internal RAM
  DecodedLine no_line_;
  BusAccess access_;
  DecodedLine uncached_;  // holds one decoded instruction
  std::uint64_t redirects_seen_ = 0;  // value at the last fetch that bypassed the caches
  std::uint32_t buffer_pa_ = 1, words_[4] = {};

  bool knows_ram_ = false;  // a line of internal RAM was found since the last forget()
  std::uint32_t process_ = 0, control_ = SystemRegisters::kControlAtReset;
  std::uint32_t lag_pc_ = 0;  // pc at which the old settings still apply
  unsigned lag_ = 0;          // number of instructions that are still fetched with them, plus one
};

}  // namespace fovea::cpu
