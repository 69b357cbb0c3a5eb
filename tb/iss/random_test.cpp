// Random instruction sequences leave the same registers, flags and memory on the core and under
// qemu. Every row of the table of instructions is compared often, or listed as an exception by
// name.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iomanip>
#include <iostream>

#include "model/cpu/core/isa.h"
#include "tb/iss/random_compare.h"

namespace fovea::cpu::test {
namespace {

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

}  // namespace
}  // namespace fovea::cpu::test
