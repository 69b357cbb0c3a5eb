@ Entry of a measured program: stack, page table, caches on, work(), end. Runs on the core with flat
@ memory and on qemu-system-arm; `svc #0x123456` is the semihosting call of both.
  .syntax unified
  .arm
  .global _start
_start:
  ldr sp, =stack_top
  ldr r0, =page_table        @ sections, VA = PA, write-back, for the 32 MB there are
  ldr r1, =0x00000c1e
  mov r2, #0
1: orr r3, r1, r2, lsl #20
  str r3, [r0, r2, lsl #2]
  add r2, r2, #1
  cmp r2, #32
  blo 1b
  mcr p15, 0, r0, c2, c0, 0
  mvn r0, #0
  mcr p15, 0, r0, c3, c0, 0
  mrc p15, 0, r0, c1, c0, 0
  ldr r1, =0x1005
  orr r0, r0, r1
  mcr p15, 0, r0, c1, c0, 0
  bl work
  mov r0, #0x18              @ SYS_EXIT
  ldr r1, =0x20026           @ ADP_Stopped_ApplicationExit
  svc #0x123456
2: b 2b
  .ltorg
  .bss
  .balign 16384
page_table:
  .space 16384
  .space 65536
stack_top:
