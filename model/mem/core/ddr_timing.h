// DDR2 command timing as rules in rows: one constraint a line, readable beside the data sheet.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

namespace fovea::mem {

enum class Cmd : std::uint8_t { kAct, kPre, kPreAll, kRd, kWr, kRef, kCount };
inline constexpr std::size_t kCmdCount = static_cast<std::size_t>(Cmd::kCount);

/// Timing in DDR clocks, as the controller's registers hold it (SDTIMR, SDTIMR2, SDBCR) plus what
/// TI's controller fixes: BL8 and WL = CL - 1. BL8 moves 16 bytes on the 16-bit bus.
struct DdrTiming {
  unsigned CL = 5;
  unsigned nRFC = 31, nRP = 5, nRCD = 5, nWR = 4, nRAS = 11, nRC = 16, nRRD = 3, nWTR = 3;
  unsigned nRTP = 2;
  unsigned banks = 8;
  unsigned WL() const { return CL - 1; }
  static constexpr unsigned kBurstClocks = 4;  // BL8 / 2
};

enum class Level : std::uint8_t { kBank, kRank };

struct DdrRule {
  Level level;
  Cmd from, to;
  unsigned (*clocks)(const DdrTiming&);
};

using T = const DdrTiming&;
/// From JESD79-2 relations (AL = 0, BL8). A PREA is a PRE to every bank; on 8-bank parts it takes
/// one clock more.
inline constexpr std::array kDdrRules = {
    DdrRule{Level::kBank, Cmd::kAct, Cmd::kRd, [](T t) { return t.nRCD; }},
    DdrRule{Level::kBank, Cmd::kAct, Cmd::kWr, [](T t) { return t.nRCD; }},
    DdrRule{Level::kBank, Cmd::kAct, Cmd::kPre, [](T t) { return t.nRAS; }},
    DdrRule{Level::kBank, Cmd::kAct, Cmd::kAct, [](T t) { return t.nRC; }},
    DdrRule{Level::kRank, Cmd::kAct, Cmd::kAct, [](T t) { return t.nRRD; }},
    DdrRule{Level::kBank, Cmd::kPre, Cmd::kAct, [](T t) { return t.nRP; }},
    DdrRule{Level::kRank, Cmd::kPre, Cmd::kRef, [](T t) { return t.nRP; }},
    DdrRule{Level::kRank, Cmd::kPreAll, Cmd::kAct,
            [](T t) { return t.nRP + (t.banks == 8 ? 1u : 0u); }},
    DdrRule{Level::kRank, Cmd::kPreAll, Cmd::kRef,
            [](T t) { return t.nRP + (t.banks == 8 ? 1u : 0u); }},
    DdrRule{Level::kRank, Cmd::kRd, Cmd::kRd, [](T) { return DdrTiming::kBurstClocks; }},
    DdrRule{Level::kRank, Cmd::kWr, Cmd::kWr, [](T) { return DdrTiming::kBurstClocks; }},
    DdrRule{Level::kRank, Cmd::kRd, Cmd::kWr,
            [](T t) { return t.CL + DdrTiming::kBurstClocks + 1 - t.WL(); }},
    DdrRule{Level::kRank, Cmd::kWr, Cmd::kRd,
            [](T t) { return t.WL() + DdrTiming::kBurstClocks + t.nWTR; }},
    DdrRule{Level::kBank, Cmd::kRd, Cmd::kPre,
            [](T t) { return DdrTiming::kBurstClocks - 2 + std::max(t.nRTP, 2u); }},
    DdrRule{Level::kBank, Cmd::kWr, Cmd::kPre,
            [](T t) { return t.WL() + DdrTiming::kBurstClocks + t.nWR; }},
    DdrRule{Level::kRank, Cmd::kRef, Cmd::kAct, [](T t) { return t.nRFC; }},
    DdrRule{Level::kRank, Cmd::kRef, Cmd::kRef, [](T t) { return t.nRFC; }},
};

/// The device as seen through its command bus: which command is legal from which clock on, and
/// which row each bank holds. Clocks are edge numbers of the DDR clock.
class DdrDevice {
 public:
  static constexpr unsigned kMaxBanks = 8;
  static constexpr std::uint32_t kClosed = ~0u;

  void configure(const DdrTiming& timing) {
    timing_ = timing;
    for (Effects& e : effects_) e.count = 0;
    for (const DdrRule& r : kDdrRules) {
      Effects& e = effects_[static_cast<std::size_t>(r.from)];
      e.list[e.count++] = {r.level, r.to, r.clocks(timing)};
    }
  }
  const DdrTiming& timing() const { return timing_; }
  std::uint32_t row(unsigned bank) const { return banks_[bank].row; }
  bool all_closed() const { return open_ == 0; }

  /// First clock at which the command is legal. PREA needs PRE to be legal in every open bank.
  std::uint64_t earliest(Cmd cmd, unsigned bank) const {
    const auto c = static_cast<std::size_t>(cmd);
    if (cmd == Cmd::kPreAll) {
      std::uint64_t e = rank_[static_cast<std::size_t>(Cmd::kPre)];
      for (const Bank& b : banks_)
        if (b.row != kClosed) e = std::max(e, b.next[static_cast<std::size_t>(Cmd::kPre)]);
      return e;
    }
    if (cmd == Cmd::kRef) return rank_[c];
    return std::max(rank_[c], banks_[bank].next[c]);
  }

  void issue(Cmd cmd, unsigned bank, std::uint32_t row, std::uint64_t clock) {
    const Effects& effects = effects_[static_cast<std::size_t>(cmd)];
    for (unsigned i = 0; i < effects.count; ++i) {
      const Effect& x = effects.list[i];
      auto& next = x.level == Level::kRank ? rank_ : banks_[bank].next;
      auto& slot = next[static_cast<std::size_t>(x.to)];
      slot = std::max(slot, clock + x.clocks);
    }
    if (cmd == Cmd::kAct) {
      banks_[bank].row = row;
      open_ |= 1u << bank;
    } else if (cmd == Cmd::kPre) {
      banks_[bank].row = kClosed;
      open_ &= ~(1u << bank);
    } else if (cmd == Cmd::kPreAll) {
      for (auto& b : banks_) b.row = kClosed;
      open_ = 0;
    }
  }

 private:
  struct Bank {
    std::array<std::uint64_t, kCmdCount> next{};
    std::uint32_t row = kClosed;
  };
  // The rules in effect, by the command that starts them.
  struct Effect {
    Level level;
    Cmd to;
    unsigned clocks;
  };
  struct Effects {
    std::array<Effect, 6> list;
    unsigned count = 0;
  };
  DdrTiming timing_;
  std::array<Effects, kCmdCount> effects_{};
  std::uint32_t open_ = 0;  // banks with an open row
  std::array<Bank, kMaxBanks> banks_{};
  std::array<std::uint64_t, kCmdCount> rank_{};
};

}  // namespace fovea::mem
