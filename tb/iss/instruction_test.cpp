// Results and flags of single instructions, worked out by hand from ARM DDI 0100; corner cases of
// v5TE.
#include "tb/iss/machine.h"

namespace fovea::cpu::test {
namespace {

/// `r0` is the result, `r1` a second one where a case gives it; flags as N Z C V Q from the left.
struct Case {
  const char* name;
  const char* text;
  std::uint32_t r0;
  const char* flags = nullptr;  ///< "nzcvq": capital set, small clear; nullptr: not looked at
  std::uint32_t r1 = 0;
  bool check_r1 = false;
};

constexpr Case kCases[] = {
    // Sums and differences.
    {"AddCarry", "mvn r1, #0\n adds r0, r1, #1", 0, "nZCvq"},
    {"AddOverflow", "ldr r1, =0x7fffffff\n adds r0, r1, #1", 0x80000000, "NzcVq"},
    {"AddNegativeOverflow", "mov r1, #0x80000000\n adds r0, r1, r1", 0, "nZCVq"},
    {"SubNoBorrow", "mov r1, #5\n subs r0, r1, #5", 0, "nZCvq"},
    {"SubBorrow", "mov r1, #4\n subs r0, r1, #5", 0xFFFFFFFF, "Nzcvq"},
    {"SubOverflow", "mov r1, #0x80000000\n subs r0, r1, #1", 0x7FFFFFFF, "nzCVq"},
    {"Rsb", "mov r1, #4\n rsbs r0, r1, #5", 1, "nzCvq"},
    {"AdcWithCarry", "mvn r1, #0\n cmp r1, r1\n adcs r0, r1, #0", 0, "nZCvq"},
    {"AdcWithoutCarry", "mov r1, #0\n cmn r1, r1\n adcs r0, r1, #7", 7, "nzcvq"},
    {"SbcWithCarry", "mov r1, #9\n cmp r1, r1\n sbcs r0, r1, #4", 5, "nzCvq"},
    {"SbcWithoutCarry", "mov r1, #9\n cmn r1, #0\n sbcs r0, r1, #4", 4, "nzCvq"},
    {"RscWithoutCarry", "mov r1, #4\n cmn r1, #0\n rscs r0, r1, #9", 4, "nzCvq"},
    {"CmpUnsignedLower", "mov r0, #1\n cmp r0, #0xff000000", 1, "nzcvq"},
    {"CmnCarry", "mvn r0, #0\n cmn r0, #2", 0xFFFFFFFF, "nzCvq"},
    // Logic: C from the shifter, V kept.
    {"AndKeepsV", "mov r1, #0x80000000\n adds r2, r1, r1\n ands r0, r1, r1", 0x80000000, "NzCVq"},
    {"RotatedImmediateGivesCarry", "movs r0, #0x80000000", 0x80000000, "NzCvq"},
    {"RotatedImmediateClearsCarry", "cmp r0, r0\n movs r0, #0x40000000", 0x40000000, "nzcvq"},
    {"PlainImmediateKeepsCarry", "cmp r0, r0\n movs r0, #1", 1, "nzCvq"},
    {"Bic", "mvn r1, #0\n bics r0, r1, #0xff", 0xFFFFFF00, "Nzcvq"},
    {"Mvn", "mvns r0, #0", 0xFFFFFFFF, "Nzcvq"},
    {"Teq", "mov r0, #6\n teq r0, #6", 6, "nZcvq"},
    {"Tst", "mov r0, #6\n tst r0, #9", 6, "nZcvq"},
    // Shifts by immediate: row 21 of the corner cases.
    {"LslImmediate", "mov r1, #0xc0000000\n movs r0, r1, lsl #1", 0x80000000, "NzCvq"},
    {"LsrThirtyTwo", "mov r1, #0x80000000\n movs r0, r1, lsr #32", 0, "nZCvq"},
    {"AsrThirtyTwo", "mov r1, #0x80000000\n movs r0, r1, asr #32", 0xFFFFFFFF, "NzCvq"},
    {"RorImmediate", "mov r1, #0x18\n movs r0, r1, ror #4", 0x80000001, "NzCvq"},
    {"RrxWithCarry", "mov r1, #2\n cmp r1, r1\n movs r0, r1, rrx", 0x80000001, "Nzcvq"},
    {"RrxGivesCarry", "mov r1, #3\n cmn r1, #0\n movs r0, r1, rrx", 1, "nzCvq"},
    // Shifts by register: row 20.
    {"LslByZeroKeepsCarry", "mov r1, #1\n mov r2, #0\n cmp r1, r1\n movs r0, r1, lsl r2", 1,
     "nzCvq"},
    {"LslBy256IsZero", "mov r1, #1\n mov r2, #256\n cmp r1, r1\n movs r0, r1, lsl r2", 1, "nzCvq"},
    {"LslBy32", "mov r1, #1\n mov r2, #32\n movs r0, r1, lsl r2", 0, "nZCvq"},
    {"LslBy33", "mvn r1, #0\n mov r2, #33\n cmp r1, r1\n movs r0, r1, lsl r2", 0, "nZcvq"},
    {"LsrBy32", "mov r1, #0x80000000\n mov r2, #32\n movs r0, r1, lsr r2", 0, "nZCvq"},
    {"LsrBy33", "mvn r1, #0\n mov r2, #33\n cmp r1, r1\n movs r0, r1, lsr r2", 0, "nZcvq"},
    {"AsrBy40", "mov r1, #0x80000000\n mov r2, #40\n movs r0, r1, asr r2", 0xFFFFFFFF, "NzCvq"},
    {"AsrBy40Positive", "ldr r1, =0x7fffffff\n mov r2, #40\n cmp r1, r1\n movs r0, r1, asr r2", 0,
     "nZcvq"},
    {"RorBy32", "mov r1, #0x80000000\n mov r2, #32\n movs r0, r1, ror r2", 0x80000000, "NzCvq"},
    {"RorBy33", "mov r1, #1\n mov r2, #33\n movs r0, r1, ror r2", 0x80000000, "NzCvq"},
    {"RorBy64", "mov r1, #1\n mov r2, #64\n cmp r1, r1\n movs r0, r1, ror r2", 1, "nzcvq"},
    // Multiplies: row 22, C and V keep their values.
    {"MulsKeepsCarry", "mov r1, #3\n mvn r2, #0\n cmp r1, r1\n muls r0, r1, r2", 0xFFFFFFFD,
     "NzCvq"},
    {"Mla", "mov r1, #3\n mov r2, #5\n mov r3, #7\n mla r0, r1, r2, r3", 22},
    {"Umull", "mvn r2, #0\n umull r0, r1, r2, r2", 1, nullptr, 0xFFFFFFFE, true},
    {"Smull", "mvn r2, #0\n smull r0, r1, r2, r2", 1, nullptr, 0, true},
    {"SmullNegative", "mvn r2, #0\n mov r3, #2\n smulls r0, r1, r2, r3", 0xFFFFFFFE, "Nzcvq",
     0xFFFFFFFF, true},
    {"UmlalCarries", "mvn r0, #0\n mov r1, #0\n mov r2, #1\n umlal r0, r1, r2, r2", 0, nullptr, 1,
     true},
    {"SmlalNegative", "mov r0, #0\n mov r1, #0\n mvn r2, #0\n mov r3, #1\n smlal r0, r1, r2, r3",
     0xFFFFFFFF, nullptr, 0xFFFFFFFF, true},
    {"UmullsZeroNeedsBothHalves", "mov r2, #0x10000\n umulls r0, r1, r2, r2", 0, "nzcvq", 1, true},
    // Halfword multiplies: row 24.
    {"Smulbb", "ldr r1, =0x7fff8000\n smulbb r0, r1, r1", 0x40000000},
    {"Smultt", "ldr r1, =0x7fff8000\n smultt r0, r1, r1", 0x3FFF0001},
    {"Smulbt", "ldr r1, =0x7fff8000\n smulbt r0, r1, r1", 0xC0008000},
    {"SmlabbOverflowSetsQAndWraps", "ldr r1, =0x8000\n mov r2, #0x40000000\n smlabb r0, r1, r1, r2",
     0x80000000, "nzcvQ"},
    {"SmlabbNoOverflow", "mov r1, #2\n mov r2, #3\n smlabb r0, r1, r1, r2", 7, "nzcvq"},
    {"Smulwb", "ldr r1, =0x12345678\n ldr r2, =0x00010002\n smulwb r0, r1, r2", 0x2468},
    {"SmulwtNegative", "mvn r1, #0\n mov r2, #0x10000\n smulwt r0, r1, r2", 0xFFFFFFFF},
    {"SmlawbOverflow",
     "ldr r1, =0x7fffffff\n ldr r2, =0x7fff\n ldr r3, =0x7fffffff\n"
     "smlawb r0, r1, r2, r3",
     0xBFFF7FFE, "nzcvQ"},
    {"Smlalbb", "mvn r0, #0\n mov r1, #0\n mov r2, #2\n smlalbb r0, r1, r2, r2", 3, nullptr, 1,
     true},
    {"SmlalttNegative",
     "mov r0, #0\n mov r1, #0\n mvn r2, #0xff000000\n mov r2, r2, lsl #8\n"
     "mov r3, #0x10000\n smlaltt r0, r1, r2, r3",
     0xFFFFFFFF, nullptr, 0xFFFFFFFF, true},
    // Saturation.
    {"QaddUp", "ldr r1, =0x7fffffff\n mov r2, #1\n qadd r0, r1, r2", 0x7FFFFFFF, "nzcvQ"},
    {"QaddDown", "mov r1, #0x80000000\n mvn r2, #0\n qadd r0, r1, r2", 0x80000000, "nzcvQ"},
    {"QaddInside", "mov r1, #5\n mov r2, #6\n qadd r0, r1, r2", 11, "nzcvq"},
    {"QsubOrder", "mov r1, #5\n mov r2, #6\n qsub r0, r1, r2", 0xFFFFFFFF, "nzcvq"},
    {"QdaddSaturatesTwice", "mvn r1, #0\n mov r2, #0x40000000\n qdadd r0, r1, r2", 0x7FFFFFFE,
     "nzcvQ"},
    {"Qdsub", "mov r1, #9\n mov r2, #4\n qdsub r0, r1, r2", 1, "nzcvq"},
    {"QIsSticky", "ldr r1, =0x7fffffff\n qadd r0, r1, r1\n adds r0, r1, #0\n", 0x7FFFFFFF, "nzcvQ"},
    {"QClearedByMsr", "ldr r1, =0x7fffffff\n qadd r0, r1, r1\n mov r2, #0\n msr cpsr_f, r2",
     0x7FFFFFFF, "nzcvq"},
    {"ClzZero", "mov r1, #0\n clz r0, r1", 32},
    {"ClzOne", "mov r1, #1\n clz r0, r1", 31},
    {"ClzTop", "mvn r1, #0\n clz r0, r1", 0},
    // Unaligned: rows 1 to 7. r4 points to 44332211 88776655.
    {"LdrRotatesByOne", "ldr r0, [r4, #1]", 0x11443322},
    {"LdrRotatesByTwo", "ldr r0, [r4, #2]", 0x22114433},
    {"LdrRotatesByThree", "ldr r0, [r4, #3]", 0x33221144},
    {"LdrhOdd", "ldrh r0, [r4, #1]", 0x2211},
    {"LdrshOdd", "mov r1, r4\n ldrsh r0, [r1, #5]", 0x6655},
    {"StrUnaligned", "ldr r1, =0xaabbccdd\n str r1, [r4, #1]\n ldr r0, [r4]", 0xAABBCCDD},
    {"StrhOdd", "ldr r1, =0xaabb\n strh r1, [r4, #1]\n ldr r0, [r4]", 0x4433AABB},
    {"LdmIgnoresLowBits", "add r5, r4, #2\n ldmia r5!, {r0, r2}\n sub r1, r5, r4", 0x44332211,
     nullptr, 10, true},
    {"SwpRotates", "add r5, r4, #1\n mov r1, #0\n swp r0, r1, [r5]\n ldr r1, [r4]", 0x11443322,
     nullptr, 0, true},
    {"Swpb", "mov r1, #0xee\n swpb r0, r1, [r4]\n ldr r1, [r4]", 0x11, nullptr, 0x443322EE, true},
    {"SwpSameRegister", "mov r0, #7\n swp r0, r0, [r4]\n ldr r1, [r4]", 0x44332211, nullptr, 7,
     true},
    {"Ldrsb", "ldrsb r0, [r4, #7]", 0xFFFFFF88},
    {"Ldrsh", "ldrsh r0, [r4, #6]", 0xFFFF8877},
    {"Ldrd", "ldrd r0, r1, [r4]", 0x44332211, nullptr, 0x88776655, true},
    {"StrdPostIndexed",
     "mov r0, #1\n mov r1, #2\n mov r5, r4\n strd r0, r1, [r5], #8\n ldr r0, [r4, #4]\n"
     "sub r1, r5, r4",
     2, nullptr, 8, true},
    // The base among the registers: rows 13 to 15, 19.
    {"LdmBaseFirstWriteBackWins",
     "mov r0, r4\n .word 0xe8b00003 @ ldmia r0!, {r0, r1}\n sub r0, r0, r4", 8, nullptr, 0x88776655,
     true},
    {"LdmBaseLastIsLoaded", "mov r1, r4\n .word 0xe8b10003 @ ldmia r1!, {r0, r1}", 0x44332211,
     nullptr, 0x88776655, true},
    {"LdmBaseOnlyWriteBackWins", "mov r0, r4\n .word 0xe8b00001\n sub r0, r0, r4", 4},
    {"StmStoresOldBase",
     "mov r0, #1\n mov r1, r4\n .word 0xe8a10003 @ stmia r1!, {r0, r1}\n"
     "ldr r2, [r4, #4]\n sub r0, r2, r4\n sub r1, r1, r4",
     0, nullptr, 8, true},
    {"LdmEmptyList", "mov r0, #5\n mov r1, r4\n .word 0xe8b10000\n sub r1, r1, r4", 5, nullptr, 64,
     true},
    {"LdrBaseIsDestination", "mov r0, r4\n .word 0xe4900004 @ ldr r0, [r0], #4", 0x44332211},
    {"LdmdbAddresses", "add r1, r4, #8\n ldmdb r1!, {r0, r2}\n sub r1, r1, r4", 0x44332211, nullptr,
     0, true},
    {"LdmibAddresses", "sub r1, r4, #4\n ldmib r1, {r0, r2}\n sub r1, r2, r0", 0x44332211, nullptr,
     0x44444444, true},
    {"LdmdaAddresses", "add r1, r4, #4\n ldmda r1, {r0, r2}\n mov r1, r2", 0x44332211, nullptr,
     0x88776655, true},
    // The pc: rows 11 and 12.
    {"PcReadsEight", "mov r0, pc\n 1: adr r1, 1b\n sub r0, r0, r1", 4},
    {"PcReadsTwelveInRegisterShift",
     "mov r2, #0\n mov r0, pc, lsl r2\n 1: adr r1, 1b\n sub r0, r0, r1", 8},
    {"StrPcStoresTwelve", "str pc, [r4]\n 1: adr r1, 1b\n ldr r0, [r4]\n sub r0, r0, r1", 8},
    {"StmPcStoresTwelve", "stmia r4, {r3, pc}\n 1: adr r1, 1b\n ldr r0, [r4, #4]\n sub r0, r0, r1",
     8},
    {"MovPcDoesNotInterwork", "adr r1, 1f + 1\n mov pc, r1\n1: mrs r0, cpsr\n and r0, r0, #0x20",
     0},
    {"BlxReadsLrFirst", "adr lr, 1f\n blx lr\n 2: .word 0\n1: adr r1, 2b\n sub r0, lr, r1", 0},
    {"BlxImmediateToThumb",
     "blx 1f\n mov r0, #9\n b 2f\n .thumb\n.align 2\n1: movs r1, #4\n bx lr\n"
     ".align 2\n.arm\n2:",
     9, nullptr, 4, true},
    {"LdrPcToThumb",
     "adr r1, 1f + 1\n str r1, [r4]\n ldr pc, [r4]\n .thumb\n.align 2\n1: movs r0, #3\n"
     "bx pc\n nop\n .arm",
     3},
    {"L4TurnsInterworkingOff",
     "mrc p15, 0, r2, c1, c0, 0\n orr r2, r2, #0x8000\n mcr p15, 0, r2, c1, c0, 0\n"
     "adr r1, 1f + 1\n str r1, [r4]\n ldr pc, [r4]\n1: mrs r0, cpsr\n"
     "and r0, r0, #0x20",
     0},
    // Rows 25, 29, 32.
    {"PldDoesNothing", "mov r0, #3\n pld [r4]", 3},
    {"MrsMsr", "mov r1, #0xf0000000\n msr cpsr_f, r1\n mrs r0, cpsr\n and r0, r0, #0xf8000000",
     0xF0000000, "NZCVq"},
    {"MrcToPcSetsFlags", "mrc p15, 0, r15, c7, c10, 3\n moveq r0, #1\n movne r0, #2", 1, "nZcvq"},
    {"CacheTypeRegister", "mrc p15, 0, r0, c0, c0, 1\n mrc p15, 0, r1, c0, c0, 0", 0x1D112152,
     nullptr, 0x41069265, true},
    // Thumb.
    {"ThumbAddHigh",
     "adr r1, 1f + 1\n bx r1\n .thumb\n.align 2\n1: movs r0, #5\n mov r8, r0\n add r0, r8\n"
     ".align 2\n bx pc\n nop\n .arm",
     10},
    {"ThumbNegAdc",
     "adr r1, 1f + 1\n bx r1\n .thumb\n.align 2\n1: movs r1, #5\n negs r0, r1\n"
     "cmp r1, r1\n adcs r0, r1\n .align 2\n bx pc\n nop\n .arm",
     1, "nzCvq"},
    {"ThumbLdmBaseListedKeepsLoad",
     "adr r1, 1f + 1\n bx r1\n .thumb\n.align 2\n1: adds r1, r4, #0\n"
     ".short 0xc903 @ ldmia r1, {r0, r1}\n nop\n .align 2\n bx pc\n nop\n .arm",
     0x44332211, nullptr, 0x88776655, true},
    {"ThumbAdrAlignsPc",
     "adr r1, 1f + 1\n bx r1\n .thumb\n.align 2\n1: nop\n add r0, pc, #4\n mov r1, pc\n"
     "subs r0, r0, r1\n bx pc\n nop\n .arm",
     0},
    {"ThumbBlHalvesAreSeparate",
     "adr r1, 1f + 1\n bx r1\n .thumb\n.align 2\n1: .short 0xf000\n mov r0, lr\n"
     "mov r1, pc\n subs r0, r1, r0\n bx pc\n nop\n .arm",
     4},
};

class InstructionTest : public testing::TestWithParam<Case> {};

TEST_P(InstructionTest, GivesTheArchitectedResult) {
  const Case& c = GetParam();
  Machine m;
  m.execute(std::string("ldr r4, =0x4000\n ldr r0, =0x44332211\n ldr r1, =0x88776655\n"
                        " stmia r4, {r0, r1}\n mov r0, #0\n mov r1, #0\n msr cpsr_f, #0\n") +
            c.text);
  EXPECT_EQ(m.core.reg(0), c.r0) << std::hex << m.core.reg(0);
  if (c.check_r1) {
    EXPECT_EQ(m.core.reg(1), c.r1) << std::hex << m.core.reg(1);
  }
  if (c.flags) {
    std::string flags = "nzcvq";
    for (unsigned k = 0; k < 5; ++k)
      if (m.core.cpsr() >> (31 - k) & 1u) flags[k] = static_cast<char>(flags[k] - 'a' + 'A');
    EXPECT_EQ(flags, c.flags);
  }
}
INSTANTIATE_TEST_SUITE_P(Rows, InstructionTest, testing::ValuesIn(kCases),
                         [](const auto& row) { return std::string(row.param.name); });

/// All sixteen conditions against all sixteen flag values.
TEST(ConditionTest, EachConditionReadsItsFlags) {
  std::string text =
      "mov r11, #0\n ldr r4, =0x4000\n1: mov r0, r11, lsl #28\n msr cpsr_f, r0\n mov r1, #0\n";
  const char* const names[] = {"eq", "ne", "cs", "cc", "mi", "pl", "vs",
                               "vc", "hi", "ls", "ge", "lt", "gt", "le"};
  for (unsigned k = 0; k < 14; ++k)
    text += std::string("orr") + names[k] + " r1, r1, #" + std::to_string(1u << k) + "\n";
  text += "str r1, [r4], #4\n add r11, r11, #1\n cmp r11, #16\n bne 1b\n";
  Machine m;
  m.execute(text);
  for (unsigned f = 0; f < 16; ++f) {
    const bool n = f & 8, z = f & 4, c = f & 2, v = f & 1;
    const bool holds[14] = {z,  !z,      c,          !c,     n,      !n,           v,
                            !v, c && !z, !(c && !z), n == v, n != v, !z && n == v, z || n != v};
    std::uint32_t want = 0;
    for (unsigned k = 0; k < 14; ++k) want |= holds[k] ? 1u << k : 0u;
    std::uint32_t got = 0;
    std::memcpy(&got, m.tcm.data() + 0x4000 + 4 * f, 4);
    EXPECT_EQ(got, want) << "flags " << f;
  }
}

}  // namespace
}  // namespace fovea::cpu::test
