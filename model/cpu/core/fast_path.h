// What nearly every instruction does: fetch from the current line, translate a known page, hit the
// D-cache or internal RAM. Inline, for the files that execute instructions.
#pragma once
#include <cstring>

#include "model/cpu/core/core.h"

namespace fovea::cpu {

inline void Core::record(std::uint32_t va, unsigned bytes, bool write) {
  ring_[ring_count_++ % ring_.size()] = {pc_, va, static_cast<std::uint8_t>(bytes), write};
}

inline const Instruction* Core::fetch() {
  if ((pc_ & ~31u) == line_va_ && (cpsr_ & 0x20u) == line_thumb_) {
    if (cycle_ < ifill_.last && ifill_.line == (modified(pc_) & ~31u)) [[unlikely]]
      stall_to(ifill_.word((pc_ >> 2) & 7u), Cause::kIcache);
    const unsigned at = (pc_ & 31u) >> line_shift_;
    if (current_line_->valid >> at & 1u) return &current_line_->records[at];
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

template <unsigned kBytes>
inline bool Core::load_hit(std::uint32_t va, std::uint32_t& value, bool user) {
  const std::uint32_t mva = modified(va);
  if (mva & (kBytes - 1)) [[unlikely]] return false;
  value = 0;
  if (in_tcm(mva)) {
    if (tcm_wait_) return false;
    record(va, kBytes, false);
    std::memcpy(&value, tcm(mva), kBytes);
    return true;
  }
  const Memo& memo = dmemo_[(mva >> 10) % kMemos];
  // Both bits of the control register: with the MMU off its memos say nothing.
  if (memo.page != memo_key(mva, user) || !memo.read_ok || !memo.translation.cacheable ||
      (control_ & 5u) != 5u)
    return false;
  const int i = dcache_.find(mva);
  if (i < 0) return false;
  record(va, kBytes, false);
  ++counts_.dcache_reads;
  if (cycle_ < dfill_.last) dcache_wait(mva);
  std::memcpy(&value, dcache_.data(static_cast<unsigned>(i)) + (mva & 31u), kBytes);
  return true;
}

/// Also takes the write that misses a cacheable, bufferable page.
template <unsigned kBytes>
inline bool Core::store_hit(std::uint32_t va, std::uint32_t value, bool user) {
  const std::uint32_t mva = modified(va);
  if (mva & (kBytes - 1)) [[unlikely]] return false;
  const Memo& memo = dmemo_[(mva >> 10) % kMemos];
  if (memo.page != memo_key(mva, user) || !memo.write_ok || !memo.translation.cacheable ||
      !memo.translation.bufferable || (control_ & 5u) != 5u || (cache_debug_ & 4u) || in_tcm(mva))
    return false;
  const int i = dcache_.find(mva);
  record(va, kBytes, true);
  ++counts_.dcache_writes;
  if (i < 0) {  // no allocation on a write: to the write buffer
    if (cycle_ < dfill_.last) dcache_wait(mva);
    ++counts_.dcache_write_misses;
    enqueue_write(memo.translation.physical(mva), reinterpret_cast<const std::uint8_t*>(&value),
                  kBytes);
    return true;
  }
  if (cycle_ < dfill_.last) dcache_wait(mva);
  std::memcpy(dcache_.data(static_cast<unsigned>(i)) + (mva & 31u), &value, kBytes);
  dcache_.line(static_cast<unsigned>(i)).dirty |= static_cast<std::uint8_t>(1u << (mva >> 4 & 1u));
  return true;
}

}  // namespace fovea::cpu
