// Parameters of the ARM926EJ-S.
#pragma once
#include "model/common/param.h"

namespace fovea::cpu {

using ParamUnit = IntParam::Unit;

struct CacheParams : ParamGroup {
  IntParam size;
  CacheParams(std::string prefix, std::uint64_t def, const char* belief)
      : ParamGroup(std::move(prefix)),
        size(*this, "size", ParamUnit::kBytes, def, 4096, 131072,
             "size, a power of two; 4 ways of 32-byte lines", Origin::kFamily,
             "TMS320DM355 (SPRS463A), TMS320DM6446 (SPRS283): the same ARM subsystem",
             {belief, belief, "two sister chips agree"}) {}
};

struct CpuParams : ParamGroup {
  using U = ParamUnit;
  CacheParams icache{"cpu.icache", 16384, "16KiB"};
  CacheParams dcache{"cpu.dcache", 8192, "8KiB"};
  IntParam ahb_ratio{*this, "ahb_ratio", U::kCount, 2, 1, 8, "core clocks in an AHB clock",
                     Origin::kAssumed, "no public figure",
                     {"1", "3", "two is usual in subsystems with this core"}};
  IntParam fill_latency{*this, "fill_latency", U::kCycles, 1, 0, 8,
                        "core clocks from the critical word on the AHB to the core",
                        Origin::kAssumed, "not in ARM DDI 0198 or DDI 0222",
                        {"1 cycles", "2 cycles", "a register stage or two behind the bus"}};
  IntParam walk_cycles{*this, "walk_cycles", U::kCycles, 3, 0, 16,
                       "core clocks of a page walk beyond its bus reads", Origin::kAssumed,
                       "not in ARM DDI 0198 or DDI 0222",
                       {"2 cycles", "4 cycles", "one clock to begin and one for each level"}};
  IntParam cache_op_cycles{*this, "cache_op_cycles", U::kCycles, 1, 0, 16,
                           "extra core clocks of a cache operation by MVA or set/way",
                           Origin::kAssumed, "not in ARM DDI 0198 or DDI 0222",
                           {"0 cycles", "1 cycles", "one or two clocks in all"}};
  IntParam test_clean_cycles{*this, "test_clean_cycles", U::kCycles, 2, 0, 16,
                             "extra core clocks of one test-and-clean step", Origin::kAssumed,
                             "not in ARM DDI 0198 or DDI 0222",
                             {"1 cycles", "3 cycles", "two to four clocks in all"}};
  IntParam invalidate_all_cycles{
      *this,
      "invalidate_all_cycles",
      U::kCycles,
      4,
      0,
      1024,
      "extra core clocks to invalidate a whole cache",
      Origin::kAssumed,
      "not in ARM DDI 0198 or DDI 0222",
      {"1 cycles", "128 cycles",
       "from all lines at once to one clock for each set of the I-cache"}};
  IntParam tcm_wait_states{
      *this,
      "tcm.wait_states",
      U::kCycles,
      0,
      0,
      3,
      "extra core clocks of an access to internal RAM, beside the one that the "
      "program asks for with MISC.ARM_WAITST = 0",
      Origin::kSourced,
      "MISC.ARM_WAITST: 1, its reset value, is none"};
  IntParam tcm_dma_word_clocks{
      *this,
      "tcm.dma_word_clocks",
      U::kCycles,
      2,
      1,
      8,
      "core clocks for which a word of a DMA holds its bank of internal RAM",
      Origin::kAssumed,
      "no public figure; an AHB clock",
      {"1 cycles", "4 cycles", "half to twice an AHB clock"}};
  IntParam tcm_dma_latency{*this, "tcm.dma_latency", U::kCycles, 2, 0, 32,
                           "core clocks from a burst's arrival at internal RAM to its first word",
                           Origin::kAssumed, "no public figure",
                           {"1 cycles", "8 cycles", "one to four AHB clocks"}};
  IntParam tcm_banks{*this, "tcm.banks", U::kCount, 2, 1, 2,
                     "banks of internal RAM; core and DMA wait for each other only in the same one",
                     Origin::kAssumed, "no public figure; two of 16 KB",
                     {"1", "2", "one memory of 32 KB or one behind each port of the core"}};
  IntParam tcm_own_conflict{*this, "tcm.own_conflict", U::kCycles, 0, 0, 2,
                            "core clocks lost by a load or store in the bank that the core fetches "
                            "from",
                            Origin::kAssumed, "no figure for the chip; 1 on the ARM946E-S's ITCM",
                            {"0 cycles", "1 cycles", "none, or as on the ARM946E-S"}};
  EnumParam tcm_first{*this, "tcm.first", "core", {"core", "dma"},
                      "who goes first if both want a bank in the same clock", Origin::kAssumed,
                      "no public figure", {"core", "dma", "either is possible"}};
  BoolParam shifted_address_cycle{*this, "shifted_address_cycle", true,
                                  "a shifted register offset costs a cycle", Origin::kSourced,
                                  "ARM DDI 0222B table 8.2"};
  CpuParams() : ParamGroup("cpu") {
    add_part(icache);
    add_part(dcache);
  }
};

}  // namespace fovea::cpu
