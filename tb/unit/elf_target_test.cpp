// Programs for processors other than an ARM926EJ-S are refused because of their ELF attributes.
#include "sw/fovea/program/elf_target.h"

#include <initializer_list>

#include "sw/fovea/program/elf_image.h"
#include "tb/unit/support.h"

namespace fovea::app {
namespace {

using test::user_error;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Bytes = std::vector<std::uint8_t>;

void put_word(Bytes& to, std::size_t v) {
  for (unsigned k = 0; k < 4; ++k) to.push_back(static_cast<std::uint8_t>(v >> (8 * k)));
}

/// A section of one vendor with attributes of one scope (1: the file, 2: a section, 3: a symbol).
Bytes section(const Bytes& attributes, const std::string& vendor = "aeabi",
              std::uint8_t scope = 1) {
  Bytes out{'A'};
  put_word(out, 4 + vendor.size() + 1 + 5 + attributes.size());
  out.insert(out.end(), vendor.begin(), vendor.end());
  out.push_back(0);
  out.push_back(scope);
  put_word(out, 5 + attributes.size());
  out.insert(out.end(), attributes.begin(), attributes.end());
  return out;
}

constexpr std::uint8_t kRawName = 4, kName = 5, kArch = 6, kProfile = 7, kThumbUse = 9, kFp = 10,
                       kVfpArgs = 28, kCompatibility = 32;

TEST(ElfTargetTest, ArchitecturesUpToV5TejAreAccepted) {
  for (std::uint8_t arch = 0; arch <= 5; ++arch)
    EXPECT_EQ(unfit_attributes(section({kArch, arch})), "") << unsigned{arch};
  const char* const later[] = {"ARMv6", "ARMv6KZ", "ARMv6T2", "ARMv6K", "ARMv7", "ARMv6-M"};
  for (std::uint8_t arch = 6; arch < 6 + std::size(later); ++arch)
    EXPECT_EQ(unfit_attributes(section({kArch, arch})),
              std::string("it is built for ") + later[arch - 6]);
  EXPECT_EQ(unfit_attributes(section({kArch, 13})), "it is built for ARMv7E-M");
  EXPECT_EQ(unfit_attributes(section({kArch, 14})), "it is built for ARMv8-A");
  EXPECT_EQ(unfit_attributes(section({kArch, 22})), "it is built for ARMv9-A");
  EXPECT_EQ(unfit_attributes(section({kArch, 23})), "it is built for architecture number 23");
  EXPECT_EQ(unfit_attributes(section({kArch, 10, kProfile, 'M'})), "it is built for ARMv7-M");
  EXPECT_EQ(unfit_attributes(section({kArch, 0x85, 0x01})),
            "it is built for architecture number 133")
      << "numbers of two bytes";
}

TEST(ElfTargetTest, ProfileThumbAndCallsAreLookedAtToo) {
  EXPECT_THAT(unfit_attributes(section({kProfile, 'M'})), HasSubstr("Cortex-M"));
  EXPECT_EQ(unfit_attributes(section({kProfile, 'S'})), "");
  EXPECT_EQ(unfit_attributes(section({kArch, 5, kThumbUse, 1})), "");
  EXPECT_THAT(unfit_attributes(section({kArch, 5, kThumbUse, 2})), HasSubstr("Thumb-2"));
  EXPECT_THAT(unfit_attributes(section({kVfpArgs, 1})), HasSubstr("VFP registers"));
  EXPECT_EQ(unfit_attributes(section({kVfpArgs, 0})), "");
  EXPECT_EQ(unfit_attributes(section({kVfpArgs, 3})), "") << "compatible with both";
  EXPECT_EQ(unfit_attributes(section({kArch, 4, kFp, 2})), "")
      << "a kernel may ask before it uses it";
}

TEST(ElfTargetTest, OtherAttributesAreSteppedOver) {
  const Bytes name{'v', 6, 0};  // text with what would be a tag in it
  for (const std::uint8_t tag : {kRawName, kName, std::uint8_t{67}}) {
    Bytes a{tag};
    a.insert(a.end(), name.begin(), name.end());
    a.insert(a.end(), {kArch, 7});
    EXPECT_EQ(unfit_attributes(section(a)), "it is built for ARMv6KZ") << unsigned{tag};
  }
  EXPECT_EQ(unfit_attributes(section({68, 6, kArch, 7})), "it is built for ARMv6KZ");
  EXPECT_EQ(unfit_attributes(section({kCompatibility, 1, 'g', 0, kArch, 7})),
            "it is built for ARMv6KZ");
  EXPECT_EQ(unfit_attributes(section({kArch, 10}, "gnu")), "") << "another vendor's";
  EXPECT_EQ(unfit_attributes(section({kArch, 10}, "aeabi", 2)), "") << "of a section alone";
  // The second vendor's part, the second scope.
  Bytes two = section({kArch, 3}, "gnu"), next = section({kArch, 10});
  two.insert(two.end(), next.begin() + 1, next.end());
  EXPECT_EQ(unfit_attributes(two), "it is built for ARMv7");
}

TEST(ElfTargetTest, DamagedAttributesSayNothingAndDoNoHarm) {
  EXPECT_EQ(unfit_attributes({}), "");
  EXPECT_EQ(unfit_attributes(Bytes{'B', 1, 2, 3}), "");
  const Bytes whole = section({kArch, 10});
  for (std::size_t n = 0; n < whole.size(); ++n)
    EXPECT_EQ(unfit_attributes(std::span(whole).first(n)), "") << n;
  for (std::size_t k = 1; k < whole.size(); ++k)
    for (const unsigned v : {0x00u, 0x01u, 0x7Fu, 0x80u, 0xFFu}) {
      Bytes bad = whole;
      bad[k] = static_cast<std::uint8_t>(v);
      unfit_attributes(bad);
    }
}

TEST(ElfTargetTest, FlagsOfTheHeader) {
  EXPECT_EQ(unfit_flags(0x05000000), "");
  EXPECT_EQ(unfit_flags(0x05000200), "") << "EABI 5, soft float";
  EXPECT_EQ(unfit_flags(0x00000000), "") << "no EABI";
  EXPECT_EQ(unfit_flags(0x00000400), "") << "the bit means something else before EABI 5";
  EXPECT_THAT(unfit_flags(0x05000400), HasSubstr("hard-float"));
  EXPECT_THAT(unfit_flags(0x05800200), HasSubstr("BE8"));
}

TEST(ElfTargetTest, ProgramsOfTheCompilerAreRefusedInOneLine) {
  const std::pair<const char*, const char*> refused[] = {
      {"cortex_m3.elf", "ARMv7-M"}, {"cortex_a8.elf", "ARMv7"}, {"arm1136.elf", "ARMv6"}};
  for (const auto& [file, what] : refused) {
    const std::string path = std::string(FIXTURE_DIR "/") + file;
    EXPECT_THAT(user_error([&] { ElfImage::load(path); }),
                AllOf(HasSubstr(path), HasSubstr(std::string("it is built for ") + what),
                      HasSubstr("-mcpu=arm926ej-s"), Not(HasSubstr("\n"))));
  }
  EXPECT_NO_THROW(ElfImage::load(FIXTURE_DIR "/arm7tdmi.elf"));
  EXPECT_NO_THROW(ElfImage::load(FIXTURE_GOOD));
}

}  // namespace
}  // namespace fovea::app
