#include "sw/fovea/program/code_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>

namespace fovea::app {
namespace {

/// FNV-1a with 64 bits (Fowler, Noll, Vo): distinguishes versions of one program; it need not withstand
/// an attacker.
class Hash {
 public:
  void add(std::string_view bytes) {
    for (const char c : bytes) step(static_cast<std::uint8_t>(c));
    step(0xff);  // not in a name: ends it
  }
  void add(std::uint32_t word) {
    for (unsigned k = 0; k < 32; k += 8) step(static_cast<std::uint8_t>(word >> k));
  }
  std::string text() const { return fmt::format("{:016x}", state_); }

 private:
  void step(std::uint8_t byte) { state_ = (state_ ^ byte) * 0x100000001b3u; }
  std::uint64_t state_ = 0xcbf29ce484222325u;
};

/// A name for an address of the program, with the offset in what the name means; the section alone where
/// no symbol is, such as for the text of a message. Empty if the program has nothing there. Small numbers
/// are more often numbers than addresses in the internal RAM: of those only the beginning of a symbol is
/// one. So are odd ones in the middle of an object.
std::string meaning(const ElfImage& image, std::uint32_t address) {
  const auto& symbols = image.symbols();
  auto above = std::upper_bound(symbols.begin(), symbols.end(), address,
                                [](std::uint32_t a, const ElfSymbol& s) { return a < s.address; });
  constexpr std::uint32_t kSmall = 0x10000;
  constexpr int kNearest = 8;  // symbols may overlap a little
  for (int looks = 0; looks < kNearest && above != symbols.begin(); ++looks) {
    const ElfSymbol& s = *--above;
    const bool within = address >= kSmall && address - s.address < s.size && (s.function || address % 4 == 0);
    if (address == s.address || within)
      return fmt::format("{}+{}", s.text(), address - s.address);
  }
  if (address < kSmall) return "";
  for (const ElfSection& s : image.sections())
    if (address - s.address < s.size) return s.name;
  return "";
}

class Code {
 public:
  Code(const ElfImage& image, std::uint32_t address, std::uint32_t size)
      : image_(image), address_(address), size_(size) {
    for (const ElfSegment& s : image.segments())
      if (address - s.virtual_address < s.data.size())
        bytes_ = std::span(s.data).subspan(address - s.virtual_address);
    if (bytes_.size() > size) bytes_ = bytes_.first(size);
  }
  void add_data(Hash& hash) const {
    std::size_t at = 0;
    for (; at + 4 <= bytes_.size(); at += 4) value(hash, half(at) | half(at + 2) << 16);
    rest(hash, at);
  }

  void add_arm(Hash& hash) const {
    const std::set<std::size_t> literals = arm_literals();
    std::size_t at = 0;
    for (; at + 4 <= bytes_.size(); at += 4) {
      const std::uint32_t word = half(at) | half(at + 2) << 16;
      const auto from = static_cast<std::uint32_t>(address_ + at);
      // B, BL and BLX with an offset: bits 27 to 25 are 101.
      const bool branches = (word & 0x0e00'0000) == 0x0a00'0000;
      if (literals.contains(at) || (!branches && word - address_ < size_)) {
        value(hash, word);
      } else if (branches) {
        const auto offset = static_cast<std::uint32_t>(static_cast<std::int32_t>(word << 8) >> 6);
        branch(hash, word & 0xff00'0000, from + 8 + offset, word);
      } else {
        hash.add(word);
      }
    }
    rest(hash, at);
  }

  void add_thumb(Hash& hash) const {
    std::size_t at = 0;
    for (; at + 2 <= bytes_.size(); at += 2) {
      const std::uint32_t first = half(at);
      const std::uint32_t second = at + 4 <= bytes_.size() ? half(at + 2) : 0;
      const auto from = static_cast<std::uint32_t>(address_ + at);
      // BL and BLX are two halves: 11110 with the upper bits, 111x1 with the lower ones.
      if ((first & 0xf800) == 0xf000 && (second & 0xe800) == 0xe800) {
        const auto upper = static_cast<std::uint32_t>(static_cast<std::int32_t>(first << 21) >> 9);
        branch(hash, (second & 0xf800) << 16 | 0xf000, (from + 4 + upper + ((second & 0x7ff) << 1)) & ~1u,
               first | second << 16);
        at += 2;
      } else if (from % 4 == 0 && at + 4 <= bytes_.size() && !meaning(image_, first | second << 16).empty()) {
        value(hash, first | second << 16);
        at += 2;
      } else {
        hash.add(first);
      }
    }
    rest(hash, at);
  }

 private:
  /// Offsets of the words that loads relative to the program counter read: an instruction is not mistaken for an
  /// address.
  std::set<std::size_t> arm_literals() const {
    std::set<std::size_t> out;
    for (std::size_t at = 0; at + 4 <= bytes_.size(); at += 4) {
      const std::uint32_t word = half(at) | half(at + 2) << 16;
      const bool load = (word & 0x0f7f'0000) == 0x051f'0000, pair = (word & 0x0f7f'00f0) == 0x014f'00d0;
      if (!load && !pair) continue;
      const std::uint32_t offset = load ? word & 0xfff : (word >> 4 & 0xf0) | (word & 0xf);
      const std::size_t target = at + 8 + (word & 1u << 23 ? offset : 0u - std::size_t{offset});
      out.insert(target);
      if (pair) out.insert(target + 4);
    }
    return out;
  }
  std::uint32_t half(std::size_t at) const { return bytes_[at] | std::uint32_t{bytes_[at + 1]} << 8; }
  /// Within the code a branch is as far as before. A number among the code may look like a branch: it leads nowhere.
  void branch(Hash& hash, std::uint32_t opcode, std::uint32_t target, std::uint32_t word) const {
    const bool within = target - address_ < size_;
    const std::string name = within ? "" : meaning(image_, target);
    if (!within && name.empty()) return hash.add(word);
    hash.add(opcode);
    if (within) hash.add(target - address_);
    else hash.add(name);
  }
  void value(Hash& hash, std::uint32_t word) const {
    const std::string name = meaning(image_, word);
    if (name.empty()) hash.add(word);
    else hash.add(name);
  }
  void rest(Hash& hash, std::size_t at) const {
    for (; at < bytes_.size(); ++at) hash.add(std::uint32_t{bytes_[at]});
  }

  const ElfImage& image_;
  std::uint32_t address_, size_;
  std::span<const std::uint8_t> bytes_;
};

}  // namespace

std::string code_hash(const ElfImage& image, std::uint32_t address, std::uint32_t size, bool thumb) {
  Hash hash;
  const Code code(image, address, size);
  if (thumb) code.add_thumb(hash);
  else code.add_arm(hash);
  return hash.text();
}

std::string data_hash(const ElfImage& image) {
  std::vector<const ElfSymbol*> objects;
  for (const ElfSymbol& s : image.symbols())
    if (!s.function && s.size) objects.push_back(&s);
  // Of several static objects with one name the larger one comes first; equal ones count in the order of
  // their addresses, which a link keeps.
  std::stable_sort(objects.begin(), objects.end(), [](const ElfSymbol* a, const ElfSymbol* b) {
    return std::tuple(std::string_view(a->name), b->size) < std::tuple(std::string_view(b->name), a->size);
  });
  Hash hash;
  for (const ElfSymbol* const s : objects) {
    const Code code(image, s->address, s->size);
    hash.add(s->name);
    hash.add(s->size);
    code.add_data(hash);
  }
  return hash.text();
}

}  // namespace fovea::app
