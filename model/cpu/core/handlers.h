// Execution of decoded instructions ("records"): each handler executes one record and calls the
// next record's handler by a tail call, so that a chain of records runs without a loop around it. A
// handler makes no other calls in between: slow cases are tail calls too, so that handlers need no
// stack frame.
//
// Within a chain, the clock is a parameter (kept in a host register); the ledger's clock, the pc
// and the counters keep their values from the start of the chain until settle(). A handler that
// calls a function out of line and then continues must not have a variable whose address is taken:
// the compiler would keep its frame, and the stack would grow with the chain (checked by
// iss.chain). A chain begins when nothing is under way that could delay a record (operands, an
// instruction fill). It ends at chain_.stop, at a record or line that is not known yet, and after
// an instruction that may have called the outside if that requires attention.
#pragma once
#include <utility>

#include "model/cpu/core/conditions.h"
#include "model/cpu/core/core.h"
#include "model/cpu/core/shifter.h"

namespace fovea::cpu {

/// How the address of a load or store is formed from the base register and an offset.
enum class Address : std::uint8_t { kImm, kRegUp, kRegDown, kLsl };
enum class Indexed : std::uint8_t { kOffset, kPre, kPost };

/// Returns f(integral_constant<k>) for the constant k that equals n; all results of f have one
/// type.
template <class F, std::size_t... k>
auto select(unsigned n, F f, std::index_sequence<k...>) {
  decltype(f(std::integral_constant<std::size_t, 0>{})) out{};
  ((n == k ? void(out = f(std::integral_constant<std::size_t, k>{})) : void()), ...);
  return out;
}

struct Core::Ops {
  using Next = const Instruction*;
  using Cycle = std::uint64_t;
  using Context = RecordContext;
  using Hint = DataCache::Hint;
  static constexpr unsigned kReadSpan = DataCache::kReadSpan, kWriteSpan = DataCache::kWriteSpan,
                            kHints = DataCache::kHints;
  static constexpr Cycle kNever = ~Cycle{0};

  [[gnu::always_inline]] static Next go(Core& c, Next i, Cycle cycle) {
#if defined(FOVEA_TAIL_CALLS)
    return i->handler(c, i, cycle);
#else
    c.chain_.cycle = cycle;
    return i;
#endif
  }
  /// Continues with record i at an instruction boundary.
  [[gnu::always_inline]] static Next next(Core& c, Next i, Cycle cycle) {
    // Without this, compilers compute both from the old values again in each of the two tail calls
    // and move them there, instead of changing the registers that they already are in.
    asm("" : "+r"(i), "+r"(cycle));
    if (cycle >= c.chain_.stop) [[unlikely]] return leave(c, i, cycle);
    return go(c, i, cycle);
  }
  /// Ends the chain before record i.
  [[gnu::noinline]] static Next leave(Core& c, Next i, Cycle cycle) {
    c.settle(i, cycle);
    c.ends_before(i);
    return nullptr;
  }
  /// Ends the chain after the taken branch i.
  [[gnu::noinline]] static Next leave_to(Core& c, Next i, Cycle cycle, std::uint32_t target) {
    c.settle(i + 1, cycle);
    c.failure_.jumped_from = c.chain_.va + i->at;
    c.failure_.jumped_to = target;
    c.regs_.pc = target;
    return nullptr;
  }
  /// Executes record i with settled state, for everything that is rare or calls the outside.
  [[gnu::noinline]] static Next generic(Core& c, Next i, Cycle cycle) {
    c.settle(i, cycle);
    if (c.profile_) [[unlikely]]
      c.execute_one_counted(*i);
    else
      c.execute_one(*i);
    return resume(c, i + 1);
  }
  /// An UNPREDICTABLE form: gives a warning, then executes a separate record of it.
  [[gnu::noinline]] static Next warned(Core& c, Next i, Cycle cycle);
  /// Continues with record i after the previous one was executed with settled state.
  [[gnu::always_inline]] static Next resume(Core& c, Next i) {
    return c.chain_goes_on(i) ? resume_here(c, i) : nullptr;
  }
  [[gnu::always_inline]] static Next resume_here(Core& c, Next i) {
    c.chain_.first = reinterpret_cast<std::intptr_t>(i);
    // After the last record of a line, line_end() handles results that are not available yet.
    if (c.ledger_.cycle < c.scoreboard_.latest && i->at < 32) {
      const Cycle start = held_until(c, i, c.ledger_.cycle);
      if (start == kNever) return nullptr;
      Cycle cycle = c.ledger_.cycle;
      c.starts_at(i);
      if (start > cycle) {
        if (c.profile_) [[unlikely]]
          stall<true>(c, i, cycle, start);
        else
          stall<false>(c, i, cycle, start);
      }
      return go(c, i, cycle);
    }
    c.starts_at(i);
    return go(c, i, c.ledger_.cycle);
  }
  /// For records that do not know which instruction precedes them: the clock at which the operands
  /// of the first one are available. kNever: it has to be executed on its own.
  static Cycle held_until(const Core& c, Next i, Cycle cycle);
  /// @param late registers that may not be available at `cycle`
  static Cycle held(const Core& c, Next i, Cycle cycle, std::uint32_t late);

  /// Distance of the record of an address from the first byte of its decoded line, in host memory.
  template <bool kThumb>
  static constexpr std::uint32_t record_offset(std::uint32_t target) {
    return static_cast<std::uint32_t>(offsetof(DecodedLine, records) +
                                      target % 32 / (kThumb ? 2 : 4) * sizeof(Instruction));
  }
  /// Continues at the target of the taken branch i, without a change of state (ARM or Thumb).
  template <bool kThumb, bool kMaybeSameLine, bool kCounted>
  [[gnu::always_inline]] static Next jump(Core& c, Next i, Cycle cycle, std::uint32_t target) {
    return jump<kThumb, kMaybeSameLine, kCounted>(c, i, cycle, target,
                                                  record_offset<kThumb>(target));
  }
  template <bool kThumb, bool kMaybeSameLine, bool kCounted>
  [[gnu::always_inline]] static Next jump(Core& c, Next i, Cycle cycle, std::uint32_t target,
                                          std::uint32_t offset) {
    ++c.ledger_.counts.redirects;
    if (cycle >= c.chain_.stop) [[unlikely]] return leave_to(c, i, cycle, target);
    DecodedLine* d = c.fetch_.jumps[target / 32 % FetchUnit::kJumps];
    if (d->valid != (c.fetch_.epoch | (target & ~31u) | kThumb)) [[unlikely]]
      return leave_to(c, i, cycle, target);
    const auto to = reinterpret_cast<Next>(reinterpret_cast<const char*>(d) + offset);
    if (!to->body) [[unlikely]] return leave_to(c, i, cycle, target);
    if (!kMaybeSameLine || c.chain_.va != (target & ~31u)) {
      c.chain_.va = target & ~31u;
      c.fetch_.current = d;
    }
    c.chain_.first += reinterpret_cast<std::intptr_t>(to) - reinterpret_cast<std::intptr_t>(i + 1);
    if constexpr (kCounted) ++d->tallies[target % 32 / 2].flow;
    return go(c, to, cycle);
  }
  /// Branches to an address whose bit 0 is the new Thumb state.
  template <bool kThumb, bool kCounted>
  [[gnu::always_inline]] static Next exchange(Core& c, Next i, Cycle cycle, std::uint32_t target) {
    if ((target & 1u) == kThumb) [[likely]]
      return jump<kThumb, true, kCounted>(c, i, cycle, target & (kThumb ? ~1u : ~3u));
    c.regs_.cpsr ^= 0x20u;
    ++c.ledger_.counts.redirects;
    return leave_to(c, i, cycle, target & (kThumb ? ~3u : ~1u));
  }

  template <unsigned kCond>
  [[gnu::always_inline]] static bool passes(const Core& c) {
    const RegisterFile& r = c.regs_;
    return condition_holds(kCond, r.n >> 31, r.z == 0, r.c != 0, r.v != 0);
  }

  /// @tparam kCounted record i is of the current line, whose tallies are kept
  template <bool kCounted>
  [[gnu::always_inline]] static void stall(Core& c, Next i, Cycle& cycle, Cycle until) {
    if constexpr (kCounted)
      c.fetch_.current->tally(*i).waited += static_cast<std::uint32_t>(until - cycle);
    c.ledger_.counts.stall[index(Cause::kInterlock)] += until - cycle;
    // settle() counts all clocks since the start of the chain as issue.
    c.ledger_.counts.issue -= until - cycle;
    cycle = until;
  }
  /// Runs before the body of a record that has a condition, may wait for operands, or reads r15.
  template <unsigned kCond, Context::Check kCheck, bool kPc, bool kCounted>
  static Next before(Core& c, Next i, Cycle cycle);
  template <std::size_t... k>
  static constexpr std::array<Handler, sizeof...(k)> before_table(std::index_sequence<k...>);

  /// Notes a result that becomes available only after the next record has started.
  [[gnu::always_inline]] static void track(Core& c, unsigned r, Cycle ready,
                                           Scoreboard::Producer by) {
    c.scoreboard_.ready_at(r, ready, by);
  }

  /// Pseudo record after the last one of a line: leads to the next line.
  template <bool kThumb, bool kCounted>
  static Next line_end(Core& c, Next i, Cycle cycle);
  template <bool kThumb, bool kCounted>
  static Next line_end_busy(Core& c, Next i, Cycle cycle, DecodedLine& d);
  template <bool kThumb, bool kCounted>
  static Next enter_line(Core& c, Next i, Cycle cycle, DecodedLine& d);

  template <Op kOp, Form kForm, bool kSet>
  static Next data(Core& c, Next i, Cycle cycle);
  static constexpr std::size_t kDataOps = 16;
  using DataRow = std::array<Handler, kDataOps>;
  template <Form kForm, bool kSet, std::size_t... op>
  static constexpr DataRow data_row(std::index_sequence<op...>);
  template <bool kSet, std::size_t... form>
  static constexpr std::array<DataRow, sizeof...(form)> data_rows(std::index_sequence<form...>);
  template <Op kOp, bool kSet>
  static Next multiply(Core& c, Next i, Cycle cycle);
  static Next count_zeros(Core& c, Next i, Cycle cycle);
  template <unsigned kCond, bool kLink, bool kThumb, bool kNear, bool kCounted>
  static Next branch(Core& c, Next i, Cycle cycle);
  template <bool kThumb>
  static Next branch_away(Core& c, Next i, Cycle cycle);
  template <bool kThumb, bool kLink, bool kCounted>
  static Next branch_exchange(Core& c, Next i, Cycle cycle);
  static Next thumb_link_prefix(Core& c, Next i, Cycle cycle);
  template <bool kCounted>
  static Next thumb_link_suffix(Core& c, Next i, Cycle cycle);
  template <Op kOp, Address kAddress, Indexed kIndexed, bool kTrack>
  static Next load(Core& c, Next i, Cycle cycle);
  template <Op kOp, Indexed kIndexed, bool kTrack>
  static Next load_line(Core& c, Next i, Cycle cycle, std::uint32_t va, std::uint32_t end,
                        unsigned cycles);
  static Next over(Core& c, Next i);
  template <Op kOp, Address kAddress, Indexed kIndexed>
  static Next store(Core& c, Next i, Cycle cycle);
  template <Op kOp, Address kAddress, Indexed kIndexed>
  static Next store_out(Core& c, Next i, Cycle cycle);
  static Next load_literal(Core& c, Next i, Cycle cycle);
  template <bool kPc, bool kThumb, bool kLong, bool kCounted>
  static Next load_block(Core& c, Next i, Cycle cycle);
  template <bool kLong>
  static Next store_block(Core& c, Next i, Cycle cycle);

  // Each returns the body of a record, or nullptr if there is no fast one. It may rewrite the
  // operands of the record for that body.
  static Handler data_body(Instruction& i);                  // data_processing.cpp
  static Handler multiply_body(Instruction& i);              // branch_multiply.cpp
  static Handler branch_body(Instruction& i, Context context);   // branch_multiply.cpp
  template <bool kCounted>
  static Handler branch_handler(Instruction& i, Context context);
  static Handler memory_body(Instruction& i, Context context);   // load_store.cpp
  static Handler block_body(Instruction& i, Context context);    // load_store.cpp
};

}  // namespace fovea::cpu
