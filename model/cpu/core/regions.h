// Named ranges of physical addresses, for statistics of stalls by region.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace fovea::cpu {

/// Addresses outside all ranges belong to `other`; stalls without an address belong to `none`.
class RegionMap {
 public:
  static constexpr std::uint8_t kNone = 0, kOther = 1;
  /// `none`, `other`, and 16 named regions.
  static constexpr std::size_t kMax = 2 + 16;

  /// Assigns the range to region `name` and removes it from any other region. A region may consist
  /// of several ranges. Returns false, without any change, if that would be one name too many.
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
  /// The names, indexed by the numbers that find() returns.
  const std::vector<std::string>& names() const { return names_; }

 private:
  static constexpr std::uint64_t kEnd = std::uint64_t{1} << 32;
  struct Piece {
    std::uint64_t first;  // the piece ends where the next one begins
    std::uint8_t id;
  };
  /// Results found last, one for each megabyte modulo 16: consecutive accesses mostly stay in one
  /// range.
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
