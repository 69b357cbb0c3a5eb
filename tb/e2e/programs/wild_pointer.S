/* From reset on, reads through a pointer that runs over addresses without memory. */
    .syntax unified
    .arm
    .global _start
_start:
    b reset
    nop
    nop
    nop
    subs pc, lr, #4                  /* data abort: on with the next instruction */
    nop
    nop
    nop

reset:
    ldr r0, =0x50000000
next:
    ldr r1, [r0], #4
    strb r1, [r0]
    b next
