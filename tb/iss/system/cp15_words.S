@ Instructions that cp15.c runs one by one: undefined ones, and what only privileged modes may do.
#include "case.inc"
  .text
  .global run_word
  .type run_word, %function
@ run_word(word, user): the word is put behind, with clean caches, and run.
run_word:
  push {r4-r12, lr}
  adr r3, 1f
  str r0, [r3]
2:
  mrc p15, 0, r15, c7, c14, 3
  bne 2b
  mov r3, #0
  mcr p15, 0, r3, c7, c10, 4
  mcr p15, 0, r3, c7, c5, 0
  .irp r, 0, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12
  mov r\r, #0
  .endr
  mov lr, #0
  cmp r1, #0
  svcne #0x50
  mov r1, #0
  msr cpsr_f, #0
  b 1f
  .balign 32
1:
  nop
  svc #0x53
  pop {r4-r12, pc}

  .section .rodata
  .balign 4
  .global odd_words, odd_words_end
odd_words:
  @ User mode: reads and writes of every kind are undefined.
  mrc p15, 0, r1, c0, c0, 0
  mrc p15, 0, r1, c2, c0, 0
  mrc p15, 0, r1, c3, c0, 0
  mcr p15, 0, r1, c5, c0, 0
  mrc p15, 0, r1, c6, c0, 0
  mcr p15, 0, r1, c7, c10, 4
  mcr p15, 0, r1, c7, c5, 1
  mcr p15, 0, r1, c8, c7, 0
  mcr p15, 0, r1, c13, c0, 1
  @ No such register.
  mrc p15, 0, r1, c4, c0, 0
  mcr p15, 0, r1, c4, c0, 0
  mrc p15, 0, r1, c11, c0, 0
  mcr p15, 0, r1, c12, c0, 0
  mrc p15, 0, r1, c14, c0, 0
  mrc p15, 3, r1, c2, c0, 0
  mcr p15, 1, r1, c1, c0, 0
  mrc p15, 0, r1, c1, c0, 1
  mrc p15, 0, r1, c1, c1, 0
  mrc p15, 0, r1, c2, c0, 1
  mrc p15, 0, r1, c3, c0, 1
  mrc p15, 0, r1, c6, c0, 1
  mrc p15, 0, r1, c6, c1, 0
  mcr p15, 0, r1, c7, c8, 0
  mrc p15, 0, r1, c13, c0, 2
  @ Other coprocessors and forms.
  cdp p15, 0, c0, c0, c0, 0
  cdp p0, 1, c2, c3, c4, 5
  mrc p1, 0, r1, c0, c0, 0
  mcr p7, 0, r1, c0, c0, 0
  mrc p8, 7, r1, c0, c0, 0
  ldc p3, c0, [r1]
  ldc p3, c0, [r1], #4
  stc p9, c0, [r1, #4]!
  mcrr p15, 0, r1, r2, c0
  mrrc p6, 0, r1, r2, c0
  cdp2 p15, 0, c0, c0, c0, 0
  mcr2 p15, 0, r1, c0, c0, 0
  mrc2 p15, 0, r1, c0, c0, 0
  ldc2 p5, c0, [r1]
  stc2 p5, c0, [r1]
  .word 0xe7f000f0, 0xe7ffffff, 0xe6000010, 0xe7000030, 0xe7f1f2f3
  .word 0xf0000000, 0xf3212345, 0xf7f12345
  .word 0xe1a00000  @ one that is fine
odd_words_end:
