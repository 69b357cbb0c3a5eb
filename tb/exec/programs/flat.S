@ No C library: checks the stack pointer at entry against SYS_HEAPINFO, writes by SYS_WRITE0, and ends by
@ SYS_EXIT_EXTENDED, in the state it is built for. Status 5, or 6 if the stack pointer is wrong.
  .syntax unified
#ifdef __thumb__
  .thumb
#define CALL svc 0xAB
#else
#define CALL svc 0x123456
#endif
  .global _start
_start:
  adr r1, pointer
  adr r4, heap
  str r4, [r1]
  movs r0, #0x16
  CALL
  ldr r5, [r4, #8]
  mov r6, sp
  cmp r5, r6
  bne wrong
  push {r5}
  pop {r6}
  cmp r5, r6
  bne wrong
  adr r1, text
  movs r0, #4
  CALL
  adr r1, block
  movs r0, #0x20
  CALL
  b .
wrong:
  adr r1, block
  movs r0, #6
  str r0, [r1, #4]
  movs r0, #0x20
  CALL
  b .
  .align 2
block: .word 0x20026, 5
pointer: .word 0
heap: .word 0, 0, 0, 0
text: .asciz "flat\n"
