@ Lies in SDRAM, without newlib's start-up code: ends with a status that says what the loader left in the registers.
@ 1: r0 to r2 are not all 0; 2: the stack pointer is not the end of the SDRAM; 4: what is pushed does not come back.
    .syntax unified
    .arm
    .global _start
_start:
    orr r4, r0, r1
    orrs r4, r4, r2
    movne r4, #1
    cmp sp, #0x88000000
    orrne r4, r4, #2
    ldr r5, =0x5A17C0DE
    push {r5}
    pop {r6}
    cmp r5, r6
    orrne r4, r4, #4
    adr r1, 1f
    str r4, [r1, #4]
    mov r0, #0x20                    @ SYS_EXIT_EXTENDED
    svc 0x123456
1:  .word 0x20026, 0                 @ ADP_Stopped_ApplicationExit, status
    .ltorg
