// Clocks of each row of the table of instructions, counted by hand from the manuals (ARM DDI 0222B
// chapter 8, ARM DDI 0214B chapter 9): plain operands, all cache hits, two registers in a list
// besides pc and lr, conditions that pass, branches that are taken. Not taken from the table, which
// is being tested.
#pragma once

namespace fovea::cpu::test {

struct HandCount {
  unsigned clocks;
  unsigned wait;  ///< of a following instruction that adds to the result written last
  const char* rows;  ///< names, separated by ", "
};

// clang-format off
inline constexpr HandCount kHandCounts[] = {
    {1, 0, "and imm, eor imm, sub imm, rsb imm, add imm, adc imm, sbc imm, rsc imm, orr imm, mov imm, "
           "bic imm, mvn imm"},
    {1, 0, "and shift, eor shift, sub shift, rsb shift, add shift, adc shift, sbc shift, rsc shift, "
           "orr shift, mov shift, bic shift, mvn shift"},
    {2, 0, "and shift reg, eor shift reg, sub shift reg, rsb shift reg, add shift reg, adc shift reg, "
           "sbc shift reg, rsc shift reg, orr shift reg, mov shift reg, bic shift reg, mvn shift reg"},
    {1, 0, "tst imm, teq imm, cmp imm, cmn imm, tst shift, teq shift, cmp shift, cmn shift"},
    {2, 0, "tst shift reg, teq shift reg, cmp shift reg, cmn shift reg"},
    {2, 1, "mul, mla"},
    {3, 1, "umull, umlal, smull, smlal"},
    {1, 1, "smlaxy, smlawy, smulwy, smulxy, qadd, qsub, qdadd, qdsub"},
    {2, 0, "smlalxy"},
    {1, 0, "clz"},
    {2, 0, "mrs cpsr, mrs spsr"},
    {1, 0, "msr cpsr reg, msr cpsr imm"},  // only the flags
    {3, 0, "msr spsr reg, msr spsr imm"},
    {1, 1, "ldr imm pre, ldr imm post, ldrt imm, ldr reg pre, ldr reg post, ldrt reg"},
    {1, 2, "ldrb imm pre, ldrb imm post, ldrbt imm, ldrb reg pre, ldrb reg post, ldrbt reg"},
    {1, 0, "str imm pre, str imm post, strt imm, str reg pre, str reg post, strt reg"},
    {1, 0, "strb imm pre, strb imm post, strbt imm, strb reg pre, strb reg post, strbt reg"},
    {1, 2, "ldrh imm pre, ldrh imm post, ldrh reg pre, ldrh reg post"},
    {1, 2, "ldrsb imm pre, ldrsb imm post, ldrsb reg pre, ldrsb reg post"},
    {1, 2, "ldrsh imm pre, ldrsh imm post, ldrsh reg pre, ldrsh reg post"},
    {1, 0, "strh imm pre, strh imm post, strh reg pre, strh reg post"},
    {2, 1, "ldrd imm pre, ldrd imm post, ldrd reg pre, ldrd reg post"},
    {2, 0, "strd imm pre, strd imm post, strd reg pre, strd reg post"},
    {2, 1, "ldm, ldm user"},
    {3 + 4, 0, "ldm pc, ldm return"},
    {2, 0, "stm, stm user"},
    {2, 0, "swp"},
    {2, 1, "swpb"},
    {1, 0, "pld imm, pld reg"},
    {3, 0, "b, bl, blx imm, bx, bxj, blx reg"},
    {3, 0, "svc, bkpt, udf"},
    {1, 0, "mcr"},
    {1, 1, "mrc"},
    {3, 0, "mcrr, mrrc, cdp, ldc pre, ldc post, ldc option, stc pre, stc post, stc option, cdp2, "
           "ldc2 pre, ldc2 post, ldc2 option, stc2 pre, stc2 post, stc2 option, mcr2, mrc2"},
    {1, 0, "t add reg, t sub reg, t add imm3, t sub imm3, t mov imm, t cmp imm, t add imm8, t sub imm8, "
           "t and, t eor, t adc, t sbc, t tst, t neg, t cmp, t cmn, t orr, t bic, t mvn, t add pc, "
           "t add rd sp, t add sp, t sub sp, t lsl imm, t lsr imm, t asr imm"},
    {2, 0, "t lsl reg, t lsr reg, t asr reg, t ror reg"},
    {4, 0, "t mul"},
    {1, 0, "t add high, t cmp high, t mov high"},
    {1, 1, "t ldr pc, t ldr reg, t ldr imm, t ldr sp"},
    {1, 2, "t ldrsb reg, t ldrh reg, t ldrb reg, t ldrsh reg, t ldrb imm, t ldrh imm"},
    {1, 0, "t str reg, t strh reg, t strb reg, t str imm, t strb imm, t strh imm, t str sp"},
    {2, 0, "t push, t stmia"},
    {3, 0, "t push lr"},
    {2, 1, "t pop, t ldmia"},
    {3 + 4, 0, "t pop pc"},
    {3, 0, "t bx, t blx reg, t b cond, t b, t blx suffix, t bl suffix"},
    {1, 0, "t bl prefix"},
    {3, 0, "t bkpt, t udf, t svc"},
};
// clang-format on

}  // namespace fovea::cpu::test
