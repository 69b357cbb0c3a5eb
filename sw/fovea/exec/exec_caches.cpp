#include "sw/fovea/exec/exec_caches.h"

#include <array>
#include <cstring>

namespace fovea::app {
namespace {

/// Descriptors of sections (ARM DDI 0100, B3.3.3): full access, domain 0.
constexpr std::uint32_t kSection = 0xC12, kCacheable = 0x8, kBufferable = 0x4;
constexpr std::uint64_t kSectionBytes = 1u << 20;

}  // namespace

std::vector<std::uint8_t> cache_preamble(const ExecMap& map, std::uint32_t entry) {
  std::vector<std::uint32_t> words(0x1000);
  for (std::uint64_t i = 0; i < words.size(); ++i) {
    const std::uint64_t address = i * kSectionBytes;
    const bool ram = address >= map.ram_base && address < map.ram_base + map.ram_size;
    words[i] =
        static_cast<std::uint32_t>(address) | kSection | (ram ? kCacheable | kBufferable : 0);
  }
  const std::array<std::uint32_t, 16> code = {
      0xE59F0030,  // ldr r0, table
      0xEE020F10,  // mcr p15, 0, r0, c2, c0, 0   translation table base
      0xE3A00001,  // mov r0, #1
      0xEE030F10,  // mcr p15, 0, r0, c3, c0, 0   domain 0: permissions are checked
      0xE3A01000,  // mov r1, #0
      0xEE081F17,  // mcr p15, 0, r1, c8, c7, 0   invalidate the TLBs
      0xEE071F17,  // mcr p15, 0, r1, c7, c7, 0   invalidate the caches
      0xEE110F10,  // mrc p15, 0, r0, c1, c0, 0
      0xE3800A01,  // orr r0, r0, #0x1000         I-cache
      0xE3800005,  // orr r0, r0, #5              D-cache, MMU
      0xEE010F10,  // mcr p15, 0, r0, c1, c0, 0
      0xE3A00000,  // mov r0, #0
      0xE59FE004,  // ldr lr, entry
      0xE12FFF1E,  // bx lr
      map.table,
      entry,
  };
  words.insert(words.end(), code.begin(), code.end());
  std::vector<std::uint8_t> bytes(words.size() * 4);
  std::memcpy(bytes.data(), words.data(), bytes.size());
  return bytes;
}

}  // namespace fovea::app
