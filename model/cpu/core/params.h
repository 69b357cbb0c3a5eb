// Parameters of the ARM926EJ-S.
#pragma once
#include "model/common/param.h"

namespace fovea::cpu {

using ParamUnit = IntParam::Unit;

struct CacheParams : ParamGroup {
  IntParam size;
  CacheParams(std::string prefix, std::uint64_t def, const char* source)
      : ParamGroup(std::move(prefix)),
        size(*this, "size", ParamUnit::kBytes, def, 4096, 131072,
             "size, a power of two; 4 ways of 32-byte lines", Origin::kSourced, source) {}
};

struct CpuParams : ParamGroup {
  using U = ParamUnit;
  CacheParams icache{"cpu.icache", 16384, "DM646x ARM subsystem guide; DM365: 16 KB"};
  CacheParams dcache{"cpu.dcache", 8192, "DM646x ARM subsystem guide; DM365: 8 KB"};
  IntParam ahb_ratio{*this, "ahb_ratio", U::kCount, 2, 1, 8, "core clocks in an AHB clock",
                     Origin::kAssumed, "no public figure; dm365.md 12 #4"};
  IntParam fill_latency{*this, "fill_latency", U::kCycles, 1, 0, 8,
                        "core clocks from the critical word on the AHB to the core",
                        Origin::kAssumed, "arm926.md 3: 1 to 2"};
  IntParam walk_cycles{*this, "walk_cycles", U::kCycles, 3, 0, 16,
                       "core clocks of a page walk beyond its bus reads", Origin::kAssumed,
                       "arm926.md 2.5: 2 to 4"};
  IntParam cache_op_cycles{*this, "cache_op_cycles", U::kCycles, 1, 0, 16,
                           "extra core clocks of a cache operation by MVA or set/way",
                           Origin::kAssumed, "arm926.md 2.7: 1 to 2 in all"};
  IntParam test_clean_cycles{*this, "test_clean_cycles", U::kCycles, 2, 0, 16,
                             "extra core clocks of one test-and-clean step", Origin::kAssumed,
                             "arm926.md 2.7: 2 to 4 in all"};
  IntParam invalidate_all_cycles{*this, "invalidate_all_cycles", U::kCycles, 4, 0, 1024,
                                 "extra core clocks to invalidate a whole cache",
                                 Origin::kAssumed, "arm926.md 2.7: a few"};
  IntParam tcm_wait_states{*this, "tcm.wait_states", U::kCycles, 0, 0, 3,
                           "extra core clocks of an access to internal RAM", Origin::kSourced,
                           "MISC.ARM_WAITST is 1 (none) out of reset"};
  IntParam tcm_dma_word_clocks{*this, "tcm.dma_word_clocks", U::kCycles, 2, 1, 8,
                               "core clocks for which a word of a DMA holds its bank of internal RAM",
                               Origin::kAssumed, "no public figure; an AHB clock"};
  IntParam tcm_dma_latency{*this, "tcm.dma_latency", U::kCycles, 2, 0, 32,
                           "core clocks from a burst's arrival at internal RAM to its first word",
                           Origin::kAssumed, "no public figure"};
  IntParam tcm_banks{*this, "tcm.banks", U::kCount, 2, 1, 2,
                     "banks of internal RAM; core and DMA wait for each other only in the same one",
                     Origin::kAssumed, "no public figure; two of 16 KB"};
  IntParam tcm_own_conflict{*this, "tcm.own_conflict", U::kCycles, 0, 0, 2,
                            "core clocks lost by a load or store in the bank that the core fetches "
                            "from",
                            Origin::kAssumed, "no figure for the chip; 1 on the ARM946E-S's ITCM"};
  EnumParam tcm_first{*this, "tcm.first", "core", {"core", "dma"},
                      "who goes first if both want a bank in the same clock", Origin::kAssumed,
                      "no public figure"};
  BoolParam shifted_address_cycle{*this, "shifted_address_cycle", true,
                                  "a shifted register offset costs a cycle", Origin::kSourced,
                                  "ARM DDI 0222B table 8.2"};
  CpuParams() : ParamGroup("cpu") {}
  void declare(ParamSet& set) {
    set.add(*this);
    set.add(icache);
    set.add(dcache);
  }
};

}  // namespace fovea::cpu
