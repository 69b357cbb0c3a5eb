#include "model/engine/core/engine_registers.h"

namespace fovea::engine {

EngineRegs::Events::Events(RegBank& bank, const char* name, std::uint32_t offset, Mode mode,
                           const char* sentence)
    : Reg(bank, name, offset, sentence),
      done(*this, "DONE", bits::kDone, mode, "a job ended as it should"),
      refused(*this, "REFUSED", bits::kRefused, mode, "a job was not possible"),
      read_error(*this, "READ_ERROR", bits::kReadError, mode, "a job ended at a read with an error"),
      write_error(*this, "WRITE_ERROR", bits::kWriteError, mode, "a job ended at a write with an error"),
      aborted(*this, "ABORTED", bits::kAborted, mode, "a job ended by CTRL.ABORT"),
      overflow(*this, "OVERFLOW", bits::kOverflow, mode, "a job was submitted to a full queue and lost"),
      dropped(*this, "DROPPED", bits::kDropped, mode, "CTRL.ABORT dropped jobs that waited") {}

EngineRegs::EngineRegs() : RegBank("ENGINE") {}

}  // namespace fovea::engine
