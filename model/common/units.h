// Time and frequency as every block uses them.
#pragma once
#include <cstdint>
#include <numeric>
#include <ostream>

namespace fovea {

/// Simulated times and durations in picoseconds; times count from the start of the simulation.
using Picoseconds = std::uint64_t;
inline constexpr Picoseconds kNever = ~Picoseconds{0};
inline constexpr Picoseconds kPsPerNs = 1'000;
inline constexpr Picoseconds kPsPerUs = 1'000'000;
inline constexpr Picoseconds kPsPerMs = 1'000'000'000;
inline constexpr Picoseconds kPsPerSecond = 1'000'000'000'000;

/// A rational frequency num/den in Hz. num == 0 means the clock is stopped.
struct Frequency {
  std::uint64_t num = 0;
  std::uint64_t den = 1;

  constexpr Frequency() = default;
  constexpr Frequency(std::uint64_t n, std::uint64_t d = 1) : num(n), den(d) {
    const std::uint64_t g = n ? std::gcd(n, d) : 1;
    num /= g;
    den = n ? den / g : 1;
  }
  constexpr bool stopped() const { return num == 0; }
  constexpr double hertz() const { return static_cast<double>(num) / static_cast<double>(den); }
  constexpr Frequency operator*(std::uint64_t k) const { return {num * k, den}; }
  constexpr Frequency operator/(std::uint64_t k) const { return {num, den * k}; }
  /// A frequency that a user writes in whole hertz may stand for a true one up to 1 Hz away
  /// (166666667Hz for a period of 6 ns). Limits are therefore compared with 1 Hz of tolerance in
  /// the user's favour.
  constexpr Frequency less_1_hertz() const { return num > den ? Frequency(num - den, den) : *this; }
  constexpr Frequency plus_1_hertz() const { return stopped() ? *this : Frequency(num + den, den); }
  friend constexpr bool operator==(const Frequency&, const Frequency&) = default;
  friend std::ostream& operator<<(std::ostream& os, const Frequency& f) {
    return os << f.num << "/" << f.den << " Hz";
  }
};

}  // namespace fovea
