// The last data accesses of the core, for messages about a guest failure.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace fovea::cpu {

struct AccessRecord {
  std::uint32_t pc = 0, address = 0;
  std::uint8_t bytes = 0;
  bool write = false;
};

class AccessLog {
 public:
  static constexpr std::uint32_t kWritten = 1u << 8;
  static constexpr unsigned kMoreWords = 16;  // lowest bit of the number of further words

  /// @param what bytes | kWritten | number of further words << kMoreWords
  void note(std::uint32_t pc, std::uint32_t va, std::uint32_t what) {
    auto* const e = reinterpret_cast<Entry*>(reinterpret_cast<char*>(ring_.data()) + at_);
    at_ = static_cast<std::uint8_t>(at_ + sizeof(Entry));
    e->pc = pc;
    e->address = va;
    e->what = what;
  }
  /// The newest ones, oldest first; each word of a block is one.
  std::vector<AccessRecord> newest() const {
    constexpr std::size_t kShown = 8;
    std::vector<AccessRecord> out;
    const std::size_t first = at_ / sizeof(Entry);  // the oldest access
    for (std::size_t n = first; n < first + ring_.size(); ++n) {
      const Entry& e = ring_[n % ring_.size()];
      for (std::uint32_t k = 0; e.what && k <= e.what >> kMoreWords; ++k)
        out.push_back({e.pc, e.address + 4 * k, static_cast<std::uint8_t>(e.what),
                       (e.what & kWritten) != 0});
    }
    if (out.size() > kShown) out.erase(out.begin(), out.end() - kShown);
    return out;
  }

 private:
  struct alignas(16) Entry {
    std::uint32_t pc = 0, address = 0;
    std::uint32_t what = 0;  // 0: no access yet
    std::uint32_t unused = 0;
  };
  std::uint8_t at_ = 0;  // offset of the next entry in bytes; wraps at the size of the ring
  std::array<Entry, 16> ring_{};
};

}  // namespace fovea::cpu
