// What the chip has of the remap engine.
#pragma once
#include "model/common/param.h"

namespace fovea::engine {

struct EngineParams : ParamGroup {
  EnumParam kind{*this, "engine", "none", {"none", "tlm", "rtl", "both"},
                 "the hypothetical remap engine at 0x01c6a000: none; a transaction-level model; the verilated RTL; "
                 "the RTL with the model beside it, compared",
                 Origin::kChoice, ""};
  bool present() const { return !kind.is("none"); }
  EngineParams() : ParamGroup("") {}
};

}  // namespace fovea::engine
