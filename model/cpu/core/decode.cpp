// From instruction words to records; ARM ARM DDI 0100 chapters A3, A5 and A6.
#include "model/cpu/core/instruction.h"

#include <bit>

namespace fovea::cpu {
namespace {

constexpr std::uint32_t bits(std::uint32_t w, unsigned hi, unsigned lo) {
  return (w >> lo) & ((2u << (hi - lo)) - 1u);
}
constexpr bool bit(std::uint32_t w, unsigned n) { return (w >> n) & 1u; }
constexpr std::uint16_t mask(unsigned r) { return static_cast<std::uint16_t>(1u << r); }

void note_pc(Instruction& i) {
  if ((i.sources | i.stored) & 0x8000u) i.flags |= kReadsPc;
}

/// Shifter operand of a data-processing instruction.
void shifter(Instruction& i, std::uint32_t w) {
  i.rm = static_cast<std::uint8_t>(bits(w, 3, 0));
  i.shift = static_cast<std::uint8_t>(bits(w, 6, 5));
  i.sources |= mask(i.rm);
  if (bit(w, 4)) {
    i.operand = Operand::kShiftReg;
    i.rs = static_cast<std::uint8_t>(bits(w, 11, 8));
    i.sources |= mask(i.rs);
  } else {
    i.amount = static_cast<std::uint8_t>(bits(w, 11, 7));
    i.operand = i.amount == 0 && i.shift == 0 ? Operand::kReg : Operand::kShiftImm;
  }
}

Instruction data_processing(std::uint32_t w) {
  Instruction i;
  i.op = static_cast<Op>(bits(w, 24, 21));
  i.rd = static_cast<std::uint8_t>(bits(w, 15, 12));
  i.rn = static_cast<std::uint8_t>(bits(w, 19, 16));
  if (bit(w, 20)) i.flags |= kSetFlags;
  if (i.op != Op::kMov && i.op != Op::kMvn) i.sources |= mask(i.rn);
  if (bit(w, 25)) {
    const unsigned rotate = bits(w, 11, 8) * 2;
    i.imm = std::rotr(bits(w, 7, 0), static_cast<int>(rotate));
    if (rotate) i.flags |= kImmCarry;
  } else {
    shifter(i, w);
  }
  note_pc(i);
  return i;
}

Instruction status_access(std::uint32_t w) {
  Instruction i;
  if (bit(w, 22)) i.flags |= kSpsr;
  if (bit(w, 21)) {
    i.op = Op::kMsr;
    i.rs = static_cast<std::uint8_t>(bits(w, 19, 16));  // field mask
    if (bit(w, 25)) {
      i.imm = std::rotr(bits(w, 7, 0), static_cast<int>(bits(w, 11, 8) * 2));
    } else {
      i.operand = Operand::kReg;
      i.rm = static_cast<std::uint8_t>(bits(w, 3, 0));
      i.sources = mask(i.rm);
    }
  } else {
    i.op = Op::kMrs;
    i.rd = static_cast<std::uint8_t>(bits(w, 15, 12));
  }
  return i;
}

/// Bits 27:25 = 000 with bit 7 and bit 4 set: multiplies, swaps, halfword and double transfers.
Instruction extension(std::uint32_t w) {
  Instruction i;
  const unsigned sh = bits(w, 6, 5);
  i.rn = static_cast<std::uint8_t>(bits(w, 19, 16));
  i.rd = static_cast<std::uint8_t>(bits(w, 15, 12));
  i.rs = static_cast<std::uint8_t>(bits(w, 11, 8));
  i.rm = static_cast<std::uint8_t>(bits(w, 3, 0));
  if (sh == 0) {
    if (bit(w, 24)) {
      if (bits(w, 23, 23) || bits(w, 21, 20)) return i;
      i.op = bit(w, 22) ? Op::kSwpb : Op::kSwp;
      i.sources = static_cast<std::uint16_t>(mask(i.rn) | mask(i.rm));
      return i;
    }
    if (bit(w, 20)) i.flags |= kSetFlags;
    i.sources = static_cast<std::uint16_t>(mask(i.rm) | mask(i.rs));
    switch (bits(w, 23, 21)) {
      case 0: i.op = Op::kMul; break;
      case 1: i.op = Op::kMla; i.stored = mask(i.rd); break;  // accumulator field is Rn = 15:12
      case 4: i.op = Op::kUmull; break;
      case 5: i.op = Op::kUmlal; i.stored = static_cast<std::uint16_t>(mask(i.rd) | mask(i.rn)); break;
      case 6: i.op = Op::kSmull; break;
      case 7: i.op = Op::kSmlal; i.stored = static_cast<std::uint16_t>(mask(i.rd) | mask(i.rn)); break;
      default: break;
    }
    return i;
  }
  // Halfword, signed byte, doubleword transfers.
  if (bit(w, 24)) i.flags |= kPre;
  if (bit(w, 23)) i.flags |= kUp;
  if (bit(w, 21) || !bit(w, 24)) i.flags |= kWriteBack;
  i.sources = mask(i.rn);
  if (bit(w, 22)) {
    i.imm = bits(w, 11, 8) << 4 | bits(w, 3, 0);
  } else {
    i.operand = Operand::kReg;
    i.sources |= mask(i.rm);
  }
  if (bit(w, 20)) {
    i.op = sh == 1 ? Op::kLdrh : sh == 2 ? Op::kLdrsb : Op::kLdrsh;
  } else if (sh == 1) {
    i.op = Op::kStrh;
    i.stored = mask(i.rd);
  } else {
    i.op = sh == 2 ? Op::kLdrd : Op::kStrd;
    if (i.rd & 1u) i.op = Op::kUndefined;  // odd register of a pair
    else if (sh == 3) i.stored = static_cast<std::uint16_t>(mask(i.rd) | mask(i.rd + 1u));
  }
  note_pc(i);
  return i;
}

/// Bits 27:23 = 00010, bit 20 = 0: status access, BX, CLZ, saturating and halfword multiplies.
Instruction miscellaneous(std::uint32_t w) {
  Instruction i;
  const unsigned op = bits(w, 22, 21), op2 = bits(w, 7, 4);
  i.rd = static_cast<std::uint8_t>(bits(w, 15, 12));
  i.rn = static_cast<std::uint8_t>(bits(w, 19, 16));
  i.rs = static_cast<std::uint8_t>(bits(w, 11, 8));
  i.rm = static_cast<std::uint8_t>(bits(w, 3, 0));
  i.sources = mask(i.rm);
  if (op2 == 0) return status_access(w);
  if (op2 == 1 && op == 1) {
    i.op = Op::kBxReg;
  } else if (op2 == 1 && op == 3) {
    i.op = Op::kClz;
  } else if (op2 == 2 && op == 1) {
    i.op = Op::kBxReg;  // BXJ with Jazelle disabled
  } else if (op2 == 3 && op == 1) {
    i.op = Op::kBlxReg;
  } else if (op2 == 5) {
    constexpr Op kSaturating[] = {Op::kQadd, Op::kQsub, Op::kQdadd, Op::kQdsub};
    i.op = kSaturating[op];
    i.sources |= mask(i.rn);
  } else if (op2 == 7 && op == 1) {
    i.op = Op::kBkpt;
    i.sources = 0;
  } else if ((op2 & 9u) == 8u) {
    i.sources |= mask(i.rs);
    if (bit(w, 5)) i.flags |= kTop1;
    if (bit(w, 6)) i.flags |= kTop2;
    switch (op) {
      case 0: i.op = Op::kSmlaxy; i.stored = mask(i.rd); break;
      case 1:
        i.op = bit(w, 5) ? Op::kSmulwy : Op::kSmlawy;
        if (i.op == Op::kSmlawy) i.stored = mask(i.rd);
        break;
      case 2: i.op = Op::kSmlalxy; i.stored = static_cast<std::uint16_t>(mask(i.rd) | mask(i.rn)); break;
      case 3: i.op = Op::kSmulxy; break;
    }
  } else {
    i.op = Op::kUndefined;
  }
  note_pc(i);
  return i;
}

Instruction word_transfer(std::uint32_t w) {
  Instruction i;
  i.rn = static_cast<std::uint8_t>(bits(w, 19, 16));
  i.rd = static_cast<std::uint8_t>(bits(w, 15, 12));
  i.sources = mask(i.rn);
  if (bit(w, 24)) i.flags |= kPre;
  if (bit(w, 23)) i.flags |= kUp;
  if (bit(w, 21) || !bit(w, 24)) i.flags |= kWriteBack;
  if (bit(w, 21) && !bit(w, 24)) i.flags |= kUserBank;
  if (bit(w, 25)) {
    if (bit(w, 4)) return Instruction{};
    shifter(i, w);
  } else {
    i.imm = bits(w, 11, 0);
  }
  if (bit(w, 20)) {
    i.op = bit(w, 22) ? Op::kLdrb : Op::kLdr;
  } else {
    i.op = bit(w, 22) ? Op::kStrb : Op::kStr;
    i.stored = mask(i.rd);
  }
  note_pc(i);
  return i;
}

Instruction block_transfer(std::uint32_t w) {
  Instruction i;
  i.op = bit(w, 20) ? Op::kLdm : Op::kStm;
  i.rn = static_cast<std::uint8_t>(bits(w, 19, 16));
  i.imm = bits(w, 15, 0);
  i.sources = mask(i.rn);
  if (bit(w, 24)) i.flags |= kPre;
  if (bit(w, 23)) i.flags |= kUp;
  if (bit(w, 22)) i.flags |= kUserBank;
  if (bit(w, 21)) i.flags |= kWriteBack;
  if (i.op == Op::kStm) {
    // Only the first register of a store can be waited for: the others are read later.
    if (i.imm) i.stored = mask(static_cast<unsigned>(std::countr_zero(i.imm)));
    if (i.imm & 0x8000u) i.flags |= kReadsPc;
  }
  note_pc(i);
  return i;
}

Instruction coprocessor(std::uint32_t w) {
  Instruction i;
  i.rs = static_cast<std::uint8_t>(bits(w, 11, 8));
  i.rd = static_cast<std::uint8_t>(bits(w, 15, 12));
  if (bits(w, 27, 24) == 14 && bit(w, 4)) {
    i.op = bit(w, 20) ? Op::kMrc : Op::kMcr;
    if (i.op == Op::kMcr) i.sources = mask(i.rd);
  } else {
    i.op = Op::kCoprocessor;
  }
  note_pc(i);
  return i;
}

std::uint32_t branch_offset(std::uint32_t w) {
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(w << 8) >> 6);
}

Instruction unconditional(std::uint32_t w) {
  Instruction i;
  if (bits(w, 27, 25) == 5) {
    i.op = Op::kBlxImm;
    i.imm = branch_offset(w) + (bit(w, 24) ? 2u : 0u);
    i.flags |= kReadsPc;
  } else if ((w & 0x0D70F000u) == 0x0550F000u) {
    i.op = Op::kPld;
  } else if (bits(w, 27, 24) == 14 || bits(w, 27, 25) == 6) {
    i = coprocessor(w);
    i.rs = 0;  // CDP2/MCR2/...: no such coprocessor
    i.op = Op::kCoprocessor;
  }
  return i;
}

Instruction arm(std::uint32_t w) {
  switch (bits(w, 27, 25)) {
    case 0:
      if (bit(w, 7) && bit(w, 4)) return extension(w);
      if (bits(w, 24, 23) == 2 && !bit(w, 20)) return miscellaneous(w);
      return data_processing(w);
    case 1:
      if (bits(w, 24, 23) == 2 && !bit(w, 20)) return bit(w, 21) ? status_access(w) : Instruction{};
      return data_processing(w);
    case 2:
    case 3:
      return word_transfer(w);
    case 4:
      return block_transfer(w);
    case 5: {
      Instruction i;
      i.op = bit(w, 24) ? Op::kBl : Op::kB;
      i.imm = branch_offset(w);
      i.flags |= kReadsPc;
      return i;
    }
    case 6:
      return coprocessor(w);
    default:
      if (bit(w, 24)) {
        Instruction i;
        i.op = Op::kSwi;
        return i;
      }
      return coprocessor(w);
  }
}

}  // namespace

Instruction decode_arm(std::uint32_t w) {
  Instruction i;
  if (bits(w, 31, 28) == 15) {
    i = unconditional(w);
    i.cond = 14;
  } else {
    i = arm(w);
    i.cond = static_cast<std::uint8_t>(bits(w, 31, 28));
  }
  i.raw = w;
  return i;
}

/// A Thumb instruction is the record of its ARM equivalent.
Instruction decode_thumb(std::uint16_t h) {
  Instruction i;
  const auto low = [h](unsigned at) { return static_cast<std::uint8_t>((h >> at) & 7u); };
  const auto alu = [&](Op op, unsigned rd, unsigned rn, bool flags = true) {
    i.op = op;
    i.rd = static_cast<std::uint8_t>(rd);
    i.rn = static_cast<std::uint8_t>(rn);
    if (flags) i.flags |= kSetFlags;
    if (op != Op::kMov && op != Op::kMvn) i.sources |= mask(rn);
  };
  const auto with_reg = [&](unsigned rm) {
    i.operand = Operand::kReg;
    i.rm = static_cast<std::uint8_t>(rm);
    i.sources |= mask(rm);
  };
  const auto memory = [&](Op op, unsigned rd, unsigned rn, std::uint32_t offset) {
    i.op = op;
    i.rd = static_cast<std::uint8_t>(rd);
    i.rn = static_cast<std::uint8_t>(rn);
    i.imm = offset;
    i.flags |= kPre | kUp;
    i.sources |= mask(rn);
    if (op == Op::kStr || op == Op::kStrb || op == Op::kStrh) i.stored = mask(rd);
  };
  switch (h >> 12) {
    case 0:
    case 1:
      if ((h >> 11) == 3) {  // ADD/SUB register or 3-bit immediate
        alu(h & 0x200 ? Op::kSub : Op::kAdd, low(0), low(3));
        if (h & 0x400) i.imm = low(6);
        else with_reg(low(6));
      } else {  // shift by immediate
        alu(Op::kMov, low(0), 0);
        with_reg(low(3));
        i.shift = static_cast<std::uint8_t>((h >> 11) & 3u);
        i.amount = static_cast<std::uint8_t>((h >> 6) & 31u);
        if (i.amount || i.shift) i.operand = Operand::kShiftImm;
      }
      break;
    case 2:
    case 3: {
      constexpr Op kOps[] = {Op::kMov, Op::kCmp, Op::kAdd, Op::kSub};
      alu(kOps[(h >> 11) & 3u], low(8), low(8));
      i.imm = h & 0xFFu;
      break;
    }
    case 4:
      if ((h >> 10) == 0x10) {
        const unsigned op = (h >> 6) & 15u;
        switch (op) {
          case 0: alu(Op::kAnd, low(0), low(0)); with_reg(low(3)); break;
          case 1: alu(Op::kEor, low(0), low(0)); with_reg(low(3)); break;
          case 2: case 3: case 4: case 7:  // LSL LSR ASR ROR by register
            alu(Op::kMov, low(0), 0);
            with_reg(low(0));
            i.operand = Operand::kShiftReg;
            i.shift = static_cast<std::uint8_t>(op == 7 ? 3 : op - 2);
            i.rs = low(3);
            i.sources |= mask(i.rs);
            break;
          case 5: alu(Op::kAdc, low(0), low(0)); with_reg(low(3)); break;
          case 6: alu(Op::kSbc, low(0), low(0)); with_reg(low(3)); break;
          case 8: alu(Op::kTst, 0, low(0)); with_reg(low(3)); break;
          case 9: alu(Op::kRsb, low(0), low(3)); i.imm = 0; break;
          case 10: alu(Op::kCmp, 0, low(0)); with_reg(low(3)); break;
          case 11: alu(Op::kCmn, 0, low(0)); with_reg(low(3)); break;
          case 12: alu(Op::kOrr, low(0), low(0)); with_reg(low(3)); break;
          case 13:  // MUL: ARM form has Rd in 19:16
            i.op = Op::kMul;
            i.flags |= kSetFlags;
            i.rn = low(0);
            i.rm = low(3);
            i.rs = low(0);
            i.sources = static_cast<std::uint16_t>(mask(i.rm) | mask(i.rs));
            break;
          case 14: alu(Op::kBic, low(0), low(0)); with_reg(low(3)); break;
          case 15: alu(Op::kMvn, low(0), 0); with_reg(low(3)); break;
        }
      } else if ((h >> 10) == 0x11) {
        const unsigned rd = low(0) | ((h >> 4) & 8u), rm = (h >> 3) & 15u;
        switch ((h >> 8) & 3u) {
          case 0: alu(Op::kAdd, rd, rd, false); with_reg(rm); break;
          case 1: alu(Op::kCmp, 0, rd); with_reg(rm); break;
          case 2: alu(Op::kMov, rd, 0, false); with_reg(rm); break;
          case 3:
            i.op = h & 0x80 ? Op::kBlxReg : Op::kBxReg;
            i.rm = static_cast<std::uint8_t>(rm);
            i.sources = mask(rm);
            break;
        }
      } else {  // LDR rd, [pc, #imm]
        memory(Op::kLdr, low(8), 15, (h & 0xFFu) * 4);
        i.flags |= kAlignPc;
      }
      break;
    case 5: {
      constexpr Op kOps[] = {Op::kStr, Op::kStrh, Op::kStrb, Op::kLdrsb,
                             Op::kLdr, Op::kLdrh, Op::kLdrb, Op::kLdrsh};
      memory(kOps[(h >> 9) & 7u], low(0), low(3), 0);
      i.operand = Operand::kReg;
      i.rm = low(6);
      i.sources |= mask(i.rm);
      break;
    }
    case 6: memory(h & 0x800 ? Op::kLdr : Op::kStr, low(0), low(3), ((h >> 6) & 31u) * 4); break;
    case 7: memory(h & 0x800 ? Op::kLdrb : Op::kStrb, low(0), low(3), (h >> 6) & 31u); break;
    case 8: memory(h & 0x800 ? Op::kLdrh : Op::kStrh, low(0), low(3), ((h >> 6) & 31u) * 2); break;
    case 9: memory(h & 0x800 ? Op::kLdr : Op::kStr, low(8), 13, (h & 0xFFu) * 4); break;
    case 10:
      alu(Op::kAdd, low(8), h & 0x800 ? 13 : 15, false);
      i.imm = (h & 0xFFu) * 4;
      if (!(h & 0x800)) i.flags |= kAlignPc;
      break;
    case 11:
      if ((h & 0xF00u) == 0) {
        alu(h & 0x80 ? Op::kSub : Op::kAdd, 13, 13, false);
        i.imm = (h & 0x7Fu) * 4;
      } else if ((h & 0x600u) == 0x400u) {
        i.rn = 13;
        i.sources = mask(13);
        i.flags |= kWriteBack;
        if (h & 0x800) {  // POP
          i.op = Op::kLdm;
          i.imm = (h & 0xFFu) | (h & 0x100 ? 0x8000u : 0u);
          i.flags |= kUp;
        } else {  // PUSH
          i.op = Op::kStm;
          i.imm = (h & 0xFFu) | (h & 0x100 ? 0x4000u : 0u);
          i.flags |= kPre;
          if (i.imm) i.stored = mask(static_cast<unsigned>(std::countr_zero(i.imm)));
        }
      } else if ((h & 0xF00u) == 0xE00u) {
        i.op = Op::kBkpt;
      }
      break;
    case 12:
      i.op = h & 0x800 ? Op::kLdm : Op::kStm;
      i.rn = low(8);
      i.imm = h & 0xFFu;
      i.flags |= kUp | kWriteBack;
      i.sources = mask(i.rn);
      if (i.op == Op::kStm && i.imm)
        i.stored = mask(static_cast<unsigned>(std::countr_zero(i.imm)));
      // LDMIA with the base in the list has no write-back.
      if (i.op == Op::kLdm && (i.imm >> i.rn & 1u))
        i.flags = static_cast<std::uint16_t>(i.flags & ~kWriteBack);
      break;
    case 13:
      if (((h >> 8) & 15u) == 15) {
        i.op = Op::kSwi;
      } else if (((h >> 8) & 15u) != 14) {
        i.op = Op::kB;
        i.cond = static_cast<std::uint8_t>((h >> 8) & 15u);
        i.imm = static_cast<std::uint32_t>(static_cast<std::int32_t>(static_cast<std::int8_t>(h)) * 2);
        i.flags |= kReadsPc;
      }
      break;
    case 14:
      if (h & 0x800) {  // BLX suffix
        i.op = h & 1 ? Op::kUndefined : Op::kThumbBlSuffix;
        i.imm = (h & 0x7FFu) * 2;
        i.flags |= kSpsr;  // marks the exchange to ARM
      } else {
        i.op = Op::kB;
        i.imm = static_cast<std::uint32_t>((static_cast<std::int32_t>(h) << 21) >> 20);
        i.flags |= kReadsPc;
      }
      break;
    default:
      if (h & 0x800) {
        i.op = Op::kThumbBlSuffix;
        i.imm = (h & 0x7FFu) * 2;
        i.sources = mask(14);
      } else {
        i.op = Op::kThumbBlPrefix;
        i.imm = static_cast<std::uint32_t>((static_cast<std::int32_t>(h) << 21) >> 9);
        i.flags |= kReadsPc;
      }
      break;
  }
  i.flags |= kThumbInsn;
  note_pc(i);
  i.raw = h;
  return i;
}

}  // namespace fovea::cpu
