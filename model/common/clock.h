// Clock edges of a rational frequency, without accumulated rounding.
#pragma once
#include <cstdint>

#include "model/common/units.h"

namespace fovea {

/// Numbers the edges of a clock. Edge k is floor((k - k0) * 10^12 * den / num) ps after the last
/// start; periods are never added up. A frequency change restarts the clock: the edge that would
/// have come next comes at the time of the change, and numbering goes on.
/// Ratios with small terms (all of the chip's) use 64-bit arithmetic, valid for hours of simulated
/// time; others use 128 bits.
class Clock {
 public:
  Clock() = default;
  explicit Clock(Frequency f, Picoseconds start = 0) { restart(f, start); }

  void restart(Frequency f, Picoseconds at) {
    if (running()) k0_ = edge_at_or_after(at);
    start_ = at;
    frequency_ = f;
    if (f.stopped()) {
      ps_ = edges_ = 0;
      return;
    }
    const std::uint64_t g = std::gcd(kPsPerSecond, f.num);
    ps_ = kPsPerSecond / g * f.den;
    edges_ = f.num / g;
    const std::uint64_t h = std::gcd(ps_, edges_);
    ps_ /= h;
    edges_ /= h;
    ps_reciprocal_ = ~std::uint64_t{0} / ps_;
    edges_reciprocal_ = ~std::uint64_t{0} / edges_;
    wide_ = ps_ > (1u << 21) || edges_ > (1u << 10);
  }

  bool running() const { return edges_ != 0; }
  Frequency frequency() const { return frequency_; }
  Picoseconds start() const { return start_; }

  /// Time of edge k (k >= the index at the last restart).
  [[gnu::always_inline]] Picoseconds edge(std::uint64_t k) const {
    return start_ + scale(k - k0_, ps_, edges_, edges_reciprocal_, 0);
  }
  /// Index of the first edge at or after t.
  [[gnu::always_inline]] std::uint64_t edge_at_or_after(Picoseconds t) const {
    if (t <= start_) return k0_;
    // smallest k with floor(k*ps/edges) >= d  <=>  k*ps >= d*edges
    return k0_ + scale(t - start_, edges_, ps_, ps_reciprocal_, ps_ - 1);
  }
  /// Index of the first edge strictly after t.
  [[gnu::always_inline]] std::uint64_t edge_after(Picoseconds t) const {
    return t < start_ ? k0_ : edge_at_or_after(t + 1);
  }
  Picoseconds next_edge_after(Picoseconds t) const { return edge(edge_after(t)); }
  Picoseconds next_edge_at_or_after(Picoseconds t) const { return edge(edge_at_or_after(t)); }
  /// Duration of n periods from edge 0, rounded down; for reports, not for scheduling.
  Picoseconds periods(std::uint64_t n) const { return scale(n, ps_, edges_, edges_reciprocal_, 0); }

 private:
  friend class EdgeCursor;
  /// (n * mul + add) / div, exactly; reciprocal is (2^64 - 1) / div. A division instruction here
  /// took half of the memory path's host time; the product with the reciprocal is at most 2 short.
  [[gnu::always_inline]] std::uint64_t scale(std::uint64_t n, std::uint64_t mul,
                                             std::uint64_t div, std::uint64_t reciprocal,
                                             std::uint64_t add) const {
    if (wide_) [[unlikely]] return scale_wide(n, mul, div, add);
    const std::uint64_t product = n * mul + add;
    auto quotient =
        static_cast<std::uint64_t>(static_cast<unsigned __int128>(product) * reciprocal >> 64);
    // Two conditional additions rather than a loop: no branch to mispredict.
    std::uint64_t rest = product - quotient * div;
    quotient += rest >= div;
    rest -= rest >= div ? div : 0;
    return quotient + (rest >= div);
  }
  [[gnu::noinline]] static std::uint64_t scale_wide(std::uint64_t n, std::uint64_t mul,
                                                    std::uint64_t div, std::uint64_t add) {
    return static_cast<std::uint64_t>((static_cast<unsigned __int128>(n) * mul + add) / div);
  }

  Frequency frequency_;
  bool wide_ = false;
  Picoseconds start_ = 0;
  std::uint64_t k0_ = 0;
  std::uint64_t ps_ = 0;     // ps_ picoseconds hold exactly edges_ periods
  std::uint64_t edges_ = 0;  // 0: stopped
  std::uint64_t ps_reciprocal_ = 0, edges_reciprocal_ = 0;
};

}  // namespace fovea
