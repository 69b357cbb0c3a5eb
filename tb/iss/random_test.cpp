// Random sequences of instructions leave the same registers, flags and memory here and under qemu.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>

#include "tb/iss/machine.h"
#include "tb/iss/random_code.h"

namespace fovea::cpu::test {
namespace {

std::string by_qemu(const RandomProgram& p) {
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

Here by_core(const RandomProgram& p, bool caches = true) {
  Machine m;
  std::memcpy(m.port.at(kMemory), p.image.data(), p.image.size());
  static const std::string user = " msr cpsr_c, #0x10\n ldr r0, =0x100000\n bx r0\n";
  static const Program cached = assemble(kCachesOn + user, 0), plain = assemble(user, 0);
  m.load(caches ? cached : plain);
  m.run();
  return {m.output, m.core.counts().instructions};
}

/// Sequences whose results differ, with the first difference of each in words.
std::vector<std::string> differences(const RandomProgram& p, const std::string& a,
                                     const std::string& b) {
  std::vector<std::string> out;
  if (a.size() != p.out.size() * kSequenceBytes || b.size() != a.size())
    return {"lengths " + std::to_string(a.size()) + " and " + std::to_string(b.size())};
  for (std::size_t k = 0; k < p.out.size(); ++k) {
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

/// `--seed` of one's own: the variable FOVEA_SEED.
std::uint64_t first_seed() {
  const char* s = std::getenv("FOVEA_SEED");
  return s ? std::strtoull(s, nullptr, 0) : 926;
}

TEST(RandomTest, SequencesLeaveWhatQemuLeaves) {
  std::array<std::uint64_t, static_cast<std::size_t>(Class::kCount)> counts{};
  std::uint64_t instructions = 0;
  for (std::uint64_t seed = first_seed(); seed < first_seed() + 8; ++seed) {
    const RandomProgram p = generate(seed, 500, 50);
    std::cout << "seed " << seed << ", " << p.image.size() << " bytes\n";
    const Here here = by_core(p);
    const auto wrong = differences(p, here.output, by_qemu(p));
    EXPECT_TRUE(wrong.empty()) << "seed " << seed << ": " << wrong.size() << " sequences, first "
                               << wrong.front();
    EXPECT_EQ(by_core(p, false).output, here.output) << "without caches, seed " << seed;
    instructions += here.instructions;
    for (std::size_t k = 0; k < counts.size(); ++k) counts[k] += p.counts[k];
  }
  for (std::size_t k = 0; k < counts.size(); ++k) {
    std::cout << std::setw(24) << kClassNames[k] << std::setw(8) << counts[k] << "\n";
    EXPECT_GE(counts[k], 1000u) << kClassNames[k];
  }
  std::cout << instructions << " instructions compared\n";
  EXPECT_GE(instructions, 200'000u);
}

/// A core with a defect in one instruction of a class, imitated by an instruction next to the right
/// one: the comparison must notice it in places whose result is used.
TEST(RandomTest, ComparisonComplainsAboutOneWrongInstruction) {
  const RandomProgram p = generate(4711, 200, 12);
  const std::string want = by_qemu(p);
  ASSERT_TRUE(differences(p, by_core(p).output, want).empty());
  struct Plant {
    Class kind;
    std::uint32_t flip;
    const char* what;
  };
  const Plant plants[] = {{Class::kData, 1u << 20, "flags set or not"},
                          {Class::kDataShiftReg, 1u << 5, "other kind of shift"},
                          {Class::kCompare, 1u << 21, "other comparison"},
                          {Class::kLongMultiply, 1u << 22, "signed or unsigned"},
                          {Class::kDsp, 1u << 6, "other half"},
                          {Class::kSaturate, 1u << 21, "difference for sum"},
                          {Class::kNarrow, 1u << 23, "up or down"},
                          {Class::kBlock, 1u << 24, "before or after"},
                          {Class::kThumbShift, 1u << 6, "another distance"},
                          {Class::kThumbAlu, 1u << 0, "another register"},
                          {Class::kThumbMemory, 1u << 11, "load or store"}};
  for (const Plant& plant : plants) {
    unsigned tried = 0, noticed = 0;
    for (std::size_t k = 0; k < p.spots.size() && tried < 16; ++k) {
      const auto& spot = p.spots[k];
      if (spot.kind != plant.kind) continue;
      if (k % 7) continue;  // spread over the program
      ++tried;
      RandomProgram mutant = p;
      std::uint32_t w = 0;
      std::uint8_t* at = mutant.image.data() + (spot.address - kMemory);
      std::memcpy(&w, at, spot.thumb ? 2 : 4);
      w ^= plant.flip;
      std::memcpy(at, &w, spot.thumb ? 2 : 4);
      noticed += !differences(p, by_core(mutant).output, want).empty();
    }
    std::cout << std::setw(24) << kClassNames[static_cast<std::size_t>(plant.kind)] << ": "
              << plant.what << ", noticed " << noticed << " of " << tried << "\n";
    EXPECT_GE(tried, 3u);
    EXPECT_GE(noticed, 2u);  // the others had a failed condition or no effect
  }
}

}  // namespace
}  // namespace fovea::cpu::test
