// Fetch from the current line and translation of a known page. Inline, for the files that execute
// instructions.
#pragma once
#include <cstring>

#include "model/cpu/core/core.h"

namespace fovea::cpu {

inline const Instruction* Core::fetch() {
  if ((pc_ & ~31u) == line_va_ && (cpsr_ & 0x20u) == line_thumb_) {
    if (cycle_ < ifill_.last && ifill_.line == (fetched_at(pc_) & ~31u)) [[unlikely]]
      stall_to(ifill_.word((pc_ >> 2) & 7u), Cause::kIcache, ifill_.pa, kService);
    const unsigned at = (pc_ & 31u) >> line_shift_;
    if (current_line_->valid && current_line_->records[at].body) return &current_line_->records[at];
  }
  return fetch_slow();
}

/// @return nullptr: a fault was noted
inline const Translation* Core::translate(std::uint32_t mva, bool write, bool user,
                                          bool instruction) {
  if (!(control_ & 1u)) return &flat_;
  const Memo& memo = (instruction ? imemo_ : dmemo_)[(mva >> 10) % kMemos];
  if (memo.page == memo_key(mva, user) && (write ? memo.write_ok : memo.read_ok))
    return &memo.translation;
  return translate_slow(mva, write, user, instruction);
}

}  // namespace fovea::cpu
