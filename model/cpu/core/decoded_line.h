// A line of decoded instructions ("records"), and how records are prepared for their handlers.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "model/cpu/core/instruction.h"

namespace fovea::cpu {

/// What a profile (ClockProfile) counts of a record; modulo 2^32.
struct Tally {
  std::uint32_t flow = 0;     ///< times that the flow came here from elsewhere than from the record
                              ///< before, minus times that it ended in front of this record
  std::uint32_t special = 0;  ///< B and BL: times taken; others: times the condition was not met
  std::uint32_t waited = 0;   ///< clocks of interlocks
  std::uint32_t unused = 0;   // a power of two of bytes
};

/// What the neighbours in a line allow a record to leave out. The default is correct anywhere.
struct RecordContext {
  enum class Check : std::uint8_t { kNone, kYoungest, kAll } check = Check::kAll;
  bool track = true;     // a later record may have to wait for its result
  bool in_line = false;  // the record belongs to a line that holds all its records
  bool counted = false;  // the handlers keep the tallies of their line, and follow calls
  bool away = false;     // the same, and a branch leads to another function
};

/// Holds one more record than a line: the one after the last leads to the next line, and its
/// `sources` are the registers that the line's last records may deliver late. A record's place
/// follows from its offset in the line.
struct DecodedLine {
  std::uint64_t valid = 0;  // FetchUnit::key() of the last lookup; 0: nothing is decoded
  std::array<Instruction, 17> records;
  DecodedLine* next = nullptr;  // where the following line was found last, perhaps not any more
  std::uint32_t va = 0;         // address of the line in the last lookup
  std::array<Tally, 17> tallies;  // by half-word; all zero without a profile

  [[gnu::always_inline]] Tally& tally(const Instruction& record) {
    return tallies[record.at / 2];
  }

  bool holds(const Instruction* record) const {
    return record >= records.data() && record < records.data() + records.size();
  }
  /// The line that holds a decoded record.
  static const DecodedLine& of(const Instruction* record) {
    const std::size_t index = record->at / ((record->flags & kThumbInsn) ? 2u : 4u);
    return *reinterpret_cast<const DecodedLine*>(reinterpret_cast<const char*>(record - index) -
                                                 offsetof(DecodedLine, records));
  }

  /// True if nothing is decoded for this state yet.
  bool stale(bool thumb) const { return valid == 0 || (valid & 1u) != thumb; }
  /// Keeps the records, but has the next use looked up.
  void look_up_again() { valid = 2u | (valid & 1u); }
  void clear(bool thumb, bool counted);
  void prepare_record(const Instruction& decoded, unsigned index, RecordContext context,
                      bool shifted_cycle);
  /// Keeps only the record of an instruction that belongs to no line, and ends the chain behind it.
  /// @return the record
  const Instruction* hold_one(const Instruction& decoded, std::uint32_t pc, RecordContext context,
                              bool shifted_cycle);
};

/// Decodes the instruction at an index of a line.
Instruction decode_at(const std::uint8_t* bytes, unsigned index, bool thumb);
/// @param bytes of the line, whose other records may not be decoded yet
RecordContext record_context(const DecodedLine& d, unsigned index, const std::uint8_t* bytes,
                             bool thumb);
/// Chooses the handlers of a decoded record.
/// @param at offset of the instruction in its line, in bytes
/// @param shifted_cycle a shifted register offset costs a clock
void prepare(Instruction& i, unsigned at, RecordContext context, bool shifted_cycle);

}  // namespace fovea::cpu
