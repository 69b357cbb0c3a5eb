#include "sw/fovea/program/elf_target.h"

#include <elf.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

namespace fovea::app {
namespace {

// Attributes of the vendor "aeabi".
constexpr std::uint64_t kTagFile = 1, kTagCpuRawName = 4, kTagCpuName = 5, kTagCpuArch = 6,
                        kTagCpuArchProfile = 7, kTagThumbIsaUse = 9, kTagVfpArgs = 28,
                        kTagCompatibility = 32;
constexpr std::uint64_t kV5Tej = 5, kThumb2 = 2;

constexpr std::array<const char*, 23> kArchitectures = {"older than ARMv4",
                                                        "ARMv4",
                                                        "ARMv4T",
                                                        "ARMv5T",
                                                        "ARMv5TE",
                                                        "ARMv5TEJ",
                                                        "ARMv6",
                                                        "ARMv6KZ",
                                                        "ARMv6T2",
                                                        "ARMv6K",
                                                        "ARMv7",
                                                        "ARMv6-M",
                                                        "ARMv6S-M",
                                                        "ARMv7E-M",
                                                        "ARMv8-A",
                                                        "ARMv8-R",
                                                        "ARMv8-M.baseline",
                                                        "ARMv8-M.mainline",
                                                        "ARMv8.1-A",
                                                        "ARMv8.2-A",
                                                        "ARMv8.3-A",
                                                        "ARMv8.1-M.mainline",
                                                        "ARMv9-A"};

/// Reads values one after the other; after the end, all values are 0.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  bool at_end() const { return at_ >= bytes_.size(); }
  std::uint64_t uleb() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; !at_end(); shift += 7) {
      const std::uint8_t byte = bytes_[at_++];
      if (shift < 64) value |= std::uint64_t{byte & 0x7Fu} << shift;
      if (!(byte & 0x80u)) break;
    }
    return value;
  }
  std::uint32_t word() {
    std::uint32_t value = 0;
    for (unsigned k = 0; k < 4 && !at_end(); ++k) value |= std::uint32_t{bytes_[at_++]} << (8 * k);
    return value;
  }
  std::string_view text() {
    const std::size_t begin = at_;
    while (!at_end() && bytes_[at_] != 0) ++at_;
    const std::string_view out(reinterpret_cast<const char*>(bytes_.data()) + begin, at_ - begin);
    if (!at_end()) ++at_;
    return out;
  }
  /// The next `n` bytes, or as many as are left.
  Reader part(std::uint64_t n) {
    const std::size_t here = std::min<std::uint64_t>(n, bytes_.size() - at_);
    Reader out(bytes_.subspan(at_, here));
    at_ += here;
    return out;
  }
  std::size_t place() const { return at_; }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

/// The attributes that hold for the whole file. If only a part of it uses VFP or NEON, that is no
/// obstacle: an operating system asks the processor before it executes such code.
std::string unfit_file(Reader in) {
  std::uint64_t architecture = 0, profile = 0, thumb = 0, vfp_args = 0;
  while (!in.at_end()) {
    const std::uint64_t tag = in.uleb();
    if (tag == kTagCompatibility) {
      in.uleb();
      in.text();
      continue;
    }
    if (tag == kTagCpuRawName || tag == kTagCpuName || (tag > kTagCompatibility && tag % 2)) {
      in.text();
      continue;
    }
    const std::uint64_t value = in.uleb();
    switch (tag) {
      case kTagCpuArch:
        architecture = value;
        break;
      case kTagCpuArchProfile:
        profile = value;
        break;
      case kTagThumbIsaUse:
        thumb = value;
        break;
      case kTagVfpArgs:
        vfp_args = value;
        break;
      default:
        break;
    }
  }
  if (architecture > kV5Tej)
    return fmt::format("it is built for {}{}",
                       architecture < kArchitectures.size()
                           ? kArchitectures[architecture]
                           : fmt::format("architecture number {}", architecture),
                       architecture == 10 && profile == 'M' ? "-M" : "");
  if (profile == 'M') return "it is built for a microcontroller (Cortex-M)";
  if (thumb >= kThumb2) return "it uses Thumb-2 instructions";
  if (vfp_args == 1) return "it passes floating-point numbers in VFP registers";
  return "";
}

}  // namespace

std::string unfit_flags(std::uint32_t flags) {
  if (flags & EF_ARM_BE8) return "its code is for big-endian data (BE8)";
  if ((flags & EF_ARM_EABIMASK) == EF_ARM_EABI_VER5 && (flags & EF_ARM_ABI_FLOAT_HARD))
    return "it passes floating-point numbers in VFP registers (hard-float ABI)";
  return "";
}

std::string unfit_attributes(std::span<const std::uint8_t> section) {
  if (section.empty() || section[0] != 'A') return "";
  Reader all(section.subspan(1));
  while (!all.at_end()) {
    const std::uint32_t length = all.word();
    if (length < 4) return "";
    Reader vendor = all.part(length - 4);
    if (vendor.text() != "aeabi") continue;
    while (!vendor.at_end()) {
      const std::size_t begin = vendor.place();
      const std::uint64_t scope = vendor.uleb();
      const std::uint32_t size = vendor.word();
      const std::size_t header = vendor.place() - begin;
      if (size < header) return "";
      Reader attributes = vendor.part(size - header);
      if (scope != kTagFile) continue;
      if (std::string why = unfit_file(attributes); !why.empty()) return why;
    }
  }
  return "";
}

}  // namespace fovea::app
