/* The frame of a random program (random_guests.py), in internal RAM: vectors, stacks, and what of the chip is set up
   before it. The words after the marks are replaced. Faults are skipped; an interrupt is counted, and returns with
   interrupts masked, so that one without acknowledgement does not keep the program from going on. */
#include "model/contract/memory_map.h"
    .syntax unified
    .arm
    .text                            /* linked first: lies at 0 */
    .global _start
_start:
    b reset
    movs pc, lr                      /* undefined: on with the next instruction */
    movs pc, lr                      /* software interrupt */
    b end                            /* prefetch abort: the program has lost its way */
    subs pc, lr, #4                  /* data abort: on with the next instruction */
    nop
    b interrupt
    b interrupt                      /* fast interrupt */

interrupt:
    sub lr, lr, #4
    push {r0, r1, lr}
    ldr r1, =taken
    ldr r0, [r1]
    add r0, r0, #1
    str r0, [r1]
    mrs r0, spsr
    orr r0, r0, #0xC0
    msr spsr_c, r0
    ldm sp!, {r0, r1, pc}^

reset:
    msr cpsr_c, #0xD1                /* FIQ mode */
    ldr sp, =0x3400
    msr cpsr_c, #0xD2                /* IRQ mode */
    ldr sp, =0x3800
    msr cpsr_c, #0xD3
    ldr sp, =0x3F00
    ldr r4, =options
    ldr r4, [r4]
    tst r4, #1                       /* clocks, UART0, SDRAM */
    ldrne r0, =PARAM_PAGE_BASE
    blne boot_init
    tst r4, #2                       /* all modules of the chip */
    beq program
    ldr r0, =0x01C41000              /* PSC */
    add r1, r0, #0xA00               /* MDCTL0 */
    add r2, r1, #4 * 52
1:  ldr r3, [r1]
    bic r3, r3, #0x1F
    orr r3, r3, #3                   /* enable */
    str r3, [r1], #4
    cmp r1, r2
    bne 1b
    mov r3, #3
    str r3, [r0, #0x120]             /* PTCMD */
2:  ldr r3, [r0, #0x128]             /* PTSTAT */
    tst r3, #3
    bne 2b
    b program
    .global end
end:
    mcr p15, 0, r0, c7, c0, 4        /* wait for interrupt */
    b end
    .ltorg
    .data
taken:
    .word 0
    .ascii "options of guest"
options:
    .word 0
    .section .program, "awx"
program:
    .ascii "random guest's.."
    .space 12288 - 16
