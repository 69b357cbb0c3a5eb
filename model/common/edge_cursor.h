// Conversions between edges and times that lie close together, as those of one memory request do.
#pragma once
#include "model/common/clock.h"

namespace fovea {

/// The same results as its Clock's. From a base edge, kept with its exact remainder, an edge within
/// reach is one product with a reciprocal and needs no correction: with r = floor(2^64 / d) + 1,
/// floor(n * r / 2^64) = floor(n / d) for all n < 2^64 / d. A question beyond the reach goes to the
/// Clock and moves the base there; one before the base goes to the Clock.
class EdgeCursor {
 public:
  /// To be called again after each restart of the clock, which must outlive the cursor.
  void follow(const Clock& clock) {
    clock_ = &clock;
    reach_ = reach_time_ = 0;
    if (!clock.running() || clock.edges_limit_ == 0 || clock.edges_ > clock.ps_) return;
    // Both terms doubled where the divisor would be 1, whose reciprocal has no place in 64 bits.
    const std::uint64_t scale = clock.edges_ == 1 || clock.ps_ == 1 ? 2 : 1;
    ps_ = clock.ps_ * scale;
    edges_ = clock.edges_ * scale;
    ps_reciprocal_ = kAll / ps_ + 1;
    edges_reciprocal_ = kAll / edges_ + 1;
    base(clock.k0_);
  }

  /// Clock::edge
  [[gnu::always_inline]] Picoseconds edge(std::uint64_t k) {
    const std::uint64_t n = k - k_;
    if (n >= reach_) [[unlikely]]
      return far_edge(k);
    return t_ + high(n * ps_ + rest_, edges_reciprocal_);
  }
  /// Clock::edge_at_or_after
  [[gnu::always_inline]] std::uint64_t edge_at_or_after(Picoseconds t) {
    const Picoseconds d = t - t_;
    if (d >= reach_time_) [[unlikely]]
      return far_edge_at_or_after(t);
    // smallest n with floor((n*ps + rest) / edges) >= d  <=>  n*ps + rest >= d*edges
    return k_ + high(d * edges_ + round_up_, ps_reciprocal_);
  }
  /// Clock::edge_after
  [[gnu::always_inline]] std::uint64_t edge_after(Picoseconds t) {
    const Picoseconds d = t + 1 - t_;
    if (d >= reach_time_) [[unlikely]]
      return far_edge_after(t);
    return k_ + high(d * edges_ + round_up_, ps_reciprocal_);
  }

 private:
  static constexpr std::uint64_t kAll = ~std::uint64_t{0};
  static std::uint64_t high(std::uint64_t n, std::uint64_t reciprocal) {
    return static_cast<std::uint64_t>(static_cast<unsigned __int128>(n) * reciprocal >> 64);
  }
  void base(std::uint64_t k) {
    k_ = k;
    t_ = clock_->edge(k);
    const std::uint64_t n = k - clock_->k0_;
    // The true remainder is small, so arithmetic modulo 2^64 finds it.
    rest_ = (n * clock_->ps_ - (t_ - clock_->start_) * clock_->edges_) * (edges_ / clock_->edges_);
    round_up_ = ps_ - 1 - rest_;
    reach_ = (kAll / edges_ - rest_) / ps_;
    reach_time_ = (kAll / ps_ - ps_) / edges_;
  }
  [[gnu::noinline]] Picoseconds far_edge(std::uint64_t k) {
    if (reach_ != 0 && k > k_) base(k);
    return clock_->edge(k);
  }
  [[gnu::noinline]] std::uint64_t far_edge_at_or_after(Picoseconds t) {
    const std::uint64_t k = clock_->edge_at_or_after(t);
    if (reach_ != 0 && k > k_) base(k - 1);
    return k;
  }
  [[gnu::noinline]] std::uint64_t far_edge_after(Picoseconds t) {
    const std::uint64_t k = clock_->edge_after(t);
    if (reach_ != 0 && k > k_) base(k - 1);
    return k;
  }

  const Clock* clock_ = nullptr;
  std::uint64_t k_ = 0, rest_ = 0, round_up_ = 0;  // base: its true time is t_ + rest_ / edges_
  Picoseconds t_ = 0;
  std::uint64_t ps_ = 0, edges_ = 0, ps_reciprocal_ = 0, edges_reciprocal_ = 0;
  std::uint64_t reach_ = 0;     // edges from the base; 0: the clock's terms are too large
  Picoseconds reach_time_ = 0;  // time from the base
};

}  // namespace fovea
