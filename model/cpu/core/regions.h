// Named ranges of physical addresses, to say where stalls come from.
#pragma once
#include <algorithm>
#include <array>
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
    found_ = {};
    return true;
  }
  [[gnu::always_inline]] std::uint8_t find(std::uint32_t address) const {
    const Found& f = found_[address / 0x10'0000 % found_.size()];
    if (address - f.first >= f.bytes) [[unlikely]]
      return find_anew(address);
    return f.id;
  }
  /// Numbers are places in here.
  const std::vector<std::string>& names() const { return names_; }

 private:
  static constexpr std::uint64_t kEnd = std::uint64_t{1} << 32;
  struct Piece {
    std::uint64_t first;  // up to the next one's
    std::uint8_t id;
  };
  /// Found last, by megabyte: the core's streams of accesses stay in their ranges.
  struct Found {
    std::uint64_t first = 0, bytes = 0;
    std::uint8_t id = kOther;
  };
  [[gnu::noinline]] std::uint8_t find_anew(std::uint32_t address) const {
    const std::size_t k = piece(address);
    const std::uint64_t end = k + 1 < pieces_.size() ? pieces_[k + 1].first : kEnd;
    found_[address / 0x10'0000 % found_.size()] = {pieces_[k].first, end - pieces_[k].first,
                                                  pieces_[k].id};
    return pieces_[k].id;
  }
  std::uint8_t at(std::uint64_t address) const { return pieces_[piece(address)].id; }
  std::size_t piece(std::uint64_t address) const {
    std::size_t low = 0, count = pieces_.size();
    while (count > 1) {
      const std::size_t half = count / 2;
      if (pieces_[low + half].first <= address) low += half;
      count -= half;
    }
    return low;
  }

  std::vector<std::string> names_ = {"none", "other"};
  std::vector<Piece> pieces_ = {{0, kOther}};
  mutable std::array<Found, 16> found_{};
};

}  // namespace fovea::cpu
