// Requests that are generated instead of read from a file, to measure player and memory path.
#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "model/trace/core/trace.h"

namespace fovea::app {

/// Addresses of the masters' requests. Sequential: each master reads through a megabyte of its own.
/// All megabytes begin in the same bank, so that several masters close each other's rows with every
/// request. Apart: the same with a page between the megabytes, so that up to eight masters use
/// different banks. Dealt: the requests of one stream are distributed over the masters in turn, so
/// that the memory's work does not depend on their number. Random: three reads per write, anywhere
/// in 64 MiB.
enum class Pattern { kSequential, kApart, kDealt, kRandom };

/// Default number of reads, and of writes, that a master may have outstanding.
inline constexpr unsigned kWindow = 8;

/// `count` requests of 32 bytes in total, issued as fast as a window of reads and up to 16 writes
/// per master allow.
class SyntheticTrace final : public trace::RecordSource {
 public:
  SyntheticTrace(unsigned masters, std::uint64_t count, Pattern pattern, unsigned window = kWindow)
      : pattern_(pattern), masters_(masters) {
    for (unsigned m = 0; m < masters; ++m) {
      info.streams.emplace_back();
      info.masters.push_back(
          {port(m), std::string(kMasterNames[index(port(m))]), m, window, std::min(window, 2 * kWindow), false});
      left_.push_back(count / masters);
      seeds_.push_back(m * 77 + 1);
    }
  }
  bool next(unsigned stream, trace::Record& r) override {
    if (left_[stream] == 0) return false;
    const std::uint64_t n = left_[stream]--;
    r = trace::Record{};
    r.master = port(stream);
    r.bytes = 32;
    std::uint32_t& seed = seeds_[stream];
    seed = seed * 1664525u + 1013904223u;
    const bool random = pattern_ == Pattern::kRandom;
    r.write = random && seed >> 30 == 0;
    if (random)
      r.address = (seed >> 8 & 0x1F'FFFFu) * 32u;
    else if (pattern_ == Pattern::kDealt)
      r.address = static_cast<std::uint32_t>(((n + 1) * masters_ - stream) * 32 & 0x3FF'FFFFu);
    else
      r.address = stream << 20 | static_cast<std::uint32_t>((n * 32 + page(stream)) & 0xF'FFFFu);
    return true;
  }
  trace::TraceInfo info;

 private:
  /// The 64-bit masters, which follow the core's.
  static Master port(unsigned n) { return wide_master(n); }
  std::uint64_t page(unsigned stream) const {
    return pattern_ == Pattern::kApart ? stream * 2048u : 0u;
  }
  Pattern pattern_;
  unsigned masters_;
  std::vector<std::uint64_t> left_;
  std::vector<std::uint32_t> seeds_;
};

}  // namespace fovea::app
