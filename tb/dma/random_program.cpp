#include "tb/dma/random_program.h"

#include <cstdio>

namespace fovea::dma {

std::string Action::text() const {
  static constexpr const char* kNames[] = {"write", "fill set", "event",
                                           "queue", "serve",    "transfer by TC"};
  char line[64];
  if (kind == kWrite)
    std::snprintf(line, sizeof line, "write 0x%04x = 0x%08x", where, value);
  else
    std::snprintf(line, sizeof line, "%s %u", kNames[kind], where);
  return line;
}

namespace {

using Words = std::array<std::uint32_t, 8>;

class Generator {
 public:
  explicit Generator(std::uint64_t seed) : dice_(seed) {
    program_.staged = dice_.percent(40);
    for (int i = 0; i < 8; ++i) channels_.push_back(dice_.below(64));
    for (int i = 0; i < 3; ++i) qdma_.push_back(dice_.below(8));
    sets_ = channels_;
    for (int i = 0; i < 14; ++i) sets_.push_back(dice_.below(256));
  }

  Program make() {
    set_up();
    const unsigned steps = 60 + dice_.below(140);
    for (unsigned i = 0; i < steps; ++i) program_.actions.push_back(step());
    return program_;
  }

 private:
  std::uint32_t random_word() {
    const std::uint32_t high = dice_.below(0x10000) << 16;
    return high | dice_.below(0x10000);
  }
  /// Mostly bits of the channels in use.
  std::uint32_t mask(unsigned half) {
    std::uint32_t m = dice_.percent(20) ? random_word() : 0;
    for (unsigned c : channels_)
      if (c / 32 == half && dice_.percent(70)) m |= 1u << c % 32;
    return m;
  }

  void set_up() {
    const auto put = [&](std::uint32_t offset, std::uint32_t value) {
      program_.setup.push_back({Action::kWrite, offset, value});
    };
    for (unsigned i = 0; i < 8; ++i) put(0x240 + 4 * i, random_word() & 0x3333'3333);
    put(0x260, random_word() & 0x3333'3333);
    if (dice_.percent(30)) put(0x280, random_word() & 0x3333);
    if (dice_.percent(50)) put(0x620, random_word() & 0x0303'0303);
    for (unsigned region = 0; region < 4; ++region) {
      for (unsigned half = 0; half < 2; ++half) put(0x340 + 8 * region + 4 * half, mask(half));
      put(0x380 + 4 * region, dice_.below(256));
    }
    for (unsigned half = 0; half < 2; ++half) {
      put(0x1030 + 4 * half, mask(half));
      put(0x1060 + 4 * half, mask(half));
    }
    for (unsigned q : qdma_) {
      const unsigned set = dice_.of(sets_);
      put(0x200 + 4 * q, set << 5 | dice_.below(8) << 2);
    }
    for (unsigned s : sets_) program_.setup.push_back({Action::kFill, s, 0, words()});
    for (unsigned q : qdma_) put(0x108C, 1u << q);
  }

  unsigned count(unsigned most) { return dice_.percent(4) ? 0 : 1 + dice_.below(most); }
  /// The parts of a braced list are computed from left to right by every compiler.
  struct Halves {
    unsigned low, high;
  };
  std::uint32_t pair(Halves h) { return (h.low & 0xFFFF) | h.high << 16; }
  std::uint32_t place(unsigned zone, bool aligned) {
    const std::uint32_t offset = 0x1'0000 + dice_.below(0x1000);
    return zone << 28 | (aligned ? offset & ~31u : offset);
  }

  Words words() {
    const bool fixed_source = dice_.percent(8), fixed_destination = dice_.percent(8);
    const bool aligned = (fixed_source || fixed_destination) && dice_.percent(85);
    std::uint32_t opt = (fixed_source ? 1u : 0) | (fixed_destination ? 2u : 0);
    if (dice_.percent(50)) opt |= 1u << 2;
    if (dice_.percent(12)) opt |= 1u << 3;
    if (dice_.percent(25)) opt |= 1u << 11;
    opt |= dice_.below(6) << 8;
    opt |= (dice_.percent(90) ? dice_.of(channels_) : dice_.below(64)) << 12;
    for (unsigned b = 20; b < 24; ++b)
      if (dice_.percent(35)) opt |= 1u << b;

    Words w{};
    w[0] = opt;
    const bool through = program_.staged && dice_.percent(50);
    w[1] = place(through ? 9 : 8, aligned);
    w[3] = place(through || !program_.staged ? 0xA : 9, aligned);
    const unsigned step = aligned ? 32 : 1;
    const auto index = [&] {
      return static_cast<unsigned>(dice_.between(-200, 200) / static_cast<int>(step) *
                                   static_cast<int>(step));
    };
    if (dice_.percent(5)) {  // around the limit of joined arrays
      const unsigned a = 1u << dice_.below(3);
      w[0] = (opt & ~3u) | 4;
      w[2] = pair({a, 1022 + dice_.below(4)});
      w[4] = pair({a, dice_.percent(50) ? a : 8});
    } else {
      const unsigned a = dice_.percent(20) ? 1u << dice_.below(7) : count(150);
      w[2] = pair({a, count(5)});
      w[4] = pair({dice_.percent(40) ? a : index(), dice_.percent(40) ? a : index()});
    }
    w[6] = pair({index(), index()});
    w[7] = count(3) | (dice_.percent(10) ? 0xFACE'0000 : 0);
    if (dice_.percent(3)) w[2] = w[7] = 0;
    w[5] = pair({link(), dice_.below(5)});
    return w;
  }

  unsigned link() {
    if (dice_.percent(30)) return 0xFFFF;
    if (dice_.percent(3)) return 0x2000 + 32 * dice_.below(256);  // beyond the last set
    unsigned l = dice_.of(sets_) * 32;
    if (dice_.percent(60)) l |= 0x4000;
    if (dice_.percent(10)) l |= dice_.below(31);
    return l;
  }

  /// A register of the channels: in the global region or in a shadow region.
  Action channel_write(std::uint32_t offset, std::uint32_t value) {
    const std::uint32_t base = dice_.percent(50) ? 0x1000 : 0x2000 + 0x200 * dice_.below(4);
    return {Action::kWrite, base + offset, value};
  }
  Action channel_write(std::uint32_t offset) {
    const unsigned half = dice_.below(2);
    return channel_write(offset + 4 * half, mask(half));
  }

  Action step() {
    const unsigned n = dice_.below(100);
    if (n < 18) return {Action::kQueue, dice_.percent(70) ? 0 : dice_.below(4)};
    if (n < 38) return {Action::kServe};
    if (n < 46) return {Action::kTransfer, dice_.below(4)};
    if (n < 56) return {Action::kEvent, dice_.percent(90) ? dice_.of(channels_) : dice_.below(64)};
    if (n < 70) {
      const unsigned c = dice_.of(channels_);
      return channel_write(c < 32 ? 0x10 : 0x14, 1u << c % 32);
    }
    if (n < 78) return {Action::kFill, dice_.of(sets_), 0, words()};
    if (n < 82) {
      const unsigned word = dice_.below(8);
      if (program_.staged && (word == 1 || word == 3)) return {Action::kServe};  // zones would mix
      return {Action::kWrite, 0x4000 + 32 * dice_.of(sets_) + 4 * word, words()[word]};
    }
    switch (dice_.below(16)) {
      case 0:
        return channel_write(0x08);  // ECR
      case 1:
        return channel_write(0x28);  // EECR
      case 2:
        return channel_write(0x30);  // EESR
      case 3:
      case 4:
        return channel_write(0x40);  // SECR
      case 5:
        return channel_write(0x58);  // IECR
      case 6:
        return channel_write(0x60);  // IESR
      case 7:
      case 8:
        return channel_write(0x70);  // ICR
      case 9:
        return channel_write(0x78, dice_.below(2) * (dice_.percent(90) ? 1 : 2));  // IEVAL
      case 10:
        return channel_write(dice_.percent(30) ? 0x88 : 0x8C, 1u << dice_.of(qdma_));
      case 11:
        return channel_write(0x94, 1u << dice_.of(qdma_));
      case 12: {
        const unsigned half = dice_.below(2);
        return {Action::kWrite, 0x308 + 4 * half, mask(half)};
      }
      case 13:
        return {Action::kWrite, 0x314, dice_.below(256)};
      case 14:
        return {Action::kWrite, 0x31C, dice_.percent(20) ? 0x1'000Fu : dice_.below(16)};
      default:
        return {Action::kWrite, 0x320, dice_.below(2)};
    }
  }

  Dice dice_;
  Program program_;
  std::vector<unsigned> channels_, qdma_, sets_;
};

}  // namespace

Program random_program(std::uint64_t seed) { return Generator(seed).make(); }

}  // namespace fovea::dma
