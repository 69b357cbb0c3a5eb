/* Start of a boot loader in internal RAM that starts a program in SDRAM. loader_main() prepares the
 * board and provides the start state. Caches and MMU stay off, interrupts stay masked. */
    .syntax unified
    .arm

    .section .vectors, "ax", %progbits
    .global _start
    .type _start, %function
_start:
    b loader_reset
    .rept 7
    .word 0xE7F000F0                 /* undefined: an exception without a handler ends the run */
    .endr
    .size _start, . - _start

    .section .boot, "ax", %progbits
    .type loader_reset, %function
loader_reset:
    msr cpsr_c, #0xD3                /* supervisor mode, both interrupts masked */
    mrc p15, 0, r0, c1, c0, 0
    bic r0, r0, #0x00003000          /* V, I */
    bic r0, r0, #0x00000007          /* C, A, M */
    mcr p15, 0, r0, c1, c0, 0
    mov r0, #0
    mcr p15, 0, r0, c7, c7, 0
    mcr p15, 0, r0, c8, c7, 0
    mcr p15, 0, r0, c7, c10, 4
    ldr sp, =__loader_stack_top
    ldr r0, =start_state
    bl loader_main
    cmp r0, #0
    bne loader_stop
    ldr r4, =start_state
    ldmia r4, {r0-r2, sp, lr}
    bx lr
loader_stop:
    mov r0, #0
1:  mcr p15, 0, r0, c7, c0, 4        /* interrupts are masked: every wake-up returns here */
    b 1b
    .ltorg
    .size loader_reset, . - loader_reset
