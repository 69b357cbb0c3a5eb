// Clock edges of a rational frequency, without accumulated rounding.
#pragma once
#include <algorithm>
#include <cstdint>

#include "model/common/units.h"

namespace fovea {

/// Numbers the edges of a clock. Edge k is at floor((k - k0) * 10^12 * den / num) ps after the last
/// start, so rounding errors never accumulate. A change of frequency restarts the clock: the edge
/// that would have come next moves to the time of the change, and the numbering continues from
/// there.
///
/// Frequencies with small terms (all of the chip's) are converted by an exact multiplication, for
/// hours of simulated time after the last start; other frequencies and later times by a division.
class Clock {
 public:
  Clock() = default;
  explicit Clock(Frequency f, Picoseconds start = 0) { restart(f, start); }

  void restart(Frequency f, Picoseconds at) {
    if (running()) k0_ = edge_at_or_after(at);
    start_ = at;
    frequency_ = f;
    if (f.stopped()) {
      ps_ = edges_ = edges_limit_ = ps_limit_ = 0;
      return;
    }
    const std::uint64_t g = std::gcd(kPsPerSecond, f.num);
    ps_ = kPsPerSecond / g * f.den;
    edges_ = f.num / g;
    const std::uint64_t h = std::gcd(ps_, edges_);
    ps_ /= h;
    edges_ /= h;
    prepare();
  }

  bool running() const { return edges_ != 0; }
  Frequency frequency() const { return frequency_; }
  Picoseconds start() const { return start_; }

  /// Time of edge k in ps; k must not be below the index of the last restart.
  [[gnu::always_inline]] Picoseconds edge(std::uint64_t k) const {
    const std::uint64_t n = k - k0_;
    if (n > edges_limit_) [[unlikely]] return start_ + scale(n, ps_, edges_, 0);
    return start_ + n * period_ + static_cast<std::uint64_t>((Wide{n} * fraction_) >> 64);
  }
  /// Index of the first edge at or after t.
  [[gnu::always_inline]] std::uint64_t edge_at_or_after(Picoseconds t) const {
    if (t <= start_) return k0_;
    // smallest k with floor(k*ps/edges) >= d  <=>  k*ps >= d*edges
    const std::uint64_t d = t - start_;
    if (d > ps_limit_) [[unlikely]] return k0_ + scale(d, edges_, ps_, ps_ - 1);
    return k0_ + (static_cast<std::uint64_t>((Wide{d} * rate_ + round_up_) >> 64) >> rate_shift_);
  }
  /// Index of the first edge strictly after t.
  [[gnu::always_inline]] std::uint64_t edge_after(Picoseconds t) const {
    return t < start_ ? k0_ : edge_at_or_after(t + 1);
  }
  Picoseconds next_edge_after(Picoseconds t) const { return edge(edge_after(t)); }
  Picoseconds next_edge_at_or_after(Picoseconds t) const { return edge(edge_at_or_after(t)); }
  /// Duration of n periods counted from edge 0, rounded down. For reports, not for scheduling.
  Picoseconds periods(std::uint64_t n) const { return scale(n, ps_, edges_, 0); }

 private:
  using Wide = unsigned __int128;

  /// (n * mul + add) / div, with an intermediate result of 128 bits.
  [[gnu::noinline]] static std::uint64_t scale(std::uint64_t n, std::uint64_t mul,
                                               std::uint64_t div, std::uint64_t add) {
    if (div == 0) return 0;  // a stopped clock stays at its last edge
    return static_cast<std::uint64_t>((Wide{n} * mul + add) / div);
  }

  /// Computes the fixed-point factors of both directions. Exact results are multiples of 1/edges_
  /// and of 1/ps_, so an error of less than half of that never changes the whole part of a result.
  void prepare() {
    edges_limit_ = ps_limit_ = 0;  // 0: use the division
    if (ps_ > (1u << 21) || edges_ > (1u << 10)) return;
    const auto log2 = [](std::uint64_t v) {
      return 63u - static_cast<unsigned>(__builtin_clzll(v));
    };
    // For edge(): the whole picoseconds of a period, and the remainder * 2^64 rounded up, which
    // makes n periods too long by less than n / 2^64.
    period_ = ps_ / edges_;
    fraction_ = static_cast<std::uint64_t>(((Wide{ps_ % edges_} << 64) + edges_ - 1) / edges_);
    edges_limit_ = std::uint64_t{1} << (63 - log2(ps_) - 1);
    // For edge_at_or_after(): edges per ps * 2^(64 + r), rounded down, which makes d picoseconds
    // too few edges by less than d / 2^(64 + r). Rounding up adds 1 - 1/(2 ps_).
    if (edges_ >= ps_) return;
    unsigned r = log2(ps_ / edges_);
    if (edges_ << r == ps_) --r;  // otherwise the rate would need one more bit
    rate_shift_ = r;
    rate_ = static_cast<std::uint64_t>((Wide{edges_} << 64 << r) / ps_);
    const Wide one = Wide{1} << 64 << r;
    round_up_ = one - one / (2 * ps_);
    ps_limit_ = std::uint64_t{1} << (61 + r - log2(ps_));
  }

  Frequency frequency_;
  Picoseconds start_ = 0;
  std::uint64_t k0_ = 0;
  std::uint64_t ps_ = 0;     // ps_ picoseconds are exactly edges_ periods
  std::uint64_t edges_ = 0;  // 0 while the clock is stopped
  std::uint64_t period_ = 0, fraction_ = 0, edges_limit_ = 0;
  std::uint64_t rate_ = 0, ps_limit_ = 0;
  Wide round_up_ = 0;
  unsigned rate_shift_ = 0;
};

}  // namespace fovea
