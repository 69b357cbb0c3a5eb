// The last data accesses of the core, for messages about a guest failure.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/cpu/core/addressing.h"
#include "model/cpu/core/decoded_line.h"
#include "model/cpu/core/instruction.h"

namespace fovea::cpu {

struct AccessRecord {
  std::uint32_t pc = 0, address = 0;
  std::uint8_t bytes = 0;
  bool write = false;
};

/// The fast handlers note only their record and the address; the rest is worked out when the log
/// is read, or when the record is about to change.
class AccessLog {
 public:
  void note(const Instruction* record, std::uint32_t va) {
    Entry& e = take();
    e.record = record;
    e.address = va;
  }
  /// An access of `bytes` of the instruction at `pc`.
  void note(std::uint32_t pc, std::uint32_t va, unsigned bytes, bool write) {
    take() = {nullptr, va, pc, 1, static_cast<std::uint8_t>(bytes), write};
  }
  /// The record of the newest access; null if it was noted without one.
  const Instruction* last_record() const {
    return ring_[(at_ / sizeof(Entry) + ring_.size() - 1) % ring_.size()].record;
  }
  /// To be called before records of a line, or its address, change.
  void line_changes(const DecodedLine& line) {
    for (Entry& e : ring_)
      if (e.record && line.holds(e.record)) e = resolved(e);
  }
  /// The newest ones, oldest first; each word of a block is one.
  std::vector<AccessRecord> newest() const {
    std::vector<AccessRecord> out;
    const std::size_t first = at_ / sizeof(Entry);  // the oldest access
    for (std::size_t n = first; n < first + ring_.size(); ++n) {
      const Entry e = resolved(ring_[n % ring_.size()]);
      for (std::uint32_t k = 0; k < e.words; ++k)
        out.push_back({e.pc, e.address + 4 * k, e.bytes, e.write});
    }
    if (out.size() > kShown) out.erase(out.begin(), out.end() - kShown);
    return out;
  }

 private:
  static constexpr std::size_t kShown = 8;
  struct alignas(32) Entry {
    const Instruction* record = nullptr;  // nullptr: what follows the address is valid
    std::uint32_t address = 0;
    std::uint32_t pc = 0, words = 0;  // words 0: no access yet
    std::uint8_t bytes = 0;
    bool write = false;
  };
  static_assert(kShown * sizeof(Entry) == 256, "the offset wraps as a byte");

  Entry& take() {
    auto& e = *reinterpret_cast<Entry*>(reinterpret_cast<char*>(ring_.data()) + at_);
    at_ = static_cast<std::uint8_t>(at_ + sizeof(Entry));
    return e;
  }
  static Entry resolved(const Entry& e) {
    if (!e.record) return e;
    const Instruction& i = *e.record;
    const bool block = is_block(i.op);
    return {nullptr,
            e.address,
            DecodedLine::of(e.record).va + i.at,
            block ? i.amount : 1u,
            static_cast<std::uint8_t>(block ? 4 : access_bytes(i.op)),
            is_store(i.op)};
  }

  std::uint8_t at_ = 0;  // offset of the next entry in bytes
  std::array<Entry, kShown> ring_{};
};

}  // namespace fovea::cpu
