// Runs a random program on the core and on qemu, and compares the results.
#pragma once
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tb/iss/machine.h"
#include "tb/iss/random_code.h"

namespace fovea::cpu::test {

inline std::string by_qemu(const RandomProgram& p) {
  const TempFolder folder;
  const auto path = folder.path() / "p.elf";
  {
    const auto elf = as_elf(p.image, kMemory);
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(elf.data()), static_cast<std::streamsize>(elf.size()));
  }
  std::filesystem::permissions(path, std::filesystem::perms::owner_exec,
                               std::filesystem::perm_options::add);
  return output_of(QEMU_ARM " -cpu arm926 " + folder.quoted("p.elf"));
}

struct Here {
  std::string output;
  std::uint64_t instructions = 0;
};

inline Here by_core(const RandomProgram& p, bool caches = true,
                    Picoseconds limit = 500 * kPsPerMs) {
  Machine m;
  m.limit = limit;
  std::memcpy(m.port.at(kMemory), p.image.data(), p.image.size());
  static const std::string user = " msr cpsr_c, #0x10\n ldr r0, =0x100000\n bx r0\n";
  static const Program cached = assemble(kCachesOn + user, 0), plain = assemble(user, 0);
  m.load(caches ? cached : plain);
  m.run();
  return {m.output, m.core.counts().instructions};
}

/// The sequences whose results differ, each with its first difference.
inline std::vector<std::string> differences(const RandomProgram& p, const std::string& a,
                                            const std::string& b) {
  std::vector<std::string> out;
  if (a.size() != p.begin.size() * kSequenceBytes || b.size() != a.size())
    return {"lengths " + std::to_string(a.size()) + " and " + std::to_string(b.size())};
  for (std::size_t k = 0; k < p.begin.size(); ++k) {
    for (unsigned n = 0; n < kSequenceBytes; n += 4) {
      std::uint32_t x, y;
      std::memcpy(&x, a.data() + k * kSequenceBytes + n, 4);
      std::memcpy(&y, b.data() + k * kSequenceBytes + n, 4);
      if (x == y) continue;
      std::ostringstream s;
      s << std::hex << "sequence at " << p.begin[k] << ".." << p.end[k] << ": ";
      if (n < 13 * 4)
        s << "r" << std::dec << n / 4 << std::hex;
      else if (n < kLeftBytes)
        s << (n == 13 * 4 ? "lr" : "cpsr");
      else
        s << "data+" << n - kLeftBytes;
      s << " core " << x << " qemu " << y;
      out.push_back(s.str());
      break;
    }
  }
  return out;
}

}  // namespace fovea::cpu::test
