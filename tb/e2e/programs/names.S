@ With JUMP: jumps to where nothing is. Without: what would be there.
    .syntax unified
    .arm
    .global _start
    .type _start, %function
_start:
#ifdef JUMP
    ldr pc, =0x90000000
    .ltorg
#endif
    .global far_away
    .type far_away, %function
far_away:
#ifdef JUMP
    .rept 6
    .word 0xE7F000F0
    .endr
#else
    b .
    .size far_away, . - far_away
#endif
