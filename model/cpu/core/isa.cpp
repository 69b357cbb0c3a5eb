// The table of instructions. Encodings: ARM DDI 0100 chapters A3 to A7. Cycles: `source` of each
// kind.
#include "model/cpu/core/isa.h"

namespace fovea::cpu {
namespace {

// Sources of the cycle counts.
constexpr const char* k9ejs = "ARM DDI 0222B table 8-2";
constexpr const char* k9ejsUnread = "ARM DDI 0222B ch. 8 (row not seen)";
constexpr const char* k7ejs = "ARM DDI 0214B ch. 9 (same pipeline)";
constexpr const char* k9es = "ARM DDI 0165B 8.5";
constexpr const char* k926 = "ARM DDI 0198D 4.1 (no operation)";
constexpr const char* kAssumed = "assumed";

constexpr const char* kNoPc = "d != 15, n != 15, m != 15, s != 15";

// Abbreviations of this file. The members are: class, reads, stored, writes, defined if, cycles,
// source.
using C = InsnClass;
constexpr auto kFlags = kSetFlags;

constexpr const char* kDataCycles = "1; to pc 3 (ADD SUB RSB ADC SBC) or 4";
constexpr IsaKind kDataImm{C::kData, "n", "", "d", "", kDataCycles, k9ejs, Operand::kImm,
                           Immediate::kRotated};
constexpr IsaKind kDataShift{C::kData, "nm", "", "d", "", "1; to pc 4 (3 if arithmetic, unshifted)",
                             k9ejs, Operand::kShiftImm};
constexpr IsaKind kDataLate{C::kDataShiftReg, "nms", "", "d", kNoPc, "2", k9ejs,
                            Operand::kShiftReg};
constexpr IsaKind kCompareImm{C::kCompare, "n", "", "", "", "1", k9ejs, Operand::kImm,
                              Immediate::kRotated, kFlags};
constexpr IsaKind kCompareShift{C::kCompare, "nm", "", "", "", "1", k9ejs, Operand::kShiftImm,
                                Immediate::kNone, kFlags};
constexpr IsaKind kCompareLate{C::kCompare, "nms", "", "", kNoPc, "2", k9ejs, Operand::kShiftReg,
                               Immediate::kNone, kFlags};

constexpr const char* kMulDefined = "n != 15, d != 15, m != 15, s != 15, n != m";
constexpr const char* kLongDefined =
    "n != 15, d != 15, m != 15, s != 15, n != d, n != m, d != m";
constexpr IsaKind kMulKind{C::kMultiply, "ms", "d", "n", kMulDefined, "2, then 1; S: 4", k7ejs};
constexpr IsaKind kUmullKind{C::kLongMultiply, "ms", "", "nd", kLongDefined,
                             "3, then 1 for RdHi; S: 5", k7ejs};
constexpr IsaKind kUmlalKind{C::kLongMultiply, "ms", "nd", "nd", kLongDefined,
                             "3, then 1 for RdHi; S: 5", k7ejs};
constexpr IsaKind kSmulKind{C::kDsp, "ms", "d", "n", kNoPc, "1, then 1", k9ejsUnread};
constexpr IsaKind kSmlalKind{C::kDsp, "ms", "nd", "nd",
                             "n != 15, d != 15, m != 15, s != 15, n != d", "2", k9ejsUnread};
constexpr IsaKind kSaturateKind{C::kSaturate, "nm", "", "d", kNoPc, "1, then 1", k7ejs};
constexpr IsaKind kClzKind{C::kClz, "m", "", "d", kNoPc, "1", k9ejs};

constexpr IsaKind kMrsKind{C::kStatus, "", "", "d", kNoPc, "2", k7ejs};
constexpr const char* kMsrCycles = "1 (field f alone) or 3";
constexpr IsaKind kMsrReg{C::kStatus, "m", "", "", "m != 15, f != 0", kMsrCycles, k9ejsUnread,
                          Operand::kReg};
constexpr IsaKind kMsrImm{C::kStatus, "", "", "", "f != 0", kMsrCycles, k9ejsUnread, Operand::kImm,
                          Immediate::kRotated};
constexpr IsaKind kMsrSpsrReg{C::kStatus, "m", "", "", "m != 15, f != 0", "3", k9ejsUnread,
                              Operand::kReg};
constexpr IsaKind kMsrSpsrImm{C::kStatus, "", "", "", "f != 0", "3", k9ejsUnread, Operand::kImm,
                              Immediate::kRotated};

// Words and bytes: pre-indexed, post-indexed, and as user. Only a word may be loaded into the pc.
constexpr const char* kWordPre = "W: n != 15, W: n != d";
constexpr const char* kWordPreReg = "m != 15, W: n != 15, W: n != d, W: n != m";
constexpr const char* kWordPost = "n != 15, n != d";
constexpr const char* kWordPostReg = "m != 15, n != 15, n != d, n != m";
constexpr const char* kUser = "n != 15, n != d, d != 15";
constexpr const char* kUserReg = "m != 15, n != 15, n != d, n != m, d != 15";
constexpr const char* kNarrowPre = "d != 15, W: n != 15, W: n != d";
constexpr const char* kNarrowPreReg = "d != 15, m != 15, W: n != 15, W: n != d, W: n != m";
constexpr const char* kLdr = "1, then 1 (2 if rotated); to pc 5";
constexpr const char* kLdrReg = "1 (2 with a shift), then 1 (2 if rotated); to pc 5 (6)";
constexpr const char* kLdrb = "1, then 2";
constexpr const char* kLdrbReg = "1 (2 with a shift), then 2";
constexpr const char* kStr = "1";
constexpr const char* kStrReg = "1 (2 with a shift)";
constexpr auto kBack = kWriteBack;
constexpr auto kAsUser = static_cast<std::uint16_t>(kBack | kUserBank);
constexpr auto kBefore = kPre;
constexpr auto kPlain = Immediate::kUnsigned;

struct Transfer {  // the six addressing forms of one transfer
  IsaKind pre, post, user, pre_reg, post_reg, user_reg;
};
constexpr Transfer transfer(InsnClass c, bool load, bool word, const char* cycles,
                            const char* with_shift) {
  const char* stored = load ? "" : "d";
  const char* writes = load ? "d" : "";
  const auto imm = [&](const char* defined, std::uint16_t flags) {
    return IsaKind{c, "n", stored, writes, defined, cycles, k9ejs, Operand::kImm, kPlain, flags};
  };
  const auto reg = [&](const char* defined, std::uint16_t flags) {
    return IsaKind{c, "nm", stored, writes, defined, with_shift, k9ejs, Operand::kShiftImm,
                   Immediate::kNone, flags};
  };
  return {imm(word ? kWordPre : kNarrowPre, kBefore), imm(word ? kWordPost : kUser, kBack),
          imm(kUser, kAsUser), reg(word ? kWordPreReg : kNarrowPreReg, kBefore),
          reg(word ? kWordPostReg : kUserReg, kBack), reg(kUserReg, kAsUser)};
}
constexpr Transfer kLoadWord = transfer(C::kLoad, true, true, kLdr, kLdrReg);
constexpr Transfer kLoadByte = transfer(C::kLoad, true, false, kLdrb, kLdrbReg);
constexpr Transfer kStoreWord = transfer(C::kStore, false, true, kStr, kStrReg);
constexpr Transfer kStoreByte = transfer(C::kStore, false, false, kStr, kStrReg);

struct Narrow {  // halfwords, signed bytes, pairs of words
  IsaKind pre, post, pre_reg, post_reg;
};
constexpr Narrow narrow(InsnClass c, bool load, const char* cycles, const char* pair,
                        const char* pair_back, const char* pair_reg, const char* pair_reg_back) {
  const char* stored = load ? "" : "d";
  const char* writes = load ? "d" : "";
  const auto imm = [&](const char* defined, std::uint16_t flags) {
    return IsaKind{c, "n", stored, writes, defined, cycles, k9ejs, Operand::kImm, kPlain, flags};
  };
  const auto reg = [&](const char* defined, std::uint16_t flags) {
    return IsaKind{c, "nm", stored, writes, defined, cycles, k9ejs, Operand::kReg,
                   Immediate::kNone, flags};
  };
  return {imm(pair, kBefore), imm(pair_back, kBack), reg(pair_reg, kBefore),
          reg(pair_reg_back, kBack)};
}
constexpr Narrow kLoadNarrow =
    narrow(C::kNarrow, true, kLdrb, kNarrowPre, kUser, kNarrowPreReg, kUserReg);
constexpr Narrow kStoreNarrow =
    narrow(C::kNarrow, false, kStr, kNarrowPre, kUser, kNarrowPreReg, kUserReg);
constexpr Narrow kLoadPair =
    narrow(C::kDouble, true, "2, then 1 for the second word",
           "d != 14, W: n != 15, W: n != d, W: n != d+1", "d != 14, n != 15, n != d, n != d+1",
           "d != 14, m != 15, m != d, m != d+1, W: n != 15, W: n != d, W: n != d+1, W: n != m",
           "d != 14, m != 15, m != d, m != d+1, n != 15, n != d, n != d+1, n != m");
constexpr Narrow kStorePair =
    narrow(C::kDouble, false, "2", "d != 14, W: n != 15, W: n != d, W: n != d+1",
           "d != 14, n != 15, n != d, n != d+1",
           "d != 14, m != 15, W: n != 15, W: n != d, W: n != d+1, W: n != m",
           "d != 14, m != 15, n != 15, n != d, n != d+1, n != m");

constexpr const char* kLdmCycles = "n, then 1 for the last register; n = 1: 2";
constexpr IsaKind kLdmKind{C::kBlock, "n", "", "l", "n != 15, l != 0, W: n not in l", kLdmCycles,
                           k9ejs, Operand::kImm, Immediate::kList};
constexpr IsaKind kLdmPc{C::kBlock, "n", "", "l", "n != 15, W: n not in l", "n + 4", k9ejsUnread,
                         Operand::kImm, Immediate::kList};
constexpr IsaKind kLdmUser{C::kBlock, "n", "", "l", "n != 15, l != 0, W = 0", kLdmCycles, k9ejs,
                           Operand::kImm, Immediate::kList, kUserBank};
constexpr IsaKind kLdmReturn{C::kBlock, "n", "", "l", "n != 15, W: n not in l", "n + 4",
                             k9ejsUnread, Operand::kImm, Immediate::kList, kUserBank};
constexpr IsaKind kStmKind{C::kBlock, "n", "l", "", "n != 15, l != 0, W: n first in l",
                           "n; n = 1: 2", k9ejsUnread, Operand::kImm, Immediate::kList};
constexpr IsaKind kStmUser{C::kBlock, "n", "l", "", "n != 15, l != 0, W = 0", "n; n = 1: 2",
                           k9ejsUnread, Operand::kImm, Immediate::kList, kUserBank};
constexpr IsaKind kSwpKind{C::kSwap, "nm", "", "d", "n != 15, m != 15, d != 15, n != m, n != d",
                           "2", k9ejsUnread};
constexpr IsaKind kSwpbKind{C::kSwap, "nm", "", "d", "n != 15, m != 15, d != 15, n != m, n != d",
                            "2, then 1", k9ejsUnread};
constexpr IsaKind kPldImm{C::kPreload, "n", "", "", "", "1", k926};
constexpr IsaKind kPldReg{C::kPreload, "nm", "", "", "m != 15", "1", k926};

constexpr const char* kBranchCycles = "3";
constexpr IsaKind kBranchKind{C::kBranch, "", "", "", "", kBranchCycles, k9es, Operand::kImm,
                              Immediate::kSigned, kReadsPc};
constexpr IsaKind kBranchReg{C::kBranch, "m", "", "", "", kBranchCycles, k9es};
constexpr IsaKind kBranchRegNoPc{C::kBranch, "m", "", "", "m != 15", kBranchCycles, k9es};
constexpr IsaKind kTrap{C::kException, "", "", "", "", "3", k9ejsUnread};
constexpr IsaKind kTrapAlways{C::kException, "", "", "", "c = 14", "3", k9ejsUnread};
constexpr IsaKind kMcrKind{C::kCoprocessor, "d", "", "", "d != 15", "1 and the wait of the target",
                           k9ejsUnread};
constexpr IsaKind kMrcKind{C::kCoprocessor, "", "", "d", "",
                           "1 and the wait of the target, then 1; flags: 3", k9ejsUnread};
constexpr IsaKind kAbsent{C::kCoprocessor, "", "", "", "", "3: undefined on this chip", kAssumed};
constexpr IsaKind kAbsentMove{C::kCoprocessor, "", "", "", "d != 15, n != 15",
                              "3: undefined on this chip", kAssumed};
constexpr IsaKind kAbsentMrrc{C::kCoprocessor, "", "", "", "d != 15, n != 15, n != d",
                              "3: undefined on this chip", kAssumed};
constexpr IsaKind kAbsentPre{C::kCoprocessor, "", "", "", "W: n != 15",
                             "3: undefined on this chip", kAssumed};
constexpr IsaKind kAbsentPost{C::kCoprocessor, "", "", "", "n != 15",
                              "3: undefined on this chip", kAssumed};

// Thumb instructions take the cycles of their ARM equivalents (ARM DDI 0222B ch. 8).
constexpr IsaKind kTReg{C::kThumbAlu, "nm", "", "d", "", "1", k9ejs, Operand::kReg,
                        Immediate::kNone, kFlags};
constexpr IsaKind kTImm{C::kThumbAlu, "n", "", "d", "", "1", k9ejs, Operand::kImm, kPlain, kFlags};
constexpr IsaKind kTAddress{C::kThumbAlu, "n", "", "d", "", "1", k9ejs, Operand::kImm, kPlain};
constexpr IsaKind kTShiftImm{C::kThumbShift, "m", "", "d", "", "1", k9ejs, Operand::kShiftImm,
                             Immediate::kNone, kFlags};
constexpr IsaKind kTShiftReg{C::kThumbShift, "ms", "", "d", "", "2", k9ejs, Operand::kShiftReg,
                             Immediate::kNone, kFlags};
constexpr IsaKind kTMul{C::kThumbMultiply, "ms", "", "n", "n != m", "4", k7ejs, Operand::kImm,
                        Immediate::kNone, kFlags};
constexpr IsaKind kTHigh{C::kThumbHigh, "nm", "", "d", "d or m > 7", kDataCycles, k9ejs,
                         Operand::kReg};
constexpr IsaKind kTHighCmp{C::kThumbHigh, "nm", "", "", "n or m > 7, n != 15", "1", k9ejs,
                            Operand::kReg, Immediate::kNone, kFlags};
constexpr auto kAt = static_cast<std::uint16_t>(kBefore | kUp);
constexpr IsaKind kTLoad{C::kThumbMemory, "n", "", "d", "", kLdr, k9ejs, Operand::kImm, kPlain,
                         kAt};
constexpr IsaKind kTLoadNarrow{C::kThumbMemory, "n", "", "d", "", kLdrb, k9ejs, Operand::kImm,
                               kPlain, kAt};
constexpr IsaKind kTStore{C::kThumbMemory, "n", "d", "", "", kStr, k9ejs, Operand::kImm, kPlain,
                          kAt};
constexpr IsaKind kTLoadReg{C::kThumbMemory, "nm", "", "d", "", kLdr, k9ejs, Operand::kReg,
                            Immediate::kNone, kAt};
constexpr IsaKind kTLoadNarrowReg{C::kThumbMemory, "nm", "", "d", "", kLdrb, k9ejs, Operand::kReg,
                                  Immediate::kNone, kAt};
constexpr IsaKind kTStoreReg{C::kThumbMemory, "nm", "d", "", "", kStr, k9ejs, Operand::kReg,
                             Immediate::kNone, kAt};
constexpr auto kPopFlags = static_cast<std::uint16_t>(kUp | kBack);
constexpr auto kPushFlags = static_cast<std::uint16_t>(kBefore | kBack);
constexpr IsaKind kTLdm{C::kThumbBlock, "n", "", "l", "l != 0", kLdmCycles, k9ejs, Operand::kImm,
                        Immediate::kList, kPopFlags};
constexpr IsaKind kTPopPc{C::kThumbBlock, "n", "", "l", "", "n + 4", k9ejsUnread, Operand::kImm,
                          Immediate::kList, kPopFlags};
constexpr IsaKind kTStm{C::kThumbBlock, "n", "l", "", "l != 0, n first in l", "n; n = 1: 2",
                        k9ejsUnread, Operand::kImm, Immediate::kList, kPopFlags};
constexpr IsaKind kTPush{C::kThumbBlock, "n", "l", "", "l != 0", "n; n = 1: 2", k9ejsUnread,
                         Operand::kImm, Immediate::kList, kPushFlags};
constexpr IsaKind kTPushLr{C::kThumbBlock, "n", "l", "", "", "n; n = 1: 2", k9ejsUnread,
                           Operand::kImm, Immediate::kList, kPushFlags};
constexpr IsaKind kTBranch{C::kThumbBranch, "", "", "", "", kBranchCycles, k9es, Operand::kImm,
                           Immediate::kSigned, kReadsPc};
constexpr IsaKind kTBranchReg{C::kThumbBranch, "m", "", "", "", kBranchCycles, k9es};
constexpr IsaKind kTBranchRegNoPc{C::kThumbBranch, "m", "", "", "m != 15", kBranchCycles, k9es};
constexpr IsaKind kTPrefix{C::kThumbBranch, "", "", "", "", "1", k7ejs, Operand::kImm,
                           Immediate::kSigned, kReadsPc};
constexpr IsaKind kTSuffix{C::kThumbBranch, "n", "", "", "", "3", k7ejs, Operand::kImm, kPlain};
constexpr IsaKind kTTrap{C::kThumbException, "", "", "", "", "3", k9ejsUnread};

// clang-format off
// The three operand forms of an operation with two sources, of one with one source, and of a
// comparison.
#define FOVEA_DATA(NAME, BITS, OP) \
  {NAME " imm", "cccc 001" BITS "S nnnn dddd rrrr iiii iiii", NAME "<S><c> <d>, <n>, #<i>", OP, kDataImm}, \
  {NAME " shift", "cccc 000" BITS "S nnnn dddd aaaa att0 mmmm", NAME "<S><c> <d>, <n>, <m><shift>", OP, kDataShift}, \
  {NAME " shift reg", "cccc 000" BITS "S nnnn dddd ssss 0tt1 mmmm", NAME "<S><c> <d>, <n>, <m>, <t> <s>", OP, kDataLate}
#define FOVEA_MOVE(NAME, BITS, OP) \
  {NAME " imm", "cccc 001" BITS "S ---- dddd rrrr iiii iiii", NAME "<S><c> <d>, #<i>", OP, kDataImm}, \
  {NAME " shift", "cccc 000" BITS "S ---- dddd aaaa att0 mmmm", NAME "<S><c> <d>, <m><shift>", OP, kDataShift}, \
  {NAME " shift reg", "cccc 000" BITS "S ---- dddd ssss 0tt1 mmmm", NAME "<S><c> <d>, <m>, <t> <s>", OP, kDataLate}
#define FOVEA_COMPARE(NAME, BITS, OP) \
  {NAME " imm", "cccc 001" BITS "1 nnnn ---- rrrr iiii iiii", NAME "<c> <n>, #<i>", OP, kCompareImm}, \
  {NAME " shift", "cccc 000" BITS "1 nnnn ---- aaaa att0 mmmm", NAME "<c> <n>, <m><shift>", OP, kCompareShift}, \
  {NAME " shift reg", "cccc 000" BITS "1 nnnn ---- ssss 0tt1 mmmm", NAME "<c> <n>, <m>, <t> <s>", OP, kCompareLate}
#define FOVEA_TRANSFER(NAME, B, L, OP, KIND) \
  {NAME " imm pre", "cccc 0101 U" B "W" L " nnnn dddd iiii iiii iiii", NAME "<c> <d>, [<n><pre>]<W>", OP, KIND.pre}, \
  {NAME " imm post", "cccc 0100 U" B "0" L " nnnn dddd iiii iiii iiii", NAME "<c> <d>, [<n>], <offset>", \
   OP, KIND.post}, \
  {NAME "t imm", "cccc 0100 U" B "1" L " nnnn dddd iiii iiii iiii", NAME "t<c> <d>, [<n>], <offset>", OP, KIND.user}, \
  {NAME " reg pre", "cccc 0111 U" B "W" L " nnnn dddd aaaa att0 mmmm", NAME "<c> <d>, [<n>, <reg>]<W>", \
   OP, KIND.pre_reg}, \
  {NAME " reg post", "cccc 0110 U" B "0" L " nnnn dddd aaaa att0 mmmm", NAME "<c> <d>, [<n>], <reg>", \
   OP, KIND.post_reg}, \
  {NAME "t reg", "cccc 0110 U" B "1" L " nnnn dddd aaaa att0 mmmm", NAME "t<c> <d>, [<n>], <reg>", OP, KIND.user_reg}
#define FOVEA_NARROW(NAME, L, SH, RD, OP, KIND) \
  {NAME " imm pre", "cccc 0001 U1W" L " nnnn " RD " iiii 1" SH "1 iiii", NAME "<c> <d>, [<n><pre>]<W>", OP, KIND.pre}, \
  {NAME " imm post", "cccc 0000 U1-" L " nnnn " RD " iiii 1" SH "1 iiii", NAME "<c> <d>, [<n>], <offset>", \
   OP, KIND.post}, \
  {NAME " reg pre", "cccc 0001 U0W" L " nnnn " RD " ---- 1" SH "1 mmmm", NAME "<c> <d>, [<n>, <reg>]<W>", \
   OP, KIND.pre_reg}, \
  {NAME " reg post", "cccc 0000 U0-" L " nnnn " RD " ---- 1" SH "1 mmmm", NAME "<c> <d>, [<n>], <reg>", \
   OP, KIND.post_reg}
// Instructions of coprocessors that this chip does not have; CC is the condition or 1111.
#define FOVEA_ABSENT(NAME, CC, COND) \
  {"cdp" NAME, CC " 1110 oooo CCCC DDDD pppp qqq0 MMMM", "cdp" NAME COND " <p>, <o>, <D>, <C>, <M>, <q>", \
   Op::kCoprocessor, kAbsent}, \
  {"ldc" NAME " pre", CC " 1101 ULW1 nnnn DDDD pppp iiii iiii", "ldc" NAME "<L>" COND " <p>, <D>, [<n><pre>]<W>", \
   Op::kCoprocessor, kAbsentPre, 0, "", 2}, \
  {"ldc" NAME " post", CC " 1100 UL11 nnnn DDDD pppp iiii iiii", "ldc" NAME "<L>" COND " <p>, <D>, [<n>], <offset>", \
   Op::kCoprocessor, kAbsentPost, 0, "", 2}, \
  {"ldc" NAME " option", CC " 1100 1L01 nnnn DDDD pppp kkkk kkkk", "ldc" NAME "<L>" COND " <p>, <D>, [<n>], {<k>}", \
   Op::kCoprocessor, kAbsent}, \
  {"stc" NAME " pre", CC " 1101 ULW0 nnnn DDDD pppp iiii iiii", "stc" NAME "<L>" COND " <p>, <D>, [<n><pre>]<W>", \
   Op::kCoprocessor, kAbsentPre, 0, "", 2}, \
  {"stc" NAME " post", CC " 1100 UL10 nnnn DDDD pppp iiii iiii", "stc" NAME "<L>" COND " <p>, <D>, [<n>], <offset>", \
   Op::kCoprocessor, kAbsentPost, 0, "", 2}, \
  {"stc" NAME " option", CC " 1100 1L00 nnnn DDDD pppp kkkk kkkk", "stc" NAME "<L>" COND " <p>, <D>, [<n>], {<k>}", \
   Op::kCoprocessor, kAbsent}

constexpr IsaRow kRows[] = {
  // Data processing.
  FOVEA_DATA("and", "0 000", Op::kAnd),
  FOVEA_DATA("eor", "0 001", Op::kEor),
  FOVEA_DATA("sub", "0 010", Op::kSub),
  FOVEA_DATA("rsb", "0 011", Op::kRsb),
  FOVEA_DATA("add", "0 100", Op::kAdd),
  FOVEA_DATA("adc", "0 101", Op::kAdc),
  FOVEA_DATA("sbc", "0 110", Op::kSbc),
  FOVEA_DATA("rsc", "0 111", Op::kRsc),
  FOVEA_COMPARE("tst", "1 000", Op::kTst),
  FOVEA_COMPARE("teq", "1 001", Op::kTeq),
  FOVEA_COMPARE("cmp", "1 010", Op::kCmp),
  FOVEA_COMPARE("cmn", "1 011", Op::kCmn),
  FOVEA_DATA("orr", "1 100", Op::kOrr),
  FOVEA_MOVE("mov", "1 101", Op::kMov),
  FOVEA_DATA("bic", "1 110", Op::kBic),
  FOVEA_MOVE("mvn", "1 111", Op::kMvn),
  // Multiplies: the result, or its upper half, is field n.
  {"mul", "cccc 0000 000S nnnn ---- ssss 1001 mmmm", "mul<S><c> <n>, <m>, <s>", Op::kMul, kMulKind},
  {"mla", "cccc 0000 001S nnnn dddd ssss 1001 mmmm", "mla<S><c> <n>, <m>, <s>, <d>", Op::kMla, kMulKind},
  {"umull", "cccc 0000 100S nnnn dddd ssss 1001 mmmm", "umull<S><c> <d>, <n>, <m>, <s>", Op::kUmull, kUmullKind},
  {"umlal", "cccc 0000 101S nnnn dddd ssss 1001 mmmm", "umlal<S><c> <d>, <n>, <m>, <s>", Op::kUmlal, kUmlalKind},
  {"smull", "cccc 0000 110S nnnn dddd ssss 1001 mmmm", "smull<S><c> <d>, <n>, <m>, <s>", Op::kSmull, kUmullKind},
  {"smlal", "cccc 0000 111S nnnn dddd ssss 1001 mmmm", "smlal<S><c> <d>, <n>, <m>, <s>", Op::kSmlal, kUmlalKind},
  {"smlaxy", "cccc 0001 0000 nnnn dddd ssss 1yx0 mmmm", "smla<x><y><c> <n>, <m>, <s>, <d>", Op::kSmlaxy, kSmulKind},
  {"smlawy", "cccc 0001 0010 nnnn dddd ssss 1y00 mmmm", "smlaw<y><c> <n>, <m>, <s>, <d>", Op::kSmlawy, kSmulKind},
  {"smulwy", "cccc 0001 0010 nnnn ---- ssss 1y10 mmmm", "smulw<y><c> <n>, <m>, <s>", Op::kSmulwy, kSmulKind},
  {"smlalxy", "cccc 0001 0100 nnnn dddd ssss 1yx0 mmmm", "smlal<x><y><c> <d>, <n>, <m>, <s>", Op::kSmlalxy, kSmlalKind},
  {"smulxy", "cccc 0001 0110 nnnn ---- ssss 1yx0 mmmm", "smul<x><y><c> <n>, <m>, <s>", Op::kSmulxy, kSmulKind},
  {"qadd", "cccc 0001 0000 nnnn dddd ---- 0101 mmmm", "qadd<c> <d>, <m>, <n>", Op::kQadd, kSaturateKind},
  {"qsub", "cccc 0001 0010 nnnn dddd ---- 0101 mmmm", "qsub<c> <d>, <m>, <n>", Op::kQsub, kSaturateKind},
  {"qdadd", "cccc 0001 0100 nnnn dddd ---- 0101 mmmm", "qdadd<c> <d>, <m>, <n>", Op::kQdadd, kSaturateKind},
  {"qdsub", "cccc 0001 0110 nnnn dddd ---- 0101 mmmm", "qdsub<c> <d>, <m>, <n>", Op::kQdsub, kSaturateKind},
  {"clz", "cccc 0001 0110 ++++ dddd ++++ 0001 mmmm", "clz<c> <d>, <m>", Op::kClz, kClzKind},
  // Status registers.
  {"mrs cpsr", "cccc 0001 0000 ++++ dddd ---- 0000 ----", "mrs<c> <d>, CPSR", Op::kMrs, kMrsKind},
  {"mrs spsr", "cccc 0001 0100 ++++ dddd ---- 0000 ----", "mrs<c> <d>, SPSR", Op::kMrs, kMrsKind, kSpsr},
  {"msr cpsr reg", "cccc 0001 0010 ffff ++++ ---- 0000 mmmm", "msr<c> CPSR_<f>, <m>", Op::kMsr, kMsrReg},
  {"msr spsr reg", "cccc 0001 0110 ffff ++++ ---- 0000 mmmm", "msr<c> SPSR_<f>, <m>", Op::kMsr, kMsrSpsrReg, kSpsr},
  {"msr cpsr imm", "cccc 0011 0010 ffff ++++ rrrr iiii iiii", "msr<c> CPSR_<f>, #<i>", Op::kMsr, kMsrImm},
  {"msr spsr imm", "cccc 0011 0110 ffff ++++ rrrr iiii iiii", "msr<c> SPSR_<f>, #<i>", Op::kMsr, kMsrSpsrImm, kSpsr},
  // Loads and stores.
  FOVEA_TRANSFER("ldr", "0", "1", Op::kLdr, kLoadWord),
  FOVEA_TRANSFER("ldrb", "1", "1", Op::kLdrb, kLoadByte),
  FOVEA_TRANSFER("str", "0", "0", Op::kStr, kStoreWord),
  FOVEA_TRANSFER("strb", "1", "0", Op::kStrb, kStoreByte),
  FOVEA_NARROW("ldrh", "1", "01", "dddd", Op::kLdrh, kLoadNarrow),
  FOVEA_NARROW("ldrsb", "1", "10", "dddd", Op::kLdrsb, kLoadNarrow),
  FOVEA_NARROW("ldrsh", "1", "11", "dddd", Op::kLdrsh, kLoadNarrow),
  FOVEA_NARROW("strh", "0", "01", "dddd", Op::kStrh, kStoreNarrow),
  FOVEA_NARROW("ldrd", "0", "10", "eee0", Op::kLdrd, kLoadPair),
  FOVEA_NARROW("strd", "0", "11", "eee0", Op::kStrd, kStorePair),
  {"ldm", "cccc 100P U0W1 nnnn 0lll llll llll llll", "ldm<mode><c> <n><W>, <l>", Op::kLdm, kLdmKind},
  {"ldm pc", "cccc 100P U0W1 nnnn 1lll llll llll llll", "ldm<mode><c> <n><W>, <l>", Op::kLdm, kLdmPc, 0, "", 0, 0x8000},
  {"ldm user", "cccc 100P U1W1 nnnn 0lll llll llll llll", "ldm<mode><c> <n><W>, <l>^", Op::kLdm, kLdmUser},
  {"ldm return", "cccc 100P U1W1 nnnn 1lll llll llll llll", "ldm<mode><c> <n><W>, <l>^",
   Op::kLdm, kLdmReturn, 0, "", 0, 0x8000},
  {"stm", "cccc 100P U0W0 nnnn llll llll llll llll", "stm<mode><c> <n><W>, <l>", Op::kStm, kStmKind},
  {"stm user", "cccc 100P U1W0 nnnn llll llll llll llll", "stm<mode><c> <n><W>, <l>^", Op::kStm, kStmUser},
  {"swp", "cccc 0001 0000 nnnn dddd ---- 1001 mmmm", "swp<c> <d>, <m>, [<n>]", Op::kSwp, kSwpKind},
  {"swpb", "cccc 0001 0100 nnnn dddd ---- 1001 mmmm", "swpb<c> <d>, <m>, [<n>]", Op::kSwpb, kSwpbKind},
  {"pld imm", "1111 0101 U101 nnnn 1111 iiii iiii iiii", "pld [<n><pre>]", Op::kPld, kPldImm},
  {"pld reg", "1111 0111 U101 nnnn 1111 aaaa att0 mmmm", "pld [<n>, <reg>]", Op::kPld, kPldReg},
  // Branches.
  {"b", "cccc 1010 iiii iiii iiii iiii iiii iiii", "b<c> <target>", Op::kB, kBranchKind, 0, "", 2},
  {"bl", "cccc 1011 iiii iiii iiii iiii iiii iiii", "bl<c> <target>", Op::kBl, kBranchKind, 0, "", 2},
  {"blx imm", "1111 101h iiii iiii iiii iiii iiii iiii", "blx <target>", Op::kBlxImm, kBranchKind, 0, "", 2},
  {"bx", "cccc 0001 0010 ++++ ++++ ++++ 0001 mmmm", "bx<c> <m>", Op::kBxReg, kBranchReg},
  // Jazelle state is disabled, so BXJ behaves like BX.
  {"bxj", "cccc 0001 0010 ++++ ++++ ++++ 0010 mmmm", "bxj<c> <m>", Op::kBxReg, kBranchRegNoPc},
  {"blx reg", "cccc 0001 0010 ++++ ++++ ++++ 0011 mmmm", "blx<c> <m>", Op::kBlxReg, kBranchRegNoPc},
  // Exceptions.
  {"svc", "cccc 1111 kkkk kkkk kkkk kkkk kkkk kkkk", "svc<c> <k>", Op::kSwi, kTrap},
  {"bkpt", "cccc 0001 0010 kkkk kkkk kkkk 0111 kkkk", "bkpt <k>", Op::kBkpt, kTrapAlways},
  {"udf", "cccc 0111 1111 kkkk kkkk kkkk 1111 kkkk", "udf #<k>", Op::kUndefined, kTrapAlways},
  // Coprocessors. Only moves to and from CP15 have an effect.
  {"mcr", "cccc 1110 ooo0 CCCC dddd pppp qqq1 MMMM", "mcr<c> <p>, <o>, <d>, <C>, <M>, <q>", Op::kMcr, kMcrKind},
  {"mrc", "cccc 1110 ooo1 CCCC dddd pppp qqq1 MMMM", "mrc<c> <p>, <o>, <dflags>, <C>, <M>, <q>", Op::kMrc, kMrcKind},
  {"mcrr", "cccc 1100 0100 nnnn dddd pppp oooo MMMM", "mcrr<c> <p>, <o>, <d>, <n>, <M>", Op::kCoprocessor, kAbsentMove},
  {"mrrc", "cccc 1100 0101 nnnn dddd pppp oooo MMMM", "mrrc<c> <p>, <o>, <d>, <n>, <M>", Op::kCoprocessor, kAbsentMrrc},
  FOVEA_ABSENT("", "cccc", "<c>"),
  FOVEA_ABSENT("2", "1111", ""),
  {"mcr2", "1111 1110 ooo0 CCCC dddd pppp qqq1 MMMM", "mcr2 <p>, <o>, <d>, <C>, <M>, <q>",
   Op::kCoprocessor, kAbsentMove},
  {"mrc2", "1111 1110 ooo1 CCCC dddd pppp qqq1 MMMM", "mrc2 <p>, <o>, <d>, <C>, <M>, <q>", Op::kCoprocessor, kAbsent},

  // Thumb.
  {"t lsl imm", "0000 0aaa aamm mddd", "lsls <d>, <m>, #<a>", Op::kMov, kTShiftImm, 0, "t=0"},
  {"t lsr imm", "0000 1aaa aamm mddd", "lsrs <d>, <m>, #<a>", Op::kMov, kTShiftImm, 0, "t=1"},
  {"t asr imm", "0001 0aaa aamm mddd", "asrs <d>, <m>, #<a>", Op::kMov, kTShiftImm, 0, "t=2"},
  {"t add reg", "0001 100m mmnn nddd", "adds <d>, <n>, <m>", Op::kAdd, kTReg},
  {"t sub reg", "0001 101m mmnn nddd", "subs <d>, <n>, <m>", Op::kSub, kTReg},
  {"t add imm3", "0001 110i iinn nddd", "adds <d>, <n>, #<i>", Op::kAdd, kTImm},
  {"t sub imm3", "0001 111i iinn nddd", "subs <d>, <n>, #<i>", Op::kSub, kTImm},
  {"t mov imm", "0010 0ddd iiii iiii", "movs <d>, #<i>", Op::kMov, kTImm},
  {"t cmp imm", "0010 1nnn iiii iiii", "cmp <n>, #<i>", Op::kCmp, kTImm},
  {"t add imm8", "0011 0ddd iiii iiii", "adds <d>, #<i>", Op::kAdd, kTImm, 0, "n=d"},
  {"t sub imm8", "0011 1ddd iiii iiii", "subs <d>, #<i>", Op::kSub, kTImm, 0, "n=d"},
  {"t and", "0100 0000 00mm mddd", "ands <d>, <m>", Op::kAnd, kTReg, 0, "n=d"},
  {"t eor", "0100 0000 01mm mddd", "eors <d>, <m>", Op::kEor, kTReg, 0, "n=d"},
  {"t lsl reg", "0100 0000 10ss sddd", "lsls <d>, <s>", Op::kMov, kTShiftReg, 0, "m=d t=0"},
  {"t lsr reg", "0100 0000 11ss sddd", "lsrs <d>, <s>", Op::kMov, kTShiftReg, 0, "m=d t=1"},
  {"t asr reg", "0100 0001 00ss sddd", "asrs <d>, <s>", Op::kMov, kTShiftReg, 0, "m=d t=2"},
  {"t adc", "0100 0001 01mm mddd", "adcs <d>, <m>", Op::kAdc, kTReg, 0, "n=d"},
  {"t sbc", "0100 0001 10mm mddd", "sbcs <d>, <m>", Op::kSbc, kTReg, 0, "n=d"},
  {"t ror reg", "0100 0001 11ss sddd", "rors <d>, <s>", Op::kMov, kTShiftReg, 0, "m=d t=3"},
  {"t tst", "0100 0010 00mm mnnn", "tst <n>, <m>", Op::kTst, kTReg},
  {"t neg", "0100 0010 01nn nddd", "negs <d>, <n>", Op::kRsb, kTImm},
  {"t cmp", "0100 0010 10mm mnnn", "cmp <n>, <m>", Op::kCmp, kTReg},
  {"t cmn", "0100 0010 11mm mnnn", "cmn <n>, <m>", Op::kCmn, kTReg},
  {"t orr", "0100 0011 00mm mddd", "orrs <d>, <m>", Op::kOrr, kTReg, 0, "n=d"},
  {"t mul", "0100 0011 01mm mnnn", "muls <n>, <m>", Op::kMul, kTMul, 0, "s=n"},
  {"t bic", "0100 0011 10mm mddd", "bics <d>, <m>", Op::kBic, kTReg, 0, "n=d"},
  {"t mvn", "0100 0011 11mm mddd", "mvns <d>, <m>", Op::kMvn, kTReg},
  {"t add high", "0100 0100 dmmm mddd", "add <d>, <m>", Op::kAdd, kTHigh, 0, "n=d"},
  {"t cmp high", "0100 0101 nmmm mnnn", "cmp <n>, <m>", Op::kCmp, kTHighCmp},
  {"t mov high", "0100 0110 dmmm mddd", "mov <d>, <m>", Op::kMov, kTHigh},
  {"t bx", "0100 0111 0mmm m---", "bx <m>", Op::kBxReg, kTBranchReg},
  {"t blx reg", "0100 0111 1mmm m---", "blx <m>", Op::kBlxReg, kTBranchRegNoPc},
  {"t ldr pc", "0100 1ddd iiii iiii", "ldr <d>, [pc, <offset>]", Op::kLdr, kTLoad, kAlignPc, "n=15", 2},
  {"t str reg", "0101 000m mmnn nddd", "str <d>, [<n>, <m>]", Op::kStr, kTStoreReg},
  {"t strh reg", "0101 001m mmnn nddd", "strh <d>, [<n>, <m>]", Op::kStrh, kTStoreReg},
  {"t strb reg", "0101 010m mmnn nddd", "strb <d>, [<n>, <m>]", Op::kStrb, kTStoreReg},
  {"t ldrsb reg", "0101 011m mmnn nddd", "ldrsb <d>, [<n>, <m>]", Op::kLdrsb, kTLoadNarrowReg},
  {"t ldr reg", "0101 100m mmnn nddd", "ldr <d>, [<n>, <m>]", Op::kLdr, kTLoadReg},
  {"t ldrh reg", "0101 101m mmnn nddd", "ldrh <d>, [<n>, <m>]", Op::kLdrh, kTLoadNarrowReg},
  {"t ldrb reg", "0101 110m mmnn nddd", "ldrb <d>, [<n>, <m>]", Op::kLdrb, kTLoadNarrowReg},
  {"t ldrsh reg", "0101 111m mmnn nddd", "ldrsh <d>, [<n>, <m>]", Op::kLdrsh, kTLoadNarrowReg},
  {"t str imm", "0110 0iii iinn nddd", "str <d>, [<n>, <offset>]", Op::kStr, kTStore, 0, "", 2},
  {"t ldr imm", "0110 1iii iinn nddd", "ldr <d>, [<n>, <offset>]", Op::kLdr, kTLoad, 0, "", 2},
  {"t strb imm", "0111 0iii iinn nddd", "strb <d>, [<n>, <offset>]", Op::kStrb, kTStore},
  {"t ldrb imm", "0111 1iii iinn nddd", "ldrb <d>, [<n>, <offset>]", Op::kLdrb, kTLoadNarrow},
  {"t strh imm", "1000 0iii iinn nddd", "strh <d>, [<n>, <offset>]", Op::kStrh, kTStore, 0, "", 1},
  {"t ldrh imm", "1000 1iii iinn nddd", "ldrh <d>, [<n>, <offset>]", Op::kLdrh, kTLoadNarrow, 0, "", 1},
  {"t str sp", "1001 0ddd iiii iiii", "str <d>, [sp, <offset>]", Op::kStr, kTStore, 0, "n=13", 2},
  {"t ldr sp", "1001 1ddd iiii iiii", "ldr <d>, [sp, <offset>]", Op::kLdr, kTLoad, 0, "n=13", 2},
  {"t add pc", "1010 0ddd iiii iiii", "add <d>, pc, #<i>", Op::kAdd, kTAddress, kAlignPc, "n=15", 2},
  {"t add rd sp", "1010 1ddd iiii iiii", "add <d>, sp, #<i>", Op::kAdd, kTAddress, 0, "n=13", 2},
  {"t add sp", "1011 0000 0iii iiii", "add sp, #<i>", Op::kAdd, kTAddress, 0, "d=13 n=13", 2},
  {"t sub sp", "1011 0000 1iii iiii", "sub sp, #<i>", Op::kSub, kTAddress, 0, "d=13 n=13", 2},
  {"t push", "1011 0100 llll llll", "push <l>", Op::kStm, kTPush, 0, "n=13"},
  {"t push lr", "1011 0101 llll llll", "push <l>", Op::kStm, kTPushLr, 0, "n=13", 0, 0x4000},
  {"t pop", "1011 1100 llll llll", "pop <l>", Op::kLdm, kTLdm, 0, "n=13"},
  {"t pop pc", "1011 1101 llll llll", "pop <l>", Op::kLdm, kTPopPc, 0, "n=13", 0, 0x8000},
  {"t bkpt", "1011 1110 kkkk kkkk", "bkpt <k>", Op::kBkpt, kTTrap},
  {"t stmia", "1100 0nnn llll llll", "stmia <n>!, <l>", Op::kStm, kTStm},
  {"t ldmia", "1100 1nnn llll llll", "ldmia <n><W>, <l>", Op::kLdm, kTLdm},
  {"t udf", "1101 1110 kkkk kkkk", "udf #<k>", Op::kUndefined, kTTrap},
  {"t svc", "1101 1111 kkkk kkkk", "svc <k>", Op::kSwi, kTTrap},
  {"t b cond", "1101 cccc iiii iiii", "b<c> <target>", Op::kB, kTBranch, 0, "", 1},
  {"t b", "1110 0iii iiii iiii", "b <target>", Op::kB, kTBranch, 0, "", 1},
  {"t blx suffix", "1110 1iii iiii iii0", "blx <target>", Op::kThumbBlSuffix, kTSuffix, kSpsr, "n=14", 2},  // to ARM
  {"t bl prefix", "1111 0iii iiii iiii", "bl <target>", Op::kThumbBlPrefix, kTPrefix, 0, "", 12},
  {"t bl suffix", "1111 1iii iiii iiii", "bl <target>", Op::kThumbBlSuffix, kTSuffix, 0, "n=14", 1},
};
// clang-format on
#undef FOVEA_DATA
#undef FOVEA_MOVE
#undef FOVEA_COMPARE
#undef FOVEA_TRANSFER
#undef FOVEA_NARROW
#undef FOVEA_ABSENT

}  // namespace

std::span<const IsaRow> isa_rows() { return kRows; }

const char* class_name(InsnClass c) {
  constexpr const char* kNames[] = {
      "data", "data shift by register", "compare", "multiply", "long multiply", "dsp", "saturate",
      "clz", "status", "load", "store", "narrow", "double", "block", "swap", "preload", "branch",
      "exception", "coprocessor", "thumb alu", "thumb shift", "thumb multiply", "thumb high",
      "thumb memory", "thumb block", "thumb branch", "thumb exception"};
  static_assert(std::size(kNames) == static_cast<std::size_t>(InsnClass::kCount));
  return kNames[static_cast<std::size_t>(c)];
}

}  // namespace fovea::cpu
