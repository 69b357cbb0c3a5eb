// Issue clocks and interlocks, counted by hand from ARM DDI 0222B chapter 8.
#pragma once
#include <string>
#include <vector>

#include "tb/iss/machine.h"

namespace fovea::cpu::test {

/// A few instructions between two marks, and the clocks they take.
struct TimingCase {
  const char* name;
  std::uint64_t clocks;
  const char* text;
};

/// All run in zero-wait internal RAM: r4 points to data there, r5 = 3, r6 = 7.
inline constexpr TimingCase kTimingCases[] = {
    {"Alu", 1, "add r0, r5, r6"},
    {"AluShiftedByImmediate", 1, "add r0, r5, r6, lsl #3"},
    {"AluShiftedByRegister", 2, "add r0, r5, r6, lsl r5"},
    {"AluChainHasNoInterlock", 3, "add r0, r5, r6\n add r0, r0, r5\n add r0, r0, r6, lsl #2"},
    {"FailedConditionIsOneClock", 1, "cmp r5, r5\n svc #1\n ldmne r4, {r0-r3}"},
    {"FailedConditionDoesNotInterlock", 2, "cmp r5, r5\n svc #1\n ldr r0, [r4]\n addne r0, r0, r0"},
    {"AddToPc", 3, "add pc, pc, #0\n nop"},
    {"MovToPc", 4, "adr r0, 1f\n svc #1\n mov pc, r0\n1:"},
    {"AddShiftedToPc", 4, "mov r0, #0\n svc #1\n add pc, pc, r0, lsl #2\n nop"},
    {"BranchTaken", 3, "b 1f\n nop\n1:"},
    {"BranchNotTaken", 1, "cmp r5, r5\n svc #1\n bne 1f\n1:"},
    {"BranchAndLink", 3, "bl 1f\n nop\n1:"},
    {"BranchExchange", 3, "adr r0, 1f\n svc #1\n bx r0\n nop\n1:"},
    {"BranchLinkExchange", 3, "adr r0, 1f\n svc #1\n blx r0\n nop\n1:"},
    {"CopyOf32BytesIsTwentyClocks", 10 * 20 - 2,
     "mov r14, #10\n add r0, r4, #0x400\n svc #1\n1: ldmia r4!, {r1-r3, r7-r11}\n"
     "stmia r0!, {r1-r3, r7-r11}\n subs r14, r14, #1\n bne 1b"},
    {"SubsBhiLoopIsFourClocks", 400 - 2, "mov r0, #100\n svc #1\n1: subs r0, r0, #1\n bhi 1b"},
    // An ALU result is available wherever a register can be read.
    {"AluToAddress", 2, "add r0, r4, #4\n ldr r1, [r0]"},
    {"AluToStoreData", 2, "add r0, r5, r6\n str r0, [r4]"},
    {"AluToShiftAmount", 3, "add r0, r5, #1\n add r1, r5, r6, lsl r0"},
    {"AluToShiftedOperand", 2, "add r0, r5, #1\n add r1, r5, r0, lsl #4"},
    {"AluToMultiplier", 3, "add r0, r5, #1\n mul r1, r0, r6"},
    {"AluToAccumulator", 3, "add r0, r5, #1\n mla r1, r5, r6, r0"},
    {"AluToBaseOfLdm", 3, "add r0, r4, #4\n ldmia r0, {r1, r2}"},
    {"AluToBranchRegister", 1 + 3, "adr r0, 1f\n svc #1\n add r0, r0, #0\n bx r0\n1:"},
    {"LoadWord", 1, "ldr r0, [r4]"},
    {"LoadWordShiftedOffset", 2, "ldr r0, [r4, r5, lsl #2]"},
    {"LoadWordRegisterOffset", 1, "mov r1, #4\n svc #1\n ldr r0, [r4, r1]"},
    {"LoadUse", 3, "ldr r0, [r4]\n add r0, r0, r5"},
    {"LoadOneApartUse", 3, "ldr r0, [r4]\n mov r3, r3\n add r0, r0, r5"},
    {"LoadByteUse", 4, "ldrb r0, [r4]\n add r0, r0, r5"},
    {"LoadByteOneApartUse", 4, "ldrb r0, [r4]\n mov r3, r3\n add r0, r0, r5"},
    {"LoadByteTwoApartUse", 4, "ldrb r0, [r4]\n mov r3, r3\n mov r3, r3\n add r0, r0, r5"},
    {"LoadHalfUse", 4, "ldrh r0, [r4]\n add r0, r0, r5"},
    {"LoadSignedByteUse", 4, "ldrsb r0, [r4]\n add r0, r0, r5"},
    {"LoadRotatedUse", 4, "ldr r0, [r4, #1]\n add r0, r0, r5"},
    {"StallIsPaidOnce", 5, "ldrb r0, [r4]\n add r1, r0, r5\n add r2, r0, r5"},
    {"LoadToAddress", 3, "str r4, [r4]\n svc #1\n ldr r0, [r4]\n ldr r1, [r0]"},
    {"LoadToStoreData", 3, "ldr r0, [r4]\n str r0, [r4, #4]"},
    {"LoadByteToStoreData", 4, "ldrb r0, [r4]\n str r0, [r4, #4]"},
    {"LoadToAccumulator", 4, "ldr r0, [r4]\n mla r1, r5, r6, r0"},
    {"LoadOneApartToStoreData", 3, "ldr r0, [r4]\n mov r3, r3\n str r0, [r4, #4]"},
    {"LoadToBaseOfLdm", 5, "str r4, [r4]\n svc #1\n ldr r0, [r4]\n ldmia r0, {r1-r3}"},
    {"LoadToBaseOfStm", 4, "str r4, [r4]\n svc #1\n ldr r0, [r4]\n stmia r0, {r1, r2}"},
    {"LoadToFirstStored", 4, "ldr r0, [r4]\n stmia r4, {r0, r1}"},
    {"LoadToSecondStored", 3, "ldr r1, [r4]\n stmia r4, {r0, r1}"},
    {"LoadToBranchRegister", 5, "adr r1, 1f\n str r1, [r4]\n svc #1\n ldr r0, [r4]\n bx r0\n1:"},
    {"LoadUnderMultiply", 4, "ldr r0, [r4]\n mul r1, r5, r6\n add r2, r0, r5"},
    {"LoadByteUnderMultiply", 4, "ldrb r0, [r4]\n mul r1, r5, r6\n add r2, r0, r5"},
    {"LoadToMultiplier", 1 + 1 + 2, "ldr r0, [r4]\n mul r1, r0, r6"},
    {"LoadToShiftAmount", 1 + 1 + 2, "ldr r0, [r4]\n add r1, r5, r6, lsl r0"},
    {"LoadToShiftedOperand", 1 + 1 + 1, "ldr r0, [r4]\n add r1, r5, r0, lsl #4"},
    {"LoadToOffset", 1 + 1 + 1, "ldr r0, [r4]\n ldr r1, [r4, r0]"},
    {"LoadOneApartToAccumulator", 1 + 1 + 2, "ldr r0, [r4]\n mov r3, r3\n mla r1, r5, r6, r0"},
    {"LoadOneApartToBaseOfLdm", 1 + 1 + 2,
     "str r4, [r4]\n svc #1\n ldr r0, [r4]\n mov r3, r3\n ldmia r0, {r1, r2}"},
    {"LoadToStoreDouble", 1 + 1 + 2, "ldr r0, [r4]\n strd r0, r1, [r4]"},
    {"LoadToSecondOfStoreDouble", 1 + 2, "ldr r1, [r4]\n strd r0, r1, [r4]"},
    {"LoadByteToAddress", 1 + 2 + 1, "ldrb r0, [r4]\n ldr r1, [r0]"},
    {"LoadByteToMultiplier", 1 + 2 + 2, "ldrb r0, [r4]\n mul r1, r0, r6"},
    {"LoadByteToAccumulator", 1 + 2 + 2, "ldrb r0, [r4]\n mla r1, r5, r6, r0"},
    {"LoadByteToBaseOfLdm", 1 + 2 + 2, "ldrb r0, [r4]\n ldmia r0, {r1, r2}"},
    {"LoadByteOneApartToBaseOfLdm", 1 + 1 + 1 + 2,
     "ldrb r0, [r4]\n mov r3, r3\n ldmia r0, {r1, r2}"},
    {"LoadByteOneApartToStoreData", 1 + 1 + 1 + 1, "ldrb r0, [r4]\n mov r3, r3\n str r0, [r4, #4]"},
    {"LoadSignedHalfUse", 1 + 2 + 1, "ldrsh r0, [r4]\n add r0, r0, r5"},
    {"LoadRotatedOneApartUse", 1 + 1 + 1 + 1, "ldr r0, [r4, #1]\n mov r3, r3\n add r0, r0, r5"},
    {"LoadRotatedToStoreData", 1 + 2 + 1, "ldr r0, [r4, #1]\n str r0, [r4, #4]"},
    {"LoadWriteBackIsFree", 3, "ldr r0, [r4], #4\n ldr r1, [r4], #4\n add r2, r4, #4"},
    {"LoadPc", 5, "adr r0, 1f\n str r0, [r4]\n svc #1\n ldr pc, [r4]\n nop\n1:"},
    {"LoadPcShifted", 6,
     "adr r0, 1f\n str r0, [r4]\n mov r1, #0\n svc #1\n ldr pc, [r4, r1, lsl #2]\n nop\n1:"},
    {"LoadDouble", 2, "ldrd r0, r1, [r4]"},
    {"LoadDoubleUseFirst", 3, "ldrd r0, r1, [r4]\n add r2, r0, r5"},
    {"LoadDoubleUseLast", 4, "ldrd r0, r1, [r4]\n add r2, r1, r5"},
    {"Store", 1, "str r0, [r4]"},
    {"StoreShiftedOffset", 2, "str r0, [r4, r5, lsl #2]"},
    {"StoreDouble", 2, "strd r0, r1, [r4]"},
    {"LoadMultipleOne", 2, "ldmia r4, {r0}"},
    {"LoadMultipleFour", 4, "ldmia r4, {r0-r3}"},
    {"LoadMultipleUseLast", 6, "ldmia r4, {r0-r3}\n add r7, r3, r5"},
    {"LoadMultipleUseFirst", 5, "ldmia r4, {r0-r3}\n add r7, r0, r5"},
    {"LoadMultipleOneUse", 2 + 1, "ldmia r4, {r0}\n add r7, r0, r5"},
    {"LoadMultipleUseLastButOne", 4 + 1, "ldmia r4, {r0-r3}\n add r7, r2, r5"},
    {"LoadMultipleOneApartUseLast", 4 + 1 + 1, "ldmia r4, {r0-r3}\n mov r7, r7\n add r7, r3, r5"},
    {"LoadMultipleToStoreData", 2 + 1 + 1, "ldmia r4, {r0, r1}\n str r1, [r4]"},
    {"LoadMultipleToBaseOfLdm", 2 + 1 + 2, "ldmia r4, {r0, r1}\n ldmia r1, {r2, r3}"},
    {"LoadDoubleToStoreDouble", 2 + 2, "ldrd r0, r1, [r4]\n strd r0, r1, [r4]"},
    {"LoadDoubleOneApartUseLast", 2 + 1 + 1, "ldrd r0, r1, [r4]\n mov r3, r3\n add r2, r1, r5"},
    {"LoadMultiplePc", 4 + 4,
     "adr r3, 1f\n stmia r4, {r0-r3}\n svc #1\n ldmia r4, {r0-r2, pc}\n nop\n1:"},
    {"LoadMultiplePcAlone", 1 + 4, "adr r3, 1f\n str r3, [r4]\n svc #1\n ldmia r4, {pc}\n nop\n1:"},
    {"StoreMultipleOne", 2, "stmia r4, {r0}"},
    {"StoreMultipleFour", 4, "stmia r4, {r0-r3}"},
    {"Swap", 2, "mov r1, r4\n svc #1\n swp r0, r5, [r1]"},
    {"SwapUse", 3, "swp r0, r5, [r4]\n add r0, r0, r5"},
    {"SwapByteUse", 4, "swpb r0, r5, [r4]\n add r0, r0, r5"},
    {"Mul", 2, "mul r0, r5, r6"},
    {"MulUse", 4, "mul r0, r5, r6\n add r0, r0, r5"},
    {"MulStore", 4, "mul r0, r5, r6\n str r0, [r4]"},
    {"MulToAddress", 2 + 1 + 1, "mul r0, r5, r6\n ldr r1, [r0]"},
    {"MulToSecondStored", 2 + 2, "mul r1, r5, r6\n stmia r4, {r0, r1}"},
    {"MulToFirstStored", 2 + 1 + 2, "mul r0, r5, r6\n stmia r4, {r0, r1}"},
    {"MlaUse", 2 + 1 + 1, "mla r0, r5, r6, r1\n add r0, r0, r5"},
    {"UmullHighStore", 3 + 1 + 1, "umull r0, r1, r5, r6\n str r1, [r4]"},
    {"UmullHighOneApartUse", 3 + 1 + 1, "umull r0, r1, r5, r6\n mov r3, r3\n add r2, r1, r5"},
    {"UmullsUseHigh", 5 + 1, "umulls r0, r1, r5, r6\n add r2, r1, r5"},
    {"SmlawtUse", 1 + 1 + 1, "smlawt r0, r5, r6, r1\n add r0, r0, r5"},
    {"SmulbbToAccumulator", 1 + 2, "smulbb r0, r5, r6\n mla r1, r5, r6, r0"},
    {"SmulbbToMultiplier", 1 + 1 + 2, "smulbb r0, r5, r6\n mla r1, r0, r6, r5"},
    {"QdaddToAddress", 1 + 1 + 1, "qdadd r0, r5, r6\n ldr r1, [r4, r0]"},
    {"QaddToMultiplier", 1 + 1 + 2, "qadd r0, r5, r6\n mul r1, r0, r6"},
    {"SwapRotatedUse", 2 + 1 + 1, "add r1, r4, #1\n svc #1\n swp r0, r5, [r1]\n add r0, r0, r5"},
    {"MulAccumulate", 4, "mul r0, r5, r6\n mla r1, r5, r6, r0"},
    {"MulToMultiplier", 5, "mul r0, r5, r6\n mla r1, r0, r6, r5"},
    {"MulOneApartUse", 4, "mul r0, r5, r6\n mov r3, r3\n add r0, r0, r5"},
    {"MlaChainThroughAccumulator", 4, "mla r0, r5, r6, r1\n mla r0, r5, r6, r0"},
    {"Mla", 2, "mla r0, r5, r6, r1"},
    {"Muls", 4, "muls r0, r5, r6"},
    {"MulsUse", 5, "muls r0, r5, r6\n add r0, r0, r5"},
    {"Umull", 3, "umull r0, r1, r5, r6"},
    {"UmullUseLow", 4, "umull r0, r1, r5, r6\n add r2, r0, r5"},
    {"UmullUseHigh", 5, "umull r0, r1, r5, r6\n add r2, r1, r5"},
    {"Smlals", 5, "smlals r0, r1, r5, r6"},
    {"Smulbb", 1, "smulbb r0, r5, r6"},
    {"SmulbbUse", 3, "smulbb r0, r5, r6\n add r0, r0, r5"},
    {"SmlabbAccumulateChain", 2, "smlabb r0, r5, r6, r0\n smlabb r0, r5, r6, r0"},
    {"Smlawt", 1, "smlawt r0, r5, r6, r1"},
    {"Smlalbb", 2, "smlalbb r0, r1, r5, r6"},
    {"Qadd", 1, "qadd r0, r5, r6"},
    {"QaddUse", 3, "qadd r0, r5, r6\n add r0, r0, r5"},
    {"QaddStore", 2, "qadd r0, r5, r6\n str r0, [r4]"},
    {"QaddAccumulate", 3, "qadd r0, r5, r6\n mla r1, r5, r6, r0"},
    {"Clz", 1, "clz r0, r5"},
    {"ClzUse", 2, "clz r0, r5\n add r0, r0, r5"},
    {"QaddToOperandOneApart", 3, "qadd r0, r5, r6\n mov r3, r3\n add r0, r0, r5"},
    {"SmulbbStore", 3, "smulbb r0, r5, r6\n str r0, [r4]"},
    {"SubsBneLoopIsFourClocks", 400 - 2, "mov r0, #100\n svc #1\n1: subs r0, r0, #1\n bne 1b"},
    {"SubToPcIsArithmetic", 3, "mov r0, #4\n svc #1\n sub pc, pc, r0\n1:"},
    {"OrrToPcIsLogical", 4, "adr r0, 1f\n svc #1\n orr pc, r0, #0\n1:"},
    {"MsrSaved", 3, "mov r0, #0\n svc #1\n msr spsr_cxsf, r0"},
    {"Mcr", 1, "mcr p15, 0, r5, c13, c0, 1"},
    {"Mrc", 1, "mrc p15, 0, r0, c13, c0, 1"},
    {"MrcToPcIsThreeAndItsOwnTwo", 3 + 2, "mrc p15, 0, r15, c7, c10, 3"},
    {"Pld", 1, "pld [r4]"},
    {"LoadToPreload", 3, "ldr r0, [r4]\n pld [r0]"},
    {"LoadOneApartToPreload", 3, "ldr r0, [r4]\n mov r3, r3\n pld [r0]"},
    {"LoadByteToPreloadOffset", 4, "ldrb r1, [r4]\n pld [r4, r1]"},
    {"LoadToNoAddressOfPreload", 2, "ldr r0, [r4]\n pld [r4, r5]"},
    {"Mrs", 2, "mrs r0, cpsr"},
    {"MrsUse", 3, "mrs r0, cpsr\n add r0, r0, r5"},
    {"LoadToStatus", 3, "ldr r0, [r4]\n msr cpsr_f, r0"},
    {"MsrFlags", 1, "mov r0, #0\n svc #1\n msr cpsr_f, r0"},
    {"MsrControl", 3, "mrs r0, cpsr\n svc #1\n msr cpsr_c, r0"},
    {"MrcUse", 3, "mrc p15, 0, r0, c0, c0, 0\n add r0, r0, r5"},
    {"MrcOneApart", 3, "mrc p15, 0, r0, c0, c0, 0\n mov r3, r3\n add r0, r0, r5"},
    {"ThumbBranchLinkPair", 1 + 3, ".thumb\n bl 1f\n nop\n1:"},
    {"ThumbPopPc", 1 + 4 + 0,
     ".thumb\n adr r0, 1f\n adds r0, #1\n push {r0}\n svc #1\n pop {pc}\n nop\n.align 2\n1:"},
    {"ThumbBranchTaken", 3, ".thumb\n b 1f\n nop\n1:"},
    {"ThumbConditionalNotTaken", 2, ".thumb\n cmp r5, r5\n bne 1f\n1:"},
    {"ThumbConditionalTaken", 4, ".thumb\n cmp r5, r5\n beq 1f\n nop\n1:"},
    {"ThumbLoadUse", 3, ".thumb\n ldr r0, [r4]\n adds r0, r0, r5"},
    {"ThumbLoadByteUse", 4, ".thumb\n ldrb r0, [r4]\n adds r0, r0, r5"},
    {"ThumbPushOne", 2, ".thumb\n push {r0}"},
    {"ThumbPushThree", 3, ".thumb\n push {r0-r2}"},
    {"ThumbMovToPc", 4, ".thumb\n adr r0, 1f\n svc #1\n mov pc, r0\n nop\n.align 2\n1:"},
    {"ThumbAddToPc", 3, ".thumb\n movs r0, #0\n svc #1\n add pc, r0\n nop"},
    {"ThumbShiftByRegister", 2, ".thumb\n lsls r0, r5"},
    {"ThumbMulIsMuls", 4, ".thumb\n muls r0, r5"},
};

/// Clocks in zero-wait internal RAM; code before an `svc #1` in the case itself is not counted.
inline std::uint64_t clocks_in_ram(const TimingCase& c) {
  const std::string text = c.text;
  const bool thumb = text.starts_with(".thumb"), own = text.find("svc") != std::string::npos;
  std::string program =
      "ldr r4, =0x4000\n ldr sp, =0x6000\n mov r5, #3\n mov r6, #7\n b 2f\n .ltorg\n2:\n";
  if (thumb) program += "adr r0, 3f + 1\n bx r0\n .thumb\n.align 2\n3:\n";
  if (!own) program += "svc #1\n";
  program += (thumb ? text.substr(7) : text) + "\n svc #1\n";
  Machine m;
  m.execute(program);
  EXPECT_EQ(m.marks.size(), 2u) << c.text;
  return m.between();
}

/// Clocks from the I-cache, starting at each word of a line: what the core knows about a record
/// from its neighbours must not change the timing. The second of two iterations is measured, with
/// all lines cached.
inline std::vector<std::uint64_t> clocks_by_place(const TimingCase& c) {
  const std::string text = c.text;
  const bool thumb = text.starts_with(".thumb"), own = text.find("svc") != std::string::npos;
  std::string program = std::string(kCachesOn) +
                        "ldr r4, =0x4000\n ldr sp, =0x6000\n mov r5, #3\n mov r6, #7\n b 7f\n"
                        ".ltorg\n7:\n";
  for (unsigned place = 0; place < 8; ++place) {
    program += "mov r12, #2\n b 8f\n.balign 32\n8:\n";
    // Thumb code is entered from ARM state, three words earlier.
    if (thumb) program += "adr r0, 3f + 1\n bx r0\n .thumb\n.align 2\n3:\n";
    for (unsigned k = 0; k < place; ++k) program += thumb ? "nop\n nop\n" : "nop\n";
    if (!own) program += "svc #1\n";
    program += (thumb ? text.substr(7) : text) + "\n svc #1\n";
    if (thumb) program += ".align 2\n bx pc\n nop\n.arm\n";
    program += "subs r12, r12, #1\n bne 8b\n";
  }
  Machine m;
  m.execute(program, kMemory);
  EXPECT_EQ(m.marks.size(), 8u * 4) << c.text;
  std::vector<std::uint64_t> out;
  for (unsigned place = 0; place < 8; ++place) out.push_back(m.between(4 * place + 2));
  return out;
}

}  // namespace fovea::cpu::test
