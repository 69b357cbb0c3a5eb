#include "tb/iss/access_stream.h"

#include <bit>
#include <cstring>
#include <sstream>

namespace fovea::cpu::test {
namespace {

constexpr std::uint32_t bits(std::uint32_t w, unsigned high, unsigned low) {
  return w >> low & ((1u << (high - low + 1)) - 1);
}
constexpr bool bit(std::uint32_t w, unsigned n) { return w >> n & 1u; }

}  // namespace

void AccessStream::check() {
  for (const Loaded& l : loaded_) {
    const std::uint32_t is = l.reg == 16 ? core_.cpsr() : core_.reg(l.reg);
    if ((is & l.mask) == (l.value & l.mask) || !complaint_.empty()) continue;
    std::ostringstream out;
    out << std::hex << "pc " << l.pc << ": r" << std::dec << l.reg << std::hex << " should be "
        << l.value << ", is " << is;
    complaint_ = out.str();
  }
  loaded_.clear();
}

void AccessStream::boundary() {
  // The core also looks around while an instruction is still being fetched.
  if (core_.instructions_executed() == executed_) return;
  executed_ = core_.instructions_executed();
  check();
  pc_ = core_.reg(15);
  cpsr_ = core_.cpsr();
  thumb_ = bit(cpsr_, 5);
  std::uint32_t w = 0;
  if (internal(pc_)) {
    std::memcpy(&w, tcm_.data() + (pc_ & 0x7FFCu), 4);
    oracle_.flow_changes();
  } else {
    w = oracle_.fetch(pc_, thumb_);
  }
  if (thumb_) w = bit(pc_, 1) ? w >> 16 : w & 0xFFFFu;
  if (may_go_to_next(w)) oracle_.flow_changes();
  if (thumb_) return thumb(w);
  arm(w);
}

/// Branches to the next instruction, which cannot be told from where the program goes on. A Thumb
/// MOV to the pc is one wherever it goes, and counted once.
bool AccessStream::may_go_to_next(std::uint32_t w) const {
  if (!thumb_) return bits(w, 27, 0) == 0xAFF'FFFFu && passes(bits(w, 31, 28));
  return w == 0xE7FFu || (w & 0xFF87u) == 0x4687u ||
         (bits(w, 15, 12) == 13 && bits(w, 7, 0) == 0xFFu && passes(bits(w, 11, 8)));
}

bool AccessStream::passes(unsigned condition) const {
  const bool n = bit(cpsr_, 31), z = bit(cpsr_, 30), c = bit(cpsr_, 29), v = bit(cpsr_, 28);
  bool out = true;
  switch (condition / 2) {
    case 0:
      out = z;
      break;
    case 1:
      out = c;
      break;
    case 2:
      out = n;
      break;
    case 3:
      out = v;
      break;
    case 4:
      out = c && !z;
      break;
    case 5:
      out = n == v;
      break;
    case 6:
      out = n == v && !z;
      break;
    default:
      return true;
  }
  return out != (condition % 2 == 1);
}

void AccessStream::load(std::uint32_t address, unsigned bytes, bool sign, unsigned d) {
  const std::uint32_t aligned = address / bytes * bytes;
  if (internal(aligned)) return;
  ++accesses_;
  std::uint32_t value = oracle_.load(aligned, bytes);
  if (bytes == 4) value = std::rotr(value, static_cast<int>(8 * (address % 4)));
  if (sign && bytes == 1) value = (value ^ 0x80u) - 0x80u;
  if (sign && bytes == 2) value = (value ^ 0x8000u) - 0x8000u;
  if (d == 15) return;
  loaded_.push_back({pc_, d, value, ~0u});
}

void AccessStream::store(std::uint32_t address, unsigned bytes,
                         const std::vector<std::uint32_t>& values) {
  // Words of one instruction may lie on both sides of an end of the internal RAM.
  std::vector<std::uint32_t> outside;
  std::uint32_t first = 0, at = address / bytes * bytes;
  for (const std::uint32_t v : values) {
    if (!internal(at)) {
      if (outside.empty()) first = at;
      outside.push_back(v);
    }
    at += bytes;
  }
  if (outside.empty()) return;
  accesses_ += outside.size();
  oracle_.store(first, bytes, outside);
}

void AccessStream::transfer(bool is_load, std::uint32_t address, unsigned bytes, bool sign,
                            unsigned d) {
  if (is_load) return load(address, bytes, sign, d);
  store(address, bytes, {d == 15 ? pc_ + 12 : reg(d)});
}

/// Words in order of register numbers, from `address` on. A base that is written back is not looked
/// at: which value stays is another test's matter.
void AccessStream::block(bool is_load, std::uint32_t address, std::uint32_t list, unsigned base) {
  std::vector<std::uint32_t> values;
  for (unsigned r = 0; r < 16; ++r) {
    if (!bit(list, r)) continue;
    if (is_load) {
      load(address, 4, false, r == base ? 15 : r);
      address += 4;
    } else {
      values.push_back(r == 15 ? pc_ + 12 : reg(r));
    }
  }
  if (!is_load) store(address, 4, values);
}

/// Offset of LDR and STR: a register, shifted by a constant.
std::uint32_t AccessStream::shifted(std::uint32_t w) const {
  const std::uint32_t v = reg(bits(w, 3, 0));
  const unsigned n = bits(w, 11, 7);
  switch (bits(w, 6, 5)) {
    case 0:
      return v << n;
    case 1:
      return n ? v >> n : 0;
    case 2:
      return static_cast<std::uint32_t>(static_cast<std::int32_t>(v) >> (n ? n : 31));
    default:
      return n ? std::rotr(v, static_cast<int>(n)) : v >> 1 | std::uint32_t{bit(cpsr_, 29)} << 31;
  }
}

void AccessStream::arm(std::uint32_t w) {
  const unsigned condition = bits(w, 31, 28), n = bits(w, 19, 16), d = bits(w, 15, 12);
  if (condition == 15 || !passes(condition)) return;
  const bool is_load = bit(w, 20), before = bit(w, 24), up = bit(w, 23);
  const auto address = [&](std::uint32_t offset) {
    return before ? (up ? reg(n) + offset : reg(n) - offset) : reg(n);
  };
  switch (bits(w, 27, 25)) {
    case 0: {
      const unsigned kind = bits(w, 6, 5);
      if (bits(w, 7, 4) == 9 && bits(w, 27, 23) == 2 && bits(w, 21, 20) == 0) {  // SWP
        const unsigned bytes = bit(w, 22) ? 1 : 4;
        const std::uint32_t out = reg(bits(w, 3, 0));
        load(reg(n), bytes, false, d);
        return store(reg(n), bytes, {out});
      }
      if (!bit(w, 7) || !bit(w, 4) || kind == 0) return;
      const std::uint32_t offset =
          bit(w, 22) ? bits(w, 11, 8) << 4 | bits(w, 3, 0) : reg(bits(w, 3, 0));
      if (is_load) return load(address(offset), kind == 2 ? 1 : 2, kind != 1, d);
      if (kind == 1) return store(address(offset), 2, {reg(d)});
      if (kind == 2) return block(true, address(offset) & ~3u, 3u << d, 16);
      return block(false, address(offset) & ~3u, 3u << d, 16);
    }
    case 2:
      return transfer(is_load, address(bits(w, 11, 0)), bit(w, 22) ? 1 : 4, false, d);
    case 3:
      if (!bit(w, 4)) transfer(is_load, address(shifted(w)), bit(w, 22) ? 1 : 4, false, d);
      return;
    case 4: {
      const auto count = static_cast<std::uint32_t>(std::popcount(bits(w, 15, 0)));
      std::uint32_t first = up ? reg(n) : reg(n) - 4 * count;
      if (before == up) first += 4;
      return block(is_load, first & ~3u, bits(w, 15, 0), bit(w, 21) ? n : 16);
    }
    case 7:
      if (!bit(w, 24) && bit(w, 4) && bits(w, 11, 8) == 15) coprocessor(w);
      return;
    default:
      return;
  }
}

void AccessStream::coprocessor(std::uint32_t w) {
  const unsigned crn = bits(w, 19, 16), crm = bits(w, 3, 0), op2 = bits(w, 7, 5),
                 d = bits(w, 15, 12);
  if (bit(w, 20)) {
    if (crn == 7 && (crm == 10 || crm == 14) && op2 == 3) {
      const bool clean = oracle_.test_and_clean(crm == 14);
      if (d == 15) loaded_.push_back({pc_, 16, clean ? 1u << 30 : 0u, 1u << 30});
    }
    return;
  }
  const std::uint32_t v = reg(d);
  if (crn == 1) oracle_.control = v;
  if (crn == 9 && crm == 0) oracle_.lock(op2 == 1, v);
  if (crn == 15 && bits(w, 23, 21) == 7) oracle_.cache_debug = v;
  if (crn == 7 && !oracle_.operate(crm, op2, v) && complaint_.empty())
    complaint_ = "a cache operation that the oracle does not know";
}

void AccessStream::thumb(std::uint32_t w) {
  const unsigned d = bits(w, 2, 0);
  const std::uint32_t n = reg(bits(w, 5, 3));
  switch (bits(w, 15, 12)) {
    case 4:
      if (bit(w, 11)) load((reg(15) & ~3u) + 4 * bits(w, 7, 0), 4, false, bits(w, 10, 8));
      return;
    case 5: {
      const std::uint32_t a = n + reg(bits(w, 8, 6));
      constexpr unsigned kBytes[] = {4, 2, 1, 1, 4, 2, 1, 2};
      const unsigned kind = bits(w, 11, 9);
      return transfer(kind >= 3, a, kBytes[kind], kind == 3 || kind == 7, d);
    }
    case 6:
      return transfer(bit(w, 11), n + 4 * bits(w, 10, 6), 4, false, d);
    case 7:
      return transfer(bit(w, 11), n + bits(w, 10, 6), 1, false, d);
    case 8:
      return transfer(bit(w, 11), n + 2 * bits(w, 10, 6), 2, false, d);
    case 9:
      return transfer(bit(w, 11), reg(13) + 4 * bits(w, 7, 0), 4, false, bits(w, 10, 8));
    case 11: {
      if (bits(w, 10, 9) != 2) return;
      std::uint32_t list = bits(w, 7, 0);
      if (bit(w, 8)) list |= bit(w, 11) ? 1u << 15 : 1u << 14;
      const auto count = static_cast<std::uint32_t>(std::popcount(list));
      return block(bit(w, 11), bit(w, 11) ? reg(13) : reg(13) - 4 * count, list, 13);
    }
    case 12:
      return block(bit(w, 11), reg(bits(w, 10, 8)) & ~3u, bits(w, 7, 0), bits(w, 10, 8));
    default:
      return;
  }
}

}  // namespace fovea::cpu::test
