// sw/fovea/program/elf_image.h with programs built by the cross compiler.
#include <fstream>

#include "sw/fovea/program/elf_image.h"
#include "tb/unit/support.h"

namespace fovea::app {
namespace {

using test::read_text;
using test::TempDir;
using test::user_error;
using testing::AllOf;
using testing::HasSubstr;

const std::string kGood = FIXTURE_GOOD;        // linked to 0x80000000
const std::string kOutside = FIXTURE_OUTSIDE;  // the same, linked to 0x10000000
const std::string kObject = FIXTURE_OBJECT;    // not linked

// ELF32 file header, byte offsets (System V ABI).
constexpr std::size_t kClass = 4, kData = 5, kMachine = 18, kPhoff = 28, kPhnum = 44;
constexpr std::size_t kVersion = 20, kEntry = 24, kPhentry = 42;
constexpr std::size_t kPhentsize = 32, kPPaddr = 12, kPFilesz = 16;

class ElfTest : public testing::Test {
 protected:
  std::string patched_error(std::size_t offset, std::uint8_t value) {
    std::string bytes = read_text(kGood);
    bytes.at(offset) = static_cast<char>(value);
    const auto file = dir.write("patched.elf", bytes);
    return user_error([&] { ElfImage::load(file); });
  }
  TempDir dir;
};

TEST_F(ElfTest, SegmentsHoldTheFilesBytesAtTheirAddresses) {
  const auto image = ElfImage::load(kGood);
  ASSERT_FALSE(image.segments().empty());
  std::uint64_t in_file = 0, in_memory = 0;
  bool found = false;
  const ElfSymbol* counter = image.find("counter");
  ASSERT_NE(counter, nullptr);
  EXPECT_EQ(counter->size, 4u);
  for (const auto& s : image.segments()) {
    EXPECT_EQ(s.address >> 24, 0x80u);
    EXPECT_LE(s.data.size(), s.memory_size);
    in_file += s.data.size();
    in_memory += s.memory_size;
    const std::uint32_t offset = counter->address - s.virtual_address;
    if (counter->address >= s.virtual_address && offset + 4 <= s.data.size()) {
      found = true;
      EXPECT_EQ(s.data[offset], 5) << "the initial value of `counter`, little-endian";
      EXPECT_EQ(s.data[offset + 1], 0);
    }
  }
  EXPECT_TRUE(found);
  EXPECT_GE(in_memory - in_file, 64u) << "`zeroed` takes no room in the file";
}

TEST_F(ElfTest, ControlCharactersInNamesAreEscaped) {
  std::string bytes = read_text(kGood);
  const std::string name("\0counter\0", 9);
  const std::size_t at = bytes.find(name);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at + 1, 7, "\x1b[31m\nr");
  const auto image = ElfImage::load(dir.write("escape.elf", bytes));
  EXPECT_EQ(image.find("counter"), nullptr);
  EXPECT_NE(image.find("\\x1b[31m\\nr"), nullptr);
}

TEST_F(ElfTest, EntryIsTheStartFunction) {
  const auto image = ElfImage::load(kGood);
  ASSERT_NE(image.find("_start"), nullptr);
  EXPECT_EQ(image.entry(), image.find("_start")->address);
}

TEST_F(ElfTest, AddressesFindTheirFunction) {
  const auto image = ElfImage::load(kGood);
  const ElfSymbol* add = image.find("add_one");
  ASSERT_NE(add, nullptr);
  EXPECT_TRUE(add->function);
  EXPECT_EQ(image.describe(add->address), "add_one");
  EXPECT_EQ(image.describe(add->address + 4), "add_one+0x4");
  EXPECT_EQ(image.function_at(add->address + add->size - 1), add);
  EXPECT_NE(image.function_at(add->address + add->size), add) << "one behind the end";
  EXPECT_EQ(image.describe(0x4000'0000), "");
  EXPECT_EQ(image.describe(image.find("counter")->address), "") << "data is no function";
}

TEST_F(ElfTest, ThumbFunctionHasAnEvenAddress) {
  const auto image = ElfImage::load(kGood);
  const ElfSymbol* thumb = image.find("thumb_double");
  ASSERT_NE(thumb, nullptr);
  EXPECT_EQ(thumb->address & 1u, 0u);
  EXPECT_EQ(image.describe(thumb->address + 2), "thumb_double+0x2");
}

TEST_F(ElfTest, LabelWithoutSizeCountsAsFunctionAndMappingSymbolsDoNot) {
  const auto image = ElfImage::load(kGood);
  const ElfSymbol* label = image.find("plain_label");
  ASSERT_NE(label, nullptr);
  EXPECT_EQ(image.describe(label->address + 4), "plain_label+0x4");
  for (const auto& s : image.symbols()) EXPECT_NE(s.name.front(), '$') << s.name;
}

TEST_F(ElfTest, ProgramThatFitsIsAcceptedToTheByte) {
  const auto image = ElfImage::load(kGood);
  std::uint64_t end = 0;
  for (const auto& s : image.segments())
    end = std::max<std::uint64_t>(end, std::uint64_t{s.address} + s.memory_size);
  const std::vector<MemoryRegion> exact{{"DDR", 0x8000'0000, end - 0x8000'0000}};
  EXPECT_NO_THROW(check_fits(image, exact));
  const std::vector<MemoryRegion> short_by_one{{"DDR", 0x8000'0000, end - 0x8000'0001}};
  EXPECT_THAT(user_error([&] { check_fits(image, short_by_one); }), HasSubstr("outside memory"));
}

TEST_F(ElfTest, ProgramOutsideMemoryNamesSegmentAndRegions) {
  const auto image = ElfImage::load(kOutside);
  const std::vector<MemoryRegion> regions{{"DDR", 0x8000'0000, 128u << 20},
                                          {"ARM internal RAM", 0, 32u << 10}};
  EXPECT_THAT(user_error([&] { check_fits(image, regions); }),
              AllOf(HasSubstr(kOutside), HasSubstr("segment"), HasSubstr("0x10000000"),
                    HasSubstr("DDR 0x80000000..0x87ffffff"),
                    HasSubstr("ARM internal RAM 0x00000000..0x00007fff")));
}

TEST_F(ElfTest, WhatIsNoElfIsSaidSo) {
  const auto text = dir.write("fw.elf", "#!/bin/sh\necho this is a script\n");
  EXPECT_THAT(user_error([&] { ElfImage::load(text); }),
              AllOf(HasSubstr("fw.elf"), HasSubstr("not an ELF"), HasSubstr("ARM")));
  const auto empty = dir.write("empty.elf", "");
  EXPECT_THAT(user_error([&] { ElfImage::load(empty); }), HasSubstr("not an ELF"));
  EXPECT_THAT(user_error([&] { ElfImage::load(dir / "none.elf"); }), HasSubstr("No such file"));
}

TEST_F(ElfTest, ProgramForTheHostNamesItsMachine) {
  const std::string error = user_error([] { ElfImage::load("/proc/self/exe"); });
  EXPECT_THAT(error, AllOf(HasSubstr("it is for"), HasSubstr("ARM")));
#if defined(__x86_64__)
  EXPECT_THAT(error, HasSubstr("x86-64"));
#endif
}

TEST_F(ElfTest, OtherMachineClassOrderAndTypeAreRefused) {
  EXPECT_THAT(patched_error(kMachine, 8), HasSubstr("MIPS"));
  EXPECT_THAT(patched_error(kClass, 2), HasSubstr("patched.elf"));
  EXPECT_THAT(patched_error(kData, 2), HasSubstr("patched.elf"));
  EXPECT_THAT(user_error([] { ElfImage::load(kObject); }), HasSubstr("object file"));
}

// The entry point is in no segment; in the zeros behind one; in the middle of an ARM instruction; of the other state.
TEST_F(ElfTest, EntryPointIsInTheBytesOfASegmentAndOfItsInstructionSet) {
  const std::string whole = read_text(kGood);
  const auto image = ElfImage::load(kGood);
  const auto with_entry = [&](std::uint32_t entry) {
    std::string bytes = whole;
    for (unsigned k = 0; k < 4; ++k) bytes[kEntry + k] = static_cast<char>(entry >> 8 * k);
    return dir.write("entry.elf", bytes);
  };
  const auto refusal = [&](std::uint32_t entry) {
    const auto file = with_entry(entry);
    return user_error([&] { ElfImage::load(file); });
  };
  const std::uint32_t arm = image.find("add_one")->address, thumb = image.find("thumb_double")->address;
  EXPECT_EQ(ElfImage::load(with_entry(arm)).entry(), arm);
  EXPECT_EQ(ElfImage::load(with_entry(thumb + 1)).entry(), thumb + 1);
  EXPECT_THAT(refusal(0x0400'0000), AllOf(HasSubstr("entry.elf"), HasSubstr("entry point 0x04000000 is in no segment"),
                                          HasSubstr("an address in the bytes of one")));
  EXPECT_THAT(refusal(image.find("zeroed")->address & ~3u), HasSubstr("is in no segment"));
  EXPECT_THAT(refusal(arm + 2), HasSubstr("no address of an ARM instruction"));
  EXPECT_THAT(refusal(arm + 1), HasSubstr("selects Thumb state, but the code there is ARM"));
  EXPECT_THAT(refusal((thumb + 3) & ~3u), HasSubstr("selects ARM state, but the code there is Thumb"));
}

TEST_F(ElfTest, FieldsOfTheHeaderThatLibelfTakesAsTheyAreAreChecked) {
  EXPECT_THAT(patched_error(kVersion, 2), HasSubstr("version 2 of ELF"));
  EXPECT_THAT(patched_error(kPhentry, 40), HasSubstr("has 40 bytes; allowed: 32"));
}

TEST_F(ElfTest, OverlapOfSegmentsIsOneOfPhysicalAddresses) {
  std::string bytes = read_text(kGood);
  const auto phoff = static_cast<std::uint8_t>(bytes[kPhoff]);
  for (unsigned i = 0; i < static_cast<std::uint8_t>(bytes[kPhnum]); ++i)
    bytes.replace(phoff + i * kPhentsize + kPPaddr, 4, 4, '\0');
  const auto file = dir.write("patched.elf", bytes);
  EXPECT_THAT(user_error([&] { ElfImage::load(file); }),
              AllOf(HasSubstr("overlap in their physical addresses"), HasSubstr("0x00000000..")));
}

TEST_F(ElfTest, ProgramWithoutSegmentsIsRefused) {
  EXPECT_THAT(patched_error(kPhnum, 0), HasSubstr("no segments"));
}

TEST_F(ElfTest, SegmentLongerInFileThanInMemoryIsRefused) {
  const std::string bytes = read_text(kGood);
  const auto phoff = static_cast<std::uint8_t>(bytes[kPhoff]);
  // The high byte of p_filesz of every header: one of them is loadable.
  std::string broken = bytes;
  for (unsigned i = 0; i < static_cast<std::uint8_t>(bytes[kPhnum]); ++i)
    broken[phoff + i * kPhentsize + kPFilesz + 2] = 0x7f;
  const auto file = dir.write("patched.elf", broken);
  EXPECT_THAT(user_error([&] { ElfImage::load(file); }), HasSubstr("longer in file"));
}

TEST_F(ElfTest, EveryCutOfTheFileIsAnErrorOrHasAllSegments) {
  const std::string whole = read_text(kGood);
  const auto image = ElfImage::load(kGood);
  int refused = 0;
  for (std::size_t size = 0; size < whole.size(); size += size < 600 ? 1 : 131) {
    const auto file = dir.write("cut.elf", whole.substr(0, size));
    try {
      const auto cut = ElfImage::load(file);
      ASSERT_EQ(cut.segments().size(), image.segments().size()) << size;
      for (std::size_t i = 0; i < cut.segments().size(); ++i)
        ASSERT_EQ(cut.segments()[i].data, image.segments()[i].data) << size;
    } catch (const UserError& e) {
      ++refused;
      ASSERT_THAT(e.what(), HasSubstr("cut.elf"));
    }
  }
  EXPECT_GT(refused, 52) << "at least every cut in the file header";
}

TEST_F(ElfTest, RandomDamageNeverGetsPastAnError) {
  const std::string whole = read_text(kGood);
  std::uint32_t random = 12345;
  const auto next = [&random] { return random = random * 1664525u + 1013904223u; };
  for (int i = 0; i < 500; ++i) {
    std::string bytes = whole;
    for (int k = 0; k < 4; ++k) {
      // Headers at both ends of the file are what matters.
      const std::size_t span = std::min<std::size_t>(200, bytes.size());
      const std::size_t at =
          next() >> 16 & 1 ? (next() >> 8) % span : bytes.size() - 1 - (next() >> 8) % (2 * span);
      bytes[at] = static_cast<char>(next() >> 24);
    }
    const auto file = dir.write("damaged.elf", bytes);
    try {
      const auto image = ElfImage::load(file);
      for (const auto& s : image.segments()) ASSERT_LE(s.data.size(), s.memory_size);
      image.describe(image.entry());
    } catch (const UserError& e) {
      ASSERT_THAT(e.what(), HasSubstr("damaged.elf"));
    }
  }
}

}  // namespace
}  // namespace fovea::app
