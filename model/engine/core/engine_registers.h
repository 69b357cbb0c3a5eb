// Registers of the remap engine. The block is hypothetical: the DM365 has none, and this declaration is the
// definition. The RTL's package, the firmware's header and the tables of the documents are printed from it.
#pragma once
#include <cstdint>

#include "model/common/regbank.h"
#include "model/engine/core/engine_offsets.h"

namespace fovea::engine {

inline constexpr unsigned kQueueDepth = 4;  ///< jobs that can wait
inline constexpr std::uint32_t kIdentity = 0x52454D31;

/// A field whose place is one of `bits`.
struct FieldAt : Field {
  FieldAt(Reg& reg, const char* name, Bits where, Mode mode, const char* sentence)
      : Field(reg, name, where.lsb, where.width, mode, sentence) {}
};

struct EngineRegs : RegBank {
  struct Control : Reg {
    using Reg::Reg;
    FieldAt enable{*this, "ENABLE", bits::kEnable, Mode::kRw, "takes jobs from the queue"};
    FieldAt abort{*this, "ABORT", bits::kAbort, Mode::kWo, "ends the job under way early and drops the queue"};
  };
  struct Status : Reg {
    using Reg::Reg;
    FieldAt busy{*this, "BUSY", bits::kBusy, Mode::kRo, "a job is under way"};
    FieldAt queued{*this, "QUEUED", bits::kQueued, Mode::kRo, "jobs that wait, 0 to 4"};
    FieldAt full{*this, "FULL", bits::kFull, Mode::kRo, "no other job can wait"};
  };
  /// The bits of a job's end and of the queue: in EVENTS, where 1 clears, and in ENABLES.
  struct Events : Reg {
    Events(RegBank& bank, const char* name, std::uint32_t offset, Mode mode, const char* sentence);
    FieldAt done, refused, read_error, write_error, aborted, overflow, dropped;
  };
  struct Submit : Reg {
    using Reg::Reg;
    FieldAt tag{*this, "TAG", bits::kTag, Mode::kWo, "returned in ENDED"};
  };
  struct Ended : Reg {
    using Reg::Reg;
    FieldAt tag{*this, "TAG", bits::kEndedTag, Mode::kRo, "of the job that ended last"};
    FieldAt events{*this, "EVENTS", bits::kEndedEvents, Mode::kRo, "its bits of EVENTS"};
    FieldAt count{*this, "COUNT", bits::kEndedCount, Mode::kRo, "jobs that ended, modulo 65536"};
  };
  struct JobMode : Reg {
    using Reg::Reg;
    FieldAt mode{*this, "MODE", bits::kRemapMode, Mode::kRw, "0 table, 1 grid, 2 radial, 3 project"};
    FieldAt bilinear{*this, "BILINEAR", bits::kBilinear, Mode::kRw, "interpolates; 0: the nearest pixel"};
    FieldAt grid_log2{*this, "GRID_LOG2", bits::kGridLog2, Mode::kRw, "step of the grid, 2^n pixels"};
    FieldAt pieces{*this, "PIECES", bits::kPieces, Mode::kRw, "pieces of the radial function"};
    FieldAt piece_log2{*this, "PIECE_LOG2", bits::kPieceLog2, Mode::kRw, "width of a piece, 2^n square pixels"};
  };
  struct Size : Reg {
    using Reg::Reg;
    FieldAt pairs{*this, "PAIRS", bits::kPairs, Mode::kRw, "pairs of pixels in an output row"};
    FieldAt rows{*this, "ROWS", bits::kRows, Mode::kRw, "output rows"};
  };
  struct SourceSize : Reg {
    using Reg::Reg;
    FieldAt width{*this, "WIDTH", bits::kWidth, Mode::kRw, "pixels"};
    FieldAt height{*this, "HEIGHT", bits::kHeight, Mode::kRw, "rows"};
  };
  /// A byte address or distance of which the low bits are 0.
  struct Bytes : Reg {
    Bytes(RegBank& bank, const char* name, std::uint32_t offset, Bits where, const char* sentence)
        : Reg(bank, name, offset, sentence), value(*this, "BYTES", where, Mode::kRw, sentence) {}
    FieldAt value;
  };
  struct Words : Reg {
    using Reg::Reg;
    FieldAt value{*this, "WORDS", bits::kMapWords, Mode::kRw, "words of 32 bits"};
  };

  Reg id{*this, "ID", at::kId, Mode::kRo, "identification", kIdentity};
  Control ctrl{*this, "CTRL", at::kCtrl, "control"};
  Status status{*this, "STATUS", at::kStatus, "status"};
  Events events{*this, "EVENTS", at::kEvents, Mode::kW1c, "what has happened; 1 clears"};
  Events enables{*this, "ENABLES", at::kEnables, Mode::kRw, "events that hold the interrupt line high"};
  Submit submit{*this, "SUBMIT", at::kSubmit, "puts the job of MODE to C2 into the queue"};
  Ended ended{*this, "ENDED", at::kEnded, "the job that ended last"};
  Reg clocks{*this, "CLOCKS", at::kClocks, Mode::kRo, "clocks that the job took which ended last"};
  Reg lines{*this, "LINES", at::kLines, Mode::kRo, "lines of the source that it read"};
  Reg writes{*this, "WRITES", at::kWrites, Mode::kRo, "bursts that it wrote"};
  Reg bad{*this, "BAD", at::kBad, Mode::kRo, "entries of its table that are no addresses"};
  JobMode mode{*this, "MODE", at::kMode, "how positions follow"};
  Size size{*this, "SIZE", at::kSize, "the result's size"};
  Bytes src_base{*this, "SRC_BASE", at::kSrcBase, bits::kBase, "first byte of the source"};
  Bytes src_pitch{*this, "SRC_PITCH", at::kSrcPitch, bits::kPitch, "from row to row of the source"};
  SourceSize src_size{*this, "SRC_SIZE", at::kSrcSize, "the source's size"};
  Bytes dst_base{*this, "DST_BASE", at::kDstBase, bits::kBase, "first byte of the result"};
  Bytes dst_pitch{*this, "DST_PITCH", at::kDstPitch, bits::kPitch, "from row to row of the result"};
  Bytes map_base{*this, "MAP_BASE", at::kMapBase, bits::kMapBase, "first byte of the map"};
  Words map_words{*this, "MAP_WORDS", at::kMapWords, "length of the map"};
  Reg border{*this, "BORDER", at::kBorder, Mode::kRw, "the word of a pair without a source"};
  Reg radius_limit{*this, "RADIUS_LIMIT", at::kRadiusLimit, Mode::kRw, "largest visible square radius, Q8"};
  Reg centre_x{*this, "CENTRE_X", at::kCentreX, Mode::kRw, "centre in the source, pixels, Q16"};
  Reg centre_y{*this, "CENTRE_Y", at::kCentreY, Mode::kRw, "centre in the source, rows, Q16"};
  Reg a0{*this, "A0", at::kA0, Mode::kRw, "linear form A: first value"};
  Reg a1{*this, "A1", at::kA1, Mode::kRw, "linear form A: step of a pair"};
  Reg a2{*this, "A2", at::kA2, Mode::kRw, "linear form A: step of a row"};
  Reg b0{*this, "B0", at::kB0, Mode::kRw, "linear form B: first value"};
  Reg b1{*this, "B1", at::kB1, Mode::kRw, "linear form B: step of a pair"};
  Reg b2{*this, "B2", at::kB2, Mode::kRw, "linear form B: step of a row"};
  Reg c0{*this, "C0", at::kC0, Mode::kRw, "linear form C: first value"};
  Reg c1{*this, "C1", at::kC1, Mode::kRw, "linear form C: step of a pair"};
  Reg c2{*this, "C2", at::kC2, Mode::kRw, "linear form C: step of a row"};

  EngineRegs();
};

}  // namespace fovea::engine
