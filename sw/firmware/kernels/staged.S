/* void staged_tile(uint8_t *out, const uint16_t *code, uint32_t *ram, uint32_t step)
 *
 * r0 out, r2 code, r3 ram, r12 the pattern of the next four pairs; r1 and lr the places from which the next
 * steps of the upper row (to `out`) and of the lower one (to `ram`) count. On the stack: the step and the
 * number of times that are left.
 *
 * Eight pairs take 26 clocks if nothing waits: two patterns (8), two codes (2), eight pairs (8), their
 * store (8). All loads but those from the stack read internal RAM. A store to `out` leaves through the
 * write buffer, which needs 37 clocks for 32 bytes, and about 50 while the EDMA is busy; so eight pairs for
 * `out` alternate with eight for `ram`, and the core hardly ever waits for the buffer. */
    .syntax unified
    .arm
    .section .text.staged, "ax", %progbits

/* The second four of eight pairs, the code of the four pairs behind them, and the store. */
.macro finish base, to
    ldm r8, {r8-r11}
    ldrh r12, [r2], #2
    ldr r8, [\base, r8]
    ldr r9, [\base, r9]
    ldr r10, [\base, r10]
    ldr r11, [\base, r11]!
    stm \to!, {r4-r11}
.endm

.macro first_four base
    ldr r4, [\base, r4]
    ldr r5, [\base, r5]
    ldr r6, [\base, r6]
    ldr r7, [\base, r7]!
.endm

.macro eight base, to
    ldm r12, {r4-r7}
    ldrh r8, [r2], #2
    first_four \base
    finish \base, \to
.endm

.macro two_rows
    ldr r9, [sp]
    ldm r12, {r4-r7}
    ldrh r1, [r2], #2
    ldrh lr, [r2], #2
    ldrh r8, [r2], #2
    add r0, r0, r9
    first_four r1
    finish r1, r0
    eight lr, r3
    .rept 4
    eight r1, r0
    eight lr, r3
    .endr
.endm

    .balign 32
    .global staged_tile
    .type staged_tile, %function
staged_tile:
    stmfd sp!, {r4-r11, lr}
    mov r4, #6
    stmfd sp!, {r3, r4}
    mov r12, r1
    mov r3, r2
    add r2, r12, #2
    ldrh r12, [r12]
1:  two_rows
    two_rows
    ldr r4, [sp, #4]
    subs r4, r4, #1
    str r4, [sp, #4]
    bne 1b
    add sp, sp, #8
    ldmfd sp!, {r4-r11, pc}
    .size staged_tile, . - staged_tile
