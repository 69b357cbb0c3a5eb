// The core's messages about faulty programs.
#include <map>

#include "model/common/check.h"
#include "tb/iss/machine.h"

namespace fovea::cpu::test {
namespace {

class MessageTest : public testing::Test {
 protected:
  Machine m;
  MessageTest() {
    m.core.describe = [](std::uint32_t a) {
      return a >= 0x300 && a < 0x400 ? "late" : std::string();
    };
  }
  std::map<std::string, std::uint64_t> warnings() const {
    std::map<std::string, std::uint64_t> out;
    for (const auto& [key, n] : m.diagnostics.counts()) out[key.second] = n;
    return out;
  }
  /// Runs until nothing helps. @return what is said then
  std::string failure(const std::string& text, std::uint32_t base = 0x100) {
    for (std::uint32_t a = 0; a < 0x20; a += 4) std::memcpy(m.tcm.data() + a, &kUndefined, 4);
    try {
      m.execute(text, base);
    } catch (const GuestFailure& e) {
      return e.what();
    }
    return "";
  }
  static constexpr std::uint32_t kUndefined = 0xE7F000F0u;
};

TEST_F(MessageTest, UnpredictableFormNamesItsFirstPlace) {
  // ldr r0, [r0], #4: the base is the destination.
  m.execute(
      "mov r5, #3\n1: mov r0, #0x4000\n .inst 0xe4900004\n subs r5, r5, #1\n bne 1b\n"
      "mov r0, #0x4000\n .inst 0xe4900004\n mov r0, #0x4000\n mov r1, #0x4000\n"
      ".inst 0xe4911004\n");
  const std::map<std::string, std::uint64_t> expected = {
      {"UNPREDICTABLE: ldr imm post, first at 0x00000008", 5}};
  EXPECT_EQ(warnings(), expected) << "one warning for the form, not one for each place";
}

TEST_F(MessageTest, UnpredictableFormNamesItsFunction) {
  m.execute("mov r0, #0x4000\n .inst 0xe4900004\n", 0x300);
  EXPECT_EQ(warnings().count("UNPREDICTABLE: ldr imm post, first at 0x00000304 (late)"), 1u);
}

TEST_F(MessageTest, AnotherCoreOfTheProcessIsNotHeard) {
  Machine other;
  other.execute("mov r0, #0x4000\n .inst 0xe4900004\n");
  EXPECT_TRUE(warnings().empty());
  EXPECT_EQ(other.diagnostics.counts().size(), 1u);
}

TEST_F(MessageTest, JumpToZeroSaysWhereFrom) {
  const std::string rest = "undefined instruction with no handler: its vector faults again";
  EXPECT_EQ(failure("mov r3, #0\n blx r3\n"), "jumped to 0 from 0x00000104; " + rest);
  EXPECT_EQ(m.core.current_pc(), 0u);
  // Each kind of jump, from a place with a name.
  for (const char* text :
       {"mov r3, #0\n bx r3\n", "mov r3, #0\n mov pc, r3\n", "ldr pc, 1f\n nop\n1: .word 0\n"}) {
    Machine again;
    const std::uint32_t at = std::string(text).starts_with("ldr") ? 0x300 : 0x304;
    for (std::uint32_t a = 0; a < 0x20; a += 4) std::memcpy(again.tcm.data() + a, &kUndefined, 4);
    again.core.describe = m.core.describe;
    try {
      again.execute(text, 0x300);
      ADD_FAILURE() << text;
    } catch (const GuestFailure& e) {
      char from[32];
      std::snprintf(from, sizeof from, "0x%08x (late); ", at);
      EXPECT_EQ(e.what(), "jumped to 0 from " + std::string(from) + rest) << text;
    }
  }
}

TEST_F(MessageTest, ThumbJumpToZeroSaysWhereFrom) {
  EXPECT_EQ(failure("adr r0, 1f + 1\n bx r0\n .thumb\n1: movs r3, #0\n blx r3\n .arm\n"),
            "jumped to 0 from 0x0000010a; undefined instruction with no handler: its vector faults "
            "again");
}

TEST_F(MessageTest, OtherFailuresAreNoJumps) {
  EXPECT_EQ(failure("mov r3, #0\n b 1f\n.balign 64\n1: .inst 0xe7f000f0\n"),
            "undefined instruction with no handler: its vector faults again");
  Machine at_zero;  // the reset's own instruction
  std::memcpy(at_zero.tcm.data(), &kUndefined, 4);
  std::memcpy(at_zero.tcm.data() + 4, &kUndefined, 4);
  try {
    at_zero.run(0);
    ADD_FAILURE();
  } catch (const GuestFailure& e) {
    EXPECT_STREQ(e.what(), "undefined instruction with no handler: its vector faults again");
  }
}

}  // namespace
}  // namespace fovea::cpu::test
