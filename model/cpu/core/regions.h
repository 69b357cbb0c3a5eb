// Named ranges of physical addresses, to say where stalls come from.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace fovea::cpu {

/// Addresses in no range are `other`; what has no address is `none`.
class RegionMap {
 public:
  static constexpr std::uint8_t kNone = 0, kOther = 1;
  /// `none`, `other`, and those that have ranges.
  static constexpr std::size_t kMax = 2 + 16;

  /// The range belongs to `name` from here on, whatever lay there before. A name may have several
  /// ranges. False, and nothing changed: that would be a name too many.
  bool add(std::string_view name, std::uint64_t first, std::uint64_t bytes) {
    const auto known = std::find(names_.begin(), names_.end(), name);
    if (known == names_.end() && names_.size() == kMax) return false;
    const auto id = static_cast<std::uint8_t>(known - names_.begin());
    if (known == names_.end()) names_.emplace_back(name);
    const std::uint64_t end = std::min(first + bytes, kEnd);
    if (first >= end) return true;
    std::vector<Piece> pieces;
    const std::uint8_t behind = at(end);
    for (const Piece& p : pieces_)
      if (p.first < first) pieces.push_back(p);
    pieces.push_back({first, id});
    if (end < kEnd) pieces.push_back({end, behind});
    for (const Piece& p : pieces_)
      if (p.first > end) pieces.push_back(p);
    pieces_ = std::move(pieces);
    blocks_.assign(blocks_.size(), kUnknown);
    return true;
  }
  std::uint8_t find(std::uint32_t address) const {
    const std::uint8_t known = blocks_[address >> kBlockBits];
    return known < kMax ? known : find_slow(address);
  }
  /// Numbers are places in here.
  const std::vector<std::string>& names() const { return names_; }

 private:
  static constexpr std::uint64_t kEnd = std::uint64_t{1} << 32;
  struct Piece {
    std::uint64_t first;  // up to the next one's
    std::uint8_t id;
  };
  std::uint8_t at(std::uint64_t address) const {
    std::size_t low = 0, count = pieces_.size();
    while (count > 1) {
      const std::size_t half = count / 2;
      if (pieces_[low + half].first <= address) low += half;
      count -= half;
    }
    return pieces_[low].id;
  }

  [[gnu::noinline]] std::uint8_t find_slow(std::uint32_t address) const {
    std::uint8_t& block = blocks_[address >> kBlockBits];
    if (block == kUnknown) {
      const std::uint64_t first = address >> kBlockBits << kBlockBits;
      const std::uint64_t end = first + (std::uint64_t{1} << kBlockBits);
      const bool cut = std::any_of(pieces_.begin(), pieces_.end(), [&](const Piece& p) {
        return p.first > first && p.first < end;
      });
      block = cut ? kSeveral : at(first);
    }
    return at(address);
  }

  /// Which region a block of addresses lies in as a whole, noted when somebody asks.
  static constexpr unsigned kBlockBits = 12;  // linkers align large objects to pages
  static constexpr std::uint8_t kSeveral = 0xFE, kUnknown = 0xFF;
  mutable std::vector<std::uint8_t> blocks_ =
      std::vector<std::uint8_t>(std::size_t{1} << (32 - kBlockBits), kUnknown);

  std::vector<std::string> names_ = {"none", "other"};
  std::vector<Piece> pieces_ = {{0, kOther}};
};

}  // namespace fovea::cpu
