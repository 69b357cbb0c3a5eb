#include "case.inc"
  .text
  .global program, random_done
program:
  bl random_prepare
  bl fill_registers
  msr cpsr_f, #0
  mov pc, #0x00200000
random_done:
  ldr sp, =stack_top
  bl random_check
  b finish
  .ltorg
