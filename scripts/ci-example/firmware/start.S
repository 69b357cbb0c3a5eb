@ Reset vector, stack, main(), and the end by semihosting. Everything lies in the internal RAM, which the
@ core can use at power-up.
    .syntax unified
    .arm

    .section .vectors, "ax", %progbits
    .global _start
    .type _start, %function
_start:
    b reset
    .rept 7
    b .                              @ no exception is expected
    .endr
    .size _start, . - _start

    .text
    .type reset, %function
reset:
    ldr sp, =0x00018000
    bl main
    @ SYS_EXIT: main() returned 0 or something else.
    cmp r0, #0
    ldreq r1, =0x20026               @ ADP_Stopped_ApplicationExit
    ldrne r1, =0x20023               @ ADP_Stopped_RunTimeErrorUnknown
    mov r0, #0x18
    svc #0x123456
    b .
    .size reset, . - reset
    .ltorg
