@ Returns by operations that QEMU does not take for returns. Each must do what MOVS does.
#include "returns.inc"

  .text
  .global program
program:
  bl mmu_on
  bl fill_registers
  msr cpsr_f, #0
  from_exception_modes "movs pc, lr", movs_pc
  from_exception_modes "adds pc, lr", adds_pc
  from_exception_modes "orrs pc", orrs_pc
  from_exception_modes "mvns pc", mvns_pc
  from_exception_modes "rsbs pc", rsbs_pc
  from_exception_modes "bics pc", bics_pc
  b finish
  .ltorg

  .data
  .space 64
memory:
  .space 64
