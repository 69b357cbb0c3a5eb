// Histograms of latencies, cheap enough to be kept for every request.
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "model/common/slow_request.h"
#include "model/common/units.h"

namespace fovea::bus {

/// Log-linear: 256 bins per factor of two (relative error below 0.4 %). Count, sum, minimum and
/// maximum are exact.
class LatencyHistogram {
 public:
  [[gnu::always_inline]] void add(Picoseconds t) {
    if (t >= limit_) [[unlikely]]
      grow(t);
    ++bins_[bin_of(t)];
    sum_ += t;
    max_ = std::max(max_, t);
    min_ = std::min(min_, t);
  }
  void add(const LatencyHistogram& other) {
    if (other.bins_.size() > bins_.size()) resize(other.bins_.size());
    for (std::size_t i = 0; i < other.bins_.size(); ++i) bins_[i] += other.bins_[i];
    sum_ += other.sum_;
    max_ = std::max(max_, other.max_);
    min_ = std::min(min_, other.min_);
  }
  void reset() { *this = LatencyHistogram(); }

  std::uint64_t count() const {
    std::uint64_t n = 0;
    for (const std::uint64_t b : bins_) n += b;
    return n;
  }
  Picoseconds min() const { return min_ == kNever ? 0 : min_; }
  Picoseconds max() const { return max_; }
  /// In ps; 0 if empty.
  double mean() const {
    const std::uint64_t n = count();
    return n ? static_cast<double>(sum_) / static_cast<double>(n) : 0;
  }
  /// Last picosecond of the bin that holds the q-quantile (0 < q <= 1), but at most max(). 0 if empty.
  Picoseconds quantile(double q) const {
    const auto rank = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(count())));
    std::uint64_t seen = 0;
    for (std::size_t b = 0; b < bins_.size(); ++b) {
      seen += bins_[b];
      if (seen >= rank && seen > 0) return std::min(low_of(b + 1) - 1, max_);
    }
    return max_;
  }
  /// Calls f(low, high, count) for each bin that is not empty, in order: latencies t with
  /// low <= t < high. 16 bins per factor of two, enough to draw them.
  template <class F>
  void each_bin(F f) const {
    constexpr std::size_t kTogether = 16;
    for (std::size_t b = 0; b < bins_.size(); b += kTogether) {
      std::uint64_t n = 0;
      for (std::size_t i = b; i < std::min(b + kTogether, bins_.size()); ++i) n += bins_[i];
      if (n) f(low_of(b), low_of(b + kTogether), n);
    }
  }

 private:
  static constexpr unsigned kSubBits = 8;
  static std::size_t bin_of(Picoseconds t) {
    const auto exponent = static_cast<unsigned>(std::bit_width(t | ((2u << kSubBits) - 1))) - 1 - kSubBits;
    return (std::size_t{exponent} << kSubBits) + (t >> exponent);
  }
  static Picoseconds low_of(std::size_t bin) {
    constexpr std::size_t kSub = std::size_t{1} << kSubBits;
    if (bin < 2 * kSub) return bin;
    return static_cast<Picoseconds>((bin & (kSub - 1)) + kSub) << ((bin >> kSubBits) - 1);
  }
  [[gnu::noinline]] void grow(Picoseconds t) { resize(std::max(bin_of(t) + 1, 2 * bins_.size())); }
  void resize(std::size_t bins) {
    bins_.resize(bins);
    limit_ = low_of(bins);
  }

  std::vector<std::uint64_t> bins_;
  Picoseconds limit_ = 0;  // latencies below it have a bin
  Picoseconds sum_ = 0, max_ = 0, min_ = kNever;
};

/// Latencies of the SDRAM requests of one port and direction, from the request on the master's port.
/// Read: to its first and its last beat at the port. Write: until the crossbar takes the first beat
/// of its data, and to its acknowledgement at the port, behind the last beat.
struct BeatLatencies {
  LatencyHistogram first, last;
};
struct PortLatencies {
  BeatLatencies read, write;
  SlowRequest slowest_read, slowest_write;  ///< the earliest of the slowest: to its first beat; to its last
};

}  // namespace fovea::bus
