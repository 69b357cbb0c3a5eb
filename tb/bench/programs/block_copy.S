@ Copies by LDM and STM: 4 KB within the D-cache.
  .syntax unified
  .arm
  .global work
work:
  push {r4-r11, lr}
  ldr r12, =ROUNDS
1: ldr r0, =to
  ldr r1, =from
  ldr r3, [r0]               @ brings the lines of the destination in
  mov r2, #2048
2: ldmia r1!, {r4-r11}
  subs r2, r2, #32
  ldr r3, [r0]
  stmia r0!, {r4-r11}
  bhi 2b
  subs r12, r12, #1
  bne 1b
  pop {r4-r11, pc}
  .ltorg
  .bss
  .balign 32
from:
  .space 2048
to:
  .space 2048
