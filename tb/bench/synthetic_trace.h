// Requests without a file, for the speed of the player and the path.
#pragma once
#include <string>
#include <vector>

#include "model/trace/core/trace.h"

namespace fovea::app {

/// What the masters ask for. Sequential: each reads on through a megabyte of its own; all megabytes
/// begin in one bank, so that several masters close each other's rows with every request. Apart: the
/// same with a page between them, so that each is in a bank of its own and the memory has as much to do
/// as for one. Random: three reads to a write, anywhere in 64 MiB.
enum class Pattern { kSequential, kApart, kRandom };

/// `count` requests of 32 bytes in all, as fast as windows of 8 reads and 8 writes let them go.
class SyntheticTrace final : public trace::RecordSource {
 public:
  SyntheticTrace(unsigned masters, std::uint64_t count, Pattern pattern) : pattern_(pattern) {
    for (unsigned m = 0; m < masters; ++m) {
      info.streams.emplace_back();
      info.masters.push_back(
          {port(m), std::string(kMasterNames[index(port(m))]), m, 8, 8, false});
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
    const std::uint64_t page = pattern_ == Pattern::kApart ? stream * 2048u : 0;
    r.write = random && seed >> 30 == 0;
    r.address = random ? (seed >> 8 & 0x1F'FFFFu) * 32u
                       : stream << 20 | static_cast<std::uint32_t>((n * 32 + page) & 0xF'FFFFu);
    return true;
  }
  trace::TraceInfo info;

 private:
  /// Behind the core's: those of 64 bits.
  static Master port(unsigned n) { return static_cast<Master>(index(Master::kEdmaTc0Read) + n); }
  Pattern pattern_;
  std::vector<std::uint64_t> left_;
  std::vector<std::uint32_t> seeds_;
};

}  // namespace fovea::app
