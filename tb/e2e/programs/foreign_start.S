/* Start of foreign_sequences.c, which lies in internal RAM as a whole: vectors, stacks, and a data abort
   that is counted and skipped. */
#include "model/contract/memory_map.h"
    .syntax unified
    .arm
    .text                            /* linked first: lies at 0 */
    .global _start
_start:
    b reset
    b .                              /* undefined */
    b .                              /* software interrupt */
    b .                              /* prefetch abort */
    b data_abort
    nop
    b interrupt
    b .

reset:
    msr cpsr_c, #0xD7                /* abort mode */
    ldr sp, =0x7400
    msr cpsr_c, #0xD2                /* IRQ mode */
    ldr sp, =0x7800
    msr cpsr_c, #0xD3
    ldr sp, =0x8000
    ldr r0, =PARAM_PAGE_BASE
    bl boot_init                     /* clocks, UART0, SDRAM */
    bl main
1:  b 1b

data_abort:
    stmfd sp!, {r0, r1}
    ldr r1, =aborts
    ldr r0, [r1]
    add r0, r0, #1
    str r0, [r1]
    ldmfd sp!, {r0, r1}
    subs pc, lr, #4                  /* the instruction after the one that failed */

interrupt:
    sub lr, lr, #4
    stmfd sp!, {r0-r3, r12, lr}
    bl irq_handler
    ldmfd sp!, {r0-r3, r12, pc}^
    .ltorg
