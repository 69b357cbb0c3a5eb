// Prints the table of instructions as INSTRUCTIONS.md.
#include <cstdio>
#include <string>

#include "model/cpu/core/isa.h"

using fovea::cpu::class_name;
using fovea::cpu::InsnClass;
using fovea::cpu::isa_rows;

int main() {
  std::puts(R"(# Instructions of the ARM926EJ-S (ARMv5TE)

Printed by `isa_table` from `core/isa.cpp`, which decoder, disassembler and random tests read;
`iss.isa` fails when this file differs from what the table prints.

Pattern: from the top bit down. `0` `1` fixed, `-` should be zero, `+` should be one (both are
ignored), letters are fields: `c` condition, `S` sets flags, `n` `d` `m` `s` registers (`e` is
half of d), `a` shift distance, `t` kind of shift, `i` immediate, turned right by twice `r`,
`l` register list, `P` `U` `W` indexing, `f` PSR fields, `x` `y` halves of SMULxy, `h` half of
BLX, `k` a number for software, `p` `o` `q` `C` `D` `M` `L` of coprocessors. In ARM state n is
bits 19:16 and d bits 15:12, also where the manual names them otherwise (the result of MUL is n).

*Assembler*: field letters in angle brackets; `<pre>` `<offset>` `<reg>` are the offset with its
sign, `<shift>` a shift of the last operand, if there is one.

*Defined if*: otherwise the instruction is UNPREDICTABLE; `W:` only with write-back. Clauses about
operands that a row lacks do not count. Such instructions have the reactions of the last section,
and are counted and warned of.

*Clocks*: issue with everything hit (`iss.timing` compares the first figure with the core); *then*:
so many more before the next instruction can use the result without waiting; *n* registers. A
failed condition takes 1. Thumb instructions take the clocks of their ARM equivalents.)");
  for (unsigned k = 0; k < static_cast<unsigned>(InsnClass::kCount); ++k) {
    const std::string title = class_name(static_cast<InsnClass>(k));
    std::printf("\n## %c%s\n\n", static_cast<char>(title[0] - 'a' + 'A'), title.c_str() + 1);
    std::puts("| row | pattern | assembler | defined if | clocks | source of the clocks |\n"
              "|---|---|---|---|---|---|");
    for (const auto& row : isa_rows())
      if (row.kind.insn_class == static_cast<InsnClass>(k))
        std::printf("| %s | `%s` | `%s` | %s | %s | %s |\n", row.name, row.pattern, row.syntax,
                    row.kind.defined_if, row.kind.cycles, row.kind.source);
  }
  std::puts("\n## UNPREDICTABLE forms\n\n"
            "What happens where the clause is broken. Bits that should be zero or one are ignored. An\n"
            "instruction that fails its condition is none of these. Every one that passes counts in\n"
            "`cpu.unpredictable`, and its row is named in a warning.\n\n"
            "| clause | classes | reaction |\n|---|---|---|");
  for (const auto& r : fovea::cpu::isa_reactions())
    std::printf("| %s | %s | %s |\n", r.clause, r.classes, r.reaction);
  return 0;
}
