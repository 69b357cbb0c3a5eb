// DDR2 command timing as rules in rows: one constraint a line, readable beside the data sheet.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace fovea::mem {

/// Up to kRef each has its own place in the timing; a column command with auto-precharge is timed
/// as the plain one, followed by the PRE that the part gives itself. The last four move CKE:
/// power-down and self-refresh, entry and exit.
enum class Cmd : std::uint8_t {
  kAct,
  kPre,
  kPreAll,
  kRd,
  kWr,
  kRef,
  kCount,
  kRda = kCount,
  kWra,
  kPde,
  kPdx,
  kSre,
  kSrx
};
inline constexpr std::size_t kCmdCount = static_cast<std::size_t>(Cmd::kCount);

/// Timing in DDR clocks, as the controller's registers hold it (SDTIMR, SDTIMR2, SDBCR) plus what
/// TI's controller fixes: BL8, which moves 16 bytes on the 16-bit bus, and what the kind of part
/// fixes: WL = CL - 1 for DDR2, 1 for mobile DDR.
struct DdrTiming {
  unsigned CL = 5;
  unsigned nRFC = 31, nRP = 5, nRCD = 5, nWR = 4, nRAS = 11, nRC = 16, nRRD = 3, nWTR = 3;
  unsigned nRTP = 2;
  unsigned nXP = 3, nXSNR = 34, nXSRD = 200, nCKE = 3;
  unsigned banks = 8;
  bool mobile = false;  // mobile DDR
  unsigned WL() const { return mobile ? 1 : CL - 1; }
  static constexpr unsigned kBurstClocks = 4;  // BL8 / 2
  /// The shortest refresh interval that leaves requests their turn. An urgent refresh may come between
  /// an ACT and its column: the interval lasts until that column has been given behind the refresh.
  unsigned least_interval() const {
    const unsigned refreshed = nRAS + nRP + (banks == 8 ? 1u : 0u) + nRFC;
    return std::max(2 * nRFC, std::max(refreshed, nRC) + nRRD + nRCD + 2);
  }
};

enum class Level : std::uint8_t { kBank, kRank };

struct DdrRule {
  Level level;
  Cmd from, to;
  unsigned (*clocks)(const DdrTiming&);
};

using T = const DdrTiming&;
/// From the relations of JESD79-2 (AL = 0, BL8) and, for mobile parts, JESD209. A PREA is a PRE to
/// every bank; on 8-bank parts it takes one clock more.
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
            [](T t) { return t.CL + DdrTiming::kBurstClocks + (t.mobile ? 0u : 1u - t.WL()); }},
    DdrRule{Level::kRank, Cmd::kWr, Cmd::kRd,
            [](T t) { return t.WL() + DdrTiming::kBurstClocks + t.nWTR; }},
    DdrRule{
        Level::kBank, Cmd::kRd, Cmd::kPre,
        [](T t) { return DdrTiming::kBurstClocks + (t.mobile ? 0u : std::max(t.nRTP, 2u) - 2); }},
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
    for (std::size_t i = 0; i < kDdrRules.size(); ++i) clocks_[i] = kDdrRules[i].clocks(timing);
  }
  const DdrTiming& timing() const { return timing_; }
  std::uint32_t row(unsigned bank) const { return banks_[bank].row; }
  bool all_closed() const { return open_ == 0; }
  /// What a request to another row than the bank's needs first.
  Cmd preparation(unsigned bank) const { return row(bank) == kClosed ? Cmd::kAct : Cmd::kPre; }

  /// First clock at which the command to this bank is legal.
  std::uint64_t earliest(Cmd cmd, unsigned bank) const {
    const auto c = static_cast<std::size_t>(cmd);
    return std::max(rank_[c], banks_[bank].next[c]);
  }
  /// PREA needs PRE to be legal in every open bank.
  std::uint64_t earliest_pre_all() const {
    std::uint64_t e = rank_[static_cast<std::size_t>(Cmd::kPre)];
    for (const Bank& b : banks_)
      if (b.row != kClosed) e = std::max(e, b.next[static_cast<std::size_t>(Cmd::kPre)]);
    return e;
  }
  std::uint64_t earliest_refresh() const { return rank_[static_cast<std::size_t>(Cmd::kRef)]; }

  template <Cmd kCmd>
  void issue(unsigned bank, std::uint32_t row, std::uint64_t clock) {
    start_rules<kCmd>(bank, clock, std::make_index_sequence<kDdrRules.size()>());
    if constexpr (kCmd == Cmd::kAct) {
      banks_[bank].row = row;
      banks_[bank].opened = clock;
      if (open_ == 0) open_since_ = std::max(open_since_, clock);
      open_ |= 1u << bank;
    } else if constexpr (kCmd == Cmd::kPre) {
      close(bank, clock);
    } else if constexpr (kCmd == Cmd::kPreAll) {
      for (auto& b : banks_) b.row = kClosed;
      last_close_ = std::max(last_close_, clock);
      if (open_ != 0) all_closed_at(last_close_);
      open_ = 0;
    }
  }

  /// First clock at which CKE may fall, the last burst's data being over: after a RD at c that is
  /// c + CL + BL/2 + 1, after a WR c + WL + BL/2 + tWTR. Both follow from what they put off
  /// already.
  std::uint64_t quiet() const {
    const std::uint64_t write = rank_[static_cast<std::size_t>(Cmd::kWr)];
    return std::max(rank_[static_cast<std::size_t>(Cmd::kRd)], write ? write + timing_.WL() : 0);
  }
  void put_off_reads(std::uint64_t until) {
    auto& slot = rank_[static_cast<std::size_t>(Cmd::kRd)];
    slot = std::max(slot, until);
  }
  /// The row closes by itself, as soon as a PRE would be legal.
  void close_when_legal(unsigned bank) {
    const std::uint64_t at = banks_[bank].next[static_cast<std::size_t>(Cmd::kPre)];
    start_rules<Cmd::kPre>(bank, at, std::make_index_sequence<kDdrRules.size()>());
    close(bank, at);
  }
  /// Clock of the ACT of a bank's open row.
  std::uint64_t opened(unsigned bank) const { return banks_[bank].opened; }
  /// Clocks with a row open before `until`, since this was asked last.
  std::uint64_t take_open_clocks(std::uint64_t until) {
    if (open_ != 0 && until > open_since_) {
      open_clocks_ += until - open_since_;
      open_since_ = until;
    }
    // A row that closes by itself was counted to its end when that was known.
    const std::uint64_t ahead =
        std::min(open_clocks_, counted_to_ > until ? counted_to_ - until : 0);
    return std::exchange(open_clocks_, ahead) - ahead;
  }

 private:
  struct alignas(64) Bank {
    std::array<std::uint64_t, kCmdCount> next{};
    std::uint64_t opened = 0;
    std::uint32_t row = kClosed;
  };
  void close(unsigned bank, std::uint64_t clock) {
    banks_[bank].row = kClosed;
    last_close_ = std::max(last_close_, clock);
    if (open_ == 1u << bank) all_closed_at(last_close_);
    open_ &= ~(1u << bank);
  }
  /// A row that closes by itself may do so after another PRE or the next ACT: open_since_ then lies
  /// ahead of that.
  void all_closed_at(std::uint64_t clock) {
    if (clock <= open_since_) return;
    open_clocks_ += clock - open_since_;
    open_since_ = counted_to_ = clock;
  }
  template <Cmd kCmd, std::size_t... kRule>
  void start_rules(unsigned bank, std::uint64_t clock, std::index_sequence<kRule...>) {
    (start_rule<kCmd, kRule>(bank, clock), ...);
  }
  template <Cmd kCmd, std::size_t kRule>
  void start_rule(unsigned bank, std::uint64_t clock) {
    if constexpr (kDdrRules[kRule].from == kCmd) {
      constexpr bool kRank = kDdrRules[kRule].level == Level::kRank;
      constexpr Cmd kTo = kDdrRules[kRule].to;
      auto& slot = (kRank ? rank_ : banks_[bank].next)[static_cast<std::size_t>(kTo)];
      const std::uint64_t legal = clock + clocks_[kRule];
      // The command itself was legal now, so what it puts off for its own kind lies ahead.
      slot = kTo == kCmd ? legal : std::max(slot, legal);
    }
  }

  DdrTiming timing_;
  std::array<std::uint32_t, kDdrRules.size()> clocks_{};  // each rule's number in effect
  std::uint32_t open_ = 0;                                // banks with an open row
  std::uint64_t open_clocks_ = 0, open_since_ = 0;        // with any row open: counted up to here
  std::uint64_t last_close_ = 0, counted_to_ = 0;
  std::array<Bank, kMaxBanks> banks_{};
  std::array<std::uint64_t, kCmdCount> rank_{};
};

}  // namespace fovea::mem
