// The main write buffer (16 words, 4 addresses) and the victim buffer (8 words, 1 address).
#pragma once
#include <array>
#include <cstdint>
#include <cstring>
#include <span>

namespace fovea::cpu {

/// Entries leave in order. An entry of several words is sent as bursts of eight words, then of
/// four, then as single words; no burst crosses a 1 KB boundary.
class WriteBuffer {
 public:
  static constexpr unsigned kAddresses = 4, kWords = 16;
  struct Entry {
    std::uint32_t address = 0;
    unsigned bytes = 0;  // 1, 2 or a multiple of 4
    unsigned sent = 0;
    std::uint64_t asked = 0;  // see BusAccess::asked
    std::array<std::uint8_t, 64> data{};
  };
  bool empty() const { return count_ == 0; }
  unsigned count() const { return count_; }
  bool room(unsigned bytes) const {
    return count_ < kAddresses && words_ + (bytes + 3) / 4 <= kWords;
  }
  void push(std::uint32_t address, const std::uint8_t* data, unsigned bytes,
            std::uint64_t asked) {
    std::memcpy(next(address, bytes, asked).data.data(), data, bytes);
  }
  /// The same for a word or less.
  void push(std::uint32_t address, std::uint32_t value, unsigned bytes, std::uint64_t asked) {
    std::memcpy(next(address, bytes, asked).data.data(), &value, 4);
  }
  Entry& front() { return entries_[head_]; }
  const Entry& front() const { return entries_[head_]; }
  /// Bytes of the next burst of an entry.
  static unsigned next_burst(const Entry& e) {
    const unsigned left = e.bytes - e.sent;
    if (left < 4) return left;
    const unsigned to_boundary = 1024 - ((e.address + e.sent) & 1023u);
    if (left >= 32 && to_boundary >= 32) return 32;
    if (left >= 16 && to_boundary >= 16) return 16;
    return 4;
  }
  /// To be called when a burst of this many bytes was acknowledged.
  void acknowledge(unsigned bytes) {
    words_ -= (bytes + 3) / 4;
    Entry& e = entries_[head_];
    e.sent += bytes;
    if (e.sent >= e.bytes) {
      head_ = (head_ + 1) % kAddresses;
      --count_;
    }
  }
  /// True if bytes [address, address + n) overlap a pending write.
  bool overlaps(std::uint32_t address, unsigned n) const {
    for (unsigned i = 0; i < count_; ++i) {
      const Entry& e = entries_[(head_ + i) % kAddresses];
      if (address < e.address + e.bytes && e.address < address + n) return true;
    }
    return victim_bytes && address < victim_address + victim_bytes &&
           victim_address < address + n;
  }

  /// The same without what was sent: that includes the next `taken` bytes of the front entry and, if
  /// not 0, the victim.
  bool overlaps(std::uint32_t address, unsigned n, unsigned taken, unsigned victim_taken) const {
    for (unsigned i = 0; i < count_; ++i) {
      const Entry& e = entries_[(head_ + i) % kAddresses];
      const unsigned gone = e.sent + (i == 0 ? taken : 0);
      if (address < e.address + e.bytes && e.address + gone < address + n) return true;
    }
    return victim_bytes && !victim_taken && address < victim_address + victim_bytes &&
           victim_address < address + n;
  }

  /// The byte at an address after all pending writes; false if none of them covers it.
  bool find(std::uint32_t address, std::uint8_t& byte) const {
    for (unsigned i = count_; i-- > 0;) {
      const Entry& e = entries_[(head_ + i) % kAddresses];
      if (address - e.address >= e.bytes) continue;
      byte = e.data[address - e.address];
      return true;
    }
    if (address - victim_address >= victim_bytes) return false;
    byte = victim[address - victim_address];
    return true;
  }

  /// Changes pending bytes from `address` on in place (a debugger's write).
  void patch(std::uint32_t address, std::span<const std::uint8_t> bytes) {
    for (std::size_t k = 0; k < bytes.size(); ++k) {
      const std::uint32_t at = address + static_cast<std::uint32_t>(k);
      for (unsigned i = 0; i < count_; ++i) {
        Entry& e = entries_[(head_ + i) % kAddresses];
        if (at - e.address < e.bytes) e.data[at - e.address] = bytes[k];
      }
      if (at - victim_address < victim_bytes) victim[at - victim_address] = bytes[k];
    }
  }

  std::uint32_t victim_address = 0;
  unsigned victim_bytes = 0;  // 0: empty
  std::uint64_t victim_asked = 0;
  std::array<std::uint8_t, 32> victim{};

 private:
  Entry& next(std::uint32_t address, unsigned bytes, std::uint64_t asked) {
    Entry& e = entries_[(head_ + count_++) % kAddresses];
    e.address = address;
    e.bytes = bytes;
    e.sent = 0;
    e.asked = asked;
    words_ += (bytes + 3) / 4;
    return e;
  }

  std::array<Entry, kAddresses> entries_{};
  unsigned head_ = 0, count_ = 0, words_ = 0;
};

}  // namespace fovea::cpu
