// Prints the table of instructions as INSTRUCTIONS.md.
#include <cstdio>
#include <string>

#include "model/cpu/core/isa.h"

using fovea::cpu::class_name;
using fovea::cpu::InsnClass;
using fovea::cpu::isa_rows;

int main() {
  std::puts(
      "# Instructions of the ARM926EJ-S (ARMv5TE)\n\n"
      "Printed by `isa_table` from `core/isa.cpp`, which decoder, disassembler and random tests read;\n"
      "`iss.isa` fails when this file is older than the table.\n\n"
      "Pattern: from the top bit down. `0` `1` fixed, `-` should be zero, `+` should be one (both are\n"
      "ignored), letters are fields: `c` condition, `S` sets flags, `n` `d` `m` `s` registers (`e` is\n"
      "half of d), `a` shift distance, `t` kind of shift, `i` immediate, turned right by twice `r`,\n"
      "`l` register list, `P` `U` `W` indexing, `f` PSR fields, `x` `y` halves of SMULxy, `h` half of\n"
      "BLX, `k` a number for software, `p` `o` `q` `C` `D` `M` `L` of coprocessors. n is bits 19:16 and\n"
      "d bits 15:12 in ARM state, also where the manual calls them otherwise (the result of MUL is n).\n\n"
      "*Defined if*: otherwise the instruction is UNPREDICTABLE; `W:` only with write-back. Clauses about\n"
      "operands that a row lacks do not count.\n\n"
      "*Assembler*: field letters in angle brackets; `<pre>` `<offset>` `<reg>` are the offset with\n"
      "its sign, `<shift>` a shift of the last operand, if there is one.\n\n"
      "*Clocks*: issue with everything hit; *then*: so many more before the next instruction can use\n"
      "the result without waiting; *n* registers. A failed condition takes 1, a branch not taken 1.\n"
      "Thumb instructions take the clocks of their ARM equivalents.");
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
  return 0;
}
