// Random sequences of instructions leave the same registers, flags and memory here and under qemu;
// every row of the table of instructions is compared often, or excused by name.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>

#include "model/cpu/core/disassemble.h"
#include "model/cpu/core/isa.h"
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

Here by_core(const RandomProgram& p, bool caches = true, Picoseconds limit = 500 * kPsPerMs) {
  Machine m;
  m.limit = limit;
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

/// `--seed` of one's own: the variable FOVEA_SEED.
std::uint64_t first_seed() {
  const char* s = std::getenv("FOVEA_SEED");
  return s ? std::strtoull(s, nullptr, 0) : 926;
}

constexpr unsigned kPrograms = 13, kSequences = 8'000, kLength = 10;
constexpr std::uint64_t kEachRow = 1'000, kInAll = 1'000'000;

/// Rows that were compared too rarely and have no excuse, and excuses that are not needed.
std::vector<std::string> uncovered(const std::vector<std::uint64_t>& counts) {
  std::vector<std::string> out;
  const auto rows = isa_rows();
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const bool enough = counts[row] >= kEachRow;
    if (enough == excused(static_cast<int>(row))) out.push_back(rows[row].name);
  }
  return out;
}

TEST(RandomTest, SequencesLeaveWhatQemuLeaves) {
  std::vector<std::uint64_t> counts(isa_rows().size());
  double in_core = 0, in_qemu = 0;
  const auto now = [] { return std::chrono::steady_clock::now(); };
  const auto seconds = [](auto d) { return std::chrono::duration<double>(d).count(); };
  for (std::uint64_t seed = first_seed(); seed < first_seed() + kPrograms; ++seed) {
    const RandomProgram p = generate(seed, kSequences, kLength);
    std::cout << "seed " << seed << ", " << p.image.size() << " bytes\n";
    const auto begin = now();
    const Here here = by_core(p);
    const auto middle = now();
    const auto wrong = differences(p, here.output, by_qemu(p));
    in_core += seconds(middle - begin);
    in_qemu += seconds(now() - middle);
    EXPECT_TRUE(wrong.empty()) << "seed " << seed << ": " << wrong.size() << " sequences, first "
                               << wrong.front();
    if (seed == first_seed()) {
      EXPECT_EQ(by_core(p, false).output, here.output) << "without caches, seed " << seed;
    }
    for (std::size_t row = 0; row < counts.size(); ++row) counts[row] += p.counts[row];
  }
  std::uint64_t all = 0;
  for (std::size_t row = 0; row < counts.size(); ++row) {
    std::cout << std::setw(18) << isa_rows()[row].name << std::setw(8) << counts[row] << "\n";
    all += counts[row];
  }
  for (const Excuse& e : excuses()) std::cout << std::setw(18) << e.row << "  " << e.reason << "\n";
  std::cout << all << " instructions compared; " << in_core << " s in the core, " << in_qemu
            << " s in qemu\n";
  EXPECT_GE(all, kInAll);
  for (const std::string& name : uncovered(counts)) ADD_FAILURE() << name;
}

TEST(RandomTest, ARowNeitherComparedNorExcusedIsNamed) {
  std::vector<std::uint64_t> counts(isa_rows().size(), kEachRow);
  for (std::size_t row = 0; row < counts.size(); ++row)
    if (excused(static_cast<int>(row))) counts[row] = 0;
  EXPECT_TRUE(uncovered(counts).empty());
  const auto at = static_cast<std::size_t>(isa_row(0xE16F0F11u, false));
  counts[at] = kEachRow - 1;
  EXPECT_EQ(uncovered(counts), std::vector<std::string>{"clz"});
  counts[at] = kEachRow;
  counts[static_cast<std::size_t>(isa_row(0xEF000000u, false))] = kEachRow;
  EXPECT_EQ(uncovered(counts), std::vector<std::string>{"svc"});
}

TEST(RandomTest, EveryExcuseNamesARow) {
  for (const Excuse& e : excuses())
    EXPECT_TRUE(std::any_of(isa_rows().begin(), isa_rows().end(), [&](const IsaRow& row) {
      return std::string(row.name) == e.row;
    })) << e.row;
}

/// A core with a defect in one instruction of a class, imitated by an instruction next to the right
/// one: the comparison must notice it in places whose result is used.
struct Plant {
  InsnClass kind;
  const char* what;
  std::uint32_t (*wrong)(std::uint32_t, Op);  ///< 0: this one stays
};
constexpr Plant kPlants[] = {
    {InsnClass::kData, "flags set or not", [](std::uint32_t w, Op) { return w ^ 1u << 20; }},
    {InsnClass::kDataShiftReg, "other kind of shift",
     [](std::uint32_t w, Op) { return w ^ 1u << 5; }},
    {InsnClass::kCompare, "other comparison", [](std::uint32_t w, Op) { return w ^ 1u << 21; }},
    {InsnClass::kMultiply, "accumulate or not", [](std::uint32_t w, Op) { return w ^ 1u << 21; }},
    {InsnClass::kLongMultiply, "accumulate or not",
     [](std::uint32_t w, Op) { return w ^ 1u << 21; }},
    {InsnClass::kDsp, "other half", [](std::uint32_t w, Op) { return w ^ 1u << 6; }},
    {InsnClass::kSaturate, "difference for sum", [](std::uint32_t w, Op) { return w ^ 1u << 21; }},
    {InsnClass::kClz, "a move", [](std::uint32_t w, Op) { return 0xE1A00000u | (w & 0xF00Fu); }},
    {InsnClass::kStatus, "flags not written, or another register",
     [](std::uint32_t w, Op op) { return w ^ (op == Op::kMsr ? 1u << 19 : 1u << 12); }},
    {InsnClass::kLoad, "byte or word", [](std::uint32_t w, Op) { return w ^ 1u << 22; }},
    {InsnClass::kStore, "byte or word", [](std::uint32_t w, Op) { return w ^ 1u << 22; }},
    {InsnClass::kNarrow, "up or down", [](std::uint32_t w, Op) { return w ^ 1u << 23; }},
    {InsnClass::kDouble, "up or down", [](std::uint32_t w, Op) { return w ^ 1u << 23; }},
    {InsnClass::kBlock, "before or after", [](std::uint32_t w, Op) { return w ^ 1u << 24; }},
    {InsnClass::kSwap, "byte or word", [](std::uint32_t w, Op) { return w ^ 1u << 22; }},
    {InsnClass::kPreload, "changes the first register",
     [](std::uint32_t w, Op) { return 0xE2800001u | (w & 0u); }},
    {InsnClass::kBranch, "link or not",
     [](std::uint32_t w, Op op) { return op == Op::kB || op == Op::kBl ? w ^ 1u << 24 : 0; }},
    {InsnClass::kThumbShift, "another distance, or operation",
     [](std::uint32_t h, Op) { return h ^ 1u << 6; }},
    {InsnClass::kThumbAlu, "another register", [](std::uint32_t h, Op) { return h ^ 1u; }},
    {InsnClass::kThumbMultiply, "another operation",
     [](std::uint32_t h, Op) { return h ^ 1u << 6; }},
    {InsnClass::kThumbHigh, "another register", [](std::uint32_t h, Op) { return h ^ 1u << 3; }},
    {InsnClass::kThumbMemory, "load or store", [](std::uint32_t h, Op) { return h ^ 1u << 11; }},
    {InsnClass::kThumbBlock, "another register in the list",
     [](std::uint32_t h, Op) { return h ^ 1u << 2; }},
    {InsnClass::kThumbBranch, "not taken",
     [](std::uint32_t h, Op op) { return op == Op::kB ? 0x46C0u | (h & 0u) : 0; }}};

TEST(RandomTest, ComparisonComplainsAboutOneWrongInstruction) {
  const RandomProgram p = generate(4711, 300, kLength);
  const std::string want = by_qemu(p);
  ASSERT_TRUE(differences(p, by_core(p).output, want).empty());
  std::vector<bool> planted(static_cast<std::size_t>(InsnClass::kCount));
  for (const Plant& plant : kPlants) {
    planted[static_cast<std::size_t>(plant.kind)] = true;
    std::vector<std::pair<const RandomProgram::Spot*, std::uint32_t>> places;
    for (const auto& spot : p.spots) {
      const IsaRow& row = isa_rows()[static_cast<std::size_t>(spot.row)];
      if (!spot.certain || row.kind.insn_class != plant.kind) continue;
      std::uint32_t w = 0;
      std::memcpy(&w, p.image.data() + (spot.address - kMemory), spot.thumb ? 2 : 4);
      if (const std::uint32_t wrong = plant.wrong(w, row.op)) places.emplace_back(&spot, wrong);
    }
    unsigned tried = 0, noticed = 0;
    const std::size_t step = std::max<std::size_t>(1, places.size() / 12);
    for (std::size_t k = 0; k < places.size(); k += step) {
      ++tried;
      RandomProgram mutant = p;
      const auto& [spot, wrong] = places[k];
      std::memcpy(mutant.image.data() + (spot->address - kMemory), &wrong, spot->thumb ? 2 : 4);
      try {
        noticed += !differences(p, by_core(mutant, true, 5 * kPsPerMs).output, want).empty();
      } catch (const std::exception&) {  // it ran away
        ++noticed;
      }
    }
    std::cout << std::setw(24) << class_name(plant.kind) << ": " << plant.what << ", noticed "
              << noticed << " of " << tried << "\n";
    EXPECT_GE(tried, 3u) << class_name(plant.kind);
    // The others had no effect, or a later instruction hid it.
    EXPECT_GE(4 * noticed, tried) << class_name(plant.kind);
  }
  // Every class of which some row is compared has a plant.
  for (std::size_t row = 0; row < isa_rows().size(); ++row) {
    const InsnClass kind = isa_rows()[row].kind.insn_class;
    EXPECT_TRUE(excused(static_cast<int>(row)) || planted[static_cast<std::size_t>(kind)])
        << class_name(kind);
  }
}

}  // namespace
}  // namespace fovea::cpu::test
