// Loops in zero-wait internal RAM. Their clocks are counted by hand from ARM DDI 0222B chapter 8,
// instruction by instruction, independently of the core and its table.
#include <sstream>

#include "tb/iss/machine.h"

namespace fovea::cpu::test::loops {
namespace {

/// Behind each instruction of `turn`, after the @, stand its issue clocks and, after a +, those
/// that it waits for an operand. The last branch falls through in the last turn: two clocks less.
struct Loop {
  const char* name;
  unsigned clocks;  ///< of a turn
  unsigned turns;
  const char* before;
  const char* turn;
  unsigned result;      ///< a register that shows that the loop has done its work
  std::uint32_t value;  ///< what it holds afterwards, reckoned apart from the core
};

void PrintTo(const Loop& loop, std::ostream* out) { *out << loop.turn; }

/// Words at `data` for the loops to read; results go to 0x4000 on.
const char* const kData = R"(
  b 9f
data:
  .word 0x00010002, 0x7fff8000, 0xffffffff, 0x12345678
  .word 0x80000001, 0x00000000, 0x0badcafe, 0x55aa33cc
  .word 0x76543210, 0xfedcba98, 0x01020304, 0x00ff00ff
  .word 0x7fffffff, 0x80000000, 0x13579bdf, 0x2468ace0
  .word 0x0f1e2d3c, 0xcafef00d, 0x00000007, 0x40000000
  .word 0x31415926, 0x27182818, 0xdeadbeef, 0x01234567
  .ltorg
9:
  ldr r0, =0x4000
  adr r1, data
  mov r2, r1
)";

constexpr Loop kLoops[] = {
    // Two packed 16-bit samples and taps at a time.
    {"FirMultiplyAccumulate", 15, 6, "add r2, r1, #8\n mov r0, #0\n mov r9, #0\n mov r3, #6\n", R"(
  ldr r4, [r1], #4        @ 1
  ldr r5, [r2], #4        @ 1
  smlabb r0, r4, r5, r0   @ 1 + 1  r5 is the word just loaded
  smlatt r0, r4, r5, r0   @ 1      an accumulator is forwarded to the next accumulate
  ldr r6, [r1], #4        @ 1
  ldr r7, [r2], #4        @ 1
  mov r8, r0, asr #15     @ 1      two instructions behind smlatt
  smlabb r0, r6, r7, r0   @ 1      r7: one instruction between
  smlatt r0, r6, r7, r0   @ 1
  qadd r9, r9, r8         @ 1
  subs r3, r3, #1         @ 1
  bne 1b                  @ 3
)",
     0, 0xC56C4A10},
    {"CopyWords", 15, 4, "mov r2, #4\n", R"(
  ldr r3, [r1], #4        @ 1
  ldr r4, [r1], #4        @ 1
  ldr r5, [r1], #4        @ 1
  str r3, [r0], #4        @ 1      store data three instructions behind its load
  ldr r6, [r1], #4        @ 1
  str r4, [r0], #4        @ 1
  str r5, [r0], #4        @ 1
  str r6, [r0], #4        @ 1      two between
  ldr r3, [r1], #4        @ 1
  str r3, [r0], #4        @ 1 + 1  store data just loaded
  subs r2, r2, #1         @ 1
  bne 1b                  @ 3
)",
     3, 0x40000000},
    // Words, halves and bytes added with end-around carry.
    {"Checksum", 19, 9, "mov r0, r1\n mov r1, #0\n mov r6, #0\n mov r2, #9\n", R"(
  ldr r3, [r0], #4        @ 1
  ldrh r4, [r0], #2       @ 1
  adds r1, r1, r3         @ 1      a word, one instruction between
  adc r1, r1, #0          @ 1      flags never wait
  adds r1, r1, r4         @ 1      a half, two instructions between
  adc r1, r1, #0          @ 1
  ldrh r4, [r0], #2       @ 1
  sub r2, r2, #1          @ 1
  adds r1, r1, r4         @ 1 + 1  a half, one instruction between
  adc r1, r1, #0          @ 1
  ldrb r5, [r0, #-1]      @ 1
  add r6, r6, r5          @ 1 + 2  a byte, used at once
  teq r2, #0              @ 1
  bne 1b                  @ 3
)",
     1, 0xA5818316},
    {"SaturatedAdd", 18, 5,
     "add r2, r1, #40\n mov r7, #0\n mov r8, #0\n mov r12, #5\n ldr r10, =0x5000\n", R"(
  ldmia r1!, {r3, r4}     @ 2
  ldmia r2!, {r5, r6}     @ 2
  qadd r3, r3, r5         @ 1      r5 is not the last of the list
  qadd r4, r4, r6         @ 1      r6 is: one instruction between
  qsub r7, r7, r3         @ 1      QADD class, one between
  qdadd r8, r8, r4        @ 1      likewise
  stmia r0!, {r3, r4}     @ 2
  qadd r7, r7, r8         @ 1      QDADD, hidden under the STM
  mov r9, r7, asr #16     @ 1 + 1  QADD class, used at once
  strh r9, [r10], #2      @ 1
  subs r12, r12, #1       @ 1
  bne 1b                  @ 3
)",
     7, 0x7FFFFFFF},
    {"LongAddAndMultiply", 25, 5, "add r2, r1, #40\n mov r8, #0\n mov r9, #0\n mov r12, #5\n", R"(
  ldrd r4, r5, [r1], #8   @ 2
  ldrd r6, r7, [r2], #8   @ 2
  adds r4, r4, r6         @ 1      r6 is the first word of the pair
  adc r5, r5, r7          @ 1      r7 the second: one instruction between
  umlal r8, r9, r4, r6    @ 3
  strd r4, r5, [r0], #8   @ 2
  umull r10, r11, r5, r7  @ 3
  adds r8, r8, r10        @ 1      the low word does not wait
  adc r9, r9, r11         @ 1      the high word, one instruction between
  umull r10, r11, r4, r7  @ 3
  add r9, r9, r11         @ 1 + 1  the high word at once
  subs r12, r12, #1       @ 1
  bne 1b                  @ 3
)",
     9, 0x4CE7BF3B},
    {"BitCount", 20, 7,
     "mov r0, r1\n mov r7, #0\n mov r9, #0\n mov r8, #31\n mov r12, #7\n ldr r3, =0x55555555\n"
     "ldr r4, =0x33333333\n ldr r5, =0x0f0f0f0f\n ldr r6, =0x01010101\n b 8f\n .ltorg\n8:\n",
     R"(
  ldr r1, [r0], #4        @ 1
  and r2, r3, r1, lsr #1  @ 1 + 1  a word at once, through the shifter
  sub r1, r1, r2          @ 1
  and r2, r4, r1, lsr #2  @ 1
  and r1, r1, r4          @ 1
  add r1, r1, r2          @ 1
  add r1, r1, r1, lsr #4  @ 1
  and r1, r1, r5          @ 1
  mul r2, r1, r6          @ 2
  add r7, r7, r2, lsr #24 @ 1 + 1  a product at once
  movs r2, r1, lsl r8     @ 2      shift by a register
  addne r9, r9, #1        @ 1      passed or failed
  subs r12, r12, #1       @ 1
  bne 1b                  @ 3
)",
     7, 84},
    {"TableLookup", 20, 8, "mov r0, #0\n add r2, r1, #32\n ldr r6, =0x4000\n mov r12, #8\n", R"(
  ldrb r3, [r1], #1            @ 1
  sub r12, r12, #1             @ 1
  and r3, r3, #15              @ 1 + 1  a byte, one instruction between
  ldr r4, [r2, r3, lsl #2]     @ 2      shifted offset
  ldrb r5, [r1], #1            @ 1
  add r0, r0, r4               @ 1      a word, one instruction between
  and r5, r5, #15              @ 1 + 1  a byte, one instruction between
  ldr r4, [r2, r5, lsl #2]     @ 2
  eor r0, r0, r4, ror #7       @ 1 + 1  a word at once
  str r0, [r6, r3, lsl #2]     @ 2
  cmp r12, #0                  @ 1
  bgt 1b                       @ 3
)",
     0, 0x9106BC95},
    {"ThumbMixedLoop", 22, 7,
     "mov r0, r1\n mov r1, #0\n mov r2, #3\n ldr sp, =0x5000\n add r8, r0, #28\n adr r7, 2f + 1\n"
     "bx r7\n .thumb\n .align 2\n2:\n",
     R"(
  ldrh r3, [r0, #0]       @ 1
  ldrb r4, [r0, #2]       @ 1
  adds r0, #4             @ 1
  lsls r5, r3, #2         @ 1      a half, two instructions between
  adds r1, r1, r4         @ 1      a byte, two between
  muls r5, r4             @ 4      sets flags
  adds r1, r1, r5         @ 1      so the product is there
  lsrs r5, r2             @ 2      shift by a register
  push {r1, r5}           @ 2
  pop {r6, r7}            @ 2
  adds r2, r2, r7         @ 1 + 1  last of the list, at once
  cmp r0, r8              @ 1
  bne 1b                  @ 3
)",
     1, 0x0864F704},
    {"BlockTransfers", 33, 2, "mov r2, r0\n mov r0, r1\n mov r1, r2\n mov r2, #0\n mov r12, #2\n",
     R"(
  ldmia r0!, {r3-r6}      @ 4
  add r2, r2, r3          @ 1      not the last
  eor r2, r2, r6          @ 1      the last, one instruction between
  stmia r1!, {r3-r6}      @ 4
  ldmia r0!, {r3-r8}      @ 6
  stmia r1!, {r8, r9}     @ 2 + 1  the last loaded is the first stored
  stmia r1!, {r3-r7}      @ 5
  ldmdb r0, {r10}         @ 2      a list of one
  subs r12, r12, #1       @ 1
  add r2, r2, r10         @ 1      one instruction between
  stmia r1, {r2}          @ 2      a list of one
  bne 1b                  @ 3
)",
     2, 0xD2141416},
    // The firmware's two loops over pixel pairs: eight pairs a turn, one pair a turn.
    {"RemapEightPairs", 28, 2,
     "mov r2, r1\n ldr r5, =0x4100\n mov r6, #16\n mov r7, r5\n"
     "7: sub r6, r6, #1\n mov r8, r6, lsl #2\n str r8, [r7], #4\n cmp r6, #0\n bne 7b\n"
     "mov r2, r5\n mov r3, #8\n b 8f\n .ltorg\n8:\n",
     R"(
  ldmia r2!, {r4-r11}     @ 8
  ldr r4, [r1, r4]        @ 1      not the last
  ldr r5, [r1, r5]        @ 1
  ldr r6, [r1, r6]        @ 1
  ldr r7, [r1, r7]        @ 1
  ldr r8, [r1, r8]        @ 1
  ldr r9, [r1, r9]        @ 1
  ldr r10, [r1, r10]      @ 1
  ldr r11, [r1, r11]      @ 1      the last, seven instructions between
  subs r3, r3, #8         @ 1
  stmia r0!, {r4-r11}     @ 8
  bhs 1b                  @ 3
)",
     11, 0x00010002},
    {"RemapOnePair", 9, 16,
     "mov r2, r1\n ldr r5, =0x4100\n mov r6, #16\n mov r7, r5\n"
     "7: sub r6, r6, #1\n mov r8, r6, lsl #2\n str r8, [r7], #4\n cmp r6, #0\n bne 7b\n"
     "mov r2, r5\n add r3, r0, #64\n b 8f\n .ltorg\n8:\n",
     R"(
  ldr r12, [r2], #4       @ 1
  ldr r12, [r1, r12]      @ 1 + 1  an address just loaded
  str r12, [r0], #4       @ 1 + 1  store data just loaded
  cmp r3, r0              @ 1
  bne 1b                  @ 3
)",
     12, 0x00010002},
};

/// Adds up the figures behind the @ of each line.
unsigned noted(const char* turn) {
  unsigned sum = 0;
  std::istringstream lines(turn);
  for (std::string line; std::getline(lines, line);) {
    const auto at = line.find('@');
    if (at == std::string::npos) continue;
    std::istringstream figures(line.substr(at + 1));
    unsigned n = 0;
    char plus = 0;
    figures >> n;
    sum += n;
    if (figures >> plus && plus == '+' && figures >> n) sum += n;
  }
  return sum;
}

class LoopTest : public testing::TestWithParam<Loop> {};

TEST_P(LoopTest, TakesTheClocksCountedByHand) {
  const Loop& loop = GetParam();
  ASSERT_EQ(noted(loop.turn), loop.clocks) << "the sum beside the instructions";
  Machine m;
  m.execute(std::string(kData) + loop.before + " svc #1\n1:" + loop.turn + " svc #1\n");
  ASSERT_EQ(m.marks.size(), 2u);
  EXPECT_EQ(m.between(), loop.turns * loop.clocks - 2);
  EXPECT_EQ(m.core.reg(loop.result), loop.value);
}
INSTANTIATE_TEST_SUITE_P(TenAndMore, LoopTest, testing::ValuesIn(kLoops),
                         [](const auto& row) { return std::string(row.param.name); });

/// Leaves in its middle, so it is counted by itself: strings of 16 characters.
TEST(LoopsTest, StringLength) {
  Machine m;
  m.execute(R"(
  b 9f
text: .asciz "sixteen  letters"
  .align 2
9: adr r0, text
  mov r1, #0
  svc #1
1: ldrb r2, [r0], #1   @ 1
  cmp r2, #0           @ 1 + 2  a byte at once
  beq 2f               @ 1      3 where it ends the loop
  ldrb r3, [r0], #1    @ 1
  cmp r3, #0           @ 1 + 2
  beq 2f               @ 1      3 where it ends the loop
  ldrb r2, [r0], #1    @ 1
  add r1, r1, #3       @ 1
  cmp r2, #0           @ 1 + 1  one instruction between
  bne 1b               @ 3
2: svc #1
  sub r0, r0, #1
  adr r1, text
  sub r0, r0, r1
)");
  // Five whole turns of 17; in the sixth the second character is the end: 1 + 3 + 1, 1 + 3 + 3.
  EXPECT_EQ(m.between(), 5u * 17 + 5 + 7);
  EXPECT_EQ(m.core.reg(0), 16u);
}

/// A sum that is not what stands beside the instructions is found.
TEST(LoopsTest, SumOfTheFiguresIsRead) {
  EXPECT_EQ(noted(" add r0, r0  @ 1\n ldr r1, [r0] @ 1 + 2 why\n b 1b @ 3\n"), 7u);
  EXPECT_EQ(noted(" add r0, r0  @ 1 + r1 was loaded before\n"), 1u);
}

}  // namespace
}  // namespace fovea::cpu::test::loops
