@ No C library: writes by SYS_WRITE0 and ends by SYS_EXIT_EXTENDED, in the state it is built for.
  .syntax unified
#ifdef __thumb__
  .thumb
#define CALL svc 0xAB
#else
#define CALL svc 0x123456
#endif
  .global _start
_start:
  adr r1, text
  movs r0, #4
  CALL
  adr r1, block
  movs r0, #0x20
  CALL
  b .
  .align 2
block: .word 0x20026, 5
text: .asciz "flat\n"
