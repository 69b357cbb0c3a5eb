#include "model/cpu/core/debug.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace fovea::cpu {
namespace {

constexpr std::uint32_t kLineMask = Cache::kLineBytes - 1;

/// Calls f(va, offset, count) for each part within one cache line, until a call returns false.
template <class F>
bool by_lines(std::uint32_t va, std::size_t bytes, F f) {
  for (std::size_t done = 0; done < bytes;) {
    const std::uint32_t at = va + static_cast<std::uint32_t>(done);
    const std::size_t n = std::min<std::size_t>(bytes - done, Cache::kLineBytes - (at & kLineMask));
    if (!f(at, done, n)) return false;
    done += n;
  }
  return true;
}

}  // namespace

/// Reads memory, including the pending bytes of the write and victim buffers.
bool CoreDebug::read_memory(std::uint32_t pa, std::span<std::uint8_t> to) {
  if (!memory_.debug_read(pa, to)) return false;
  for (std::size_t k = 0; k < to.size(); ++k)
    core_.writes_.find(pa + static_cast<std::uint32_t>(k), to[k]);
  return true;
}

std::optional<std::uint32_t> CoreDebug::table_word(std::uint32_t pa) {
  std::array<std::uint8_t, 4> bytes;
  if (!read_memory(pa, bytes)) return std::nullopt;
  std::uint32_t word;
  std::memcpy(&word, bytes.data(), 4);
  return word;
}

std::optional<CoreDebug::Mapping> CoreDebug::mapping(std::uint32_t mva) {
  if (!(core_.control_ & 1u)) return Mapping{mva, false};
  const bool cache_on = core_.control_ & 4u;
  if (const TlbEntry* e = core_.tlb_.find(mva))
    return Mapping{e->physical(mva), e->cacheable && cache_on};
  // The same walk as Core::walk(), without time, faults or TLB.
  const auto first = table_word((core_.ttbr_ & 0xFFFFC000u) | (mva >> 20) << 2);
  if (!first) return std::nullopt;
  const auto page = [&](std::uint32_t d, std::uint32_t mask) {
    return Mapping{(d & ~mask) | (mva & mask), (d >> 3 & 1u) && cache_on};
  };
  if ((*first & 3u) == 2) return page(*first, 0xFFFFFu);
  if ((*first & 3u) == 0) return std::nullopt;
  const bool fine = (*first & 3u) == 3;
  const auto second = table_word(fine ? (*first & 0xFFFFF000u) | ((mva >> 10) & 0x3FFu) << 2
                                      : (*first & 0xFFFFFC00u) | ((mva >> 12) & 0xFFu) << 2);
  if (!second) return std::nullopt;
  switch (*second & 3u) {
    case 1: return page(*second, 0xFFFFu);
    case 2: return page(*second, 0xFFFu);
    case 3: return fine ? std::optional(page(*second, 0x3FFu)) : std::nullopt;
    default: return std::nullopt;
  }
}

std::optional<std::uint32_t> CoreDebug::physical(std::uint32_t va) {
  const auto p = mapping(core_.modified(va));
  return p ? std::optional(p->pa) : std::nullopt;
}

bool CoreDebug::read(std::uint32_t va, std::span<std::uint8_t> to) {
  return by_lines(va, to.size(), [&](std::uint32_t at, std::size_t offset, std::size_t n) {
    const std::uint32_t mva = core_.modified(at);
    const auto piece = to.subspan(offset, n);
    const auto p = mapping(mva);
    if (!p) return false;
    if (core_.in_tcm(p->pa)) {
      std::memcpy(piece.data(), core_.tcm(p->pa), n);
      return true;
    }
    if (const int i = p->cached ? core_.dcache_.find(mva) : -1; i >= 0) {
      std::memcpy(piece.data(), core_.dcache_.data(static_cast<unsigned>(i)) + (mva & kLineMask),
                  n);
      return true;
    }
    return read_memory(p->pa, piece);
  });
}

bool CoreDebug::write(std::uint32_t va, std::span<const std::uint8_t> from) {
  return by_lines(va, from.size(), [&](std::uint32_t at, std::size_t offset, std::size_t n) {
    const std::uint32_t mva = core_.modified(at);
    const auto piece = from.subspan(offset, n);
    const auto p = mapping(mva);
    if (!p) return false;
    if (core_.in_tcm(p->pa)) {
      std::memcpy(core_.tcm(p->pa), piece.data(), n);
      core_.tcm_decoded(p->pa).valid = 0;
      core_.line_va_ = 1;
      return true;
    }
    if (!memory_.debug_write(p->pa, piece)) return false;
    // Older data on their way to memory must not overwrite the new bytes later.
    core_.writes_.patch(p->pa, piece);
    if (core_.write_in_flight_) {
      BusAccess& a = core_.write_access_;
      for (std::size_t k = 0; k < n; ++k)
        if (const std::uint32_t d = p->pa + static_cast<std::uint32_t>(k) - a.address; d < a.bytes)
          a.data[d] = piece[k];
    }
    if (const int i = core_.dcache_.find(mva); i >= 0)
      std::memcpy(core_.dcache_.data(static_cast<unsigned>(i)) + (mva & kLineMask), piece.data(),
                  n);
    patch_instructions(mva, p->pa, piece);
    return true;
  });
}

void CoreDebug::patch_instructions(std::uint32_t mva, std::uint32_t pa,
                                   std::span<const std::uint8_t> from) {
  if (const int i = core_.icache_.find(mva); i >= 0) {
    const auto n = static_cast<unsigned>(i);
    std::memcpy(core_.icache_.data(n) + (mva & kLineMask), from.data(), from.size());
    core_.decoded_[n].valid = 0;
    core_.line_va_ = 1;
  }
  auto* const words = reinterpret_cast<std::uint8_t*>(core_.fetch_words_);
  for (std::size_t k = 0; k < from.size(); ++k)
    if (const std::uint32_t d = pa + static_cast<std::uint32_t>(k) - core_.fetch_buffer_pa_;
        core_.fetch_buffer_pa_ != 1 && d < sizeof core_.fetch_words_)
      words[d] = from[k];
}

void CoreDebug::set_reg(unsigned i, std::uint32_t value) {
  if (i != 15) return core_.set_reg(i, value);
  core_.pc_ = core_.next_pc_ = value & ((core_.cpsr_ & 0x20u) ? ~1u : ~3u);
  core_.fetch_branched_ = true;
}

void CoreDebug::set_cpsr(std::uint32_t value) {
  core_.set_cpsr(value);
  core_.line_va_ = 1;
}

void CoreDebug::back_to_failure() {
  if (!core_.failing_) return;
  set_cpsr(core_.failed_cpsr_);
  core_.pc_ = core_.next_pc_ = core_.failed_pc_;
}

bool CoreDebug::set_spsr(std::uint32_t value) {
  const unsigned bank = Core::bank(core_.cpsr());
  if (bank == 0) return false;
  core_.spsr_[bank] = value;
  return true;
}

std::span<const CoreDebug::SystemRegister> CoreDebug::system_registers() {
  static constexpr std::array<SystemRegister, 8> kRegisters = {{
      {"control", [](const Core& c) { return c.control_; }, 0x0100},
      {"ttbr", [](const Core& c) { return c.ttbr_; }, 0x0200},
      {"dacr", [](const Core& c) { return c.dacr_; }, 0x0300},
      {"dfsr", [](const Core& c) { return c.dfsr_; }, 0x0500},
      {"ifsr", [](const Core& c) { return c.ifsr_; }, 0x0501},
      {"far", [](const Core& c) { return c.far_; }, 0x0600},
      {"fcse_pid", [](const Core& c) { return c.fcse_pid_; }, 0x0D00},
      {"context_id", [](const Core& c) { return c.context_id_; }, 0x0D01},
  }};
  return kRegisters;
}

void CoreDebug::set_system_register(const SystemRegister& r, std::uint32_t value) {
  core_.cp15_write(r.number, value);
}

std::span<const CoreDebug::BankedRegister> CoreDebug::banked_registers() {
  static constexpr std::array<BankedRegister, 27> kRegisters = {{
      {"r8_usr", 0, 8},    {"r9_usr", 0, 9},    {"r10_usr", 0, 10},  {"r11_usr", 0, 11},
      {"r12_usr", 0, 12},  {"sp_usr", 0, 13},   {"lr_usr", 0, 14},   {"r8_fiq", 1, 8},
      {"r9_fiq", 1, 9},    {"r10_fiq", 1, 10},  {"r11_fiq", 1, 11},  {"r12_fiq", 1, 12},
      {"sp_fiq", 1, 13},   {"lr_fiq", 1, 14},   {"spsr_fiq", 1, 16}, {"sp_irq", 2, 13},
      {"lr_irq", 2, 14},   {"spsr_irq", 2, 16}, {"sp_svc", 3, 13},   {"lr_svc", 3, 14},
      {"spsr_svc", 3, 16}, {"sp_abt", 4, 13},   {"lr_abt", 4, 14},   {"spsr_abt", 4, 16},
      {"sp_und", 5, 13},   {"lr_und", 5, 14},   {"spsr_und", 5, 16},
  }};
  return kRegisters;
}

const std::uint32_t* CoreDebug::banked(const BankedRegister& r) const {
  if (r.number == kSpsrNumber) return &core_.spsr_[r.bank];
  const unsigned present = Core::bank(core_.cpsr());
  if (r.number >= 13)
    return r.bank == present ? &core_.r_[r.number] : &core_.banked_[r.bank][r.number - 13u];
  const bool fiq = r.bank == 1;
  if (fiq == (present == 1)) return &core_.r_[r.number];
  return &(fiq ? core_.fiq_high_ : core_.user_high_)[r.number - 8u];
}

CoreDebug::Pending CoreDebug::pending() const {
  Pending p;
  const auto later = [this](std::uint64_t cycle) -> Picoseconds {
    return cycle > core_.cycle_ ? core_.time(cycle) : 0;
  };
  p.data_fill = later(core_.dfill_.last);
  p.instruction_fill = later(core_.ifill_.last);
  p.operands = later(core_.busy_until_);
  p.data_line = core_.dfill_.line;
  p.instruction_line = core_.ifill_.line;
  p.writes = core_.writes_.count();
  p.victim_bytes = core_.writes_.victim_bytes;
  p.victim = core_.writes_.victim_address;
  p.write_on_bus = core_.write_in_flight_;
  p.write_address = core_.write_access_.address;
  p.irq = core_.irq_.level;
  p.fiq = core_.fiq_.level;
  return p;
}

std::optional<Instruction> CoreDebug::instruction(std::uint32_t va) {
  const bool thumb = core_.cpsr() & 0x20u;
  std::array<std::uint8_t, 4> bytes{};
  const auto piece = std::span(bytes).first(thumb ? 2 : 4);
  const std::uint32_t mva = core_.modified(va);
  const auto p = mapping(mva);
  if (const int i = p && core_.in_tcm(p->pa) ? -1 : core_.icache_.find(mva); i >= 0)
    std::memcpy(bytes.data(), core_.icache_.data(static_cast<unsigned>(i)) + (mva & kLineMask),
                piece.size());
  else if (!read(va, piece))
    return std::nullopt;
  std::uint32_t word;
  std::memcpy(&word, bytes.data(), 4);
  return thumb ? decode_thumb(static_cast<std::uint16_t>(word)) : decode_arm(word);
}

}  // namespace fovea::cpu
