/* Vectors, reset, stacks and exception entries. Located in internal RAM (see firmware.ld). */
#include "model/contract/memory_map.h"

    .syntax unified
    .arm

    .section .vectors, "ax", %progbits
    .global _start
    .type _start, %function
_start:
vectors:
    ldr pc, reset_address
    ldr pc, undefined_address
    ldr pc, swi_address
    ldr pc, prefetch_address
    ldr pc, data_address
    nop
    ldr pc, irq_address
    ldr pc, fiq_address
reset_address:     .word reset_handler
undefined_address: .word undefined_entry
swi_address:       .word swi_entry
prefetch_address:  .word prefetch_entry
data_address:      .word data_entry
irq_address:       .word irq_entry
fiq_address:       .word fiq_entry
    .size _start, . - _start

    .section .boot, "ax", %progbits
    .equ MODE_FIQ, 0x11
    .equ MODE_IRQ, 0x12
    .equ MODE_SVC, 0x13
    .equ MODE_ABT, 0x17
    .equ MODE_UND, 0x1B
    .equ NO_INTERRUPTS, 0xC0

    .global reset_handler
    .type reset_handler, %function
reset_handler:
    msr cpsr_c, #(MODE_SVC | NO_INTERRUPTS)
    /* A debugger may start a core that is already running: caches and MMU off, caches and TLB
     * invalidated. */
    mrc p15, 0, r0, c1, c0, 0
    bic r0, r0, #0x00002000          /* V: vectors at 0 */
    bic r0, r0, #0x00001000          /* I */
    bic r0, r0, #0x00000007          /* C, A, M */
    mcr p15, 0, r0, c1, c0, 0
    mov r0, #0
    mcr p15, 0, r0, c7, c7, 0
    mcr p15, 0, r0, c8, c7, 0
    mcr p15, 0, r0, c7, c10, 4

    ldr sp, =BOOT_STACK_TOP
    ldr r0, =PARAM_PAGE_BASE
    bl boot_init                     /* clocks, UART0, DDR2; uses only internal RAM */
    cmp r0, #0
    bne stop                         /* the page was refused */

    /* From here on DDR2 can be used. */
    msr cpsr_c, #(MODE_FIQ | NO_INTERRUPTS)
    ldr sp, =EXCEPTION_STACK_TOP
    msr cpsr_c, #(MODE_ABT | NO_INTERRUPTS)
    ldr sp, =EXCEPTION_STACK_TOP
    msr cpsr_c, #(MODE_UND | NO_INTERRUPTS)
    ldr sp, =EXCEPTION_STACK_TOP
    msr cpsr_c, #(MODE_IRQ | NO_INTERRUPTS)
    ldr sp, =__irq_stack_top
    msr cpsr_c, #(MODE_SVC | NO_INTERRUPTS)
    ldr sp, =__svc_stack_top

    bl mmu_enable                    /* page table, both caches; makes clearing the memory faster */

    mov r2, #0
    ldr r0, =__bss_start
    ldr r1, =__bss_end
1:  cmp r0, r1
    strlo r2, [r0], #4
    blo 1b
    ldr r0, =__uncached_start
    ldr r1, =__uncached_end
2:  cmp r0, r1
    strlo r2, [r0], #4
    blo 2b

    bl main
    b stop
    .size reset_handler, . - reset_handler

    .global stop
    .type stop, %function
/* Sleeps for ever: interrupts stay masked, so that every wake-up returns to the sleep. */
stop:
    msr cpsr_c, #(MODE_SVC | NO_INTERRUPTS)
    mov r0, #0
1:  mcr p15, 0, r0, c7, c0, 4
    b 1b
    .size stop, . - stop

    .type irq_entry, %function
irq_entry:
    sub lr, lr, #4
    stmfd sp!, {r0-r3, r12, lr}
    bl irq_dispatch
#ifdef CONSOLE
    bl background_frame_due
    cmp r0, #0
    bne frames_first
#endif
    ldmfd sp!, {r0-r3, r12, pc}^
    .size irq_entry, . - irq_entry

#ifdef CONSOLE
/* A table was being built, and a frame waits: the frame comes first. It is corrected in the mode and on the stack of
 * the build, with interrupts open; then the build goes on. What the entry has saved moves to that stack, because the
 * next interrupt needs its own one. */
    .type frames_first, %function
frames_first:
    mrs r0, spsr
    mov r1, sp
    add sp, sp, #24
    msr cpsr_c, #(MODE_SVC | NO_INTERRUPTS)
    sub sp, sp, #24
    ldmia r1!, {r2, r3, r12}         /* r0 to r2 of the build */
    stmia sp, {r2, r3, r12}
    ldmia r1, {r2, r3, r12}          /* r3, r12, pc */
    str r2, [sp, #12]
    str r3, [sp, #16]
    str r12, [sp, #20]
    stmfd sp!, {r0, r4, lr}
    mov r4, sp
    bic sp, sp, #7                   /* as functions expect it */
    bl background_frames
    mov sp, r4
    ldmfd sp!, {r0, r4, lr}
    msr spsr_cxsf, r0
    ldmfd sp!, {r0-r3, r12, pc}^
    .size frames_first, . - frames_first
#endif

/* Calls fatal_exception(kind, pc of the failing instruction), which prints a message and stops. */
    .type undefined_entry, %function
undefined_entry:
    sub r1, lr, #4
    mov r0, #0
    b fatal_exception
    .type swi_entry, %function
swi_entry:
    sub r1, lr, #4
    mov r0, #1
    b fatal_exception
    .type prefetch_entry, %function
prefetch_entry:
    sub r1, lr, #4
    mov r0, #2
    b fatal_exception
    .type data_entry, %function
data_entry:
    sub r1, lr, #8
    mov r0, #3
    b fatal_exception
    .type fiq_entry, %function
fiq_entry:
    sub r1, lr, #4
    mov r0, #4
    b fatal_exception
    .ltorg

/* Programs without interrupts need not define a dispatcher. */
    .weak irq_dispatch
    .type irq_dispatch, %function
irq_dispatch:
    mov r0, #5
    mov r1, lr
    b fatal_exception
