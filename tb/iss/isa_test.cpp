// The table of instructions: its patterns and texts, checked with the GNU assembler.
#include "model/cpu/core/isa.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <set>
#include <sstream>

#include "model/cpu/core/disassemble.h"
#include "tb/iss/assembler.h"

namespace fovea::cpu::test {
namespace {

int row_count() { return static_cast<int>(isa_rows().size()); }
const IsaRow& row_at(int row) { return isa_rows()[static_cast<std::size_t>(row)]; }

/// A random word that the row defines, and that no earlier row takes.
std::uint32_t random_word(int row, std::mt19937& random) {
  const IsaBits& b = isa_bits(row);
  const std::uint32_t all = row_at(row).thumb() ? 0xFFFFu : 0xFFFFFFFFu;
  for (int tries = 0; tries < 100'000; ++tries) {
    std::uint32_t w = static_cast<std::uint32_t>(random()) & all;
    w = (w & ~b.mask & ~b.zeros) | b.value | b.ones;
    // Half of the time with small operands, where the special cases of the texts are.
    if (random() % 2 && isa_has(row, 'i')) {
      IsaFields f = isa_fields(row, w);
      f['i'] &= 3;
      w = isa_encode(row, f);
    }
    if (isa_row(w, row_at(row).thumb()) == row && isa_defined(row, w)) return w;
  }
  ADD_FAILURE() << "no word for " << row_at(row).name;
  return b.value;
}

TEST(IsaTest, NamesAreUnique) {
  std::set<std::string> names;
  for (const IsaRow& row : isa_rows()) EXPECT_TRUE(names.insert(row.name).second) << row.name;
}

/// Two patterns that share a word: the first must be a special case of the second.
TEST(IsaTest, PatternsThatOverlapAreSpecialCases) {
  for (int b = 0; b < row_count(); ++b)
    for (int a = 0; a < b; ++a) {
      if (row_at(a).thumb() != row_at(b).thumb()) continue;
      const IsaBits &x = isa_bits(a), &y = isa_bits(b);
      // Field c of an ARM pattern does not take 1111.
      if (!row_at(a).thumb() && (x.mask >> 28 == 15) != (y.mask >> 28 == 15)) continue;
      if ((x.value ^ y.value) & x.mask & y.mask) continue;
      EXPECT_EQ(x.mask & y.mask, y.mask) << row_at(a).name << " and " << row_at(b).name;
      EXPECT_NE(x.mask, y.mask) << row_at(a).name << " and " << row_at(b).name;
    }
}

TEST(IsaTest, WordsKeepRowAndFields) {
  std::mt19937 random(1);
  for (int row = 0; row < row_count(); ++row)
    for (int k = 0; k < 200; ++k) {
      const std::uint32_t w = random_word(row, random);
      EXPECT_EQ(isa_encode(row, isa_fields(row, w)), w) << row_at(row).name;
    }
}

TEST(IsaTest, UndefinedWordsHaveNoRow) {
  // Media space, unused multiplies, LDRD with an odd register, BLX suffix with bit 0, 10111111.
  for (const std::uint32_t w : {0xE6000010u, 0xE0400090u, 0xE06F1092u, 0xE1CF10D0u, 0xE300F000u})
    EXPECT_EQ(isa_row(w, false), kNoRow) << std::hex << w;
  for (const std::uint32_t h : {0xE801u, 0xBF00u, 0xB100u}) EXPECT_EQ(isa_row(h, true), kNoRow);
}

TEST(IsaTest, BrokenClausesAreSeen) {
  const auto defined = [](std::uint32_t w, bool thumb = false) {
    return isa_defined(isa_row(w, thumb), w);
  };
  EXPECT_TRUE(defined(0xE0010392));             // mul r1, r2, r3
  EXPECT_FALSE(defined(0xE0010391));            // mul r1, r1, r3
  EXPECT_FALSE(defined(0xE0011392));            // a bit that should be zero
  EXPECT_TRUE(defined(0xE5910000));             // ldr r0, [r1]
  EXPECT_TRUE(defined(0xE5911000));             // ldr r1, [r1]
  EXPECT_FALSE(defined(0xE5B11000));            // ldr r1, [r1, #0]!
  EXPECT_FALSE(defined(0xE1CEE0D0));            // ldrd lr, [lr]
  EXPECT_FALSE(defined(0xE0CC00D2 | 0x1000));   // ldrd with r1
  EXPECT_FALSE(defined(0xE8B10002));            // ldmia r1!, {r1}
  EXPECT_TRUE(defined(0xE8910002));             // ldmia r1, {r1}
  EXPECT_FALSE(defined(0xE8910000));            // no register
  EXPECT_FALSE(defined(0x4608, true));          // mov between low registers
  EXPECT_TRUE(defined(0x4688, true));           // mov r8, r1
  EXPECT_FALSE(defined(0xE12FF31E & ~0x100u));  // bx without its ones
}

TEST(IsaTest, InstructionsMdIsWhatTheTablePrints) {
  const auto bytes = read_file(INSTRUCTIONS);
  EXPECT_TRUE(std::string(bytes.begin(), bytes.end()) == output_of(ISA_TABLE))
      << "write it again: isa_table > model/cpu/INSTRUCTIONS.md";
}

// Texts.

struct Sample {
  std::uint32_t word;
  int row;
  std::string text;
};
constexpr std::uint32_t kBase = 0x0200'0000;

/// The assembler takes "#value, rotation" for data operations, but has no way to say it for MSR;
/// and it refuses the pc as second operand of a Thumb CMP. Where a Thumb sum has two encodings it
/// takes that with 8 bits. Transfers of coprocessor 9 are halfwords of a floating-point unit to it.
bool writable(int row, std::uint32_t w) {
  const IsaFields f = isa_fields(row, w);
  const std::string name = row_at(row).name;
  if (f['p'] == 9 && isa_has(row, 'D') && isa_has(row, 'n')) return false;
  if (name.ends_with("imm3") && f['n'] == f['d']) return false;
  if (row_at(row).thumb() && row_at(row).op == Op::kCmp && f['m'] == 15) return false;
  return row_at(row).op != Op::kMsr || !isa_has(row, 'r') ||
         disassemble(w, false, 0).find(", ") == disassemble(w, false, 0).rfind(", ");
}

std::vector<Sample> samples(bool thumb, unsigned each, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Sample> out;
  for (int row = 0; row < row_count(); ++row) {
    if (row_at(row).thumb() != thumb) continue;
    for (unsigned k = 0; k < each; ++k) {
      std::uint32_t w = random_word(row, random);
      while (!writable(row, w)) w = random_word(row, random);
      const std::uint32_t pc = kBase + static_cast<std::uint32_t>(out.size()) * (thumb ? 2u : 4u);
      out.push_back({w, row, disassemble(w, thumb, pc)});
    }
  }
  return out;
}

/// Branch targets relative to the place: the assembler then needs no linker.
std::string relative(const std::string& text, std::uint32_t pc) {
  const std::size_t at = text.find(" 0x");
  if (text[0] != 'b' || at == std::string::npos) return text;
  const auto target = static_cast<std::uint32_t>(std::stoul(text.substr(at + 1), nullptr, 16));
  return text.substr(0, at) + " . + " + std::to_string(static_cast<std::int32_t>(target - pc));
}

/// Samples that the assembler turns into another word.
std::vector<std::string> misread(const std::vector<Sample>& samples, bool thumb) {
  std::ostringstream source;
  source << (thumb ? ".thumb\n" : ".arm\n") << ".balign 4\n";
  std::uint32_t pc = kBase;
  for (const Sample& s : samples) {
    source << relative(s.text, pc) << "\n";
    pc += thumb ? 2 : 4;
  }
  const Program p = assemble(source.str(), kBase);
  std::vector<std::string> out;
  EXPECT_GE(p.bytes.size(), samples.size() * (thumb ? 2u : 4u));
  for (std::size_t k = 0; k < samples.size(); ++k) {
    std::uint32_t w = 0;
    const unsigned bytes = thumb ? 2 : 4;
    std::memcpy(&w, p.bytes.data() + k * bytes, bytes);
    if (w == samples[k].word) continue;
    std::ostringstream s;
    s << row_at(samples[k].row).name << ": " << samples[k].text << std::hex << " is " << w
      << ", not " << samples[k].word;
    out.push_back(s.str());
  }
  return out;
}

class IsaTextTest : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(States, IsaTextTest, testing::Bool(),
                         [](const auto& state) { return state.param ? "Thumb" : "Arm"; });

TEST_P(IsaTextTest, AssemblerReadsBackEveryRow) {
  const auto wrong = misread(samples(GetParam(), 60, 2), GetParam());
  for (const std::string& s : wrong) ADD_FAILURE() << s;
}

TEST_P(IsaTextTest, AssemblerComplainsAboutAWrongText) {
  auto some = samples(GetParam(), 1, 3);
  ASSERT_TRUE(misread(some, GetParam()).empty());
  some[7].text = GetParam() ? "movs r1, #77" : "mov r1, #77";
  EXPECT_EQ(misread(some, GetParam()).size(), 1u);
}

/// What objdump prints, without its comments and in one kind of white space.
std::vector<std::string> by_objdump(const std::vector<Sample>& samples, bool thumb) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("fovea_isa_" + std::to_string(::getpid())))
          .string();
  {
    std::ofstream file(path, std::ios::binary);
    for (const Sample& s : samples)
      file.write(reinterpret_cast<const char*>(&s.word), thumb && s.word < 0x10000 ? 2 : 4);
  }
  std::ostringstream command;
  command << ARM_PREFIX "objdump -D -b binary -m armv5tej --adjust-vma=0x" << std::hex << kBase
          << (thumb ? " -M force-thumb " : " ") << path;
  std::istringstream lines(output_of(command.str()));
  std::filesystem::remove(path);
  std::vector<std::string> out;
  for (std::string s; std::getline(lines, s);) {  // address:, word, text @ comment
    const std::size_t word = s.find(":\t"),
                      at = word == std::string::npos ? word : s.find('\t', word + 2);
    if (at == std::string::npos) continue;
    std::istringstream parts(s.substr(at + 1, s.find('@') - at - 1));
    std::string text;
    for (std::string part; parts >> part;) text += (text.empty() ? "" : " ") + part;
    // Numbers of SVC and BKPT are hexadecimal there, the last of a coprocessor's is in braces.
    if (const std::size_t hex = text.find(" 0x");
        hex != std::string::npos && (text.starts_with("svc") || text.starts_with("bkpt")))
      text = text.substr(0, hex + 1) + std::to_string(std::stoul(text.substr(hex), nullptr, 16));
    if (text.ends_with('}') && text[text.size() - 3] == '{')
      text = text.substr(0, text.size() - 3) + text[text.size() - 2];
    if (const std::size_t narrow = text.find(".n "); narrow != std::string::npos)
      text.erase(narrow, 2);
    out.push_back(text);
  }
  return out;
}

TEST(IsaPairTest, HalvesOfThumbCallsPrintAsOne) {
  std::mt19937 random(5);
  std::vector<Sample> all;
  for (unsigned k = 0; k < 200; ++k) {
    const std::uint32_t suffix = k % 2 ? 0xF800u | random() % 2048 : 0xE800u | random() % 1024 * 2;
    const std::uint32_t w = suffix << 16 | 0xF000u | random() % 2048;
    all.push_back({w, isa_row(suffix, true), disassemble(w, true, kBase + 4 * k)});
  }
  const auto theirs = by_objdump(all, true);
  ASSERT_EQ(theirs.size(), all.size());
  for (std::size_t k = 0; k < all.size(); ++k) EXPECT_EQ(all[k].text, theirs[k]);
}

TEST_P(IsaTextTest, ObjdumpPrintsTheSame) {
  std::vector<Sample> all = samples(GetParam(), 40, 4);
  std::erase_if(all, [](const Sample& s) { return s.text.starts_with(".short"); });  // joined there
  const auto theirs = by_objdump(all, GetParam());
  ASSERT_EQ(theirs.size(), all.size());
  unsigned compared = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const IsaFields f = isa_fields(all[k].row, all[k].word);
    // Coprocessors of other chips have instructions of their own for objdump.
    if (isa_has(all[k].row, 'p') && (f['p'] != 15 || theirs[k].ends_with(']'))) continue;
    // Other names for a move to itself and for one register on the stack.
    if (theirs[k] == "nop" ||
        (theirs[k].find('{') != std::string::npos && all[k].text.find('{') == std::string::npos))
      continue;
    ++compared;
    EXPECT_EQ(all[k].text, theirs[k]) << row_at(all[k].row).name << std::hex << " " << all[k].word;
  }
  EXPECT_GE(compared, all.size() * 8 / 10);
}

}  // namespace
}  // namespace fovea::cpu::test
