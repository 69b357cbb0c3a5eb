// What the chip has of the remap engine.
#pragma once
#include <initializer_list>

#include "model/common/param.h"
#include "model/common/units.h"

namespace fovea::engine {

struct EngineParams : ParamGroup {
  EnumParam kind{*this, "engine", "none", {"none", "tlm", "rtl", "both", "both_tlm"},
                 "the hypothetical remap engine at 0x01c6a000: none; a transaction-level model; the verilated RTL; "
                 "the RTL with the model beside it, compared; the model with the RTL beside it",
                 Origin::kChoice, ""};
  /// Sizes that are parameters of the RTL; the program has it with these defaults alone.
  EnumParam cache{*this, "engine.cache", "8KiB",
                  {"32B", "256B", "512B", "1KiB", "2KiB", "4KiB", "8KiB", "16KiB", "32KiB", "64KiB", "128KiB"},
                  "cache of the remap engine for lines of the source; 32B: the last line alone", Origin::kChoice, ""};
  IntParam prefetch{*this, "engine.prefetch", IntParam::Unit::kCount, 8, 1, 8,
                    "lines of the source that the remap engine has under way at most", Origin::kChoice, ""};
  /// Waveforms of the RTL (`fovea run --waves`).
  TextParam waves_file{*this, "waves.file", "", "FST file for the waveforms of the RTL engine; empty: none",
                       "a file name"};
  EnumParam waves_trigger{*this, "waves.trigger", "busy", {"busy", "job", "interrupt", "error"},
                          "what begins the waveforms: the first clock of the engine, a job that is submitted, a rising "
                          "interrupt line, an answer with an error",
                          Origin::kChoice, ""};
  IntParam waves_skip{*this, "waves.skip", IntParam::Unit::kCount, 0, 0, 1'000'000'000,
                      "events of that kind that are let pass before the waveforms begin", Origin::kChoice, ""};
  IntParam waves_from{*this, "waves.from", IntParam::Unit::kTime, 0, 0, 3600 * kPsPerSecond,
                      "events of that kind before this time do not count", Origin::kChoice, ""};
  IntParam waves_length{*this, "waves.length", IntParam::Unit::kTime, 0, 0, 3600 * kPsPerSecond,
                        "length of the waveforms from that event on; 0: to the end of the run", Origin::kChoice, ""};
  bool present() const { return !kind.is("none"); }
  bool compares() const { return kind.is("both") || kind.is("both_tlm"); }
  bool has_rtl() const { return present() && !kind.is("tlm"); }
  /// The cache has 2^n lines of 32 bytes.
  unsigned log_cache_lines() const {
    static constexpr unsigned kLogLines[] = {0, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};  // in the order of the words
    return kLogLines[cache.index()];
  }
  EngineParams() : ParamGroup("") {
    for (ParamBase* p : std::initializer_list<ParamBase*>{&cache, &prefetch})
      p->matters_only("an engine", {&kind}, [this] { return present(); });
    waves_file.matters_only("engine = rtl, both or both_tlm", {&kind}, [this] { return has_rtl(); });
    for (ParamBase* p : std::initializer_list<ParamBase*>{&waves_trigger, &waves_skip, &waves_from, &waves_length})
      p->matters_only("--waves", {&kind, &waves_file}, [this] { return has_rtl() && !waves_file().empty(); });
  }
};

}  // namespace fovea::engine
