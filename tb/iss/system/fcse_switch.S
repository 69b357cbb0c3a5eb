#include "case.inc"
  .text
  .global switch_process
  .type switch_process, %function
switch_process:
1:
  mrc p15, 0, r15, c7, c14, 3
  bne 1b
  mov r3, #0
  mcr p15, 0, r3, c7, c10, 4
  mcr p15, 0, r0, c13, c0, 0
  mcr p15, 0, r3, c7, c7, 0
  mcr p15, 0, r3, c8, c7, 0
  nop
  bx lr
